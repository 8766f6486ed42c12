"""Connectors as a term of the balance of forces, with a multiplier for each motion that they take; theory (F21), (F22)."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from abut.bodies.rigid_modes import FREE, SUPPORTED, free_motions
from abut.errors import SingularModelError, Unsound
from abut.jets import Jet
from abut.model import Connector, Model
from abut.model.connector import FIELD
from abut.problem.constraints import Constraints
from abut.problem.free_modes import NO_WORK
from abut.problem.joints import AnyJoint, joints
from abut.problem.restraint import Restraint
from abut.problem.rigid_bodies import RigidBody
from abut.problem.terms import MatrixTangent, Motion, Share
from abut.solution.connectors import ConnectorResult
from abut.types import Array, Sparse

ROUND, QUARTER = 2.0 * np.pi, 0.5 * np.pi
REACHED = 1e-6  # of the joint's size: nearer to a limit it is there
STOPS = ("stop", "stop2")  # what limits of the first and the second free motion are
ROUNDED = (
    2.0**-52 / 1e-9
)  # of a joint's size: to what conditions are known, over the share of forces that Newton's method
# leaves; what moves a joint by less than that share of it cannot be told from no force
NEW = 1e-8  # of a row's own size: what earlier ones leave of it, from which on it says something new


@dataclass(frozen=True)
class Condition:
    """A function of the points of a joint that is zero, times a force as its multiplier; ``open``: the multiplier is zero in
    its place. what: "held", "stop", "stop2" or "motion"; unit: what makes its multiplier the force along a motion."""

    what: str
    jet: Jet
    open: bool = False
    unit: float = 1.0


@dataclass(frozen=True)
class Connectors:
    """All connectors of a model. unit: stiffness by which multipliers, which are lengths, are forces; loose: numbers of
    those, and of their free motions, that nothing but limits hold."""

    model: Model
    joints: Sequence[AnyJoint]
    unit: float
    loose: frozenset[tuple[int, int]] = frozenset()
    name: str = FIELD
    constant: bool = False

    @classmethod
    def of(cls, model: Model, bodies: Sequence[RigidBody]) -> Connectors | None:
        """None where there are none. Raises InputError for bodies whose points do not say how they turn."""
        if not model.connectors:
            return None
        mesh = model.mesh
        modulus = max(solid.material.modulus for solid in model.solids)
        cell = float(np.ptp(mesh.points, axis=0).max()) / len(mesh.points) ** (1.0 / mesh.dim)
        return cls(model, joints(model, bodies), modulus * (cell if mesh.dim == 3 else 1.0))

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """Force, tangent and history at a state, as in ``Term``; its history is the turn of each connector, beyond half
        a turn too."""
        n, multipliers = len(now.displacement), now.fields[FIELD][:, 0]
        force, sizes = np.zeros(n + len(multipliers)), np.zeros(n + len(multipliers))
        blocks, history = list[tuple[Sparse, Array, Array, Array]](), {}
        for number, joint, own in self._each():
            held, free, turned = self._functions(joint, before, now)
            history[f"turn{number}"] = np.array(turned).reshape(-1, 1)
            conditions = self._conditions(number, joint, held, free, multipliers[own], now.time)
            at = self._forces(joint, conditions, free, multipliers[own], now.time)
            rows = joint.rows
            force[:n] += rows.T @ at.slope
            for k, (condition, multiplier) in enumerate(zip(conditions, multipliers[own])):
                force[n + own.start + k] = self.unit * (-multiplier if condition.open else condition.jet.value)
            sizes[n + own.start : n + own.stop] = self.unit * joint.size
            slopes = [(0.0 if c.open else self.unit) * c.jet.slope for c in conditions]
            couples = np.reshape(slopes, (len(slopes), rows.shape[0]))
            blocks.append((rows, at.bend, couples, np.array([-self.unit if c.open else 0.0 for c in conditions])))
        rounded = ROUNDED * self.unit * max(joint.size for joint in self.joints)
        sizes[:n] = np.maximum(np.abs(force[:n]), rounded)
        return Share(force, MatrixTangent(_tangent(blocks, n)), history, sizes=sizes)

    def _each(self) -> Iterator[tuple[int, AnyJoint, slice]]:
        """Number, joint, and its multipliers."""
        first = 0
        for number, joint in enumerate(self.joints):
            last = first + joint.connector.multipliers(self.model.mesh)
            yield number, joint, slice(first, last)
            first = last

    def _functions(self, joint: AnyJoint, before: Motion, now: Motion) -> tuple[list[Jet], list[Jet], list[float]]:
        """As ``Joint.functions``, turns beyond half a turn as they follow what was ``before``; and the free motions. Raises
        Unsound for a step so long that turns, and the way in which a joint closes, are no longer the nearest ones."""
        held, free = joint.functions(joint.rows @ now.displacement)
        number = next(k for k, other in enumerate(self.joints) if other is joint)
        last = before.history.get(f"turn{number}", np.zeros((len(free), 1)))[:, 0]
        for k, (name, jet) in enumerate(zip(joint.connector.motions, free)):
            if name.startswith("turn") and joint.finite:
                times = np.round((last[k] - jet.value) / ROUND)
                free[k] = Jet(np.asarray(jet.value + ROUND * times), jet.slope, jet.bend)
                if abs(float(free[k].value) - last[k]) > QUARTER:
                    raise Unsound(f"connector '{joint.connector.name}' turns by more than a quarter in one step")
        return held, free, [float(jet.value) for jet in free]

    def _conditions(
        self, number: int, joint: AnyJoint, held: Sequence[Jet], free: Sequence[Jet], multipliers: Array, time: float
    ) -> list[Condition]:
        """In the order of the multipliers."""
        connector, result = joint.connector, [Condition("held", jet) for jet in held]
        for k, limits in connector.limited:
            result.append(self._stop(number, joint, k, limits, free[k], float(multipliers[len(result)])))
        if connector.motion is not None:
            length, given = _length(joint), connector.motion * _factor(connector, time)
            result.append(Condition("motion", _less(free[0].times(length), length * given), unit=length))
        return result

    def _stop(
        self, number: int, joint: AnyJoint, k: int, limits: tuple[float, float], motion: Jet, multiplier: float
    ) -> Condition:
        """Of the limits of free motion k."""
        length = _length(joint, k)
        way, what = motion.times(length), STOPS[k]
        lower, upper = (length * limit for limit in limits)
        over, under = multiplier + way.value - upper, multiplier + way.value - lower
        if (number, k) in self.loose:
            at = _stopped(joint.connector, multiplier, float(way.value), lower, upper, joint.size)
            return Condition(what, _less(way, at), unit=length)
        if over > 0.0 or under < 0.0:
            return Condition(what, _less(way, upper if over > 0.0 else lower), unit=length)
        return Condition(what, way, open=True, unit=length)

    def _forces(
        self, joint: AnyJoint, conditions: Sequence[Condition], free: Sequence[Jet], multipliers: Array, time: float
    ) -> Jet:
        """The work whose slopes are the forces of a connector on the points of its joint, against displacements."""
        count = joint.rows.shape[0]
        total = Jet(np.zeros(()), np.zeros(count), np.zeros((count, count)))
        for condition, multiplier in zip(conditions, multipliers):
            if not condition.open:
                total = total + condition.jet.times(self.unit * float(multiplier))
        connector = joint.connector
        if connector.load is not None:
            total = total + free[0].times(-connector.load * _factor(connector, time))
        if connector.stiffness is not None:
            way = free[0]
            bend = np.outer(way.slope, way.slope) + way.value * way.bend
            spring = Jet(0.5 * way.value**2, way.value * way.slope, bend)
            total = total + spring.times(connector.stiffness)
        return total

    def results(self, before: Motion, now: Motion) -> dict[str, ConnectorResult]:
        """By name, at the end of a step; ``before`` has the term's history there."""
        found, multipliers = {}, now.fields[FIELD][:, 0]
        for number, joint, own in self._each():
            held, free, turned = self._functions(joint, before, now)
            conditions = self._conditions(number, joint, held, free, multipliers[own], now.time)
            at = self._forces(joint, conditions, free, multipliers[own], now.time)
            force, moment = joint.resultant(-at.slope, joint.rows @ now.displacement)
            along = {
                c.what: 0.0 if c.open else -self.unit * c.unit * float(m)
                for c, m in zip(conditions, multipliers[own])
                if c.what != "held"
            }
            motion = dict(zip(joint.connector.motions, turned))
            stops = (along.get(what) for what in STOPS)
            found[joint.connector.name] = ConnectorResult(
                motion, force, moment, next(stops), along.get("motion"), *stops
            )
        return found

    def gradient(self, limited: bool) -> tuple[Sparse, list[tuple[Connector, str]]]:
        """At the outset (n, dim n_points) rows of what is held and prescribed, and with ``limited`` of limits too; and what
        each is of."""
        rows, names = [], list[tuple[Connector, str]]()
        for joint in self.joints:
            held, free = joint.functions(np.zeros(joint.rows.shape[0]))
            connector, taken = joint.connector, [("held", jet) for jet in held]
            if connector.motion is not None:
                taken.append(("motion", free[0].times(_length(joint))))
            resisted = {0} if connector.stiffness is not None else set()
            resisted |= {k for k, _ in connector.limited} if limited else set()
            taken += [("limits", free[k].times(_length(joint, k))) for k in sorted(resisted)]
            slopes = np.reshape([jet.slope for _, jet in taken], (len(taken), joint.rows.shape[0]))
            rows.append(sp.csr_matrix(slopes) @ joint.rows)
            names += [(connector, what) for what, _ in taken]
        return sp.vstack(rows, format="csr"), names

    def resistance(self, motions: Array, limited: bool = True) -> Array:
        """Gram matrix of motions (dim n_points, m) by what connectors take of them, of the size of one; ``limited``: limits
        take what they stop."""
        rows, _ = self.gradient(limited)
        moved = rows @ motions
        size = np.asarray(abs(rows).sum(axis=1)).ravel()
        moved = moved / np.maximum(size, 1e-300)[:, None]
        return np.asarray(moved.T @ moved) / max(rows.shape[0], 1)

    def require_held(self, restrained: Restraint, ends: Sequence[Array]) -> None:
        """Raises SingularModelError where loads (dim n_points,) at the end of steps drive a free motion that nothing
        resists; restrained: with connectors."""
        rigid = restrained.rigid
        free = free_motions(restrained.everything, SUPPORTED)
        for load in ends:
            work = free.T @ (rigid.modes.T @ load)
            if np.abs(work).max(initial=0.0) > NO_WORK * np.abs(load).sum():
                what = ", ".join(self._named(rigid.modes @ (free @ work)[:, None]))
                if what:
                    raise SingularModelError(
                        f"nothing resists {what}, and the loads act that way; give it a stiffness, limits or a motion, or "
                        "support the bodies that it joins"
                    )

    def free_in(self, restrained: Restraint) -> list[str]:
        """Free motions that nothing resists, in words; restrained: with connectors."""
        return self._named(restrained.rigid.modes @ free_motions(restrained.everything, SUPPORTED))

    def _named(self, free: Array) -> list[str]:
        moving = ((self.joints[number].connector, k) for number, k in sorted(self._moving(free)))
        return [f"the {c.motions[k]} of connector '{c.name}'" for c, k in moving]

    def _moving(self, free: Array) -> frozenset[tuple[int, int]]:
        """The connectors that motions (dim n_points, m) move along free motions, those with these."""
        found = set[tuple[int, int]]()
        for number, joint in enumerate(self.joints):
            if joint.connector.motions and free.shape[1]:
                _, motions = joint.functions(np.zeros(joint.rows.shape[0]))
                for k, motion in enumerate(motions):
                    moved = motion.times(_length(joint, k)).slope @ (joint.rows @ free)
                    if np.abs(moved).max() > np.sqrt(FREE) * np.abs(joint.rows @ free).max():
                        found.add((number, k))
        return frozenset(found)

    def beside(self, restrained: Restraint) -> Connectors:
        """With those that nothing but their limits hold, beside supports, springs and contact."""
        own = self.resistance(restrained.rigid.modes, limited=False)
        free = free_motions([*restrained.everything, own], SUPPORTED)
        moving = self._moving(restrained.rigid.modes @ free)
        limited = {(n, k) for n, joint in enumerate(self.joints) for k, _ in joint.connector.limited}
        return replace(self, loose=moving & limited)

    def require_independent(self, constraints: Constraints, factors: Array) -> None:
        """Raises SingularModelError where connectors hold what others, supports or prescribed motions hold already."""
        rows, names = self.gradient(limited=False)
        near = constraints.near(np.zeros(constraints.free.shape[1]), factors)
        reduced = (rows @ near.free[: rows.shape[1]]).tocsr()
        used = np.unique(reduced.indices)
        dense, earlier = reduced[:, used].toarray(), list[Array]()
        size = np.asarray(abs(rows).max(axis=1).todense()).ravel()
        for row, (connector, what), scale in zip(dense, names, size):
            if what == "limits":
                continue
            left = row.copy()
            for _ in range(2):  # once more, against rounding
                for one in earlier:
                    left -= (one @ left) * one
            length = float(np.linalg.norm(left))
            if length <= NEW * scale:
                raise SingularModelError(_repeated(connector, what))
            earlier.append(left / length)


