"""Contact problems as quadratic programmes in the pressures alone, by dense matrices, and their solution by quadprog."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linprog

import abut
from abut.problem.assembly import assemble, prescribed
from abut.problem.backend import serial
from abut.problem.clock import Clock
from abut.problem.linearised import Linearised
from abut.problem.problem import ContactProblem

Array = NDArray[np.float64]
SLACK = 1e-7  # share of the loads by which balance may be missed, as far as linprog solves

CLOSED = 1e-9  # of the largest pressure: quadprog's rounding of none


@dataclass(frozen=True)
class Programme:
    """min p C p / 2 + gap p with moved^T p = load and p >= 0 where not tied. compliance C: (n, n); gap: (n,) without
    pressure; moved: (n, m) gaps by rigid motions that supports leave free; load: (m,) work of the loads on them, the other
    way round; size: sum of the loads."""

    compliance: Array
    gap: Array
    moved: Array
    load: Array
    tied: NDArray[np.bool_]
    size: float


def assembled(model: abut.Model) -> ContactProblem:
    """Supports, stiffness and pairs of a model."""
    held, loaded = prescribed(model)
    return assemble(model, held, loaded, serial(model), lambda _: None, lambda _: None, Clock()).problem


def at_the_end(problem: ContactProblem, inside: NDArray[np.bool_] | None = None) -> Linearised:
    """The problem at the end of the loads, with ordinary functions where the step that was solved had them
    (``abut.solution.Saved.inside``)."""
    own = problem.with_ordinary(inside) if inside is not None and inside.any() else problem
    state = replace(own.start(), time=1.0)
    return own.linearise(state, own.frame(state), state)


def programme(system: Linearised) -> Programme:
    """Of a problem, linearised."""
    motions, stiffness = system.motions, system.stiffness.toarray()
    basis = np.linalg.svd(motions, full_matrices=False)[0]
    stiffness += np.median(np.diagonal(stiffness)) * basis @ basis.T  # holds them, and nothing else where loads balance
    operator, load = system.operator.toarray(), system.load
    answers = np.linalg.solve(stiffness, np.column_stack([operator.T, load]))
    compliance = operator @ answers[:, :-1]
    tied, gap = system.tied, system.offset + operator @ answers[:, -1]
    return Programme(
        0.5 * (compliance + compliance.T), gap, operator @ motions, -motions.T @ load, tied, float(np.abs(load).sum())
    )


def solvable(own: Programme) -> bool:
    """Whether some pressures balance the loads: the least imbalance of a linear programme is none."""
    n, m = own.moved.shape
    if not m or not own.size > 0.0:
        return True
    unit = np.linalg.norm(own.moved, axis=1)
    rows = own.moved / np.where(unit > 0.0, unit, 1.0)[:, None]
    load = own.load / own.size
    ones = np.ones((m, 1))
    answer = linprog(
        np.append(np.zeros(n), 1.0), np.block([[rows.T, -ones], [-rows.T, -ones]]), np.concatenate([load, -load]),
        bounds=[(None if t else 0.0, None) for t in own.tied] + [(0.0, None)],
    )  # fmt: skip
    assert answer.status == 0, answer.message
    return bool(answer.fun < SLACK)


def exact(own: Programme) -> Array:
    """The pressures (n,) by quadprog's dual active set method (Goldfarb and Idnani 1983), scaled to a compliance with a unit
    diagonal and to independent resultants of unit size."""
    import quadprog

    size = 1.0 / np.sqrt(np.diagonal(own.compliance))
    basis, unit, turn = np.linalg.svd(own.moved * size[:, None], full_matrices=False)
    held = unit > 1e-10 * unit.max(initial=0.0)
    wanted = (turn @ own.load)[held] / unit[held]
    pushing = np.flatnonzero(~own.tied)
    conditions = np.column_stack([basis[:, held], np.eye(len(size))[:, pushing]])
    bounds = np.concatenate([wanted, np.zeros(len(pushing))])
    answer = quadprog.solve_qp(
        own.compliance * size[:, None] * size, -own.gap * size, conditions, bounds, int(held.sum())
    )[0]
    return _sharpened(own, np.asarray(answer * size))


def _sharpened(own: Programme, pressure: Array) -> Array:
    """The conditions of the same set of pressures as equations: where gaps are large beside what pressures press in,
    quadprog leaves 1e-8 of them."""
    closed = own.tied | (pressure > CLOSED * np.abs(pressure).max(initial=0.0))
    moved = own.moved[closed]
    matrix = np.block([[own.compliance[np.ix_(closed, closed)], moved], [moved.T, np.zeros((moved.shape[1],) * 2)]])
    found = np.linalg.lstsq(matrix, np.concatenate([-own.gap[closed], own.load]), rcond=None)[0][: closed.sum()]
    result = np.zeros_like(pressure)
    result[closed] = found
    return result if (found[~own.tied[closed]] > 0.0).all() else pressure
