"""Rigid bodies and equations by multigrid: the answers of the direct solver."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.linear.multigrid import slots, wide
from abut.mesh.make import box, join
from abut.problem.constraints import supports
from models.constrained import SOFT, at
from models.rigid import glued

AGREE = 1e-8  # equations are met to 2e-9


def free_tool() -> abut.Model:
    """Pushed off its centre, held by contact alone."""
    mesh = join({"block": box((-2, 2), (-2, 2), (-2, 0), (6, 6, 3)), "tool": box((-1, 1), (-1, 1), (0, 1), (2, 3, 1))})
    mesh = replace(mesh, node_sets={"handle": np.array([at(mesh, "tool", 1.0, 1 / 3, 1.0)])})
    return abut.Model(
        mesh, [abut.Solid("block", SOFT)], [abut.Support("block.bottom", x=0, y=0, z=0)],
        [abut.NodalForce("handle", (0.0, 0.0, -3.0)), abut.Force("tool.top", (0.0, 0.0, -6.0))],
        [abut.Contact(contactor="block.top", target="tool.bottom")], rigid=[abut.Rigid("tool", x=0, y=0, rz=0)],
    )  # fmt: skip


def backed_pad(**contact: object) -> abut.Model:
    """A pad glued to a rigid back that is free but along x; equations tie the sides of the block."""
    parts = {
        "block": box((0, 1), (0, 1), (-1, 0), (5, 5, 4)), "pad": box((0, 1), (0, 1), (0, 1), (4, 4, 3)),
        "back": box((0, 1), (0, 1), (1, 1.3), (4, 4, 1)),
    }  # fmt: skip
    mesh = glued(join(parts), "pad", "back.bottom")
    left, right = (np.sort(mesh.nodes_of(f"block.{side}")) for side in ("left", "right"))
    inside = [(a, b) for a, b in zip(left, right) if -1.0 < mesh.points[a, 2] < 0.0]
    periodic = [
        abut.Equation((abut.Term(int(a), axis, 1.0), abut.Term(int(b), axis, -1.0))) for a, b in inside for axis in "yz"
    ]
    return abut.Model(
        mesh, [abut.Solid(body, SOFT) for body in ("block", "pad")], [abut.Support("block.bottom", x=0, y=0, z=0)],
        [abut.Force("back.top", (0.0, 0.1, -2.0))], [abut.Contact(contactor="block.top", target="pad.bottom", **contact)],
        rigid=[abut.Rigid("back", x=0.0)], equations=periodic,
    )  # fmt: skip


@pytest.mark.parametrize(
    "model", [free_tool(), backed_pad(friction=0.2), backed_pad(kind="tied")], ids=["tool", "friction", "tied"]
)
def test_same_answer_as_the_direct_path(model: abut.Model) -> None:
    ours, direct = (abut.solve(replace(model, solve=abut.SolveOptions(linear=kind))) for kind in ("amg", "direct"))
    assert "multigrid" in ours.solver
    assert ours.converged
    assert np.abs(ours.displacement - direct.displacement).max() < AGREE * np.abs(direct.displacement).max()
    p, q = ours.contacts[0].pressure, direct.contacts[0].pressure
    assert np.nanmax(np.abs(p - q)) < AGREE * np.nanmax(np.abs(q))
    (note,) = (note for note in ours.notes if "linear iterations" in note)
    assert int(note.split()[0]) < 100


def test_what_moves_many_points_has_no_place_in_the_blocks() -> None:
    """Five free motions of the back; displacements that an equation joins are alone in a block."""
    free = supports(backed_pad()).free
    many = wide(free, 3)
    assert many.sum() == 5
    slot, point = slots(free.tocsc()[:, ~many], 3)
    assert len(np.unique(slot)) == (~many).sum()
    moved = np.array([len(np.unique(free.tocsc()[:, [k]].indices // 3)) for k in np.flatnonzero(~many)])
    shared = np.isin(slot // 3, slot[moved == 2] // 3)
    assert shared.sum() == (moved == 2).sum() > 20
    assert len(point) == slot.max() // 3 + 1