def _repeated(connector: Connector, what: str) -> str:
    sides = f"'{connector.on}' and {_to(connector)}"
    if what == "motion":
        return (
            f"connector '{connector.name}': motion is prescribed, but supports or other connectors fix it already; leave "
            "motion out"
        )
    return (
        f"connector '{connector.name}' ({connector.kind}) between {sides} holds what supports, prescribed motions or other "
        "connectors hold already, so that its forces are not unique; use a kind that holds less (a slot or ball in place "
        "of one of several hinges, say), or free a prescribed motion"
    )


def _to(connector: Connector) -> str:
    return f"'{connector.to}'" if connector.to else "the ground"


def _length(joint: AnyJoint, k: int = 0) -> float:
    """What makes free motion k a length."""
    return joint.size if joint.connector.motions[k].startswith("turn") else 1.0


def _factor(connector: Connector, time: float) -> float:
    return time if connector.amplitude is None else connector.amplitude(time)


def _stopped(connector: Connector, multiplier: float, way: float, lower: float, upper: float, size: float) -> float:
    """Where a free motion is stopped that nothing else holds. Raises SingularModelError where loads drive it away from the
    only limit that there is."""
    if np.isfinite(lower) and np.isfinite(upper):
        return upper if multiplier >= 0.0 else lower
    only = upper if np.isfinite(upper) else lower
    pulls = multiplier if only == lower else -multiplier
    if abs(way - only) <= REACHED * size and pulls > 0.0:
        raise SingularModelError(
            f"connector '{connector.name}': the loads drive its free motion away from its limit, and nothing else holds it; "
            "give it another limit, a stiffness, or a support of its body"
        )
    return only


def _less(jet: Jet, value: float) -> Jet:
    return Jet(np.asarray(jet.value - value), jet.slope, jet.bend)


def _tangent(blocks: Sequence[tuple[Sparse, Array, Array, Array]], n: int) -> Sparse:
    """(n + k, n + k) of connectors one after the other: rows (m, n) of each joint, bends (m, m) of its work, slopes (k, m)
    of its conditions, (k,) the diagonal of those that are open."""
    own = sum((rows.T @ sp.csr_matrix(bend) @ rows for rows, bend, _, _ in blocks), sp.csr_matrix((n, n)))
    coupling = sp.vstack([sp.csr_matrix(couples) @ rows for rows, _, couples, _ in blocks], format="csr")
    diagonal = sp.diags(np.concatenate([open_ for *_, open_ in blocks]))
    return sp.csr_matrix(sp.bmat([[own, coupling.T], [coupling, diagonal]], format="csr"))
