"""Multigrid at large displacements and sliding: the states of the direct solver, one hierarchy a load step."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.analysis.run import Run
from abut.linear import iterative
from abut.linear.bodies_now import bodies_now
from abut.linear.choice import choose
from abut.linear.krylov import fgmres
from abut.linear.multigrid import hierarchy
from abut.linear.schur_preconditioner import interfaces, schur_inverse, selection
from abut.mesh import make
from abut.problem.linearised import Linearised
from abut.problem.pair import Pair
from models.rigid import glued
from models.sliding import FIRST, SOFT, THEN, arched, bent, finite, pressed_in_space, turned

TWO_STEPS = abut.SolveOptions(times=(0.4, 1.0))
AGREE = 1e-6  # equilibrium is met to 1e-9 of the largest force, and pressures and slip are worse conditioned


def both(model: abut.Model) -> tuple[abut.Solution, abut.Solution]:
    """By multigrid and directly, in the same load steps."""
    found, times = [], []
    for kind in ("amg", "direct"):
        ends: list[float] = []
        own = replace(model, solve=replace(model.solve, linear=kind))
        found.append(abut.solve(own, on_step=lambda _, saved, ends=ends: ends.append(saved.state.time)))
        times.append(ends)
    assert all(solution.converged for solution in found)
    assert "multigrid" in found[0].solver
    assert not any("takes this step" in note for note in found[0].notes)
    assert times[0] == pytest.approx(times[1])
    return found[0], found[1]


def assert_same(model: abut.Model) -> abut.Solution:
    ours, direct = both(model)
    for step, other in zip(ours.steps, direct.steps):
        assert abs(len(step.iterations) - len(other.iterations)) <= 3  # quadratic convergence is not lost
        size = np.abs(other.displacement).max()
        assert np.abs(step.displacement - other.displacement).max() < AGREE * size
        for contact, reference in zip(step.contacts, other.contacts):
            largest = np.nanmax(np.abs(reference.pressure), initial=1e-300)
            assert np.nanmax(np.abs(contact.pressure - reference.pressure), initial=0.0) < AGREE * largest
    return ours


def cushion(friction: float, cell: str, cells: tuple[int, int]) -> abut.Model:
    """A block with a curved underside pressed 0.04 into a plate, then slid by 0.12, aslant."""
    n, m = cells
    lower = make.box([0, 1.2], [0, 1], [0, 0.6], cells=[n, n, 1], cell=cell)
    upper = bent(
        make.box([0.2, 0.8], [0.2, 0.8], [0.6, 1.1], cells=[m, m, 1], cell=cell),
        lambda x: x + np.outer(0.2 * (1.1 - x[:, 2]) * ((x[:, 0] - 0.5) ** 2 + (x[:, 1] - 0.5) ** 2), [0, 0, 1]),
    )
    return abut.Model(
        make.join({"lower": lower, "upper": upper}), kinematics="finite",
        solids=[abut.Solid("lower", SOFT), abut.Solid("upper", abut.NeoHooke(200.0, 0.3))],
        supports=[
            abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", z=-0.04, amplitude=FIRST),
            abut.Support("upper.top", x=0.12, y=0.05, amplitude=THEN),
        ],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", friction=friction)], solve=TWO_STEPS,
    )  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize(("cell", "friction", "cells"), [("hex8", 0.3, (4, 3)), ("tet10", 0.3, (2, 1))])
def test_pressed_and_slid_in_space(cell: str, friction: float, cells: tuple[int, int]) -> None:
    solution = assert_same(cushion(friction, cell, cells))
    rows = solution.steps[-1].iterations[-1]
    assert rows.slipping
    assert rows.slipping > 3


def test_in_the_plane() -> None:
    assert_same(arched(0.3, "quad8", slide=0.1, solve=TWO_STEPS))


def stacked() -> abut.Model:
    """A pad glued to a rigid back that is free to sink and to tilt, pressed on a slab and pulled along it; only friction
    with the ground holds the slab. Equations tie points of the pad, and a pressure follows its side."""
    mesh = make.join(
        {
            "ground": make.box([-0.2, 1.4], [-0.2, 1.2], [-0.4, 0], cells=[3, 3, 1]),
            "slab": make.box([0, 1.2], [0, 1], [0, 0.4], cells=[4, 3, 1]),
            "pad": make.box([0.3, 0.9], [0.2, 0.8], [0.4, 0.7], cells=[2, 2, 1]),
            "back": make.box([0.3, 0.9], [0.2, 0.8], [0.7, 0.9], cells=[2, 2, 1]),
        }
    )
    mesh = glued(mesh, "pad", "back.bottom")
    low = [int(node) for node in mesh.nodes_of("pad.right") if mesh.points[node, 2] < 0.5]
    equal = [abut.Equation((abut.Term(low[0], "x", 1.0), abut.Term(node, "x", -1.0))) for node in low[1:]]
    return abut.Model(
        mesh, kinematics="finite", solids=[abut.Solid(body, SOFT) for body in ("ground", "slab", "pad")],
        supports=[abut.Support("ground.bottom", x=0, y=0, z=0)],
        loads=[
            abut.Force("back.top", (0.0, 0.0, -1.5), amplitude=FIRST), abut.Pressure("pad.left", 0.5, amplitude=FIRST),
        ],
        rigid=[abut.Rigid("back", x=0.05, y=0.0, rx=0.0, rz=0.0, amplitude=THEN)], equations=equal,
        contacts=[
            abut.Contact(contactor="pad.bottom", target="slab.top", friction=0.2),
                abut.Contact(contactor="slab.bottom", target="ground.top", friction=0.6),
        ], solve=TWO_STEPS,
    )  # fmt: skip


@pytest.mark.long
def test_rigid_body_equations_and_what_only_friction_holds() -> None:
    solution = assert_same(stacked())
    assert solution.steps[-1].rigid["back"].displacement[2] < -1e-3
    assert np.abs(solution.contacts[1].force[0]) > 0.05  # the ground holds the slab


def test_one_hierarchy_a_load_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """Set up at the first iteration of a step, and the same object in all others."""
    made, used = [], []
    set_up, solve = iterative.hierarchy, iterative.Iterative.solve

    def counted(*args: object) -> object:
        made.append(set_up(*args))
        return made[-1]

    def noted(self: iterative.Iterative, *args: object) -> object:
        used.append((self.system.time, self.hierarchy.cycle))
        return solve(self, *args)

    monkeypatch.setattr(iterative, "hierarchy", counted)
    monkeypatch.setattr(iterative.Iterative, "solve", noted)
    model = arched(0.3, slide=0.1, solve=replace(TWO_STEPS, linear="amg"))
    solution = abut.solve(model)
    assert solution.converged
    assert len(made) == len(solution.steps) == 2
    assert len(used) > 6
    for time, levels in zip((0.4, 1.0), made):
        assert {id(cycle) for when, cycle in used if when == time} == {id(levels.cycle)}


def test_the_direct_solver_takes_a_step_that_multigrid_cannot(monkeypatch: pytest.MonkeyPatch) -> None:
    """One Krylov iteration meets no tolerance; in the second step they may be as many as they want again."""
    solve, model = iterative.Iterative.solve, arched(0.3, slide=0.1, solve=TWO_STEPS)

    def fails(self: iterative.Iterative, *args: object) -> object:
        monkeypatch.setattr(iterative, "RESTART", 1 if self.system.time < 0.5 else 100)
        return solve(self, *args)

    monkeypatch.setattr(iterative.Iterative, "solve", fails)
    ours = abut.solve(replace(model, solve=replace(TWO_STEPS, linear="amg")))
    direct = abut.solve(replace(model, solve=replace(TWO_STEPS, linear="direct")))
    (note,) = (note for note in ours.notes if "takes this step" in note)
    assert note == f"step 1: {iterative.FAILED}: the direct solver takes this step"
    assert "multigrid" in ours.solver
    assert [len(step.iterations) for step in ours.steps] == [len(step.iterations) for step in direct.steps]
    assert np.abs(ours.displacement - direct.displacement).max() < AGREE * np.abs(direct.displacement).max()
    assert ours.steps[0].displacement == pytest.approx(direct.steps[0].displacement, abs=1e-15)


def test_a_body_that_turns_far() -> None:
    """Rigid motions are those of where the body is: after a quarter turn as many Krylov iterations as before it, with those
    of the undeformed body more."""
    mesh = make.join({"strip": make.rectangle([0, 30], [0, 1], cells=[120, 4])})
    counts = {}
    for angle in (0.0, 0.5 * np.pi):
        model = abut.Model(
            mesh, [abut.Solid("strip", SOFT)], plane="strain", kinematics="finite",
            rotations=[abut.Rotation("strip.left", angle, (0.0, 0.0))],
        )  # fmt: skip
        problem = Run.of(model, lambda *_: None, lambda *_: None, None, ()).assembled.problem
        moved = (mesh.points @ turned(angle).T - mesh.points).ravel()
        state = replace(problem.start(), time=1.0, unknowns=problem.constraints.coordinates(moved[:, None])[:, 0])
        system = problem.linearise(problem.start(), problem.frame(problem.start()), state)
        now = bodies_now(problem, system)
        for name, motions in (("now", now.near_null), ("undeformed", bodies_now(problem, at_rest(system)).near_null)):
            levels = hierarchy(system.stiffness, now.free, motions, now.points)
            rhs = np.random.default_rng(0).standard_normal(problem.n_free)
            counts[angle, name] = fgmres(lambda u, k=system.stiffness: k @ u, levels.cycle, rhs, 1e-8, 200, 1)[1]
    assert counts[0.5 * np.pi, "now"] < 1.2 * counts[0.0, "now"]
    assert counts[0.5 * np.pi, "undeformed"] > 1.5 * counts[0.0, "now"]


def at_rest(system: Linearised) -> Linearised:
    """The same system with its state forgotten."""
    return replace(system, about=None)


def test_large_models_choose_it(monkeypatch: pytest.MonkeyPatch) -> None:
    """By size in 3D; never in 2D, nor where bodies are one cell thick, whose factors are those of a surface."""
    models = (arched(0.3), cushion(0.3, "hex8", (4, 3)), pressed_in_space(0.3))
    flat, layer, solid = (finite(model) for model in models)
    assert choose("auto", solid) == choose("auto", layer) == choose("auto", flat) == "direct"
    monkeypatch.setattr("abut.linear.choice.LARGE_FINITE", {1: 100, 2: 100})
    assert choose("auto", solid) == choose("amg", layer) == "amg"
    assert choose("auto", layer) == choose("auto", flat) == "direct"


def test_tractions_do_not_depend_on_the_tangents_they_have() -> None:
    """Tangents turned by an angle of its own at every function: the inverse of S turns with them."""
    pair = finite(cushion(0.3, "hex8", (4, 3))).pairs[0]
    assert pair.slip is not None
    rng = np.random.default_rng(1)
    angles = rng.uniform(0.0, 2.0 * np.pi, len(pair.space))
    turns = np.stack([turned(angle) for angle in angles])
    other = replace(pair, slip=replace(pair.slip, tangents=np.einsum("kab,kbd->kad", turns, pair.slip.tangents)))
    every = selection(np.ones(len(pair), dtype=bool))
    values = rng.standard_normal((len(pair.space), 2))

    def answer(of: Pair, jumps: NDArray[np.float64]) -> NDArray[np.float64]:
        gap = np.zeros(len(of))
        gap[of.index[:, 1:]] = jumps
        return schur_inverse(interfaces([of]), every)(gap)[of.index[:, 1:]]

    here = np.einsum("kab,kb->ka", turns, answer(pair, values))
    there = answer(other, np.einsum("kab,kb->ka", turns, values))
    assert np.abs(here - there).max() < 1e-3 * np.abs(here).max()  # roots are to 1 %
