"""Friction on curved surfaces: either side as contactor, any frame and unit, symmetry, many load steps, and no friction at
all as the limit."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.benchmarks.friction import DOWN, RADIUS, WIDTH, along, cylinders
from abut.mesh import make
from models.friction import FRICTION

PUSHES = [(0.5, 0.0), (1.0, 1.0)]
CELLS = 4  # over half of what sticks: eleven facets over the contact
Array = np.ndarray


def tractions(model: abut.Model) -> tuple[Array, Array, abut.ContactResult]:
    solution = abut.solve(model)
    assert solution.converged
    x, drag, _ = along(solution.contacts[0])
    return x, drag, solution.contacts[0]


def far(x: Array, one: Array, y: Array, other: Array) -> float:
    """In the mean square over the contact, relative."""
    at = np.linspace(-1.1 * WIDTH, 1.1 * WIDTH, 501)
    a, b = (
        np.interp(at, *(own[np.unique(s, return_index=True)[1]] for own in (s, v))) for s, v in ((x, one), (y, other))
    )
    return float(np.linalg.norm(a - b) / np.linalg.norm(a))


@pytest.mark.long
def test_swapped_sides() -> None:
    """The same meshes: what differs is the side that carries the tractions. Facets of a tenth of the contact."""
    model = cylinders("quad4", False, 8, PUSHES)
    contact = model.contacts[0]
    swapped = replace(model, contacts=[replace(contact, contactor=contact.target, target=contact.contactor),
                                       model.contacts[1]])  # fmt: skip
    x, drag, _ = tractions(model)
    y, other, _ = tractions(swapped)
    assert far(x, drag, y, other) < 0.05


def test_pressing_alone_drags_nothing() -> None:
    """Two equal cylinders: tractions stay far below what friction carries, and a contactor that is flat or round sees the
    same as its mirror."""
    for upper in (False, True):
        _, drag, contact = tractions(cylinders("quad4", upper, 8, [(1.0, 0.0)]))
        assert np.abs(drag).max() < 0.05 * FRICTION * contact.max_pressure
        assert np.abs(drag + drag[::-1]).max() < 1e-6 * contact.max_pressure


@pytest.mark.long
@pytest.mark.parametrize("angle", [0.3, 2.0])
def test_in_any_frame(angle: float) -> None:
    model = cylinders("quad4", True, CELLS, PUSHES)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    turned = replace(
        model,
        mesh=replace(model.mesh, points=model.mesh.points @ turn.T + np.array([3.0, -7.0])),
        loads=[replace(load, value=tuple(turn @ load.value)) for load in model.loads],
    )
    u, v = (abut.solve(own).displacement for own in (model, turned))
    assert np.abs(v - u @ turn.T).max() < 1e-8 * np.abs(u).max()


@pytest.mark.long
@pytest.mark.parametrize("unit", [1e-3, 1e3, 1.0 / 25.4], ids=["m", "um", "inch"])
def test_in_any_unit(unit: float) -> None:
    model = cylinders("quad4", True, CELLS, PUSHES)
    scaled = replace(
        model,
        mesh=replace(model.mesh, points=unit * model.mesh.points),
        solids=[replace(s, material=abut.LinearElastic(s.material.young / unit**2, 0.3)) for s in model.solids],
        loads=[replace(load, value=tuple(np.array(load.value) / unit)) for load in model.loads],
    )
    u, v = (abut.solve(own).displacement for own in (model, scaled))
    assert np.abs(v / unit - u).max() < 1e-8 * np.abs(u).max()


@pytest.mark.long
def test_more_load_steps_tend_to_one_limit() -> None:
    def runs(count: int) -> tuple[Array, Array]:
        times = [*((i + 1) / (2 * count) for i in range(count)), 1.0]
        model = cylinders("quad4", True, CELLS, PUSHES)
        soft = abut.Solid("lower", abut.LinearElastic(100.0, 0.1))
        x, drag, _ = tractions(replace(model, solids=[soft, model.solids[1]], solve=abut.SolveOptions(times=times)))
        return x, drag

    x, last = runs(24)
    errors = [far(x, last, *runs(count)) for count in (1, 4, 12)]
    assert errors[2] < 0.5 * errors[0]
    assert errors[2] < 0.02


def test_restart_between_closing_and_pushing() -> None:
    saved: list = []
    model = cylinders("quad4", True, CELLS, [(0.25, 0.0), (0.5, 0.5), (1.0, 1.0)])
    whole = abut.solve(model, on_step=lambda _, step: saved.append(step))
    again = abut.solve(model, resume=saved[:1])
    assert np.array_equal(whole.displacement, again.displacement)


@pytest.mark.parametrize("materials", [(200.0, 200.0), (200.0, 20.0)], ids=["equal", "other"])
def test_half_of_it_is_half(materials: tuple[float, float]) -> None:
    """A cylinder on another, cut at the plane of symmetry: as the whole, to rounding."""

    def pressed(left: float) -> tuple[Array, Array]:
        cells = (12, 4) if left else (6, 4)
        parts = {}
        for name, y, way in (("lower", (-2.0, 0.0), -1.0), ("upper", (0.0, 2.0), 1.0)):
            mesh = make.rectangle((left, 3.0), y, cells, "quad4")
            x, z = mesh.points.T
            parts[name] = replace(mesh, points=np.column_stack([x, z + way * x**2 / 20.0 * (1.0 - np.abs(z) / 2.0)]))
        supports = [abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0, y=-0.2)]
        supports += [] if left else [abut.Support(f"{name}.left", x=0) for name in parts]
        model = abut.Model(
            make.join(parts),
            [abut.Solid(name, abut.LinearElastic(young, 0.3)) for name, young in zip(parts, materials)],
            supports,
            contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", friction=0.2)],
            plane="strain",
            solve=abut.SolveOptions(steps=3),
        )
        contact = abut.solve(model).contacts[0]
        x = contact.contactor.points[contact.contactor.nodes[:, :2], 0].ravel()
        keep = x > -1e-9
        order = np.lexsort((contact.pressure[:, :2].ravel()[keep], x[keep]))
        assert contact.friction is not None
        return x[keep][order], contact.friction.traction[:, :2].reshape(-1, 2)[keep][order]

    x, whole = pressed(-3.0)
    y, half = pressed(0.0)
    _, first = np.unique(np.round(x, 9), return_index=True)
    _, own = np.unique(np.round(y, 9), return_index=True)
    assert np.abs(whole).max() > 0.0
    assert np.abs(whole[first] - half[own]).max() < 1e-9 * 200.0


def test_restrained_friction_alone_in_one_step() -> None:
    """A cylinder that lies on another by its weight, which leans by a hundredth: all but one node close in the step."""
    model = cylinders("quad4", True, CELLS, PUSHES)
    lean = 0.01
    alone = abut.Model(
        model.mesh,
        [abut.Solid(s.body, replace(s.material, density=1.0)) for s in model.solids]
        + [abut.Solid("plate", model.solids[0].material)],
        [
            abut.Support("lower.bottom", x=0, y=0),
            abut.Support("plate.bottom", x=0, y=0),
            abut.Support("plate.top", x=0, y=0),
        ],
        [abut.Gravity((lean * DOWN / 96.0, -DOWN / 96.0), on="upper")],
        [model.contacts[0]],
        plane="strain",
    )
    solution = abut.solve(alone)
    assert solution.converged
    force = solution.contacts[0].force
    assert abs(force[0] / force[1]) == pytest.approx(lean, rel=1e-8)


def rigid_target(friction: float) -> abut.Model:
    """A cylinder on a rigid plane, leaning as it is pressed: with a rigid target the normals are the contactor's."""
    mesh = cylinders("quad4", True, CELLS, PUSHES)
    return replace(
        mesh, solids=[mesh.solids[1]], rigid=[*mesh.rigid, abut.Rigid("lower", x=0.0, y=0.0, rz=0.0)],
        supports=[], contacts=[replace(mesh.contacts[0], friction=friction), mesh.contacts[1]],
        loads=[mesh.loads[0]], solve=abut.SolveOptions(),
    )  # fmt: skip


