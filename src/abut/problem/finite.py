"""A problem at large displacements, with contact or without, linearised anew at every state; contact at current
positions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import reduce
from operator import add
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.coupling_tangent import Differentiate, differentiated
from abut.contact.pressure_space import DUAL_P1
from abut.model.conditions import weights
from abut.model.offset import offsets
from abut.problem.adjusted_gaps import BARELY, taken_off
from abut.problem.contact_pairs import reach_of
from abut.problem.current import ContactNow, Current, Place
from abut.problem.edge_functions import handed_over
from abut.problem.linearised import Expansion, Linearised, by_pair
from abut.problem.pair import Pair
from abut.problem.problem import TOUCHING, ContactProblem, stacked, unit_of
from abut.problem.slip_points import Past, SlipPoints
from abut.problem.step_error import LANDED, PairEnd, landed
from abut.problem.terms import Motion, Share
from abut.problem.turning_ties import TurningTie, turning_tie
from abut.solution.state import State, at_rest
from abut.types import Operator

INNER = "inner"  # whose history is where "dual-P1" had ordinary functions, in the step that ended
FOLLOWING = "following"  # whose history is which function each one followed, in the step that ended
POINTS = "points"  # whose history is the integration points of the last step
FIT = "fit"  # whose history is what fits add to the weighted gaps, in the step that ended
SAME_FIT = 1e-2  # of their size at closed multipliers: what fits may differ by from those that belong to a state
SAME_PRESSURE = 1e-3  # of the largest: a pressure, as a gap times the stiffness of a facet, up to which they may too
RUBBING = 1e-2  # the same with friction, where states depend on their past anyway
SLIGHT = 1e-5  # strain of a cell whose forces are at least what others are judged against
SHIFT = "shift"  # whose history is where points touch that were apart
LATE = "late"  # whose history is the points for functions that the last state's do not cover, in a step that is solved again
Array = NDArray[np.float64]


@dataclass(frozen=True)
class FiniteProblem(ContactProblem):
    """As ``ContactProblem``, with ``pairs`` from ``finite_pairs``. moving: kinematics of each pair, None of ties; ties: of
    those across a gap, None of all others."""

    moving: Sequence[Current | None] = ()
    ties: Sequence[TurningTie | None] = ()

    @property
    def constant(self) -> bool:
        """As in ``Problem``."""
        return False

    def start(self) -> State:
        """As in ``Problem``: multipliers that touch at the outset are closed."""
        rest = self._marked(at_rest(self.n_free, int(self.operator.shape[0])))
        rest, closed = self.with_functions(rest, rest), []
        for pair, now in zip(self.pairs, self._contacts(rest, rest, self.displacement(rest), rest)):
            weight = (
                pair.weight[pair.normal] if pair.smooth else now.pair.space.weight
            )  # of what the gap is integrated over
            touching = (now.gap[pair.normal] <= TOUCHING * pair.size * weight) & ~bare(now.pair)
            held = np.ones(len(pair), bool) if pair.tied else ~bare(now.pair)
            closed.append(held if pair.two_way else pair.of_functions(touching))
        return self._marked(rest.with_closed(np.concatenate([np.zeros(0, bool), *closed])))

    def linearise(self, before: State, now: State) -> Linearised:
        """As in ``Problem``."""
        here = self.displacement(now)
        return self._expanded(before, now, here, np.zeros_like(here))

    def ahead(self, before: State, time: float) -> Linearised:
        """The problem near the converged state ``before``, with what is prescribed at another time: theory (G10)."""
        there, now = self.displacement(before), replace(before, time=time)
        return self._expanded(before, now, there, self.displacement(now) - there)

    def accepted(self, before: State, now: State, system: Linearised) -> State:
        """As in ``Problem``."""
        now = super().accepted(before, now, system)
        return self._marked(replace(now, history=now.history.with_term(LANDED, self._landed(before, now))))

    def again(self, before: State, state: State) -> Linearised:
        """As in ``Problem``: the functions and fits are those of ``state``."""
        history = before.history
        for term in (INNER, FOLLOWING, FIT):
            history = history.without(term).with_term(term, state.history.of(term))
        return self.linearise(replace(before, history=history), state)

    def with_functions(self, before: State, now: State) -> State:
        """A converged state from which a step begins, with the functions and gaps that belong to the state ``now``: ordinary
        functions of "dual-P1" inside what is closed there, theory (P9), and fits, theory (G15). The same object where they
        are there already, fits to ``SAME_FIT``."""
        here, inner, fits = self.displacement(now), {}, {}
        for kind, closed in zip(self.moving, self.split(now.closed)):
            if kind is not None and kind.pair.space.name == DUAL_P1:
                inner[kind.pair.contact.name] = kind.inner(here, closed)
            if kind is not None and kind.fits:
                fits[kind.pair.contact.name] = kind.fit(here)
        known = before.history.of(INNER)
        same = all(np.array_equal(known.get(name, np.zeros_like(facets)), facets) for name, facets in inner.items())
        if same and self._fitted(before.history.of(FIT), fits, now):
            return before
        return replace(before, history=before.history.with_term(INNER, inner).with_term(FIT, fits))

    def _fitted(self, known: Mapping[str, Array], fits: Mapping[str, Array], now: State) -> bool:
        """Whether known fits serve at the state ``now``, where others belong: of their size and of the largest pressure, at
        multipliers that are closed."""
        for pair, values, closed in zip(self.pairs, self.split(now.multipliers), self.split(now.closed)):
            name, touching = pair.contact.name, closed[pair.normal]
            if name not in fits:
                continue
            if name not in known or not touching.any():
                return False
            weight, down = pair.weight[pair.normal], pair.space.transfer.T
            change, size = (
                np.abs(down @ fit / weight)[touching].max() for fit in (fits[name] - known[name], fits[name])
            )
            most = (RUBBING if pair.frictional else SAME_PRESSURE) * values[pair.normal].max()
            if change > SAME_FIT * size and pair.stiffness * change > most:
                return False
        return True

    def following(self, before: State, near: State, settled: bool = False) -> dict[str, Array]:
        """Which functions follow which, by contact, (n_functions,) as in ``Following``, at the state ``near``, in which a
        step ends or is expected to. Nothing of contacts where that is as at ``before``, or, at the end of a step (settled),
        doesn't matter."""
        result, old, here = {}, before.history.of(FOLLOWING), self.displacement(near)
        for kind, touching in zip(self.moving, self.split(near.closed)):
            if kind is None:
                continue
            name = kind.pair.contact.name
            now = kind.following(here, touching, self.added(kind.pair, near.time))
            known = old.get(name, np.arange(len(now.to))).astype(np.int64)
            if not np.array_equal(now.to, known) and not (
                settled and not now.matters(known, touching[kind.pair.normal])
            ):
                result[name] = now.to.astype(float)
        return result

    def led(self, state: State, following: Mapping[str, Array]) -> State:
        """A state whose functions follow others, as from ``following``, with the pressures and tractions that they had."""
        old, parts = state.history.of(FOLLOWING), zip(self.split(state.multipliers), self.split(state.status))
        values, status = [np.zeros(0)], [np.zeros(0, np.int8)]
        for pair, (multipliers, touching) in zip(self.pairs, parts):
            to, known = following.get(pair.contact.name), old.get(pair.contact.name)
            for held, part in ((values, multipliers), (status, touching)):
                held.append(part if to is None else handed_over(pair, part, known, to.astype(np.int64)))
        history = state.history.with_term(FOLLOWING, following)
        return replace(state, multipliers=np.concatenate(values), status=np.concatenate(status), history=history)

    def with_late_points(self, before: State, here: Array, asked: NDArray[np.bool_]) -> State:
        """A converged state from which a step begins that ends near displacements ``here`` (dim n_points,): with points for
        multipliers (n,) that were hardly covered before. The same object where there is no such thing."""
        late, shift, there = {}, {}, self.displacement(before)
        for kind, part in zip(self.moving, self.split(asked)):
            if kind is not None and kind.pair.frictional:
                name, past = kind.pair.contact.name, self._past(kind, before)
                again = kind.with_late(past, there, here, part)
                if again is not past and again.late is not None:
                    late[name], shift[name] = again.late.array, again.shift
        if not late:
            return before
        return replace(before, history=before.history.with_term(LATE, late).with_term(SHIFT, shift))

    def _marked(self, state: State) -> State:
        """With the integration points from which the next step's slip counts."""
        here, points, shift = self.displacement(state), {}, {}
        for kind, closed in zip(self.moving, self.split(state.closed)):
            if kind is not None and kind.pair.frictional:
                past = kind.past(here, closed)
                points[kind.pair.contact.name], shift[kind.pair.contact.name] = past.points.array, past.shift
        history = state.history.without(LATE).with_term(POINTS, points).with_term(SHIFT, shift)
        return replace(state, history=history)

    def _landed(self, before: State, now: State) -> dict[str, Array]:
        """By contact with friction the forces of ``Landed`` in a step, (1, 2)."""
        found, factors = {}, weights(self.model.histories, now.time)
        parts = [self.split(values) for values in (now.multipliers, now.closed, now.slipping, ~before.closed)]
        for kind, values, closed, slipping, opened in zip(self.moving, *parts):
            if kind is not None and kind.pair.frictional:
                end = PairEnd(values, closed, slipping, opened, self._past(kind, before).shift)
                share = landed(kind.pair, end, factors)
                found[kind.pair.contact.name] = np.array([[share.unsure, share.limit]])
        return found

    def _past(self, kind: Current, before: State) -> Past:
        """As ``_marked`` left it."""
        name, history = kind.pair.contact.name, before.history
        late = history.of(LATE).get(name)
        return Past(
            SlipPoints.from_array(history.of(POINTS)[name]), history.of(SHIFT)[name],
            None if late is None else SlipPoints.from_array(late),
        )  # fmt: skip

    def _expanded(self, before: State, now: State, here: Array, change: Array) -> Linearised:
        """Near displacements ``here`` (dim n_points,); change: of all points, without which ``here`` is at an earlier
        time."""
        factors = weights(self.model.histories, now.time)
        there = weights(self.model.histories, before.time) if change.any() else factors
        constraints = self.constraints.near(now.unknowns, there)
        shares, contacts = self._forces(before, now.time, here), self._contacts(before, now, here, now)
        stiff = [share.tangent for share in shares if share.tangent is not None]
        bendings = [contact.bending for contact in contacts]
        bending = reduce(add, bendings) if bendings else None
        whole = np.sum([share.force for share in shares], axis=0)
        if change.any():
            whole = whole + sum(tangent.internal(change) for tangent in stiff)
            whole = whole if bending is None else whole - bending @ change
        by_contact = None if bending is None else constraints.reduce(bending)
        elastic = sum(tangent.reduce(constraints) for tangent in stiff)
        stiffness = self.springs.added_to(elastic if by_contact is None else elastic - by_contact)
        rows = [pair_now.pair.rows for pair_now in contacts]
        if self.constraints.turns is not None:
            pushed = sum(pair_now.T @ p for pair_now, p in zip(rows, self.split(now.multipliers)))
            stiffness = stiffness + self.constraints.turns.bending(now.unknowns, there, whole - pushed)
        force = constraints.free.T @ whole
        about = self._expansion(shares, now.unknowns, here, force, stiffness)
        operators = [(pair_now.by_position @ constraints.free).tocsr() for pair_now in contacts]
        pairs = [replace(pair_now.pair, operator=by, gap=pair_now.gap) for pair_now, by in zip(contacts, operators)]
        gap = np.concatenate([np.zeros(0), *(each.gap + each.by_position @ change for each in contacts)])
        load = -about.unbalanced
        return Linearised(
            now.time, factors, stiffness, load, pairs, stacked(pairs, self.n_free), gap, self.motions, self.restraint, load,
            unit_of(stiffness), about=about if not pairs else replace(about, symmetric=False),
            pushing=sp.vstack([pair_now @ constraints.free for pair_now in rows]).tocsr() if rows else None,
            forgotten=self._idle(contacts), bending=by_contact, shares=self._named(shares),
        )  # fmt: skip

    def _expansion(
        self, shares: Sequence[Share], at: NDArray[np.float64], moved: NDArray[np.float64], force: NDArray[np.float64],
        stiffness: Operator,
    ) -> Expansion:  # fmt: skip
        """The state of finite deformation, with points moved by (dim n_points,); forces are judged against the largest one,
        reactions among them, and at least against what a strain of ``SLIGHT`` makes of a cell, theory (D13). A stiff body
        that moves far leaves more than that in a soft one's scale."""
        points = self.model.mesh.points
        size = float(np.ptp(points, axis=0).max()) / len(points) ** (1.0 / self.model.dim)
        largest = max(float(np.abs(share.force).max(initial=0.0)) for share in shares)
        symmetric = all(share.symmetric for share in shares)
        unbalanced = force + self.springs.forces(at)
        unit = unit_of(stiffness)
        moduli = [solid.material.modulus for solid in self.model.solids]
        rounding = 4.0 * np.finfo(float).eps * unit * max(moduli) / min(moduli) * float(np.abs(moved).max(initial=0.0))
        return Expansion(at, unbalanced, max(largest, SLIGHT * unit * size), symmetric, rounding)

    def split(self, values: NDArray[Any]) -> list[NDArray[Any]]:
        """Values of all multipliers (n,), pair by pair."""
        return by_pair(self.pairs, values)

    def _idle(self, contacts: Sequence[ContactNow]) -> NDArray[np.bool_]:
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

    def _contacts(self, before: State, now: State, here: Array, at: State) -> list[ContactNow]:
        """Of all pairs, at displacements ``here`` and the multipliers of ``at``."""
        there = self.displacement(before)
        inner, following, fits = (before.history.of(term) for term in (INNER, FOLLOWING, FIT))
        result = []
        for pair, kind, tie, part in zip(self.pairs, self.moving, self.ties, self.split(at.multipliers)):
            if kind is None:
                result.append(_tie(pair, tie, here))
                continue
            past, offset = self._past(kind, before) if pair.frictional else None, self.added(pair, now.time)
            chosen = (each.get(pair.contact.name) for each in (inner, following, fits))
            result.append(kind.at(Place(here, there, past, offset, *chosen), part))
        return result

    def added(self, pair: Pair, time: float) -> float:
        """What is added to all gaps of a pair at a time."""
        constant, varying = offsets(self.model, pair.contact)
        return constant + float(varying @ weights(self.model.histories, time))

    def _forces(self, before: State, time: float, here: Array) -> list[Share]:
        """Of every term at displacements ``here``."""
        there = self.displacement(before)
        parts = [before.history.of(term.name) for term in self.terms]
        return [
            term.evaluate(Motion(before.time, there, share), Motion(time, here, share))
            for term, share in zip(self.terms, parts)
        ]


