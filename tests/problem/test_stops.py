"""Stops: bars that are pulled against rigid planes, in closed form."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.job.load import load_job
from abut.mesh.make import box, join, rectangle

YOUNG, LENGTH, FORCE, GAP = 1000.0, 10.0, 6.0, 0.02
EXACT = 1e-9  # stresses are uniform (nu = 0): linear cells have them exactly


def carried(area: float) -> float:
    """By the stop, when the bar has closed the gap: what is left of the force, E A g / L of which the bar takes."""
    return FORCE - YOUNG * area * GAP / LENGTH


def pulled(mesh, direction, plane=None, force=FORCE, on="bar.top", **more):
    """Held at its bottom, pulled at its top along ``direction``, nu = 0."""
    along = np.array(direction) / np.linalg.norm(direction)
    added = abut.add_stops(mesh, [abut.Stop(on, tuple(direction), GAP, "end")], plane)
    axes = "y" if plane == "axisymmetric" else "xyz"[: mesh.dim]
    return abut.Model(
        added.mesh,
        [abut.Solid("bar", abut.LinearElastic(YOUNG, 0.0))],
        [abut.Support("bar.bottom", **dict.fromkeys(axes, 0.0))],
        [abut.Force("bar.top", tuple(force * along))],
        added.contacts,
        plane=plane,
        rigid=added.rigid,
        **more,
    )


def turned(mesh, angle):
    """About the z axis."""
    c, s = np.cos(angle), np.sin(angle)
    turn = np.eye(mesh.dim)
    turn[:2, :2] = [[c, -s], [s, c]]
    return abut.Mesh(mesh.points @ turn.T, mesh.blocks, mesh.bodies, mesh.surfaces, mesh.node_sets)


FLAT = join({"bar": rectangle((0.0, 1.5), (0.0, LENGTH), (2, 4), "quad4")})
SOLID = join({"bar": box((0.0, 1.0), (0.0, 1.5), (0.0, LENGTH), (1, 2, 4))})
ROUND = join({"bar": rectangle((0.0, 0.5), (0.0, LENGTH), (1, 4), "quad4")})
CURVED = join({"bar": rectangle((0.0, 0.5), (0.0, LENGTH), (1, 4), "quad8")})


@pytest.mark.parametrize(
    ("mesh", "direction", "plane", "area"),
    [
        (FLAT, (0, 2), "stress", 1.5),
        (turned(FLAT, 0.4), (-np.sin(0.4), np.cos(0.4)), "stress", 1.5),
        (turned(FLAT, np.pi), (0, -1), "strain", 1.5),
        (SOLID, (0, 0, 1), None, 1.5),
        (ROUND, (0, 1), "axisymmetric", np.pi / 4),
        (CURVED, (0, 1), "axisymmetric", np.pi / 4),
    ],
    ids=["flat", "aslant", "down", "solid", "axisymmetric", "quadratic"],
)
def test_a_bar_is_pulled_onto_a_stop(mesh, direction, plane, area):
    """Its end stops at the distance, and the stop takes what the stretched bar does not; the load acts there, too."""
    solution = abut.solve(pulled(mesh, direction, plane))
    step, along = solution.steps[-1], np.array(direction) / np.linalg.norm(direction)
    moved = step.displacement[mesh.nodes_of("bar.top")] @ along
    assert moved == pytest.approx(GAP, rel=EXACT)
    assert step.contacts[0].name == "end"
    assert step.contacts[0].force @ along == pytest.approx(-carried(area), rel=1e-7)
    assert step.reactions["bar.bottom"] @ along == pytest.approx(-YOUNG * area * GAP / LENGTH, rel=1e-7)
    assert solution.converged
    assert all(check.passed for check in solution.certificate)


def test_a_bar_that_does_not_get_there_feels_nothing():
    step = abut.solve(pulled(FLAT, (0, 1), "stress", force=0.9 * (FORCE - carried(1.5)))).steps[-1]
    assert step.displacement[FLAT.nodes_of("bar.top"), 1] == pytest.approx(0.9 * GAP, rel=EXACT)
    assert np.abs(step.contacts[0].force).max() < 1e-12


def test_large_displacements():
    """Of a strip 1.5 wide: first Piola-Kirchhoff stress of the neo-Hookean law, nu = 0, at the stretch 1 + g / L."""
    mesh = join({"bar": rectangle((0.0, 1.5), (0.0, LENGTH), (2, 4), "quad4")})
    added = abut.add_stops(mesh, [abut.Stop("bar.top", (0, 1), 2.0)])
    model = abut.Model(
        added.mesh, [abut.Solid("bar", abut.NeoHooke(YOUNG, 0.0))],
        [abut.Support("bar.bottom", y=0), abut.Support("bar.left", x=0)], [abut.Force("bar.top", (0.0, 600.0))],
        added.contacts, plane="strain", rigid=added.rigid, kinematics="finite",
    )  # fmt: skip
    step = abut.solve(model).steps[-1]
    assert step.displacement[mesh.nodes_of("bar.top"), 1] == pytest.approx(2.0, rel=1e-8)
    stretch = 1.2  # nu = 0: mu = E / 2, lambda = 0, no lateral strain
    assert step.reactions["bar.bottom"][1] == pytest.approx(-1.5 * YOUNG / 2.0 * (stretch - 1.0 / stretch), rel=1e-6)


JOB = """schema = 1
model.plane = "stress"
solids = [{ body = "bar", material = "m" }]
supports = [{ on = "bar.bottom", x = 0, y = 0 }]
loads = [{ kind = "force", on = "bar.top", value = [0, 6] }]

