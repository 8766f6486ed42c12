"""A contact problem: residual and tangent at a state."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from abut.problem import fluid_frames, load_steps
from abut.problem.contact_pairs import with_plain_functions
from abut.problem.discretised import Discretised, stacked
from abut.problem.expanded import expanded
from abut.problem.frame import Frame
from abut.problem.laws import LawRows
from abut.problem.linearised import Linearised
from abut.problem.pair import Pair
from abut.problem.released import Released
from abut.problem.sample_gaps import apart
from abut.solution.state import State, at_rest

Laws = Callable[[Linearised, State], Sequence[LawRows]]


class Problem(Protocol):
    """What Newton's method solves. constant: stiffness, operator and compliance never change (the same objects come back
    from every state), so that one set-up of a linear solver serves them all."""

    @property
    def constant(self) -> bool: ...

    def start(self) -> State:
        """The state before the first load step."""
        ...

    def frame(self, before: State, guess: State | None = None) -> Frame:
        """What is fixed during the step from the converged state ``before``, which may end near ``guess``."""
        ...

    def linearise(self, before: State, frame: Frame, now: State) -> Linearised:
        """The problem near the trial state ``now``, at its time, which follows the converged ``before``."""
        ...

    def accepted(self, before: State, frame: Frame, now: State, system: Linearised) -> State:
        """The converged state ``now`` with the history that it leaves; system: the whole problem near it, as from
        ``expand``."""
        ...

    def expand(
        self, before: State, frame: Frame, state: State, laws: Laws, system: Linearised
    ) -> tuple[State, Linearised]:
        """A solution in all free displacements, which follows the converged ``before``, and the problem near it, nothing
        condensed; laws: the ones it meets; system: this problem near the solution."""
        ...

    def again(self, before: State, state: State) -> Linearised:
        """The whole problem near a converged state with its history, as the step from ``before`` ended."""
        ...

    def restrict(self, state: State) -> State:
        """A state in all free displacements in the unknowns of this problem."""
        ...

    def with_ordinary(self, closed: NDArray[np.bool_]) -> Problem:
        """With ordinary functions in place of dual ones where the multipliers ``closed`` (n,) let them be; the same object
        where they are nowhere; theory (P9), (P26)."""
        ...

    def alone_at_edges(self, closed: NDArray[np.bool_], state: State | None = None) -> NDArray[np.bool_]:
        """Multipliers (n,) that are ``closed`` alone at an edge where both sides end, theory (P26); of these, with a
        state in all free displacements, the ones at which the sides are apart then."""
        ...


@dataclass(frozen=True)
class ContactProblem(Discretised):
    """Bodies, loads and contact on the free displacements, looked at where bodies were (small displacements), or where they
    are: then all of it is linearised at every state."""

    def start(self) -> State:
        """The state before the first load step, as in ``Problem``: zero displacement; multipliers that touch at the
        outset are closed, theory (V6)."""
        rest = at_rest(self.n_free, int(self.operator.shape[0]))
        if self.integration is not None:
            rest = replace(rest, rates=self.integration.begins(self.model.dofs.size))
        return load_steps.started(self, rest)

    def frame(self, before: State, guess: State | None = None) -> Frame:
        """What is fixed during a step, as in ``Problem``."""
        return fluid_frames.begun(self, load_steps.begun(self, before, guess), before)

    def settled(self, before: State, frame: Frame, end: State) -> Frame:
        """The frame that belongs to the end of a step in ``frame``; the same object where that one serves as well."""
        return fluid_frames.spread(self, load_steps.settled(self, before, frame, end), end)

    def ended(self, state: State) -> Frame:
        """The frame in which a converged state ended, slips counted from there on."""
        return fluid_frames.begun(self, load_steps.ended(self, state, state), state)

    def handed(self, state: State, old: Frame, new: Frame) -> State:
        """A state whose functions follow others in a new frame, with the pressures and tractions that they had; the same
        object where none do."""
        return load_steps.handed(self, state, old, new)

    def linearise(
        self, before: State, frame: Frame, now: State, since: State | None = None, guessed: bool = False
    ) -> Linearised:
        """The problem near a trial state, as in ``Problem``; since: from which an iteration, or a guess, led to ``now``,
        theory (D24). A constant problem is affine everywhere: it is expanded about zero displacement, whose forces have
        no rounding."""
        if self.constant:
            rest = np.zeros(self.n_free)
            before, now = replace(before, unknowns=rest), replace(now, unknowns=rest)
        here = self.values(now)
        return expanded(self, before, frame, now, here, np.zeros_like(here), since, guessed)

    def ahead(self, before: State, frame: Frame, time: float) -> Linearised:
        """The problem near the converged state ``before``, with what is prescribed at another time: theory (G10)."""
        there, now = self.values(before), replace(before, time=time)
        return expanded(self, before, frame, now, there, self.values(now) - there)

    def accepted(self, before: State, frame: Frame, now: State, system: Linearised) -> State:
        """The converged state with its history, as in ``Problem``."""
        history = before.history
        for name, share in system.shares.items():
            history = history.with_term(name, share.history)
        for term in self.terms:
            if isinstance(term, Released):
                history = term.remembered(history, now, system)
        contacts = load_steps.remembered(self, before, frame, now, system)
        rates = self.rates(before, now.time, self.values(now))
        return replace(now, history=replace(history, contacts=contacts, drag=None), rates=rates and rates.converged)

    def expand(
        self, before: State, frame: Frame, state: State, laws: Laws, system: Linearised
    ) -> tuple[State, Linearised]:
        """A solution in all free displacements, as in ``Problem``: nothing has been condensed."""
        return state, system

    def again(self, before: State, state: State) -> Linearised:
        """The problem near a converged state, as in ``Problem``."""
        frame = load_steps.ended(self, before, state)
        return self.linearise(before, fluid_frames.begun(self, frame, state), state)

    def restrict(self, state: State) -> State:
        """A state in the unknowns of this problem, as in ``Problem``."""
        return state

    def with_ordinary(self, closed: NDArray[np.bool_]) -> ContactProblem:
        """The problem with ordinary functions where contact is closed, as in ``Problem``."""
        wet = {item.contact for item in self.model.penetrations}  # whose fluids push as dual pressures do
        pairs = [
            pair if pair.contact.name in wet else with_plain_functions(self.model, pair, self.constraints, part)
            for pair, part in zip(self.pairs, self.split(closed))
        ]
        if all(new is old for new, old in zip(pairs, self.pairs)):
            return self
        return self.with_pairs(pairs)

    def with_pairs(self, pairs: Sequence[Pair]) -> ContactProblem:
        """The same with others of the same surfaces."""
        kinematics = [replace(kind, pair=pair) for kind, pair in zip(self.kinematics, pairs)]
        return replace(self, kinematics=kinematics, operator=stacked(pairs, self.constraints.free.shape[1]))

    def alone_at_edges(self, closed: NDArray[np.bool_], state: State | None = None) -> NDArray[np.bool_]:
        """What is closed alone at edges where both sides end, as in ``Problem``."""
        found = np.zeros(len(closed), dtype=bool)
        for pair, own, part in zip(self.pairs, self.split(np.arange(len(closed))), self.split(closed)):
            if pair.flush is None:
                continue
            alone = pair.flush.alone(pair.space, part[pair.normal])
            if state is not None and alone.any():
                moved = self.displacement(state).reshape(-1, self.model.dim)
                alone = pair.flush.on(pair.space, alone, apart(pair, moved, self.added(pair, state.time)))
            found[own[pair.normal]] = alone
        return found
