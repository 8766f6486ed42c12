"""What must not matter at large sliding: units, position in space, which side is the contactor; and what is in balance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.problem.turns import rotation
from abut.solution import Solution
from abut.solution.state import State
from models.sliding import arched, finite, pressed_in_space, turned

SAME = 1e-8
TIMES = abut.SolveOptions(times=(0.25, 0.5, 0.75, 1.0))


def slid(
    dim: int,
    pressure: str,
    turn: NDArray[np.float64] | None = None,
    length: float = 1.0,
    force: float = 1.0,
    swap: bool = False,
    cell: str | None = None,
) -> abut.Model:
    """A rounded block pressed on a wider one while it slides, with friction; turned in space, in units of other sizes."""
    model = arched(0.3, cell or "quad4") if dim == 2 else pressed_in_space(0.3, cell or "hex8")
    turn = np.eye(dim) if turn is None else turn
    ways = {"lower.bottom": np.zeros(dim), "upper.top": np.array([0.15, -0.06] if dim == 2 else [0.1, 0.05, -0.06])}
    supports = [
        abut.Support(name, **dict(zip("xyz", (length * turn @ way).tolist(), strict=False)))
        for name, way in ways.items()
    ]
    solids = [
        replace(s, material=abut.LinearElastic(s.material.young * force / length**2, s.material.poisson))
        for s in model.solids
    ]
    sides = ("lower.top", "upper.bottom") if swap else ("upper.bottom", "lower.top")
    contacts = [abut.Contact(contactor=sides[0], target=sides[1], friction=0.3, pressure=pressure, name="pair")]
    mesh = replace(model.mesh, points=length * model.mesh.points @ turn.T)
    return replace(model, mesh=mesh, supports=supports, solids=solids, contacts=contacts, solve=TIMES)


def solved(model: abut.Model) -> tuple[Solution, State]:
    states: list[State] = []
    solution = abut.solve(model, on_step=lambda _, saved: states.append(saved.state))
    assert solution.converged
    return solution, states[-1]


@pytest.mark.long
@pytest.mark.parametrize(("length", "force"), [(1e-3, 1.0), (1e3, 1.0), (1 / 25.4, 0.2248)])
@pytest.mark.parametrize("pressure", ["P1", "dual"])
def test_units(pressure: str, length: float, force: float) -> None:
    """From mm and N to m, to um, and to inch and pounds."""
    one, other = solved(slid(2, pressure))[0], solved(slid(2, pressure, length=length, force=force))[0]
    top, stress = np.nanmax(one.contacts[0].pressure), length**2 / force
    assert np.nanmax(np.abs(stress * other.contacts[0].pressure - one.contacts[0].pressure)) < SAME * top
    rubbed = stress * other.contacts[0].friction.traction - one.contacts[0].friction.traction
    assert np.nanmax(np.abs(rubbed)) < SAME * top
    assert np.abs(other.displacement / length - one.displacement).max() < SAME


@pytest.mark.long
@pytest.mark.parametrize("pressure", ["P1", "dual"])
@pytest.mark.parametrize("dim", [2, 3])
def test_position(dim: int, pressure: str) -> None:
    """Turned in space: pressures are the same, tractions turn along."""
    turn = turned(2.0) if dim == 2 else rotation(np.array([0.7, -1.1, 0.4]))
    one, other = solved(slid(dim, pressure))[0], solved(slid(dim, pressure, turn))[0]
    top = np.nanmax(one.contacts[0].pressure)
    assert np.nanmax(np.abs(other.contacts[0].pressure - one.contacts[0].pressure)) < SAME * top
    rubbed = other.contacts[0].friction.traction - one.contacts[0].friction.traction @ turn.T
    assert np.nanmax(np.abs(rubbed)) < SAME * top
    assert np.abs(other.displacement - one.displacement @ turn.T).max() < SAME


@pytest.mark.long
@pytest.mark.parametrize("pressure", ["P1", "dual"])
def test_sides_swapped(pressure: str) -> None:
    """The force on the upper block, whichever side is the contactor: to the mesh, five facets on a block."""
    here, there = (solved(slid(2, pressure, swap=swap))[0].steps[-1].reactions["upper.top"] for swap in (False, True))
    assert np.abs(here - there).max() < 0.1 * np.abs(here).max()


@pytest.mark.long
@pytest.mark.parametrize(
    ("dim", "pressure", "friction", "offset", "cell"),
    [
        (2, "P0", 0.3, 0.0, "quad4"), (2, "dual", 0.3, 0.0, "quad8"), (2, "P1", 0.3, 0.02, "quad4"),
        (3, "P1", 0.0, 0.0, "hex8"), (3, "P1", 0.3, 0.0, "hex8"), (3, "dual", 0.3, -0.02, "hex8"),
        (3, "auto", 0.0, 0.0, "tet10"), (3, "auto", 0.3, 0.0, "tet10"), (3, "auto", 0.3, 0.0, "hex20"),
        (3, "auto", 0.3, 0.0, "tet4"),
    ],
)  # fmt: skip
def test_momentum(dim: int, pressure: str, friction: float, offset: float, cell: str) -> None:
    """Forces and moments add up to none, on curved facets, with an offset between the surfaces, and in every state: here
    in one that is not in equilibrium and at the end."""
    model = slid(dim, pressure, cell=cell)
    model = replace(model, contacts=[replace(model.contacts[0], friction=friction, offset=offset)])
    _, state = solved(model)
    problem = finite(model)
    random = state.multipliers * np.random.default_rng(1).uniform(0.5, 2.0, len(state.multipliers))
    for now in (state, replace(state, multipliers=random)):
        pair = problem.linearise(state, problem.ended(state), now).pairs[0]
        force = (pair.rows.T @ now.multipliers).reshape(-1, dim)
        x, size = pair.contactor.points, np.abs(force).sum()
        assert size > 0.1
        assert np.abs(force.sum(axis=0)).max() < 1e-13 * size
        moments = np.cross(*(np.column_stack([v, np.zeros(len(v))]) if dim == 2 else v for v in (x, force)))
        assert np.abs(moments.sum(axis=0)).max() < 1e-12 * size
