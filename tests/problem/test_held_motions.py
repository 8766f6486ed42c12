"""Neutral motions while bodies move far: rollers in races that are carried along, discs that find their place in a bowl."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.benchmarks.once_stopped import LOAD, races
from abut.diagnosis import check
from abut.mesh import make

HYPER = abut.NeoHooke(210e3, 0.3)
HELD = "resists it by its facets alone"


def far(model: abut.Model, **more: object) -> abut.Model:
    solids = [replace(solid, material=HYPER) for solid in model.solids]
    return replace(model, kinematics="finite", solids=solids, **more)


def carried(by: tuple[float, float]) -> abut.Model:
    """Both rings are moved by the same; the inner one is pressed down on the way."""
    supports = [abut.Support("outer.outer", x=by[0], y=by[1]), abut.Support("inner.inner", x=by[0])]
    return far(races("quad4", 4, 37), supports=supports)


@pytest.mark.parametrize("by", [(0.0, 0.0), pytest.param((1.5, 2.0), marks=pytest.mark.exhaustive)])
def test_rollers_share_the_load(by: tuple[float, float]) -> None:
    """Two rollers at 45 degrees take F / sqrt(2) each by statics, in the mean to the 2 % by which they lean as they give
    way, each to what facets leave; as well where the bearing is carried away, by far more than a facet. What holds their
    spin and their way round is below what facets leave, and no step is taken again."""
    solution = abut.solve(carried(by))
    assert solution.converged
    assert not {"force balance", "free rigid-body modes", "energy balance"} & {
        c.name for c in solution.certificate if not c.passed
    }
    step = solution.steps[-1]
    forces = np.array([np.hypot(*contact.force) for contact in solution.contacts])
    assert forces.mean() == pytest.approx(LOAD / np.sqrt(2.0), rel=0.02)
    assert forces == pytest.approx(LOAD / np.sqrt(2.0), rel=step.neutral)
    assert step.regularisation is not None
    assert 0.0 < step.regularisation < step.neutral
    assert sum(HELD in note for note in solution.notes) == 4
    assert not any("did not converge" in note or "led to" in note for note in solution.notes)


@pytest.mark.parametrize(("share", "status"), [(0.2, 4), (0.001, 0)])
def test_loads_along_the_race(share: float, status: int) -> None:
    """A force that drives a roller round the race is refused before anything is solved, one below what facets leave held."""
    along = share * LOAD * np.array([-1.0, 1.0]) / np.sqrt(2.0)
    model = far(races("quad4", 4, 37, loads=[abut.Force("r0.round", tuple(along))]))
    assert check(model).status == status
    if status:
        with pytest.raises(abut.SingularModelError, match=r"body 'r0' is free to .*the loads act in that direction"):
            abut.solve(model)


@pytest.mark.parametrize(("at", "held"), [("bowl", 1), ("bowl and lid", 2)])
def test_loads_that_settle(at: str, held: int) -> None:
    """A disc that a load presses askew into a bowl runs to where the load points to, as a pendulum does: nothing is refused,
    and only its spin is held. Between bowl and lid, round the same middle, a load on the lid says nothing of its place."""
    parts = {
        "bowl": make.ring((2.0, 3.0), (-180, 0), cells=(2, 61)),
        "disc": make.disc(0.8, centre=(0.0, -1.2), cells=6),
    }
    contacts, on = [abut.Contact("disc.round", "bowl.inner")], "disc.round"
    supports = [abut.Support("bowl.outer", x=0, y=0)]
    if at != "bowl":
        parts["lid"] = make.ring((0.2, 0.4), (-180, 0), cells=(2, 61))
        contacts.append(abut.Contact("disc.round", "lid.outer"))
        supports.append(abut.Support("lid.inner", x=0))
        on = "lid.inner"
    mesh = make.join(parts)
    model = abut.Model(
        mesh, [abut.Solid(body, HYPER) for body in mesh.bodies], supports, [abut.Force(on, (50.0, -500.0))], contacts,
        plane="strain", kinematics="finite",
    )  # fmt: skip
    report = check(model)
    assert report.status == 0
    assert sum(HELD in finding.line for finding in report.findings) == held


@pytest.mark.long
def test_a_disc_finds_the_bottom_of_a_bowl_by_its_weight() -> None:
    """It is laid in askew, far more than its weight presses in: it slides to the bottom, led by a drag. There it lies on a
    point or two, which resist hardly any rigid motion, and its weight alone brings it back, as that of a pendulum: what
    remains of the load needs no drag. The bowl is symmetric, so the bottom is its middle, to a hundredth of a facet."""
    parts = {
        "bowl": make.ring((1.6, 2.4), (-135, -45), cells=(3, 12)),
        "disc": make.disc(1.0, centre=(0.1, -0.6), cells=4),
    }
    model = abut.Model(
        make.join(parts), [abut.Solid(body, abut.NeoHooke(100.0, 0.3)) for body in parts],
        [abut.Support("bowl.outer", x=0, y=0)], [abut.BodyForce((0.0, -1.0), "disc")],
        [abut.Contact("disc.round", "bowl.inner")], plane="strain", kinematics="finite",
    )  # fmt: skip
    solution = abut.solve(model)
    assert solution.converged
    nodes = model.mesh.nodes_of("disc")
    lies = (model.mesh.points + solution.displacement.reshape(-1, 2))[nodes]
    assert abs(lies[:, 0].mean()) < 0.01 * 1.6 * np.pi / 24
    force = solution.contacts[0].resultant.force
    assert abs(force[0]) < 1e-6 * force[1]
    assert sum("led to time" in note for note in solution.notes) <= 1
