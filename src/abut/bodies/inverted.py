"""Cells without a sound deformation."""

from __future__ import annotations

from abut.bodies.solids import Group, Solids
from abut.errors import Unsound


class Inverted(Unsound):
    """A cell without a sound deformation. cell: its number; body: its name; determinant: of the deformation gradient."""

    def __init__(self, cell: int, body: str, determinant: float) -> None:
        self.cell, self.body, self.determinant = cell, body, determinant
        what = (
            f"turns inside out (det F = {determinant:.3g} at an integration point)"
            if determinant <= 0.0
            else f"has no stretch out of the plane without stress there (det F = {determinant:.3g})"
        )
        super().__init__(f"cell {cell} of body '{body}' {what}")


def require_sound(solids: Solids, group: Group, unsound: tuple[int, float] | None) -> None:
    """Raises Inverted for what the compiled core found of a group's cells: the row of one and its determinant."""
    if unsound is not None:
        cell = int(group.cells[unsound[0]])
        raise Inverted(cell, list(solids.materials)[solids.body_of[cell]], unsound[1])
