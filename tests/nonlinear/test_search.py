"""The search for the active set: always finds it, in a number of linear solutions that does not grow with the mesh."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.linear import direct, static_condensation
from abut.linear.choice import Direct
from abut.linear.solver import Prepared
from abut.mesh import make
from abut.nonlinear import active_set
from abut.nonlinear.active_set import solve_step
from abut.nonlinear.exact import solve_set
from abut.nonlinear.iteration import Found, Increment
from abut.nonlinear.laws import active_laws
from abut.nonlinear.search import Log, search
from abut.nonlinear.settings import DEFAULT
from abut.problem.problem import ContactProblem, Problem
from abut.solution import State
from models.oracle import assembled, at_the_end, exact, programme
from models.search import HARD, STEEL, ball, beam, line, pin
from models.units import MILLIMETRES_TO, in_units

sys.path.insert(0, str(Path(__file__).parents[2] / "bench"))

import search as bench

quadprog = pytest.importorskip("quadprog")

MOST = 20  # linear solutions in a load step
LONG = 600


def counts(model: abut.Model) -> list[int]:
    """Linear solutions of each load step."""
    solution = abut.solve(model)
    assert solution.converged
    assert all(check.passed for check in solution.certificate if check.name == "equilibrium")
    return [len(step.iterations) for step in solution.steps]


SMALL = {  # of each of the problems, sizes that take no time
    "beam": (50, 200), "beam in space": (25, 50), "ball": (48, 96), "layer": (50, 400), "cylinder": (10, 20),
    "loose pin": (12, 24),
}  # fmt: skip
QUICK = ("quad4", "quad8", "hex8", "quad8, auto")  # cells by the slower ways


@pytest.mark.long
@pytest.mark.parametrize("path", bench.PATHS)
@pytest.mark.parametrize("name", SMALL)
def test_counts_do_not_grow(name: str, path: str) -> None:
    """Peeling facet by facet took 26 to 260 solutions: now there are few, and the mesh does not matter."""
    for own in bench.problems():
        if own.name == name and (path == "elimination" or own.detail in QUICK or name == "loose pin"):
            found = [bench.count(own.model(size), path) for size in SMALL[name]]
            worst = [max(one.solutions) for one in found]
            assert bench.bounded(worst), (own, found)
            assert path != "multigrid" or not any(one.direct for one in found)


def test_the_bound_itself() -> None:
    assert bench.bounded([16, 17, 20])
    assert not bench.bounded([21])
    assert not bench.bounded([5, 10])


@pytest.mark.long
@pytest.mark.parametrize("cells", [12, 17, 24, 40])
def test_loose_pin(cells: int) -> None:
    """Nothing touches at the outset, and contact alone holds two of three bodies."""
    for force in (0.05, 0.5, 5.0, 50.0):
        for clearance in (0.002, 0.03):
            assert max(counts(pin(cells, force, clearance))) <= MOST


@pytest.mark.long
@pytest.mark.parametrize("kind", ["beam", "ball", "pin"])
def test_multigrid(kind: str) -> None:
    """Where linear systems are solved roughly: some more, and the same answer."""
    model = {"beam": beam(100, "quad4"), "ball": ball(48), "pin": pin(24, 0.1)}[kind]
    expected = abut.solve(model)
    solution = abut.solve(replace(model, solve=abut.SolveOptions(linear="amg")))
    assert "multigrid" in solution.solver
    assert not any("direct solver" in note for note in solution.notes)
    assert solution.converged
    assert len(solution.steps[0].iterations) <= MOST
    for a, b in zip(solution.contacts, expected.contacts):
        assert a.max_pressure == pytest.approx(b.max_pressure, rel=1e-6)
        assert abs(a.active - b.active) <= 1


def test_pulled_off_is_named_at_once() -> None:
    """Beyond half its weight the force at its end turns the beam over: no pressure balances that."""
    seen: list[abut.Iteration] = []
    with pytest.raises(abut.SingularModelError, match=r"body 'beam' is free to .*: the loads pull it off its contact"):
        abut.solve(beam(100, "quad4", lift=10.5), lambda told: seen.append(told))
    assert len([row for row in seen if hasattr(row, "changed")]) <= MOST
    assert counts(beam(100, "quad4", lift=9.9))[0] <= MOST


@dataclass(frozen=True)
class Ready:
    """A model at the end of its loads: the problem as solved, its state before, its linear solver."""

    whole: ContactProblem
    own: Problem
    first: State
    solver: Prepared

    def ended(self, found: Found) -> State:
        return self.own.expand(
            start := self.whole.start(), self.own.frame(start), found.state, found.laws, self.solver.system
        )[0]


def prepared(model: abut.Model) -> Ready:
    """A model and its linear solver, at the end of its loads."""
    whole, solver = assembled(model), Direct()
    own = solver.condensed(whole)
    first = replace(own.start(), time=1.0)
    system = own.linearise(first, own.frame(whole.start()), first)
    return Ready(whole, own, first, solver.prepare(system, None))


def searched(ready: Ready) -> tuple[State, int]:
    """By interior points alone, from nothing: the solution, and how many it took."""
    found = search(
        ready.solver, ready.first, Increment(1), 50, Log([], lambda _: None, 50), ready.solver.system.tied, "solution"
    )
    assert found.converged
    assert len(found.iterations) <= MOST
    return ready.ended(found), len(found.iterations)


def peeled(ready: Ready) -> State:
    """One active set after the other as the law asks for them, however many it takes: the search's slow twin."""
    state, tied = ready.first, ready.solver.system.tied
    for number in range(1, LONG + 1):
        solved = solve_set(ready.solver, state, Increment(1), tied, number, DEFAULT.accuracy.rough)
        if not solved.changed.any():
            start, frame = ready.whole.start(), ready.own.frame(ready.whole.start())
            return ready.own.expand(start, frame, solved.state, active_laws, ready.solver.system)[0]
        state = solved.state.with_closed(solved.wanted)
    raise AssertionError("not converged")


