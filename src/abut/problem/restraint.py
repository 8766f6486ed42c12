"""Rigid-body restraint by supports, ties and contact; and the repair of an active set that leaves a body unsupported."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from abut.bodies.rigid_modes import (
    SUPPORTED,
    RigidModes,
    describe,
    free_motions,
    resistance_of_rows,
    rigid_modes,
    simple_motions,
)
from abut.errors import SingularModelError
from abut.mesh.mesh import Mesh
from abut.problem.constraints import Constraints
from abut.problem.pair import Pair

UNBALANCED = 1e-9  # force that no contact balances, over the sum of all, from which on it moves a body
SLIGHT = 1e-9  # change of a gap over the motion that is rounding
EDGES = 16  # of the pyramid round a cone of friction
NOTHING = 1e-10  # share of a row that works on a rigid motion below which it is rounding


class Resists(Protocol):
    """What resists rigid motions by itself."""

    def resistance(self, motions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Gram matrix (m, m) of motions (dim n_points, m) by what it takes of them, of the size of one."""
        ...


@dataclass(frozen=True)
class Restraint:
    """Resistance against rigid motions: of the supports (with what holds loose motions), of each pair's rows."""

    rigid: RigidModes
    constraints: Constraints
    supports: NDArray[np.float64]
    pairs: Sequence[Pair]
    bare: NDArray[np.float64]  # of the supports, without what holds loose motions
    by_supports: bool  # supports and ties alone hold every body
    free: NDArray[np.float64]  # (dim n_points, m) rigid motions that the supports alone leave free

    @property
    def everything(self) -> list[NDArray[np.float64]]:
        """Resistance of supports and of every pair, closed."""
        return [self.supports, *(resistance_of_rows(self.rigid, p.rows) for p in self.pairs)]

    @property
    def steady(self) -> list[NDArray[np.float64]]:
        """Resistance of supports, and of ties and friction."""
        return [
            self.supports,
            *(resistance_of_rows(self.rigid, p.rows) for p in self.pairs if p.two_way or p.frictional),
        ]

    def helped_by(self, gram: NDArray[np.float64]) -> Restraint:
        """The same with something else that resists."""
        return (
            _restraint(self.rigid, self.constraints, self.supports + gram, self.pairs, self.bare)
            if gram.any()
            else self
        )

    def at(self, factors: NDArray[np.float64]) -> Restraint:
        """With the friction of a moment, where the model's histories are at ``factors``, (n_histories,), and the contacts
        that act then."""
        if all(pair.values is None or pair.values.history is None for pair in self.pairs):
            return self.acting(factors)
        return replace(self, pairs=[pair.at(factors) for pair in self.pairs]).acting(factors)

    def acting(self, factors: NDArray[np.float64]) -> Restraint:
        """With the contacts that act at a moment."""
        pairs = [pair.acting(factors) for pair in self.pairs]
        if not any(pair.away for pair in pairs):
            return self
        return _restraint(self.rigid, self.constraints, self.supports, pairs, self.bare)

    def complete(
        self, force: NDArray[np.float64], active: NDArray[np.bool_], gap: NDArray[np.float64]
    ) -> NDArray[np.bool_]:
        """The active set, with the closest multipliers added where it would let a body go that the loads move, theory (V8).

        force: (n_free,) loads on the free displacements; gap: (n,) weighted."""
        if self.by_supports or self._holds(active) or self._moved(force, active) is None:
            return active
        result = active.copy()
        splits = np.cumsum([len(p) for p in self.pairs])[:-1]
        for p, g, chosen in zip(self.pairs, np.split(gap, splits), np.split(result, splits)):
            if p.decided or not len(p):
                continue
            clearance = (g / (p.scale * p.stiffness * p.size))[p.normal]  # over the facet size
            chosen |= p.of_functions(clearance <= clearance.min() + 0.01)
        every = [np.full(len(p), not p.away) for p in self.pairs]
        return result if self._holds(result) else np.concatenate(every)

    def met_first(
        self, force: NDArray[np.float64], active: NDArray[np.bool_], gap: NDArray[np.float64]
    ) -> NDArray[np.bool_]:
        """As ``complete``, with what bodies meet first on the way on which the loads move them, one body after another: of a
        wheel with backlash the flanks that a torque turns together, not those that it turns apart. gap: not finite where
        there is nothing to meet. Without it ``test_a_torque_turns_a_wheel_through_its_backlash`` fails."""
        if self.by_supports or self._holds(active):
            return active
        result = active.copy()
        while (motion := self._moved(force, result)) is not None:
            nearest = self._nearest(self.constraints.coordinates(self.rigid.modes @ motion), gap) & ~result
            if not nearest.any():
                return self.complete(force, result, gap)
            result |= nearest
        return result

    def _nearest(self, way: NDArray[np.float64], gap: NDArray[np.float64]) -> NDArray[np.bool_]:
        """What a motion (n_free,) closes first, and what is within a hundredth of a facet then; of bodies as they were."""
        clearances, closings = [], []
        for p, g in zip(self.pairs, np.split(gap, np.cumsum([len(p) for p in self.pairs])[:-1])):
            one_way = not p.decided and len(p) > 0
            unit = (p.scale * p.stiffness * p.size)[p.normal] if one_way else np.zeros(0)  # over the facet size
            clearances.append(g[p.normal] / unit if one_way else unit)
            closings.append(-(p.operator @ way)[p.normal] / unit if one_way else unit)
        clearance, closing = np.concatenate(clearances), np.concatenate(closings)
        meets = np.isfinite(clearance) & (closing > SLIGHT * np.abs(closing).max(initial=0.0))
        if meets.any():
            least = float((clearance[meets] / closing[meets]).min())
            meets &= np.where(meets, clearance, 0.0) - least * closing <= 0.01
        found = np.split(meets, np.cumsum([len(part) for part in closings])[:-1])
        parts = [p.of_functions(near) if len(near) else np.zeros(len(p), bool) for p, near in zip(self.pairs, found)]
        return np.concatenate([np.zeros(0, dtype=bool), *parts])

    def unbalanced(self, force: NDArray[np.float64]) -> str:
        """The motion, in words, that forces (n_free,) cause though contact pushes wherever it can; empty where there is
        none."""
        motion = self._moved(force)
        return "" if motion is None else self._in_words(motion, [force], driven=True)

    def lifted(self, force: NDArray[np.float64], active: NDArray[np.bool_]) -> str:
        """The motion, in words, that forces (n_free,) cause though the multipliers ``active`` (n,) push; else empty."""
        motion = None if self.by_supports else self._moved(force, active)
        return "" if motion is None else describe(self.rigid, motion[:, None], one_way=True)

    def unheld(self, forces: Sequence[NDArray[np.float64]]) -> str:
        """A motion, in words, by which a body can leave its contact and that no load ever turns back; empty where there
        is none. forces: (n_free,) of each load step, none of which is out of balance."""
        free = free_motions([self.supports], SUPPORTED)
        moves = self.constraints.coordinates(self.rigid.modes @ free)
        works = [(moves.T @ force, float(np.abs(force).sum())) for force in forces]
        motion = unheld(self.pairs, moves, works)
        return "" if motion is None else self._in_words(free @ motion, forces, driven=False)

    def _in_words(self, motion: NDArray[np.float64], forces: Sequence[NDArray[np.float64]], driven: bool) -> str:
        """The motion (n_modes,), or a plain shift or turn that does as well: one that closes no contact, and on which forces
        (n_free,) do work if ``driven``, else none that turns it back."""
        plain = simple_motions(self.rigid, motion)
        moves = self.constraints.coordinates(self.rigid.modes @ plain)
        free = free_motions([self.bare], SUPPORTED)
        stays = np.linalg.norm(plain - free @ (free.T @ plain), axis=0) < 1e-6 * np.linalg.norm(plain, axis=0)
        opens = np.zeros(plain.shape[1])
        for pair in self.pairs:
            if pair.away:
                continue
            operator = pair.operator if pair.tied else pair.operator[pair.normal]
            size = np.asarray(abs(operator).sum(axis=1)).ravel()[:, None]  # none where no target is opposite yet
            moved = np.asarray(operator @ moves) / np.where(size > 0.0, size, 1.0)
            stays &= (np.abs(moved) < SLIGHT).all(axis=0) if pair.two_way else (moved > -SLIGHT).all(axis=0)
            opens += np.where(moved > SLIGHT, moved, 0.0).sum(axis=0)
        for force in forces:
            work, least = moves.T @ force, UNBALANCED * float(np.abs(force).sum())
            stays &= work > least if driven else work >= -least
        if not driven:
            stays &= opens > 0.0
        best = plain[:, stays][:, 0] if stays.any() else motion
        return describe(self.rigid, best[:, None], one_way=True)

    def _moved(self, force: NDArray[np.float64], active: NDArray[np.bool_] | None = None) -> NDArray[np.float64] | None:
        """The motion (n_modes,) that forces (n_free,) cause though contact, or that of the multipliers ``active`` alone,
        pushes where it can; None where there is none."""
        free = free_motions([self.supports], SUPPORTED)
        moves = self.constraints.coordinates(self.rigid.modes @ free)
        motion = unbalanced(self.pairs, moves, moves.T @ force, float(np.abs(force).sum()), active)
        return None if motion is None else free @ motion

    def _rows(self, active: NDArray[np.bool_]) -> list[NDArray[np.float64]]:
        splits = np.cumsum([len(p) for p in self.pairs])[:-1]
        return [
            resistance_of_rows(self.rigid, p.rows[chosen]) for p, chosen in zip(self.pairs, np.split(active, splits))
        ]

    def _holds(self, active: NDArray[np.bool_]) -> bool:
        return free_motions([self.supports, *self._rows(active)], SUPPORTED).shape[1] == 0


