"""A problem at large displacements, linearised at a state; contact at current positions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import reduce
from operator import add

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.materials.kernel import Since
from abut.model.conditions import weights
from abut.problem.discretised import Discretised, stacked, unit_of
from abut.problem.frame import Frame
from abut.problem.kinematics import ContactNow
from abut.problem.linearised import Expansion, Linearised
from abut.problem.terms import Share, added_up
from abut.solution.state import State
from abut.types import Operator

SLIGHT = 1e-5  # strain of a cell whose forces are at least what others are judged against
Array = NDArray[np.float64]


def expanded(
    problem: Discretised,
    before: State,
    frame: Frame,
    now: State,
    here: Array,
    change: Array,
    since: State | None = None,
    guessed: bool = False,
) -> Linearised:
    """Near values ``here`` (n_values,) of all fields; change: of all of them, without which ``here`` is at an earlier
    time; since, guessed: as in ``ContactProblem.linearise``."""
    factors = weights(problem.model.histories, now.time)
    there = weights(problem.model.histories, before.time) if change.any() else factors
    constraints = problem.constraints.near(now.unknowns, there)
    began, contacts = problem.values(before), list[ContactNow]()
    motion = problem.motion(now.time, here, problem.rates(before, now.time, here))
    if since is not None:
        began_at = problem.displacement(since).reshape(problem.model.mesh.points.shape)
        motion = replace(motion, since=Since(np.ascontiguousarray(began_at), guessed))
    shares = problem.shares(before, problem.motion(before.time, began, before.rates), motion, frame)
    n = constraints.free.shape[0]
    assert problem.kinematics is not None
    for kind, part, placed in zip(problem.kinematics, frame.pairs, problem.placed(now)):
        contacts.append(kind.at(part, replace(placed, displacement=here[:n]), began[:n]))
    stiff = [(share.tangent, len(share.force)) for share in shares if share.tangent is not None]
    bendings = [contact.bending for contact in contacts]
    bending = reduce(add, bendings) if bendings else None
    whole = added_up([share.force for share in shares], len(here))
    if change.any():
        moved = [tangent.internal(change[:size]) for tangent, size in stiff]
        whole = whole + added_up(moved, len(here))
        if bending is not None:
            whole[:n] -= bending @ change[:n]
    by_contact = None if bending is None else constraints.reduce(bending)
    elastic = sum(tangent.reduce(constraints) for tangent, _ in stiff)
    stiffness = problem.springs.added_to(elastic if by_contact is None else elastic - by_contact)
    rows = [pair_now.pair.rows for pair_now in contacts]
    if problem.constraints.turns is not None:
        pushed = sum(pair_now.T @ p for pair_now, p in zip(rows, problem.split(now.multipliers)))
        stiffness = stiffness + problem.constraints.turns.bending(now.unknowns, there, whole[:n] - pushed)
    force = constraints.forces(whole)
    about = _expansion(problem, shares, now.unknowns, here[:n], force, stiffness)
    operators = [(pair_now.by_position @ constraints.free).tocsr() for pair_now in contacts]
    pairs = [replace(pair_now.pair, operator=by, gap=pair_now.gap) for pair_now, by in zip(contacts, operators)]
    gap = np.concatenate([np.zeros(0), *(each.gap + each.by_position @ change[:n] for each in contacts)])
    load = -about.unbalanced
    return Linearised(
        now.time, factors, stiffness, load, pairs, stacked(pairs, problem.n_free), gap, problem.motions, problem.restraint,
        load, unit_of(stiffness), about=about if not pairs else replace(about, symmetric=False),
        pushing=sp.vstack([pair_now @ constraints.free for pair_now in rows]).tocsr() if rows else None,
        forgotten=_idle(contacts), bending=by_contact, shares=problem.named(shares),
        sizes=problem.sizes(shares, (before, now), stiffness),
    )  # fmt: skip


def _expansion(
    problem: Discretised, shares: Sequence[Share], at: Array, moved: Array, force: Array, stiffness: Operator
) -> Expansion:
    """The state of finite deformation, with points moved by (dim n_points,); forces are judged against the largest one,
    reactions among them, and at least against what a strain of ``SLIGHT`` makes of a cell, theory (D13). A stiff body
    that moves far leaves more than that in a soft one's scale."""
    points = problem.model.mesh.points
    size = float(np.ptp(points, axis=0).max()) / len(points) ** (1.0 / problem.model.dim)
    largest = max(float(np.abs(share.force[: len(moved)]).max(initial=0.0)) for share in shares)
    symmetric = all(share.symmetric for share in shares)
    unbalanced = force + problem.springs.forces(at)
    unit = unit_of(stiffness)
    moduli = [solid.material.modulus for solid in problem.model.solids]
    rounding = 4.0 * np.finfo(float).eps * unit * max(moduli) / min(moduli) * float(np.abs(moved).max(initial=0.0))
    return Expansion(at, unbalanced, max(largest, SLIGHT * unit * size), symmetric, rounding)


def _idle(contacts: Sequence[ContactNow]) -> NDArray[np.bool_]:
    """(n,) multipliers of friction whose slip does not count in this step."""
    parts = [np.zeros(0, bool)]
    for contact in contacts:
        mask = (
            contact.pair.of_functions(contact.without_history)
            if contact.pair.frictional
            else np.zeros(len(contact.gap), bool)
        )
        if not contact.pair.tied:
            mask[contact.pair.normal] = False
        parts.append(mask)
    return np.concatenate(parts)
