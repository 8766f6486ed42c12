"""A problem linearised at a state, at small displacements and at large ones."""

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
    began = problem.values(before)
    motion = problem.motion(now.time, here, problem.rates(before, now.time, here))
    if since is not None:
        began_at = problem.displacement(since).reshape(problem.model.mesh.points.shape)
        motion = replace(motion, since=Since(np.ascontiguousarray(began_at), guessed))
    shares = problem.shares(before, problem.motion(before.time, began, before.rates), motion, frame)
    n = constraints.free.shape[0]
    contacts = [
        kind.at(part, replace(placed, displacement=here[:n]), began[:n])
        for kind, part, placed in zip(problem.kinematics, frame.pairs, problem.placed(now))
    ]
    bendings = [contact.bending for contact in contacts if contact.bending is not None]
    bending = reduce(add, bendings) if bendings else None
    whole = added_up([share.force for share in shares], len(here))
    stiff = [(share.tangent, len(share.force)) for share in shares if share.tangent is not None]
    if change.any():
        whole = whole + added_up([tangent.internal(change[:size]) for tangent, size in stiff], len(here))
        if bending is not None:
            whole[:n] -= bending @ change[:n]
    by_contact = None if bending is None else constraints.reduce(bending)
    stiffness = problem.stiffness
    if stiffness is None:
        elastic = reduce(add, [tangent.reduce(constraints) for tangent, _ in stiff])
        stiffness = problem.springs.added_to(elastic if by_contact is None else elastic - by_contact)
    if problem.constraints.turns is not None:
        pushed = sum(each.pair.rows.T @ p for each, p in zip(contacts, problem.split(now.multipliers)))
        stiffness = stiffness + problem.constraints.turns.bending(now.unknowns, there, whole[:n] - pushed)
    force = constraints.forces(whole)
    gap = np.concatenate([np.zeros(0), *(each.gap + each.by_position @ change[:n] for each in contacts)])
    largest = 0.0 if problem.constant else max(float(np.abs(share.force[:n]).max(initial=0.0)) for share in shares)
    near = Linearised(
        now.time, factors, stiffness, force, [each.pair for each in contacts], problem.operator, gap, problem.motions,
        problem.restraint.acting(factors), force, problem.unit or unit_of(stiffness), forgotten=_idle(contacts),
        bending=by_contact,
        shares={} if problem.constant else problem.named(shares), sizes=problem.sizes(shares, (before, now), stiffness),
        even=problem.constraints.others is None or all(share.symmetric for share in shares), largest=largest,
    )  # fmt: skip
    if not problem.model.finite:
        return _about_rest(problem, near, now.unknowns)
    operators = [(each.by_position @ constraints.free).tocsr() for each in contacts]
    pairs = [replace(each.pair, operator=by, gap=each.gap) for each, by in zip(contacts, operators)]
    about = _expansion(problem, shares, now.unknowns, here[:n], force, stiffness)
    rows = [each.pair.rows @ constraints.free for each in contacts]
    return replace(
        near, load=-about.unbalanced, forces=-about.unbalanced, pairs=pairs, operator=stacked(pairs, problem.n_free),
        about=about if not pairs else replace(about, symmetric=False), pushing=sp.vstack(rows).tocsr() if rows else None,
    )  # fmt: skip


def _about_rest(problem: Discretised, near: Linearised, unknowns: Array) -> Linearised:
    """At small displacements all is told from rest on, where forces of a constant problem have no rounding. near: with the
    forces, and gaps, at ``unknowns`` (n_free,)."""
    load = -near.load
    if not problem.constant:
        load = near.stiffness @ unknowns - near.load - problem.springs.forces(unknowns)
    offset = near.offset - near.operator @ unknowns if len(near.offset) else near.offset
    return replace(near, load=load, forces=load, offset=offset)


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
