"""How the cells of a solid are integrated, and which cells may be so (theory (E1), (E2), (E3))."""

from __future__ import annotations

from collections.abc import Iterable

from abut.cells import CELLS
from abut.errors import InputError
from abut.mesh.quadrature import BBAR, REDUCED

INTEGRATIONS = ("auto", "full", "reduced", "b-bar")


def resolved(how: str, kinds: Iterable[str], plane: str | None, volume_preserving: bool) -> str:
    """What "auto" means for a body of some cell types: "full", but where its material hardly changes its volume "b-bar" or
    "reduced" if that is for all of them; plane stress does not lock."""
    if how != "auto":
        return how
    for choice, known in (("b-bar", BBAR), ("reduced", REDUCED)):
        if volume_preserving and plane != "stress" and all(kind in known and _locks(kind) for kind in kinds):
            return choice
    return "full"


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


def _instead(kind: str) -> str:
    """What does not lock near a Poisson's ratio of 0.5 in place of b-bar."""
    cell = CELLS[kind]
    if kind in REDUCED:
        return "'full', or 'reduced' near a Poisson's ratio of 0.5"
    if cell.degree == 1:
        return f"'full', with {'tri6' if cell.dim == 2 else 'tet10'} cells near a Poisson's ratio of 0.5"
    return "'full'"
