"""How the cells of a solid are integrated, and which cells may be so (theory (E1), (E2), (E3), (E6), (E8))."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from math import inf

from abut.cells import CELLS
from abut.errors import InputError
from abut.materials.material import Material, linear, volume_preserving
from abut.materials.volume_split import volume_split
from abut.mesh.quadrature import BBAR, CONTINUOUS, PRESSURES, REDUCED

INTEGRATIONS = ("auto", "full", "reduced", "b-bar", "mixed")
LOCKING = 0.45 + 1e-9  # Poisson's ratio beyond which "auto" takes b-bar; constants' rounding aside
SECOND = 0.4996  # the same for cells of second order, which are a few percent too stiff up to there
TETRAHEDRA = 240.0  # bulk over shear modulus from which tetrahedra of second order are too stiff: Poisson's ratio 0.498


def resolved(how: str, kinds: Iterable[str], plane: str | None, material: Material, finite: bool = False) -> str:
    """What "auto" means for a body of some cell types, finite: under finite strains: "full", but where its
    material hardly changes its volume "b-bar" for cells of first order, "mixed" for those of second order; where it flows
    "reduced" if that is for all of them. Plane stress does not lock."""
    if how != "auto":
        return how
    rest, flows, kinds = linear(material), volume_preserving(material), list(kinds)
    poisson = 0.0 if rest is None else rest.poisson
    if plane == "stress" or not kinds:
        return "full"
    if all(kind in BBAR for kind in kinds) and (flows or poisson > LOCKING):
        return "b-bar"
    if flows and poisson < SECOND and all(kind in REDUCED and _locks(kind) for kind in kinds):
        return "reduced"
    if bulk_over_shear(poisson) > TETRAHEDRA and all(kind in CONTINUOUS for kind in kinds):
        return "full" if volume_split(material, finite) is None else "mixed"
    locked = poisson > SECOND or (flows and all(_locks(kind) for kind in kinds))
    return "mixed" if locked and all(kind in PRESSURES for kind in kinds) else "full"


def bulk_over_shear(poisson: float) -> float:
    """Of moduli, infinite at a Poisson's ratio of 0.5."""
    return inf if poisson == 0.5 else 2.0 * (1.0 + poisson) / (3.0 * (1.0 - 2.0 * poisson))


def _locks(kind: str) -> bool:
    """Whether it is stiffened by material that keeps its volume: what is not a triangle or tetrahedron of second order."""
    return not (CELLS[kind].corners == CELLS[kind].dim + 1 and CELLS[kind].degree == 2)


def check_integration(how: str, kinds: Iterable[str], plane: str | None, where: str) -> None:
    """Raises InputError, beginning with ``where``, for cell types that ``how`` is not for, with the reason."""
    for kind in kinds if how == "reduced" else ():
        if CELLS[kind].corners == CELLS[kind].dim + 1 and CELLS[kind].degree == 1:
            raise InputError(f"{where}: {kind} cells have a single point already; use 'full'")
        if kind not in REDUCED:
            raise InputError(
                f"{where}: 'reduced' leaves {kind} cells zero-energy modes (hourglass modes) that spread through the "
                f"mesh; use {'full or b-bar' if kind in BBAR else 'full'}, or {', '.join(REDUCED)} cells"
            )
    for kind in kinds if how == "b-bar" else ():
        if kind not in BBAR:
            raise InputError(
                f"{where}: 'b-bar' is for {' and '.join(BBAR)} cells, the body has {kind}; use {_instead(kind)}"
            )
        if plane == "stress":
            raise InputError(f"{where}: 'b-bar' has no benefit in plane stress, which does not lock; use 'full'")
    if how == "mixed" and plane == "stress":
        raise InputError(f"{where}: 'mixed' has no benefit in plane stress, which does not lock; use 'full'")
    for kind in kinds if how == "mixed" else ():
        if kind not in (*PRESSURES, *CONTINUOUS):
            raise InputError(
                f"{where}: 'mixed' is for {_mixed()} cells, the body has {kind}, for which no pressure of its "
                f"own is stable; use {_instead(kind)}"
            )
    of_cells, shared = [k for k in kinds if k in PRESSURES], [k for k in kinds if k in CONTINUOUS]
    if how == "mixed" and of_cells and shared:
        raise InputError(
            f"{where}: pressures of 'mixed' {shared[0]} cells are continuous, those of {of_cells[0]} cells are not, and the "
            "body has both; give each of them a body of its own, tied together"
        )


def check_resolved(
    how: str, kinds: Sequence[str], material: Material, plane: str | None, finite: bool, where: str
) -> None:
    """Raises InputError, beginning with ``where``, for a material that cells so integrated, "auto" resolved, cannot bear;
    finite: under finite strains."""
    _check_continuous(how, kinds, material, finite, where)
    _check_incompressible(how, material, plane, where)


def _check_continuous(how: str, kinds: Sequence[str], material: Material, finite: bool, where: str) -> None:
    """Raises InputError for a material whose mean stress is no matter of the volume alone, where pressures are
    continuous."""
    if how == "mixed" and any(kind in CONTINUOUS for kind in kinds) and volume_split(material, finite) is None:
        raise InputError(
            f"{where}: 'mixed' {CONTINUOUS[0]} cells are for isotropic materials with a Poisson's ratio > 0 whose mean "
            "stress is a matter of the change of volume alone (LinearElastic of small strains, Hencky, NeoHooke, "
            f"MooneyRivlin and other rubber, Plastic), not for {type(material).__name__} under "
            f"{'finite' if finite else 'small'} strains; "
            "use 'full', or another material"
        )


def _check_incompressible(how: str, material: Material, plane: str | None, where: str) -> None:
    """Raises InputError for a Poisson's ratio of 0.5 where cells could not move."""
    rest = linear(material)
    if how == "full" and plane != "stress" and rest is not None and rest.poisson == 0.5:
        raise InputError(
            f"{where}: a Poisson's ratio of 0.5 needs cells that can keep their volume: 'mixed', for {_mixed()} cells"
        )


def _mixed() -> str:
    """Types of cells that may be mixed."""
    return ", ".join((*PRESSURES, *CONTINUOUS))


def _instead(kind: str) -> str:
    """What does not lock near a Poisson's ratio of 0.5 in place of b-bar."""
    cell = CELLS[kind]
    if kind in REDUCED:
        return "'full', or 'reduced' near a Poisson's ratio of 0.5"
    if cell.degree == 1:
        better = "tri6 or quad8" if cell.dim == 2 else "tet10, hex20 or hex27"
        return f"'full', with {better} cells near a Poisson's ratio of 0.5"
    return "'full'"