def unbalanced(
    pairs: Sequence[Pair],
    moves: NDArray[np.float64],
    work: NDArray[np.float64],
    size: float,
    active: NDArray[np.bool_] | None = None,
) -> NDArray[np.float64] | None:
    """The motion (m,) that is left where no pressures that push (ties: nor pull) balance the loads, theory (V15); None
    where some do.

    moves: (n_free, m) rigid motions that supports leave free; work: (m,) of the loads on them; size: sum of all forces,
    of which a work of ``UNBALANCED`` is none; active: (n,) multipliers that may press, all where left out."""
    if not _drives(work, size):
        return None
    chosen = [None] * len(pairs) if active is None else np.split(active, np.cumsum([len(p) for p in pairs])[:-1])
    forces = np.concatenate([np.zeros((0, len(work))), *(_pushes(p, moves, part) for p, part in zip(pairs, chosen))])
    if not len(forces):
        return work
    pressure, missing = _combined(forces.T, -work)
    return work + forces.T @ pressure if missing > UNBALANCED * size else None


def unheld(
    pairs: Sequence[Pair], moves: NDArray[np.float64], works: Sequence[tuple[NDArray[np.float64], float]]
) -> NDArray[np.float64] | None:
    """A motion (m,) that opens all of a contact, closes none, and that no load turns back: theory (V21). None where there is
    none, as where each contact can be under pressure while pressures balance one another or the loads.

    works: (m,) of each load step and the sum of its forces, as for ``unbalanced``."""
    pushes = [_pushes(pair, moves) for pair in pairs]
    forces = np.concatenate([np.zeros((0, moves.shape[1])), *pushes])
    loads = [work / np.linalg.norm(work) for work, size in works if _drives(work, size)]
    columns = np.concatenate([forces, *(load[None] for load in loads)])
    even = forces.sum(axis=0)  # all pressures may be one, and more: then each contact is under pressure
    if not len(forces) or _combined(columns.T, -even)[1] <= UNBALANCED * len(forces):
        return None
    pair_of = np.repeat(np.arange(len(pairs)), [len(push) for push in pushes])
    for i, pair in enumerate(pairs):
        if pair.two_way or not len(pushes[i]):
            continue
        carried = np.zeros(len(columns))
        carried[: len(forces)] = pair_of == i
        system = np.vstack([columns.T, carried])
        wanted = np.append(np.zeros(moves.shape[1]), 1.0)  # in balance, with a pressure of one in this contact
        amounts, missing = _combined(system, wanted)
        if missing > UNBALANCED:
            return np.asarray((system @ amounts - wanted)[:-1])
    return None


