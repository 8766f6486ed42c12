"""Contact that nobody names, in 3D: bodies far apart that meet after a turn or a long way, found as they come near."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.detection import every_pair
from abut.mesh import make
from abut.mesh.mesh import Mesh
from models.sliding import SOFT, bent

SWING = abut.Amplitude(((0.0, 0.0), (0.6, 1.0), (1.0, 1.0)))
LIFT = abut.Amplitude(((0.0, 0.0), (0.6, 0.0), (1.0, 1.0)))


def found(mesh: Mesh, *held: abut.Support, rotations: tuple[abut.Rotation, ...] = ()) -> abut.Model:
    """Every body of a mesh may meet every other and itself."""
    solids = [abut.Solid(body, SOFT) for body in mesh.bodies]
    contacts = [pair.contact() for pair in every_pair(mesh, solids)]
    # Between whole outsides with sharp edges, coarse facets that reach beyond an edge of the other side do not converge yet,
    # which the arm's, the coarser ones, do.
    contacts = [each.forced("pad", "arm") if each.named == ("arm", "pad") else each for each in contacts]
    assert len(contacts) == 3
    return abut.Model(mesh, solids, held, contacts=contacts, rotations=rotations, kinematics="finite")


def pad() -> Mesh:
    """With a rounded top, under the place that the arm swings to."""
    box = make.box([-0.4, 0.4], [1.9, 2.7], [-0.8, 0.0], (2, 2, 1))
    return bent(
        box, lambda x: x - np.outer(0.3 * (x[:, 2] + 0.8) / 0.8 * (x[:, 0] ** 2 + (x[:, 1] - 2.3) ** 2), [0, 0, 1])
    )


@pytest.mark.long
def test_an_arm_swings_over_a_pad() -> None:
    """Out of reach at the outset, turned by a right angle, then pressed by the pad: as if it had been built there. On
    the way it passes close over the pad: that they see each other's far sides through themselves is no penetration."""
    arm = make.box([0, 3], [-0.3, 0.3], [0.05, 0.65], (5, 1, 1))
    there = bent(arm, lambda x: np.column_stack([-x[:, 1], x[:, 0], x[:, 2]]))
    lifted = abut.Support("pad.bottom", x=0.0, y=0.0, z=0.25, amplitude=LIFT)
    swung = abut.solve(
        found(
            make.join({"arm": arm, "pad": pad()}), lifted,
            rotations=(abut.Rotation("arm.left", 0.5 * np.pi, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), amplitude=SWING),),
        )
    )  # fmt: skip
    built = abut.solve(
        found(
            make.join({"arm": there, "pad": pad()}), lifted, abut.Support("arm.left", x=0.0, y=0.0, z=0.0)
        )
    )  # fmt: skip
    assert swung.converged
    assert built.converged
    now, other = (s.model.mesh.points + s.displacement for s in (swung, built))
    assert np.abs(now - other).max() < 1e-7
    forces = [np.abs(pair.contactor_forces).sum() for pair in built.contacts]
    assert max(forces) > 0.05
    for pair, same in zip(swung.contacts, built.contacts):
        assert np.allclose(pair.force, same.force, atol=1e-6 * max(forces))
    early = [step for step in swung.steps if step.factor <= 0.6]
    assert len(early) > 1
    assert all(pair.active == 0 for step in early for pair in step.contacts)
    failed = {check.name for check in swung.certificate if not check.passed}
    # The pad touches within four coarse facets, and one layer of cells bends: true alarms. The pad's bulge counts.
    assert failed == {"resolution", "overlap", "stress error"}
