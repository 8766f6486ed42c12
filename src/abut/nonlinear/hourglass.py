"""What to say of a load step that has failed where F-bar lets cells fold as hourglasses."""

from __future__ import annotations

from dataclasses import replace

from abut.bodies.volumes import point_volumes
from abut.nonlinear.hanging import place
from abut.problem.problem import ContactProblem
from abut.solution.state import State

FOLDED = (
    0.5  # of a cell's own change of volume, at a point of it: of what keeps its volume elsewhere hardly any differs
)


def hourglassing(problem: ContactProblem, state: State) -> str:
    """Which body with F-bar has a cell that folds, at a converged state, and what to do; empty where none does.

    F-bar holds the volume of a cell at its centre alone (theory (D7)). Under strong compression its stiffness loses
    definiteness along motions that leave the centre as it is, and points of a cell shrink until one turns inside out."""
    solids = problem.model.deformable
    now = problem.displacement(state).reshape(solids.points.shape)
    moved = replace(solids, mesh=replace(solids.mesh, points=solids.points + now))
    worst, told = FOLDED, ""
    for group in solids.groups():
        if group.integration != "b-bar":
            continue
        before, after = (point_volumes(each, group, group.rule) for each in (solids, moved))
        shares = (after / before) / (after.sum(axis=1) / before.sum(axis=1))[:, None]
        cell = int(shares.min(axis=1).argmin())
        if shares[cell].min() >= worst:
            continue
        worst = float(shares[cell].min())
        body = list(solids.materials)[int(solids.body_of[group.cells[cell]])]
        told = (
            f"cells of body '{body}' fold as hourglasses, which F-bar does not resist under strong compression: at a point "
            f"of cell {group.cells[cell]}, at {place(problem, int(group.nodes[cell, 0]))} in the undeformed mesh, the "
            f"change of volume is {worst:.2g} of that of the cell; integration = 'mixed' or cells of second order resist it"
        )
    return told