def random_model(seed: int) -> abut.Model:
    """A block of random roughness pressed askew onto another one: held above, or by contact and on one side alone."""
    rng = np.random.default_rng(seed)
    cell = ("quad4", "quad8", "tri6")[seed % 3]
    lower = make.rectangle(x=[-1, 4], y=[-1, 0], cells=[int(rng.integers(8, 20)), 2], cell=cell)
    upper = make.rectangle(x=[0, 3], y=[0, rng.uniform(0.2, 1.5)], cells=[int(rng.integers(6, 18)), 2], cell=cell)
    mesh = make.join({"lower": lower, "upper": upper})
    x, y = mesh.points.T
    nodes = mesh.nodes_of("upper")
    height = y[nodes].max()
    rough = 10.0 ** rng.uniform(-4, -1) * np.interp(x[nodes], np.linspace(0, 3, 12), rng.uniform(0, 1, 12))
    y = y.copy()
    y[nodes] += rough * (height - y[nodes]) / height + 0.01  # its top stays even, so that it may turn
    loads = [
        abut.Pressure("upper.top", 10.0 ** rng.uniform(-2, 1)),
        abut.Force("upper.right", (0.0, -(10.0 ** rng.uniform(-2, 0)))),
    ]
    held = [abut.Support("upper.left", x=0)] if seed % 2 else [abut.Support("upper.top", x=0)]
    return abut.Model(
        replace(mesh, points=np.column_stack([x, y])),
        [abut.Solid("lower", STEEL), abut.Solid("upper", STEEL if seed % 4 else HARD)],
        [abut.Support("lower.bottom", x=0, y=0), *held],
        loads,
        [abut.Contact(contactor="upper.bottom", target="lower.top")],
        plane="strain",
    )


@pytest.mark.parametrize("seed", range(24))
def test_random_problems_against_quadprog(seed: int) -> None:
    ready = prepared(random_model(seed))
    found, _ = searched(ready)
    expected = exact(programme(at_the_end(ready.whole)))
    assert np.abs(found.multipliers - expected).max() < 1e-7 * np.abs(expected).max()


def touching(load: float, lift: float = 0.0) -> abut.Model:
    """Two blocks side by side on a plate, held above; one is pressed down by ``load``, or both are lifted by ``lift``: else
    the other one touches and nothing more."""
    mesh = make.join(
        {
            "plate": make.rectangle(x=[0, 1], y=[-1, 0], cells=[8, 3], cell="quad4"),
            "other plate": make.rectangle(x=[2, 3], y=[-1, 0], cells=[8, 3], cell="quad4"),
            "pressed": make.rectangle(x=[0, 1], y=[0, 1], cells=[5, 3], cell="quad4"),
            "idle": make.rectangle(x=[2, 3], y=[0, 1], cells=[6, 3], cell="quad4"),
        }
    )
    return abut.Model(
        mesh,
        [abut.Solid(body, STEEL) for body in mesh.bodies],
        [
            *(abut.Support(f"{body}.bottom", x=0, y=0) for body in ("plate", "other plate")),
            abut.Support("pressed.top", x=0, y=-load + lift),
            abut.Support("idle.top", x=0, y=lift),
        ],
        contacts=[
            abut.Contact(contactor="pressed.bottom", target="plate.top"),
            abut.Contact(contactor="idle.bottom", target="other plate.top"),
        ],
        plane="strain",
    )


def test_rows_without_gap_and_without_pressure() -> None:
    ready = prepared(touching(0.01))
    found, _ = searched(ready)
    pressed, idle = ready.solver.system.split(found.multipliers)
    assert pressed.min() > 1.0
    assert np.abs(idle).max() < 1e-6 * pressed.max()
    assert np.abs(found.multipliers - peeled(ready).multipliers).max() < 1e-6 * pressed.max()


def test_contact_that_opens_everywhere() -> None:
    found, _ = searched(prepared(touching(0.0, lift=0.02)))
    assert not found.closed.any()
    assert not found.multipliers.any()


