"""The results of a contact pair, and the lines of its certificate."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf, isnan

import numpy as np
from numpy.typing import NDArray

from abut.brief import brief, listed, vector
from abut.contact.sides import Names, words
from abut.mesh.surface import Surface


@dataclass(frozen=True)
class Check:
    """One line of the certificate: a dimensionless error of a contact, its limit, and its meaning.
    last: it counts in the last step only, since it fails while loads are small; highest: in that of the largest pressure.
    pressure: what the value is relative to, 0 where it is relative to something else. notice: from which value on it is
    worth knowing though it passes; unknown: why there is no value, which then is NaN and passes."""

    contact: str
    name: str
    value: float
    limit: float
    meaning: str
    last: bool = False
    pressure: float = 0.0
    highest: bool = False
    notice: float = inf
    unknown: str = ""

    @property
    def passed(self) -> bool:
        """Whether the value is within its limit; what is no number is not, unless that is so for a reason."""
        return bool(self.unknown) or self.value <= self.limit

    @property
    def warns(self) -> bool:
        """Whether it passes with a value that is worth knowing."""
        return self.passed and self.value > self.notice

    @property
    def verdict(self) -> str:
        """One word: "pass", "warn", "none" (nothing to measure) or "FAIL"."""
        if self.unknown:
            return "none"
        return "FAIL" if not self.passed else "warn" if self.warns else "pass"


def worst(checks: Sequence[Check]) -> Check:
    """Of one line at several states in turn, the worst; what is no number is. Errors relative to a pressure become relative
    to the largest one: where contact has just begun they matter as little as the pressure does."""
    if checks[-1].last:
        return checks[-1]
    if checks[-1].highest:
        return max(reversed(checks), key=lambda check: check.pressure)
    largest = max(check.pressure for check in checks)
    of_all = [replace(c, value=c.value * c.pressure / largest, pressure=largest) if largest else c for c in checks]
    return max(of_all, key=lambda check: inf if isnan(check.value) else check.value / check.limit)


@dataclass(frozen=True)
class PressureStatistics:
    """The pressure of a contact over its loaded area, at points at least half of whose support is covered.

    largest: of the reported pressure, force per area; place: (dim,) where, coordinates as those of Resultant;
    partly_covered: the largest at points with less of their support covered, which count nowhere else, NaN where none of
    these is loaded; area: the loaded one, its edge found within facets, theory (P30) (2D: a length;
    axisymmetric: of the whole turn); mean: normal force over it; percentile_95: the pressure that 95 % of it stays below.
    Where nothing is in contact place, mean and percentile are NaN.
    """

    largest: float
    place: NDArray[np.float64]
    partly_covered: float
    mean: float
    percentile_95: float
    area: float


@dataclass(frozen=True)
class Resultant:
    """Resultant of the nodal forces of a contact on the side named first, in undeformed coordinates; with finite kinematics
    in deformed ones.

    force: (dim,), in 2D per unit thickness, axisymmetric (radial sum, axial force) of the full circumference; moment: (1,)
    or (3,) about the origin of coordinates, zero in axisymmetric models; centre: (dim,) of pressure, the point of the
    force's line of action nearest to the mean of the nodes (weighted by their forces along the resultant); on a plane
    contact it lies in that plane, in axisymmetric models on the axis; NaN where forces cancel or there are none.
    """

    force: NDArray[np.float64]
    moment: NDArray[np.float64]
    centre: NDArray[np.float64]


@dataclass(frozen=True)
class FrictionResult:
    """Friction of one contact pair at the end of a step.

    coefficient: the largest, infinite for "rough"; traction: (n_contactor_facets, 9, dim) on the contactor, at the facets'
    own nodes, tangential force per area; traction_limit: (n_contactor_facets, 9) what its size can be there at most, the
    coefficient times the pressure, infinite for "rough"; slip, total_slip: as traction, length, of the contactor over the
    target, in this step and in all steps while in contact; status: (n_contactor_facets, 9) 0 open, 1 sticking, 2 slipping,
    of a node without a multiplier the highest of its facet; NaN (0) where padded.
    sticking_area, slipping_area: as ``ContactResult.area``.
    work, total_work: that friction takes, force times length, in this step and in all; work_per_area, total_work_per_area:
    (n_contactor_facets, 9) the same at the nodes.
    force: (dim,) resultant of the traction on the side named first; force_by_area: of its size wherever it points, the
    integral of the size of the traction over the area; force_limit: what that can be at most, the integral of the
    coefficient times the pressure, infinite for "rough"; all of the full circumference in axisymmetric models, per unit
    thickness in 2D.
    largest_share: the largest traction over the coefficient times the pressure at one point, 1 where anything slips; NaN
    where nothing is pressed, and for "rough".
    """

    coefficient: float
    traction: NDArray[np.float64]
    traction_limit: NDArray[np.float64]
    slip: NDArray[np.float64]
    total_slip: NDArray[np.float64]
    status: NDArray[np.int32]
    sticking_area: float
    slipping_area: float
    work: float
    total_work: float
    work_per_area: NDArray[np.float64]
    total_work_per_area: NDArray[np.float64]
    force: NDArray[np.float64]
    force_by_area: float
    force_limit: float
    largest_share: float

    __repr__ = brief

    @property
    def max_traction(self) -> float:
        """Size of the largest tangential traction at a node, force per area."""
        return _largest(self.traction, self.status >= 0)

    @property
    def max_slip(self) -> float:
        """The largest slip at a node in contact in this step, length."""
        return _largest(self.slip, self.status > 0)

    @property
    def max_total_slip(self) -> float:
        """The largest slip at a node in all steps, length."""
        return _largest(self.total_slip, self.status >= 0)


def _largest(values: NDArray[np.float64], at: NDArray[np.bool_]) -> float:
    """Size of the largest vector of (n_facets, 9, dim) at some nodes."""
    return float(np.nanmax(np.linalg.norm(values[at], axis=-1), initial=0.0))


@dataclass(frozen=True)
class ContactResult:
    """One contact pair at the end of a step.

    named: the two sides as the user named them; force: (dim,) resultant on the first of these (the contactor, where roles
    are given), force (2D: per unit thickness); the other one gets its opposite.
    pressure, gap: (n_contactor_facets, 9) at the facets' own nodes, NaN where padded; force per area and length. The
    pressure is recovered from the multiplier's averages over the corners' functions, theory (P10): on facets of first order
    these, on those of second order values at all nodes, theory (P18).
    multiplier: (n_contactor_facets, 9) the multiplier itself, which may jump between facets and oscillate; share:
    (n_contactor_facets, 9) covered share of each point's support. max_pressure: the largest where that is at least a half.
    covered: (n_contactor_facets,) bool, whether any part of the facet faces the target.
    target_pressure: (n_target_facets, 9), the pressure transferred, 0 where the target is not in contact.
    area: the loaded one, its edge found within facets, theory (P30); of a tie the covered one. covered_share: covered
    area over the contactor's area; checks: the certificate of this step.
    statistics: of the pressure over the loaded area; resultant: force and moment on the side named first, and their centre.
    contactor_forces, target_forces: (n_nodes, dim) of the multiplier, at ``contactor.node_ids`` and ``target.node_ids``;
    body_forces: body of the side named second -> (dim,) its part of their resultant; friction: where there is any.
    For tied pairs ``pressure`` is the normal part of the tie traction (compression positive), the forces are all of it.
    """

    name: str
    named: tuple[Names, Names]
    contactor: Surface
    target: Surface
    force: NDArray[np.float64]
    max_pressure: float
    area: float
    max_penetration: float
    active: int
    multipliers: int
    removed: int
    segments: int
    pressure: NDArray[np.float64]
    multiplier: NDArray[np.float64]
    share: NDArray[np.float64]
    gap: NDArray[np.float64]
    covered: NDArray[np.bool_]
    covered_share: float
    target_pressure: NDArray[np.float64]
    checks: tuple[Check, ...]
    statistics: PressureStatistics
    resultant: Resultant
    contactor_forces: NDArray[np.float64]
    target_forces: NDArray[np.float64]
    body_forces: Mapping[str, NDArray[np.float64]]
    friction: FrictionResult | None = None

    def __repr__(self) -> str:
        """The main numbers, in some lines."""
        s = self.statistics
        lines = [
            f"Contact '{self.name}' of {words(self.named[0])} and {words(self.named[1])}: "
            f"{self.active} of {self.multipliers} multipliers closed",
            f"  force {vector(self.force)} on the first, {self.force_by_area:.6g} over the area {self.area:.6g}",
            f"  largest pressure {self.max_pressure:.6g} at {vector(s.place)}, mean {s.mean:.6g}",
            f"  deepest penetration {self.max_penetration:.3g}, {self.covered_share:.0%} of the contactor covered",
        ]
        if self.friction is not None:
            lines.append(
                f"  friction {vector(self.friction.force)}, slips on {self.friction.slipping_area:.6g}, sticks on "
                f"{self.friction.sticking_area:.6g}"
            )
        failed = [check.name for check in self.checks if not check.passed]
        return "\n".join([*lines, *([f"  fails: {listed(failed)}"] if failed else [])])

    @property
    def nodes(self) -> NDArray[np.int64]:
        """(n,) point numbers of the mesh on the contactor, sorted."""
        return self.contactor.node_ids

    @property
    def nodal_pressure(self) -> NDArray[np.float64]:
        """(n,) force per area at ``nodes``: ``pressure`` there, where facets differ (as at a crease) the mean of theirs;
        NaN where there is none."""
        return self._at_nodes(self.pressure)

    @property
    def nodal_gap(self) -> NDArray[np.float64]:
        """(n,) length at ``nodes``, as ``nodal_pressure``; negative where sides overlap."""
        return self._at_nodes(self.gap)

    def _at_nodes(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """The mean over the facets of each node."""
        there = (self.contactor.nodes >= 0) & np.isfinite(values)
        number = np.searchsorted(self.nodes, self.contactor.nodes[there])
        count, total = (np.bincount(number, w, len(self.nodes)) for w in (None, values[there]))
        return np.where(count > 0, total / np.maximum(count, 1), np.nan)

    @property
    def force_by_area(self) -> float:
        """The pressure over the area, wherever it points, at nodes at least half of whose support is covered; 0 without
        contact. In a fit, where both sides of a body carry, the resultant is only their difference."""
        mean = self.statistics.mean
        return 0.0 if isnan(mean) else mean * self.statistics.area