[mesh.bodies]
bar = { kind = "rectangle", x = [0, 1.5], y = [0, 10], cells = [2, 4] }

[materials.m]
kind = "linear-elastic"
young = 1000
poisson = 0

[[stops]]
on = "bar.top"
direction = [0, 1]
distance = 0.02
"""


@pytest.mark.parametrize("mesh", [FLAT, SOLID], ids=["flat", "solid"])
def test_a_stop_in_its_own_body(mesh):
    """The direction of a stop is out of the surface; beyond the body, and aside, it is left to what may turn there."""
    into = (0.0,) * (mesh.dim - 1) + (-1.0,)
    with pytest.raises(InputError, match=r"stops\[0\].direction: .* points from 'bar.top' into its own body 'bar'"):
        abut.add_stops(mesh, [abut.Stop("bar.top", into, GAP)])
    aside = (1.0,) + (0.0,) * (mesh.dim - 1)
    abut.add_stops(mesh, [abut.Stop("bar.top", aside, GAP)])
    abut.add_stops(mesh, [abut.Stop("bar.top", into, 1.1 * LENGTH)])


def test_a_job(tmp_path):
    path = tmp_path / "job.toml"
    path.write_text(JOB, encoding="utf-8")
    (contact,) = abut.solve(load_job(path).model).contacts
    assert contact.name == "stop bar.top"
    assert contact.force[1] == pytest.approx(-carried(1.5), rel=1e-7)
    path.write_text(JOB.replace('on = "bar.top"\ndirection', 'on = "bar.tip"\ndirection'), encoding="utf-8")
    with pytest.raises(InputError, match=r"stops\[0\].on: no surface named 'bar.tip'"):
        load_job(path)


@pytest.mark.parametrize(
    ("stop", "plane", "words"),
    [
        ({"direction": (0, 0)}, None, "direction: it has no length"),
        ({"direction": (0, 1, 0)}, None, "expected 2 numbers, got 3"),
        ({"direction": (0, 1), "distance": -0.1}, None, "turn direction round"),
        ({"direction": (1, 1)}, "axisymmetric", "along the axis"),
        ({"direction": (0, 1), "name": "bar"}, None, "there is a body 'bar'"),
    ],
)
def test_refused(stop, plane, words):
    with pytest.raises(InputError, match=words):
        abut.add_stops(FLAT, [abut.Stop("bar.top", **stop)], plane)