def bare(pair: Pair) -> NDArray[np.bool_]:
    """(n_functions,) with hardly any target opposite now: they carry no pressure."""
    return np.asarray(pair.space.weight < BARELY * pair.weight[pair.normal])


def _tie(pair: Pair, tie: TurningTie | None, displacement: Array) -> ContactNow:
    """A tie, which holds surfaces together as they were at the outset."""
    none = sp.csr_matrix((len(displacement),) * 2)
    gap, rows = (pair.rows @ displacement, pair.rows) if tie is None else tie.at(displacement)
    return ContactNow(replace(pair, rows=rows), gap, rows, none, np.zeros(len(pair.space), dtype=bool))


def finite_problem(problem: ContactProblem, differentiate: Differentiate = differentiated) -> FiniteProblem:
    """A problem with pairs as from ``finite_pairs`` at large displacements. differentiate: as in ``Current``."""
    values = {each.name: getattr(problem, each.name) for each in fields(ContactProblem)}
    apart = [reach_of(problem.constraints, pair.contactor, pair.target) for pair in problem.pairs]
    moving = [None if pair.tied else _current(pair, reach, differentiate) for pair, reach in zip(problem.pairs, apart)]
    ties = [turning_tie(pair, reach) if pair.tied else None for pair, reach in zip(problem.pairs, apart)]
    return FiniteProblem(**{**values, "stiffness": None}, moving=moving, ties=ties)


def _current(pair: Pair, reach: float, differentiate: Differentiate) -> Current:
    return Current(pair, differentiate, taken_off(pair, reach) if pair.contact.adjust else None)