def _combined(columns: NDArray[np.float64], wanted: NDArray[np.float64]) -> tuple[NDArray[np.float64], float]:
    """Amounts (n,), none negative, of columns (m, n) that make most of what is wanted (m,), and what is missing."""
    amounts, missing = nnls(columns, wanted)
    return amounts, float(missing)


def _drives(work: NDArray[np.float64], size: float) -> bool:
    return bool(len(work)) and bool(np.abs(work).max() > UNBALANCED * size)


def _pushes(pair: Pair, moves: NDArray[np.float64], active: NDArray[np.bool_] | None = None) -> NDArray[np.float64]:
    """What a pressure of each multiplier of a pair, or of those ``active``, does on the motions, (rows, m), each of unit
    length; those of ties both ways, and none of those that do nothing but rounding."""
    if pair.away:
        return np.zeros((0, moves.shape[1]))
    if pair.frictional:
        return _pushes_and_drags(pair, moves, active)
    operator = pair.operator
    if active is not None:
        operator = operator[active]
    elif pair.points is not None:  # the pressure is positive there, its coefficients need not be
        operator = pair.points.operator
    moved = np.asarray(operator @ moves)
    length = np.linalg.norm(moved, axis=1)
    keep = length > NOTHING * np.asarray(abs(operator).sum(axis=1)).ravel()
    moved = moved[keep] / length[keep, None]
    return np.concatenate([moved, -moved]) if pair.two_way else moved


