"""Contact laws other than complementarity, and adjusted gaps, at large displacements and sliding."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.contact.laws import LawResult, LawState
from abut.errors import InputError
from abut.mesh import make
from abut.problem.frame import PairFrame
from abut.problem.kinematics import Placed
from models.sliding import SOFT, arched, bent, current, finite, pressed_in_space, tangent_errors, turned

Array = NDArray[np.float64]
TINY = 1e-7  # of the blocks' height, by which they are pressed together: what is of second order in it is left out


@dataclass(frozen=True)
class Layer:
    """A pressure in proportion to the overclosure beyond some play."""

    stiffness: float
    play: float = 0.0

    def evaluate(self, jump: Array, traction: Array, state: LawState) -> LawResult:
        closed = jump < -self.play
        return LawResult(
            traction + np.where(closed, self.stiffness * (jump + self.play), 0.0),
            np.where(closed, self.stiffness, 0.0)[:, :, None], np.ones_like(jump)[:, :, None], closed[:, 0],
        )  # fmt: skip


@dataclass(frozen=True)
class Exponential:
    """p0 at a gap of zero, nothing from c0 on: the pressure-overclosure of that name."""

    p0: float
    c0: float

    def evaluate(self, jump: Array, traction: Array, state: LawState) -> LawResult:
        closed = jump < self.c0
        x = np.where(closed, 1.0 - jump / self.c0, 0.0)
        pressure, slope = x * np.expm1(x), np.expm1(x) + x * np.exp(x)
        by = self.p0 / (np.e - 1.0)
        return LawResult(
            traction - by * pressure, (by * slope / self.c0)[:, :, None], np.ones_like(jump)[:, :, None], closed[:, 0]
        )


def with_contact(model: abut.Model, **given: Any) -> abut.Model:
    return replace(model, contacts=[replace(model.contacts[0], **given)])


def over_the_edge(model: abut.Model) -> abut.Model:
    """The upper body moved until a part of it hangs over the end of the lower one."""
    points = model.mesh.points.copy()
    points[model.mesh.nodes_of("upper"), 0] += 1.95
    return replace(model, mesh=replace(model.mesh, points=points))


def apart(gap: float, tilt: float, cell: str, **given: Any) -> abut.Model:
    """Two blocks of different meshes with a gap that grows by ``tilt`` along it."""
    lower = make.rectangle([0, 2], [0, 1], cells=[5, 2], cell=cell)
    upper = make.rectangle([0.3, 1.7], [1, 2], cells=[4, 2], cell=cell)
    upper = bent(upper, lambda x: x + np.outer(gap + tilt * (2.0 - x[:, 1]) * x[:, 0], [0.0, 1.0]))
    return abut.Model(
        make.join({"lower": lower, "upper": upper}), plane="strain", kinematics="finite",
        solids=[abut.Solid("lower", SOFT), abut.Solid("upper", SOFT)],
        supports=[abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0, y=-TINY)],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", **given)],
    )  # fmt: skip


@pytest.mark.parametrize("edge", [False, True])
@pytest.mark.parametrize("pressure", ["P1", "dual"])
@pytest.mark.parametrize(
    "given", [{"adjust": 0.02}, {"adjust": 0.02, "law": Layer(50.0)}, {"law": Layer(50.0), "offset": 0.01}]
)
def test_tangent_is_the_derivative(given: dict[str, Any], pressure: str, edge: bool) -> None:
    """As without: weights of what is covered, by which means are divided, change with the surfaces."""
    model = with_contact(arched(0.0), pressure=pressure, **given)
    problem = finite(over_the_edge(model) if edge else model)
    assert (current(problem).adjusted is not None) == ("adjust" in given)
    assert max(tangent_errors(problem, 3e-3)) < 1e-8


def test_tangent_in_space() -> None:
    """With friction, too."""
    for friction, given in ((0.0, {"law": Layer(50.0)}), (0.3, {"adjust": 0.01, "law": "constraint-function"})):
        assert max(tangent_errors(finite(with_contact(pressed_in_space(friction), **given)), 3e-3)) < 1e-7


@pytest.mark.long
@pytest.mark.parametrize(
    "given",
    [
        {"adjust": 0.1},
        {"adjust": 0.1, "pressure": "dual"},
        {"adjust": 0.1, "law": Layer(20.0)},
        {"adjust": 0.1, "law": Exponential(1e-6, 1e-4)},
        {"adjust": 0.1, "law": "constraint-function"},
    ],
)
@pytest.mark.parametrize("cell", ["quad4", "quad8"])
def test_tiny_loads_give_what_small_displacements_do(cell: str, given: dict[str, Any]) -> None:
    """Across an even gap of 0.03. Small displacements have the constraint function node by node, as large sliding has it,
    where there is friction: a coefficient of 1e-9."""
    model = apart(0.03, 0.0, cell, **{"pressure": "P1"} | given)
    by_nodes = {"friction": 1e-9} if given.get("law") == "constraint-function" else {}
    one, other = abut.solve(replace(with_contact(model, **by_nodes), kinematics="small")), abut.solve(model)
    assert other.converged
    assert one.contacts[0].max_pressure > 0.0
    assert np.abs(other.displacement - one.displacement).max() < TINY * 1e-6
    assert other.contacts[0].max_pressure == pytest.approx(one.contacts[0].max_pressure, rel=1e-6)


def test_adjusted_gaps() -> None:
    """What is larger than ``adjust`` stays: of a wedge from 0.006 to 0.034 the part that is less than 0.021 is closed."""
    model = apart(0.0, 0.02, "quad4", adjust=0.021)
    moving = current(finite(model))
    nodes = moving.pair.space.node
    gap = model.mesh.points[nodes, 1] - 1.0
    assert moving.adjusted is not None
    assert (moving.adjusted[gap < 0.014] < 0.0).all()
    assert (moving.adjusted[gap > 0.029] == 0.0).all()  # two facets on
    inside = (gap > 0.008) & (gap < 0.014)  # all round them is adjusted
    assert inside.any()
    assert np.allclose(moving.adjusted[inside], -gap[inside], rtol=1e-3)  # along the normal, which leans by 0.02


def test_adjusted_gaps_turn_with_the_bodies() -> None:
    """Both bodies turned by 70 degrees and moved together: what was adjusted is closed still."""
    model = apart(0.05, 0.01, "quad4", adjust=0.1)
    points = model.mesh.points
    there = (points @ turned(np.deg2rad(70.0)).T + [3.0, -2.0] - points).ravel()
    for adjust, least, most in ((0.1, 0.0, 1e-14), (0.0, 0.05, 0.1)):
        moving = current(finite(with_contact(model, adjust=adjust)))
        now = moving.at(PairFrame(), Placed(there, np.zeros(n := len(moving.pair)), np.zeros(n, bool), 0.0), there)
        mean = np.abs(now.gap / now.pair.space.weight)
        assert least <= mean.min()
        assert mean.max() <= most


@pytest.mark.long
def test_an_adjusted_block_slides_as_one_without_a_gap() -> None:
    """Pressed and dragged with friction. The gap of 0.02 shows where the surfaces turn: by a hundredth."""
    forces = []
    for gap in (0.0, 0.02):
        model = replace(arched(0.3), mesh=apart(gap, 0.0, "quad4").mesh)
        forces.append(abut.solve(with_contact(model, adjust=0.05)).contacts[0].force)
    assert np.abs(forces[0]).min() > 0.3
    assert forces[1] == pytest.approx(forces[0], rel=0.02)


@pytest.mark.parametrize("play", [0.0, 0.01])
@pytest.mark.parametrize("stiffness", [10.0, 1e5, 1e9])
def test_a_layer_that_loads_press(stiffness: float, play: float) -> None:
    """A block that nothing but the layer holds, under an even pressure: closed by a gap of -p / k, from a gap of zero at
    which the law by itself would let go of it. From a layer as soft as 1/3 of the block's height to one that is hardly
    there."""
    model = rest(Layer(stiffness, play))
    solution = abut.solve(model)
    assert solution.converged
    assert len(solution.steps) == 5  # a tenth, each half as long again: none is cut
    assert max(len(step.iterations) for step in solution.steps) <= 3
    contact = solution.contacts[0]
    pressure = contact.multiplier[np.isfinite(contact.multiplier)]
    assert pressure == pytest.approx(3.0, rel=1e-9)
    assert contact.gap[np.isfinite(contact.gap)] == pytest.approx(-play - 3.0 / stiffness, rel=1e-6)


def rest(law: Any) -> abut.Model:
    lower = make.rectangle([0, 2], [0, 1], cells=[5, 2], cell="quad4")
    upper = make.rectangle([0, 2], [1, 2], cells=[4, 2], cell="quad4")
    steel = abut.LinearElastic(young=210e3, poisson=0.0)
    return abut.Model(
        make.join({"lower": lower, "upper": upper}), plane="strain", kinematics="finite",
        solids=[abut.Solid("lower", steel), abut.Solid("upper", steel)],
        supports=[abut.Support("lower.bottom", y=0), abut.Support("lower.left", x=0), abut.Support("upper.left", x=0)],
        loads=[abut.Pressure("upper.top", 3.0)],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", law=law)],
    )  # fmt: skip


def test_a_steep_exponential() -> None:
    """p = 3 at x (e^x - 1) = 3 (e - 1) / p0, far up the curve."""
    law = Exponential(1e-3, 1e-3)
    solution = abut.solve(rest(law))
    assert solution.converged
    gap = solution.contacts[0].gap[np.isfinite(solution.contacts[0].gap)][:, None]
    assert law.evaluate(gap, np.full_like(gap, 3.0), LawState(np.ones(len(gap), bool))).residual == pytest.approx(
        0.0, abs=1e-6
    )


@pytest.mark.long
@pytest.mark.parametrize("law", [Layer(50.0), Exponential(0.5, 0.02), "constraint-function"])
def test_sliding(law: Any) -> None:
    """At each multiplier pressure and gap meet the law; the last iterations are quadratic."""
    epsilon = 1e-4
    solution = abut.solve(with_contact(arched(0.0), law=law, epsilon=epsilon, pressure="P1"))
    assert solution.converged
    contact = solution.contacts[0]
    p, gap = (values[np.isfinite(contact.multiplier)] for values in (contact.multiplier, contact.gap))
    if isinstance(law, str):
        reach = finite(solution.model).pairs[0].stiffness * gap * p
        assert (p > 0.0).all()
        exact = abut.solve(with_contact(arched(0.0), pressure="P1"))  # its largest pressure is the reference
        largest = np.nanmax([step.contacts[0].multiplier for step in (exact.steps[-1], solution.steps[-2])])
        assert reach == pytest.approx(epsilon * largest**2, rel=0.01)
    else:
        missed = law.evaluate(gap[:, None], p[:, None], LawState(gap < 0.0)).residual
        assert np.abs(missed).max() < 1e-6 * p.max()
    left = [max(row.residual, row.contact_residual) for row in solution.steps[-1].iterations]
    assert left[-1] < max(100.0 * left[-2] ** 2, 1e-11)


def test_what_is_refused() -> None:
    with pytest.raises(InputError, match="adjust: contactor and target have points in common"):
        finite(with_contact(arched(0.0), contactor="upper", target="upper", adjust=0.1))
