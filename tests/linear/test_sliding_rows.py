"""Friction by multigrid: slip eliminated from the rows, the same answer as by the direct path, and at what price."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.typing import NDArray

import abut
from abut.contact.laws import Complementarity, Coulomb
from abut.errors import SingularModelError
from abut.linear import iterative
from abut.linear.choice import chosen
from abut.linear.iterative import Iterative
from abut.linear.saddle_point import newton_step
from abut.linear.sliding_rows import reduced
from abut.linear.solver import Vector
from abut.problem.laws import LawRows, at_multipliers
from abut.problem.linearised import Linearised, Rows
from abut.solution.state import CLOSED, OPEN, SLIPPING
from models.friction import pushed, rubbed
from models.oracle import assembled

AGREE = 1e-7  # in traction: the equations are met to 2e-9, and tractions are worse conditioned than residuals
Status = NDArray[np.int8]


def linearised(model: abut.Model) -> Linearised:
    problem = assembled(model)
    start = problem.start()
    return problem.again(start, start)


def coulomb(system: Linearised, status: Status, multipliers: Vector, gap: Vector) -> Rows:
    """Rows of one pair for a status (n_functions,) of its functions, at multipliers and weighted gaps."""
    (pair,) = system.pairs
    full = pair.of_functions(status)
    law = Coulomb(pair.stiffness, pair.friction(system.factors))
    laws: list[LawRows] = [at_multipliers(pair, law, gap, multipliers, full != OPEN, full == SLIPPING)]
    return system.rows(laws)


def at_random(system: Linearised) -> Rows:
    """Some of it open, some stuck, some slipping, far from the solution."""
    (pair,) = system.pairs
    random = np.random.default_rng(3)
    status = random.choice([OPEN, CLOSED, SLIPPING], len(pair.space)).astype(np.int8)
    pressure = 10.0 * random.random(len(pair))
    drag = 3.0 * random.standard_normal(len(pair))
    multipliers = np.where(np.arange(len(pair)) < len(pair.space), pressure, drag)
    gap = 3.0 * system.scale * random.standard_normal(len(pair))
    gap[pair.normal] = -np.abs(gap[pair.normal])  # pressed, so that the bound is one
    return coulomb(system, status, multipliers, gap)


@pytest.mark.parametrize("model", [pushed, rubbed])
def test_the_same_newton_step_without_the_slip(model) -> None:
    """The elimination is exact: a step from the rows that are left is that of all rows, to rounding."""
    system = linearised(model())
    rows = at_random(system)
    few = reduced(rows, system.pairs)
    assert few is not None
    assert not few.symmetric
    assert few.push.shape[0] < (~rows.decoupled).sum()
    residual = np.random.default_rng(4).standard_normal(len(system.load))
    du, dp = newton_step(system.stiffness, system.operator, rows, residual, np.zeros(len(rows.residual)))
    forces, seen = few.push @ system.operator, few.pull @ system.operator
    whole = sp.bmat([[system.stiffness, -forces.T], [-seen, few.corner]]).tocsc()
    size = len(residual)
    answer = sp.linalg.spsolve(whole, np.concatenate([-residual + system.operator.T @ few.fixed, -few.residual]))
    assert np.abs(answer[:size] - du).max() < 1e-8 * np.abs(du).max()
    assert np.abs(few.fixed + few.push.T @ answer[size:] - dp).max() < 1e-8 * np.abs(dp).max()


def test_what_sticks_stays_symmetric() -> None:
    system = linearised(rubbed())
    n = len(system.pairs[0].space)
    rows = coulomb(system, np.full(n, CLOSED), np.ones(len(system)), np.zeros(len(system)))
    few = reduced(rows, system.pairs)
    assert few is not None
    assert few.symmetric
    assert (few.push != few.pull).nnz == 0


@pytest.mark.parametrize("model", [pushed, rubbed])
def test_multigrid_finds_what_the_direct_solver_finds(model) -> None:
    """In every step of a path with reversal: status, tractions and slip."""
    own = model()
    found = [abut.solve(replace(own, solve=replace(own.solve, linear=kind))) for kind in ("amg", "direct")]
    assert "multigrid" in found[0].solver
    assert not any("going on" in note for note in found[0].notes)
    statuses = set()
    for a, b in zip(*(solution.steps for solution in found), strict=True):
        mine, its = a.contacts[0], b.contacts[0]
        assert np.array_equal(mine.friction.status, its.friction.status)
        largest = np.nanmax(its.pressure)
        assert np.nanmax(np.abs(mine.pressure - its.pressure)) < AGREE * largest
        assert np.nanmax(np.abs(mine.friction.traction - its.friction.traction)) < AGREE * largest
        moved = np.nanmax(np.abs(its.friction.total_slip))
        assert np.nanmax(np.abs(mine.friction.total_slip - its.friction.total_slip)) < AGREE * moved
        statuses |= set(np.unique(its.friction.status).tolist())
    assert statuses == {0, 1, 2}


def krylov(system: Linearised, rows: Rows, monkeypatch: pytest.MonkeyPatch) -> int:
    """Iterations of a solution to 1e-8 for gaps at random."""
    counts: list[int] = []
    true = iterative.fgmres

    def counted(*arguments):
        result = true(*arguments)
        counts.append(result[1])
        return result

    monkeypatch.setattr(iterative, "fgmres", counted)
    problem = assembled(rubbed(8))
    from abut.analysis.linear_solvers import linear_solver

    solver = linear_solver("amg", problem, None).prepare(system, None)
    assert isinstance(solver, Iterative)
    solver.solve(rows, np.zeros(len(system.load)), np.zeros(len(rows.residual)), 1e-8)
    return counts[-1]


def test_iterations(monkeypatch: pytest.MonkeyPatch) -> None:
    """All slipping costs what no friction costs; all sticking has three times the multipliers, and no more than 1.8 times
    the iterations (with the blocks of the Schur complement exact it would be 1.3 times)."""
    model = rubbed(8)
    free = linearised(replace(model, contacts=[replace(model.contacts[0], friction=0.0, pressure="dual")]))
    system = linearised(model)
    n = len(system.pairs[0].space)
    random = np.random.default_rng(1)
    jump = system.scale * random.standard_normal(len(system))
    jump[n:] *= 0.1
    counts = {}
    for status in (CLOSED, SLIPPING):
        multipliers = np.where(np.arange(len(system)) < n, 1.0, 1.0)
        rows = coulomb(system, np.full(n, status), multipliers, np.zeros(len(system)))
        counts[int(status)] = krylov(system, replace(rows, residual=jump), monkeypatch)
    (pair,) = free.pairs
    plain = free.rows([at_multipliers(pair, Complementarity(pair.stiffness), jump[:n], np.ones(n), np.ones(n, bool))])
    counts[0] = krylov(free, replace(plain, residual=jump[:n]), monkeypatch)
    assert counts[2] <= 1.2 * counts[0] + 1
    assert counts[1] <= 1.8 * counts[0]


def test_a_motion_that_nothing_holds() -> None:
    """Said at once, as by a direct solver, where loads move it; one that they do not move may rest."""
    motions, held = np.eye(4)[:, :2], np.diag([2.0, 0.0])
    iterative.require_held(motions, held, np.array([1.0, 0.0, 1.0, 1.0]), 1.0)
    iterative.require_held(motions, held, np.array([1.0, 1e-9, 1.0, 1.0]), 1.0)
    with pytest.raises(SingularModelError, match="unconstrained rigid-body mode"):
        iterative.require_held(motions, held, np.array([1.0, 0.1, 1.0, 1.0]), 1.0)
    with pytest.raises(SingularModelError):
        iterative.require_held(motions, np.zeros((2, 2)), np.array([1.0, 0.0, 1.0, 1.0]), 1.0)


def test_auto_takes_multigrid_for_large_models_with_friction() -> None:
    problem = assembled(rubbed())
    large = {1: problem.n_free, 2: problem.n_free}
    for size, expected in ((0, "amg"), (1, "direct")):
        sizes = {degree: own + size for degree, own in large.items()}
        assert chosen("auto", problem.n_free, problem.pairs, problem.model.mesh, False, sizes) == expected
