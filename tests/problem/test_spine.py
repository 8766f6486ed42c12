"""A problem is linearised at a state: what is kept, what is dropped, and what users may put in."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.contact.laws import Complementarity, ConstraintFunction, LawState, Tied
from abut.linear import dense, direct, iterative
from abut.linear.choice import Direct
from abut.linear.solver import NotConverged
from abut.materials.elastic import LinearElastic
from abut.materials.material import Evaluated, OwnMaterial
from abut.mesh.make import box, join, rectangle
from abut.nonlinear import load_step, stepping
from abut.nonlinear.march import Control, march
from abut.nonlinear.pace import Pace, given_pace
from abut.nonlinear.settings import DEFAULT
from abut.nonlinear.stepping import SmallSteps
from abut.output.restart import load_steps, save_step
from abut.problem.onset import Onset
from abut.verify import law_tangents, material_tangent
from models.friction import rubbed
from models.oracle import assembled

sys.path.insert(0, str(Path(__file__).parents[2] / "examples" / "own-law"))
sys.path.insert(0, str(Path(__file__).parents[2] / "examples" / "own-material"))

import soft_layer
import stiffening

STEEL = LinearElastic(210e3, 0.3)


def blocks(steps: int = 3, cell: str = "hex8", **contact: Any) -> abut.Model:
    """A block pressed askew onto another one, so that contact opens on one side."""
    lower = box(x=(0, 3), y=(0, 2), z=(-1, 0), cells=(6, 4, 2), cell=cell)
    upper = box(x=(0.5, 2.5), y=(0.3, 1.7), z=(0, 1), cells=(5, 3, 2), cell=cell)
    return abut.Model(
        join({"lower": lower, "upper": upper}),
        [abut.Solid("lower", STEEL), abut.Solid("upper", STEEL)],
        [abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", x=0, y=0)],
        [abut.Pressure("upper.top", 100.0), abut.Force("upper.right", (0.0, 0.0, 60.0))],
        [abut.Contact(contactor="upper.bottom", target="lower.top", **contact)],
        solve=abut.SolveOptions(steps=steps),
    )


def counted(patch: pytest.MonkeyPatch, module: Any, name: str, calls: list[str]) -> None:
    function = getattr(module, name)
    patch.setattr(module, name, lambda *args, **options: (calls.append(name), function(*args, **options))[1])


@pytest.mark.parametrize("model", [blocks, rubbed], ids=["frictionless", "friction"])
@pytest.mark.parametrize("linear", ["direct", "amg"])
def test_a_linear_model_is_factorised_once(
    linear: str, model: Callable[[], abut.Model], monkeypatch: pytest.MonkeyPatch
) -> None:
    """One elimination, or one hierarchy, for all iterations of all load steps; with friction too, to and fro."""
    if linear == "direct" and direct.solver_name() != "PARDISO":
        pytest.skip("only PARDISO condenses")
    calls: list[str] = []
    for module, name in (
        (direct, "partial_factorization"), (direct, "solve"), (direct, "Factorization"), (iterative, "hierarchy"),
        (dense, "_flexibility"),
    ):  # fmt: skip
        counted(monkeypatch, module, name, calls)
    own = model()
    solution = abut.solve(replace(own, solve=replace(own.solve, linear=linear)))
    assert solution.converged
    assert sum(len(step.iterations) for step in solution.steps) >= 4
    matrices = [name for name in calls if name != "_flexibility"]
    assert matrices == (["partial_factorization"] if linear == "direct" else ["hierarchy"])


def test_a_failed_attempt_leaves_nothing_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    """A step that fails is halved: each attempt starts from the last converged state."""
    problem = assembled(blocks(1))
    starts: list[tuple[float, float]] = []
    true = load_step.load_step

    def failing(task: Any, time: float, prepared: Any) -> load_step.Attempt:
        starts.append((task.before.time, time))
        attempt = true(task, time, prepared)
        return replace(attempt, converged=False) if time - task.before.time > 0.3 else attempt

    monkeypatch.setattr(stepping, "load_step", failing)

    def none(*_: object) -> None:
        return None

    def never(number: int, reason: NotConverged) -> Direct:
        raise reason

    control = Control(50, none, none, none, none, never, none, lambda *_: Onset(), none)
    first = problem.start()
    attempts = list(march(SmallSteps(problem, first, Direct(), control), [first], Pace([1.0], first=1.0), control))
    assert [start for start, _ in starts] == [0.0, 0.0, 0.0, 0.25, 0.25, 0.4375, 0.71875]
    done = [a for a in attempts if a.converged]
    assert [a.number for a in done] == [1, 2, 3, 4]
    whole = next(march(SmallSteps(problem, first, Direct(), control), [first], given_pace([1.0], parts=False), control))
    assert np.abs(done[-1].state.multipliers - whole.state.multipliers).max() < 1e-9 * whole.state.largest.pressure


def test_another_solver_goes_on_from_the_last_converged_state(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where multigrid gives up in the second step, the direct solver does that one, not the first one, again."""
    model = blocks()
    model = replace(model, solve=replace(model.solve, linear="amg"))
    expected = abut.solve(replace(model, solve=replace(model.solve, linear="direct")))
    true, seen = iterative.Iterative.solve, []

    def fails(self: Any, *args: Any) -> Any:
        if self.system.time > 0.5:
            raise NotConverged("gives up")
        return true(self, *args)

    monkeypatch.setattr(iterative.Iterative, "solve", fails)
    solution = abut.solve(model, lambda told: seen.append(told))
    assert "step 2: gives up: going on with the direct solver" in solution.notes
    assert len(solution.steps[1].iterations) == len(expected.steps[1].iterations)
    assert [row.step for row in seen if isinstance(row, abut.solution.Iteration)].count(1) == len(
        solution.steps[0].iterations
    )
    largest = np.abs(expected.displacement).max()
    assert np.abs(solution.displacement - expected.displacement).max() < 1e-7 * largest