def test_hardly_any_friction_is_none() -> None:
    """Pressed only, so that nothing slides off; x is held at the plate for the contact without friction."""

    def upright(friction: float) -> Array:
        model = rigid_target(friction)
        rigid = [abut.Rigid("plate", x=0.0, rz=0.0), model.rigid[1]]
        return abut.solve(replace(model, rigid=rigid)).displacement

    without = upright(0.0)
    assert np.abs(upright(1e-12) - without).max() < 1e-10 * np.abs(without).max()


def test_hardly_any_friction_between_two_that_give() -> None:
    """Normals between those of both sides, instead of the contactor's: a second order in the angle between them."""

    def upright(friction: float) -> abut.ContactResult:
        model = cylinders("quad4", True, CELLS, [(1.0, 0.0)], friction)
        return abut.solve(replace(model, rigid=[abut.Rigid("plate", x=0.0, rz=0.0)])).contacts[0]

    without, hardly = upright(0.0), upright(1e-12)
    assert hardly.max_pressure == pytest.approx(without.max_pressure, rel=(WIDTH / RADIUS) ** 2)
    assert np.nanmax(np.abs(hardly.friction.traction)) < 1e-10


def test_pressed_hardly() -> None:
    """Pressed and pushed, then let go but for a millionth: laws and forces hold there as before."""
    model = cylinders("quad4", True, CELLS, PUSHES)
    down = abut.Amplitude(((0.0, 0.0), (0.4, 1.0), (0.9, 1e-6)))
    aside = abut.Amplitude(((0.4, 0.0), (0.6, 0.5), (0.9, 5e-7)))
    loads = [replace(load, amplitude=own) for load, own in zip(model.loads, (down, aside))]
    solution = abut.solve(replace(model, loads=loads, solve=abut.SolveOptions(times=[0.4, 0.6, 0.9])))
    assert solution.converged
    assert solution.contacts[0].force[1] == pytest.approx(DOWN * 1e-6, rel=1e-6)
    assert all(check.passed for check in solution.certificate)


def test_held_edge_keeps_its_friction() -> None:
    """The block's side is held where it stands on a plate that is pulled away: all of it slips, its first node too."""
    parts = {
        "plate": make.rectangle([-1, 4], [0, 1], cells=[13, 3]),
        "block": make.rectangle([0, 2], [1, 2], cells=[7, 4]),
    }
    model = abut.Model(
        make.join(parts),
        [abut.Solid(name, abut.LinearElastic(1e4, 0.3)) for name in parts],
        [abut.Support("plate.bottom", y=0, x=0.05), abut.Support("block.left", x=0)],
        [abut.Pressure("block.top", 10.0)],
        [abut.Contact(contactor="block.bottom", target="plate.top", friction=FRICTION)],
        plane="strain",
    )
    force = abut.solve(model).contacts[0].force
    assert force[0] == pytest.approx(FRICTION * force[1], rel=1e-9)
