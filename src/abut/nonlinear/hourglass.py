"""Where F-bar lets cells fold as hourglasses: steps in which they do at once, and what to say of one that has failed."""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

from abut.bodies.volumes import point_volumes
from abut.nonlinear.hanging import place
from abut.problem.problem import ContactProblem
from abut.solution.state import State


class Fold(NamedTuple):
    """share: the least change of volume at a point of a cell with F-bar over that of the cell, of which first is the first
    node, in a body."""

    share: float
    cell: int
    first: int
    body: str


def fold(problem: ContactProblem, state: State) -> Fold | None:
    """Of a state; None where no body has F-bar."""
    solids = problem.model.deformable
    now = problem.displacement(state).reshape(solids.points.shape)
    moved = replace(solids, mesh=replace(solids.mesh, points=solids.points + now))
    least: Fold | None = None
    for group in solids.groups():
        if group.integration != "b-bar":
            continue
        before, after = (point_volumes(each, group, group.rule) for each in (solids, moved))
        shares = (after / before) / (after.sum(axis=1) / before.sum(axis=1))[:, None]
        cell = int(shares.min(axis=1).argmin())
        if least is None or shares[cell].min() < least.share:
            body = list(solids.materials)[int(solids.body_of[group.cells[cell]])]
            least = Fold(float(shares[cell].min()), int(group.cells[cell]), int(group.nodes[cell, 0]), body)
    return least


def folds_at_once(problem: ContactProblem, before: State, now: State, folded: float) -> str:
    """Of a step that has converged: why it is not taken where cells fold by more than a share ``folded``; empty where none
    does.

    There equilibria are close to each other, and Newton's method gets to one that no path of small steps leads to. Without
    it ``test_swap.py::test_json_decks_and_mistakes`` fails: the pad of ``examples/deck`` differs by a quarter."""
    here, earlier = fold(problem, now), fold(problem, before)
    if here is None or earlier is None or here.share >= folded * earlier.share:
        return ""
    return (
        f"cells of body '{here.body}' fold at once: at a point {_where(problem, here)}, the change of volume is "
        f"{here.share:.2g} of that of the cell, at the least {earlier.share:.2g} before"
    )


def hourglassing(problem: ContactProblem, state: State, folded: float) -> str:
    """Which body with F-bar has a cell that folds, at a converged state, and what to do; empty where none does.

    F-bar holds the volume of a cell at its centre alone (theory (D7)). Under strong compression its stiffness loses
    definiteness along motions that leave the centre as it is, and points of a cell shrink until one turns inside out."""
    worst = fold(problem, state)
    if worst is None or worst.share >= folded:
        return ""
    return (
        f"cells of body '{worst.body}' fold as hourglasses, which F-bar does not resist under strong compression: at "
        f"a point {_where(problem, worst)}, the change of volume is {worst.share:.2g} of that of the cell; integration = "
        "'mixed' or cells of second order resist it"
    )


def _where(problem: ContactProblem, worst: Fold) -> str:
    return f"of cell {worst.cell}, at {place(problem, worst.first)} in the undeformed mesh"