def test_history_survives_a_restart_file(tmp_path: Path) -> None:
    kept: list[abut.solution.Saved] = []
    abut.solve(blocks(1), on_step=lambda _, saved: kept.append(saved))
    history = abut.solution.History({"bodies.upper": np.arange(6.0).reshape(3, 2)})
    saved = replace(kept[0], state=replace(kept[0].state, history=history))
    save_step(tmp_path, {}, saved)
    (read,) = load_steps(tmp_path, {})
    assert (read.state.history.of("bodies")["upper"] == history.arrays["bodies.upper"]).all()
    assert (read.state.multipliers == saved.state.multipliers).all()
    assert read.state.largest == saved.state.largest


LAWS: dict[str, Callable[[NDArray[np.float64]], Any]] = {
    "complementarity": lambda _: Complementarity(2.0),
    "tied": lambda _: Tied(),
    "constraint function": lambda x: ConstraintFunction(np.full(len(x), 3.0), 1e-2, 1.5, 0.3),
    "soft layer": lambda _: soft_layer.SoftLayer(7.0),
}


@pytest.mark.parametrize("name", LAWS)
def test_derivatives_of_laws(name: str) -> None:
    rng = np.random.default_rng(1)
    components = 3 if name == "tied" else 1
    jump, traction = rng.uniform(-1, 1, (40, components)), rng.uniform(-1, 1, (40, components))
    state = LawState(rng.uniform(size=40) > 0.5)
    law = LAWS[name](jump)
    assert law_tangents(law, jump, traction, state) < 1e-7
    if name == "soft layer":
        wrong = replace(law.evaluate(jump, traction, state), by_jump=np.zeros((40, 1, 1)))

        class Wrong:
            def evaluate(self, *args: Any) -> Any:
                return replace(wrong, residual=law.evaluate(*args).residual)

        assert law_tangents(Wrong(), jump, traction, state) > 0.1


@pytest.mark.parametrize("stiffness", [1e3, 1e5, 1e7])
def test_soft_layer_is_a_spring_in_a_row(stiffness: float) -> None:
    """Two blocks of height 1 and the layer give way by p (1/E + 1/E + 1/k), evenly."""
    solution = soft_layer.pressed(soft_layer.SoftLayer(stiffness))
    assert solution.converged
    top = solution.displacement[solution.model.mesh.nodes_of("upper.top"), 1]
    exact = -10.0 * (2.0 / 210e3 + 1.0 / stiffness)
    assert np.abs(top / exact - 1.0).max() < 1e-10
    assert solution.contacts[0].max_pressure == pytest.approx(10.0, rel=1e-10)


