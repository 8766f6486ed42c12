"""Shells and beams of a job file: the mesh with these made solid, and which tables say something of their nodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from pydantic import BaseModel

from abut.errors import InputError
from abut.io.raw import RawMesh
from abut.job.schema import JobFile, MeshTable, SupportTable
from abut.job.values import values
from abut.mesh.mesh import Mesh
from abut.mesh.read import read_raw
from abut.model.conditions import TURNS
from abut.thin.quadratic import sort
from abut.thin.records import Beam, MidForce, MidSupport, Shell, Thick, Thin, bodies_of

AUTO = "auto"
FORCE = "nodal-force"


@dataclass(frozen=True)
class Parts:
    """thick: the mesh, with what is said of nodes of shells and beams; supports, loads: which tables say that."""

    thick: Thick
    supports: frozenset[int] = frozenset()
    loads: frozenset[int] = frozenset()
    sections: Mapping[str, Thin] = field(default_factory=dict)

    def integration(self, body: str, given: str) -> str:
        """Of a body: where it is left to abut, that which does not lock in a shell, and leaves beams and membranes no motion
        without stiffness."""
        section = self.sections.get(body)
        if section is None or given != AUTO:
            return given
        return "reduced" if isinstance(section, Shell) and not section.membrane else "full"


def with_thin(file: JobFile, folder: Path, mesh: Mesh | None) -> Parts:
    """Of a job. mesh: the one of a job without shells and beams. Raises InputError for what does not go together."""
    if mesh is not None:
        _check_solids(file)
        return Parts(Thick(mesh))
    from abut.thin.thicken import made_solid  # and decks with it, which other jobs need not load

    assert file.mesh.file is not None  # as checked with the mesh
    path = folder / file.mesh.file
    raw, sections = read_raw(path), thin_of(file.mesh)
    on = _named(raw, sections, str(path))
    held = [i for i, table in enumerate(file.supports) if table.on in on]
    loads = [table.model_dump() for table in file.loads]
    pushed = [i for i, load in enumerate(loads) if load["kind"] == FORCE and load["on"] in on]
    _check_solids(file, held, pushed)
    thick = made_solid(
        raw,
        str(path),
        sections,
        [_support(file.supports[i], f"supports[{i}]") for i in held],
        [_force(file.loads[i], f"loads[{i}]") for i in pushed],
        file.model.kinematics != "small",
        (held, pushed),
    )
    bodies = {body: section for name, section in sections.items() for body in bodies_of(name, section)}
    return Parts(thick, frozenset(held), frozenset(pushed), bodies)


def thin_of(table: MeshTable) -> dict[str, Thin]:
    """Sections by the name of their group. Raises InputError for one that is none."""
    result: dict[str, Thin] = {}
    for kind, make, tables in (("shells", Shell, table.shells), ("beams", Beam, table.beams)):
        for name, each in tables.items():
            if name in result:
                raise InputError(f"mesh.{kind}.{name}: it is a shell, too; keep one of them")
            try:
                result[name] = make(**values(each, f"mesh.{kind}.{name}"))
            except InputError as error:
                raise InputError(f"mesh.{kind}.{name}.{error}") from None
    return result


def _named(raw: RawMesh, sections: Mapping[str, Thin], where: str) -> set[str]:
    found = sort(raw, sections, where)
    return {*found.bodies, *found.on}


def _support(table: SupportTable, where: str) -> MidSupport:
    given = values(table, where)
    for name in ("normal", "axes"):
        if given.pop(name) is not None:
            raise InputError(
                f"{where}.{name}: '{table.on}' is a group of nodes of shells and beams; give x to rz along the global axes"
            )
    return MidSupport(**given)


def _force(table: BaseModel, where: str) -> MidForce:
    given = values(table, where)
    given.pop("kind")
    if given.pop("axes") is not None:
        raise InputError(
            f"{where}.axes: '{given['on']}' is a group of nodes of shells and beams; give global components"
        )
    return MidForce(**given)


def _check_solids(file: JobFile, held: Sequence[int] = (), pushed: Sequence[int] = ()) -> None:
    """Raise InputError for turns and moments of nodes of solids."""
    words = (
        "nodes of shells and beams (mesh.shells, mesh.beams) alone turn; couple the nodes of a solid ([[couplings]])"
    )
    for i, support in enumerate(file.supports):
        for name in TURNS if i not in held else ():
            if getattr(support, name) is not None:
                raise InputError(f"supports[{i}].{name}: '{support.on}' has none: {words}")
    for i, load in enumerate(table.model_dump() for table in file.loads):
        if i not in pushed and load["kind"] == FORCE and any(load["moment"]):
            raise InputError(f"loads[{i}].moment: '{load['on']}' carries none: {words}")
