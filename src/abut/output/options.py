"""What of a solution is written to result files: of which steps, which fields, in which formats."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from abut import checks
from abut.errors import InputError
from abut.materials.invariants import max_shear, principal
from abut.model.step_choice import StepChoice, check_steps, chosen
from abut.solution.grids import Grid
from abut.types import Array

ARRAYS = {  # what a file may hold of the bodies, by its key
    "displacement": "displacement",
    "stress": "stress",
    "von-mises": "von_mises",
    "principal-stress": "principal_stress",
    "max-shear": "max_shear",
    "stress-error": "stress_error",
}
MATERIAL = "material"  # what materials remember, such as plastic strains
CONTACT = "contact"  # the files of contact surfaces
FIELDS = (*ARRAYS, MATERIAL, CONTACT)
USUAL = ("displacement", "stress", "von-mises", "stress-error", MATERIAL, CONTACT)
VTU, FRD, VTKHDF = "vtu", "frd", "vtkhdf"
FORMATS = (VTU, FRD, VTKHDF)
FAST, SMALL = "fast", "small"
COMPRESSIONS = (FAST, SMALL)


@dataclass(frozen=True)
class Output:
    """Which result files a run writes; tables, summary and report have every step in any case.

    Parameters
    ----------
    steps : str, int or sequence of int
        "all", "last", n for every n-th step, or a list of numbers; the last step is always among them.
    fields : sequence of str
        Names out of ``abut.output.options.FIELDS``; without any of the bodies' there is no ``fields.pvd``, without
        "contact" no ``contact_*.pvd``.
    formats : sequence of str
        "vtu" for ParaView, a file a step; "vtkhdf" for ParaView, all of these steps in one file for the bodies,
        ``fields.vtkhdf``, and one for each contact; "frd" for CalculiX GraphiX: ``fields.frd``, all of these steps in one
        file. What has all steps is written at the end of the run.
    compression : str
        "fast" (zlib), or "small" (LZMA): VTU files up to two fifths smaller, which take up to seven times as long to
        write. Both hold the same numbers, and viewers read both.
    restart : bool
        Whether restart files stay when the run is done, for another job to start from.

    Raises
    ------
    InputError
        For anything else.

    Examples
    --------
    >>> import abut
    >>> abut.Output(steps=10, fields=["displacement", "von-mises"]).wants(20)
    True
    """

    steps: StepChoice = "all"
    fields: Sequence[str] = USUAL
    formats: Sequence[str] = (VTU,)
    compression: str = FAST
    restart: bool = False

    def __post_init__(self) -> None:
        check_steps(self.steps, "output.steps")
        checks.choice(self.compression, "output.compression", COMPRESSIONS)
        for key, known in (("fields", FIELDS), ("formats", FORMATS)):
            given = getattr(self, key)
            if isinstance(given, str):
                raise InputError(f"output.{key}: expected a list of names, got {given!r}; write [{given!r}]")
            for name in checks.listed(given, f"output.{key}", "names"):
                checks.choice(name, f"output.{key}", known)

    def wants(self, number: int, last: bool = False) -> bool:
        """Whether files of a step are written; last: it is the last one."""
        return chosen(self.steps, number, last)

    @property
    def bodies(self) -> bool:
        """Whether VTU files of bodies are written."""
        return VTU in self.formats and self.body_fields

    @property
    def contacts(self) -> bool:
        """Whether those of contact surfaces are."""
        return VTU in self.formats and self.contact_fields

    @property
    def body_fields(self) -> bool:
        """Whether any field of bodies is asked for."""
        return any(name in self.fields for name in (*ARRAYS, MATERIAL))

    @property
    def contact_fields(self) -> bool:
        """Whether those of contact surfaces are."""
        return CONTACT in self.fields

    @property
    def small(self) -> bool:
        """Whether VTU files are to be small rather than quickly written."""
        return self.compression == SMALL

    @property
    def frd(self) -> bool:
        """Whether ``fields.frd`` is."""
        return FRD in self.formats

    @property
    def vtkhdf(self) -> bool:
        """Whether ``fields.vtkhdf`` and the like are."""
        return VTKHDF in self.formats

    def with_frd(self) -> Output:
        """The same with ``fields.frd``."""
        return self if self.frd else replace(self, formats=(*self.formats, FRD))

    def of_bodies(self, grid: Grid) -> Grid:
        """A grid of bodies with the arrays that are asked for, and the body's number."""
        known = grid.point_data
        if "principal-stress" in self.fields:
            known = {**known, "principal_stress": principal(known["stress"])}
        if "max-shear" in self.fields:
            known = {**known, "max_shear": max_shear(known["stress"])}
        left_out = {array for name, array in ARRAYS.items() if name not in self.fields}
        if MATERIAL not in self.fields:
            left_out |= known.keys() - set(ARRAYS.values())
        return single(
            replace(
                grid,
                point_data={name: values for name, values in known.items() if name not in left_out},
                cell_data={name: values for name, values in grid.cell_data.items() if name not in left_out},
            )
        )


EVERYTHING = Output()


def single(grid: Grid) -> Grid:
    """A grid with 32-bit numbers, 7 digits, but for its points and displacements, whose differences are strains."""

    def short(data: dict[str, Array]) -> dict[str, Array]:
        return {
            name: values.astype(np.float32) if values.dtype == np.float64 and name != "displacement" else values
            for name, values in data.items()
        }

    return replace(grid, point_data=short(grid.point_data), cell_data=short(grid.cell_data))
