"""A contactor that runs off the edge of its target and comes back."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.mesh import make
from abut.solution.state import State
from models.sliding import SOFT, bent, finite

PRESS = abut.Amplitude(((0.0, 0.0), (0.2, 1.0), (1.0, 1.0)))
GO = abut.Amplitude(((0.0, 0.0), (0.2, 0.0), (0.6, 1.0), (1.0, 0.0)))
FAR = 1.5


def over_the_edge(dim: int, friction: float, aside: float = 0.0) -> abut.Model:
    """A rounded block pressed on a wider one, moved 1.5 along it, beyond its end, and back; in 3D ``aside`` as well, over a
    corner. In steps of at most a twenty-fifth: shorter ones see the block tilt as it begins to slip."""
    if dim == 2:
        lower, upper = make.rectangle([0, 1.5], [0, 1], (5, 3)), make.rectangle([0.2, 1.2], [1, 1.6], (5, 2))
    else:
        lower = make.box([0, 1.5], [0, 1], [0, 0.8], (4, 3, 2))
        upper = make.box([0.2, 1.2], [0.2, 0.8], [0.8, 1.3], (4, 2, 1))
    up, axes = dim - 1, ("x", "y", "z")[:dim]

    def rounded(x: np.ndarray) -> np.ndarray:
        top, low = x[:, up].max(), x[:, up].min()
        rise = 0.5 * (top - x[:, up]) / (top - low) * (x[:, 0] - 0.7) ** 2
        return x + rise[:, None] * np.eye(dim)[up]

    held = [abut.Support("upper.top", y=aside, amplitude=GO)] if dim == 3 else []
    return abut.Model(
        make.join({"lower": lower, "upper": bent(upper, rounded)}), plane="strain" if dim == 2 else None,
        kinematics="finite", solids=[abut.Solid("lower", SOFT), abut.Solid("upper", SOFT)],
        supports=[
            abut.Support("lower.bottom", **dict.fromkeys(axes, 0.0)), *held,
            abut.Support("upper.top", **{axes[up]: -0.06}, amplitude=PRESS), abut.Support("upper.top", x=FAR, amplitude=GO),
        ],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", friction=friction)],
        solve=abut.SolveOptions(steps=25),
    )  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize(("dim", "friction", "aside"), [(2, 0.0, 0.0), (2, 0.3, 0.0), (3, 0.0, 0.0), (3, 0.3, 0.7)])
def test_off_the_edge_and_back(dim: int, friction: float, aside: float) -> None:
    """The force never rises on the way out (by more than 1 %, as nodes pass), and nothing is left of it beyond the end.
    Without friction the state is the same again at the place where it began; with friction no traction is beyond the cone
    after the way back."""
    model, states = over_the_edge(dim, friction, aside), list[State]()
    assert abut.solve(model, on_step=lambda _, saved: states.append(saved.state)).converged
    problem = finite(model)

    def force(state: State) -> float:
        pair = problem.again(state, state).pairs[0]
        return float(state.multipliers[pair.normal] @ pair.space.weight)

    times, forces = np.array([state.time for state in states]), np.array([force(state) for state in states])
    pressed = forces[np.argmin(np.abs(times - 0.2))]
    assert pressed > 0.0
    out, far = (times > 0.2) & (times <= 0.6), (times > 0.55) & (times < 0.7)
    assert (np.diff(forces[out]) <= 0.01 * pressed).all()
    assert far.sum() >= 2
    assert np.abs(states[int(np.flatnonzero(far)[0])].multipliers).max() == 0.0
    if friction:
        pair = problem.again(states[-1], states[-1]).pairs[0]
        along = np.linalg.norm(pair.tangential_traction(states[-1].multipliers), axis=1)
        assert (along <= friction * states[-1].multipliers[pair.normal] * (1.0 + 1e-8) + 1e-10).all()
        assert along.max() > 0.0
    else:
        first = states[int(np.argmin(np.abs(times - 0.2)))]
        assert np.abs(states[-1].unknowns - first.unknowns).max() < 1e-8
        assert forces[-1] == pytest.approx(pressed, rel=1e-8)