def tied_beam() -> abut.Model:
    """The beam of ``beam`` in two layers that are tied."""
    model = beam(40, "quad4")
    upper = make.rectangle(x=[0, 20], y=[1, 1.5], cells=[30, 2], cell="quad4")
    parts = dict.fromkeys(model.mesh.bodies, model.mesh)
    assert set(parts) == {"beam", "floor"}
    mesh = make.join(
        {
            "beam": make.rectangle(x=[0, 20], y=[0, 1], cells=[40, 4], cell="quad4"),
            "layer": upper,
            "floor": make.rectangle(x=[-1, 21], y=[-1, 0], cells=[22, 1], cell="quad4"),
        }
    )
    return replace(
        model,
        mesh=mesh,
        solids=[*model.solids, abut.Solid("layer", STEEL)],
        supports=[model.supports[0], abut.Support("layer.left", x=0)],
        contacts=[*model.contacts, abut.Contact(contactor="layer.bottom", target="beam.top", kind="tied", name="glue")],
        loads=[abut.Pressure("layer.top", 1.0), abut.Force("beam.right", (0.0, 8.0))],
    )


MODELS: dict[str, Callable[[], abut.Model]] = {
    "beam": lambda: beam(60, "quad4"),
    "quadratic beam": lambda: beam(40, "quad8"),
    "ball": lambda: ball(32),
    "tight pin": lambda: pin(16, 5.0, 0.0),
    "pin": lambda: pin(16, 5.0),
    "tied beam": tied_beam,
    "touching": lambda: touching(0.01),
    **{f"random {seed}": lambda seed=seed: random_model(seed) for seed in range(30, 36)},
}


@pytest.mark.long
@pytest.mark.parametrize("path", ["condensed", "sparse"])
@pytest.mark.parametrize("name", MODELS)
def test_same_answer_as_peeling(name: str, path: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where the active set is found one facet after the other, it is the same, and so are the pressures."""
    if path == "sparse":
        monkeypatch.setattr(static_condensation, "LARGEST", 0)
    elif direct.solver_name() != "PARDISO":
        pytest.skip("only PARDISO condenses")
    ready = prepared(MODELS[name]())
    expected, (found, _) = peeled(ready), searched(ready)
    if name != "touching":
        assert (found.closed == expected.closed).all()
    largest = np.abs(expected.multipliers).max()
    tolerance = 1e-8 if "beam" in name else 1e-9  # long beams bend easily, which costs digits
    assert np.abs(found.multipliers - expected.multipliers).max() < tolerance * largest


@pytest.mark.long
def test_easy_models_never_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """A set that settles soon, by foresight, is left to do so."""
    monkeypatch.setattr(active_set, "search", lambda *_: pytest.fail("searched"))
    for model in (pin(24, 5.0), touching(0.01), random_model(33), ball(96), ball(48, steps=4)):
        assert max(counts(model)) <= 8


def test_when_a_set_is_hopeless() -> None:
    assert not active_set.hopeless([40, 14, 5], 3, DEFAULT)  # too early to tell
    assert not active_set.hopeless([161, 27, 17, 12], 4, DEFAULT)
    assert active_set.hopeless([161, 27, 17, 12], 8, DEFAULT)  # later the same pace is too slow
    assert active_set.hopeless([8, 5, 4, 4], 4, DEFAULT)
    assert active_set.hopeless([4, 3, 2, 2, 2, 2], 6, DEFAULT)  # no fewer for three iterations
    assert active_set.hopeless([106, 3, 6, 15, 13], 5, DEFAULT)  # ever more change


def test_foreseen_wrongly() -> None:
    """A set that half spaces foresee and that turns out worse is given up for the one that the law asks for."""
    ready = prepared(pin(24, 50.0))
    expected = peeled(ready)

    def wrong(_: object, __: object, wanted: NDArray[np.bool_], ___: object) -> NDArray[np.bool_]:
        return ~wanted

    misled = replace(ready.solver, predict=wrong)
    found = solve_step(misled, ready.first, Increment(1), 50, lambda _: None)
    assert found.converged
    assert len(found.iterations) <= MOST
    assert (ready.ended(found).closed == expected.closed).all()


@pytest.mark.long
@pytest.mark.parametrize("path", bench.PATHS)
@pytest.mark.parametrize("swap", [False, True])
def test_units_do_not_matter(swap: bool, path: str) -> None:
    """The same cylinder in millimetres, metres, micrometres and inches: a set of units may cost no solution."""
    model = line(9, "tri6", swap)
    taken = {bench.count(in_units(model, own), path).solutions for own in MILLIMETRES_TO.values()}
    assert taken == {bench.count(model, path).solutions}


def test_units_do_not_matter_to_interior_points() -> None:
    model = beam(50, "quad4")
    taken = set()
    for own in (None, *MILLIMETRES_TO.values()):
        taken.add(searched(prepared(model if own is None else in_units(model, own)))[1])
    assert len(taken) == 1