def test_laws_of_wrong_shapes_are_refused() -> None:
    class Flat:
        def evaluate(self, jump: Any, traction: Any, state: LawState) -> Any:
            return replace(soft_layer.SoftLayer(1.0).evaluate(jump, traction, state), by_jump=np.zeros(len(jump)))

    with pytest.raises(
        abut.InputError, match=r"law: evaluate returned by_jump of shape \(\d+,\), expected \(\d+, 1, 1\)"
    ):
        soft_layer.pressed(Flat())


def test_laws_that_are_none_are_refused() -> None:
    with pytest.raises(abut.InputError, match="law"):
        abut.Contact(contactor="a", target="b", law=3.0)  # type: ignore[arg-type]


@dataclass(frozen=True)
class Hooke(OwnMaterial):
    """Linear elasticity written by a user."""

    like: LinearElastic = STEEL
    modulus: float = 210e3

    def evaluate(self, strain: NDArray[np.float64], history: NDArray[np.float64]) -> Evaluated:
        return self.like.evaluate(strain, history)


@pytest.mark.parametrize("steps", [1, 2])
def test_own_material_equals_the_built_in_one(steps: int) -> None:
    """The same law by the general way, linearised anew at every state, gives the same solution. (Cells of second order:
    stresses at the surface of others are taken from strains along it where the law is known, theory (Z9).)"""
    model = blocks(steps, "hex20")
    expected = abut.solve(model)
    own = abut.solve(replace(model, solids=[abut.Solid("lower", STEEL), abut.Solid("upper", Hooke())]))
    assert own.converged
    largest = np.abs(expected.displacement).max()
    assert np.abs(own.displacement - expected.displacement).max() < 1e-8 * largest
    assert own.contacts[0].max_pressure == pytest.approx(expected.contacts[0].max_pressure, rel=1e-7)
    assert (
        np.abs(own.steps[-1].stress - expected.steps[-1].stress).max() < 1e-6 * np.abs(expected.steps[-1].stress).max()
    )
    assert all(check.passed for check in own.certificate) == all(check.passed for check in expected.certificate)


def test_stiffening_material_under_simple_shear() -> None:
    """tau = G gamma (1 + c gamma^2 / 2), exactly, at every point of a sheared block."""
    material = stiffening.Stiffening(bulk=5.0, shear=1.0, growth=200.0)
    mesh = rectangle(x=[0, 1], y=[0, 1], cells=[3, 3], cell="quad4")
    gamma = 0.05

    def sheared(points: NDArray[np.float64]) -> NDArray[np.float64]:
        return gamma * points[:, 1]

    everywhere = [abut.Support(f"box.{side}", x=sheared, y=0) for side in ("left", "right", "top", "bottom")]
    mesh = join({"box": mesh})
    solution = abut.solve(
        abut.Model(mesh, [abut.Solid("box", material)], everywhere, plane="strain", solve=abut.SolveOptions(steps=2))
    )
    assert solution.converged
    exact = gamma * (1.0 + 200.0 * gamma**2 / 2.0)
    assert np.abs(solution.steps[-1].stress[:, 3] / exact - 1.0).max() < 1e-9
    assert material_tangent(material, np.random.default_rng(0).uniform(-0.05, 0.05, (20, 6))) < 1e-7


def test_newton_converges_quadratically(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a nonlinear material in contact: the last three errors of force balance in the first step fall with an order of
    two, to rounding."""
    errors: list[float] = []
    true = load_step.imbalance

    def told(*args: Any) -> float:
        errors.append(true(*args))
        return errors[-1]

    monkeypatch.setattr(load_step, "imbalance", told)
    solution = stiffening.pressed(stiffening.Stiffening(5.0, 1.0, 200.0), depth=0.05)
    assert solution.converged
    first = errors[: next(i for i, error in enumerate(errors) if error < DEFAULT.newton.balanced) + 1]
    before, last, rounding = first[-3:]
    assert np.log(rounding / last) / np.log(last / before) > 1.7