def _pushes_and_drags(pair: Pair, moves: NDArray[np.float64], active: NDArray[np.bool_] | None) -> NDArray[np.float64]:
    """The same with friction: the edges of each multiplier's cone, theory (R9), or of a pyramid round it in 3D."""
    moved = np.asarray(pair.operator @ moves) / pair.weight[:, None]
    there = np.ones(len(pair.space), dtype=bool) if active is None else active[pair.normal]
    along = [np.where(at[:, None] >= 0, moved[at], 0.0)[there] for at in pair.index.T]
    push, drags = along[0], along[1:]
    steep = pair.steepest[there, None]
    if len(drags) == 1:
        sides = [drags[0], -drags[0]]
    else:
        angles = 2.0 * np.pi * np.arange(EDGES) / EDGES
        sides = [(np.cos(a) * drags[0] + np.sin(a) * drags[1]) / np.cos(np.pi / EDGES) for a in angles]
    edges = [push, *sides] if np.isinf(steep).any() else [push, *(push + steep * side for side in sides)]
    rows = np.concatenate(edges)
    length = np.linalg.norm(rows, axis=1)
    keep = length > NOTHING
    return np.asarray(rows[keep] / length[keep, None])


def require_held(
    restraint: Restraint, loads: Sequence[NDArray[np.float64]], factors: Sequence[NDArray[np.float64]]
) -> None:
    """Raises SingularModelError where the loads of a step pull a body off its contact, and where one can leave its contact
    without any load that turns it back, at no step. loads: (dim n_points,) nodal forces at the end of each load step;
    factors: (n_histories,) of the histories there."""
    forces = [restraint.constraints.free.T @ load for load in loads]
    for number, (force, at) in enumerate(zip(forces, factors), start=1):
        require_balance(restraint.at(at), force, f" in step {number}" if len(forces) > 1 else "")
    require_unmoved(restraint, forces)


def require_balance(restraint: Restraint, force: NDArray[np.float64], when: str = "") -> None:
    """Raises SingularModelError where forces (n_free,) pull a body off its contact."""
    motion = restraint.unbalanced(force)
    if motion:
        raise SingularModelError(
            f"{motion}: the loads pull it off its contact{when}, which carries no tension{_rub(restraint)}; "
            "constrain it by a support or reverse the load"
        )


def _rub(restraint: Restraint) -> str:
    return " and friction only up to its coefficient" if any(pair.frictional for pair in restraint.pairs) else ""


def require_unmoved(restraint: Restraint, forces: Sequence[NDArray[np.float64]]) -> None:
    """Raises SingularModelError where a body can leave its contact and none of the forces (n_free,) of load steps turns it
    back."""
    motion = restraint.unheld(forces)
    if motion:
        raise SingularModelError(
            f"{motion}: contact can only push it that way, and no support, other contact or load opposes that; add a "
            "support, the body that it rests on, or the load that keeps it in place"
        )


def helped(restrained: Restraint, helps: Iterable[Resists | None]) -> Restraint:
    """The same with all that resists beside supports and contact: springs, supports that come or go."""
    for one in helps:
        restrained = restrained if one is None else restrained.helped_by(one.resistance(restrained.rigid.modes))
    return restrained


def restraint(mesh: Mesh, constraints: Constraints, pairs: Sequence[Pair]) -> Restraint:
    """Work out what holds the bodies of a mesh."""
    rigid = rigid_modes(mesh)
    support = resistance_of_supports(rigid, constraints)
    return _restraint(rigid, constraints, support, pairs, support)


def _restraint(
    rigid: RigidModes,
    constraints: Constraints,
    support: NDArray[np.float64],
    pairs: Sequence[Pair],
    bare: NDArray[np.float64],
) -> Restraint:
    ties = [resistance_of_rows(rigid, p.rows) for p in pairs if p.two_way]
    by_supports = free_motions([support, *ties], SUPPORTED).shape[1] == 0
    return Restraint(
        rigid, constraints, support, pairs, bare, by_supports, rigid.modes @ free_motions([support], SUPPORTED)
    )


def resistance_of_supports(rigid: RigidModes, constraints: Constraints) -> NDArray[np.float64]:
    """Gram matrix of what supports, equations and rigid bodies take out of the rigid motions."""
    taken = constraints.taken(rigid.modes)
    return np.asarray(taken.T @ taken / max(1.0, float(constraints.free.shape[0] - constraints.free.shape[1])))
