"""A contact pair, discretised: the record that laws, linear solvers, results and certificate look at."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import accumulate
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.coupling import Coupling
from abut.contact.flush_edges import FlushEdges
from abut.contact.friction_bound import FrictionBound
from abut.contact.geometry import Smoothing
from abut.contact.pressure_space import PressureSpace
from abut.contact.symmetry_planes import Planes
from abut.contact.tangential import SlipOperators
from abut.mesh.surface import Surface
from abut.model import LAWS, Contact
from abut.model.contact import TWO_WAY
from abut.model.friction import FrictionValues
from abut.types import Array, Sparse

TOUCHING = 1e-3  # initial gap over facet size below which a multiplier starts active
WHOLE = 1e-2  # a facet covered to within this share is fully covered


@dataclass(frozen=True)
class PairPoints:
    """The integration points of a pair: test (n_points, n) pressure functions; weight, gap, stiffness (n_points,);
    operator (n_points, n_free) change of the gap by the free displacements; prescribed (n_points, n_histories)."""

    test: Sparse
    weight: NDArray[np.float64]
    stiffness: NDArray[np.float64]  # of the constraint function, pressure per length
    gap: NDArray[np.float64]
    operator: Sparse
    prescribed: NDArray[np.float64]


@dataclass(frozen=True)
class Slip:
    """What makes tangential rows. operators: by facets; tangents: (n_functions, dim - 1, dim), normals: (n_functions, dim)
    from target to contactor, unit, at the place of each function of the pressure, ``points`` (n_functions, dim);
    at_facets: (n_facets, 9, dim) normals of the contactor; area: (n_functions,) by which weighted slips are divided, None
    for int H_k as it is."""

    operators: SlipOperators
    tangents: NDArray[np.float64]
    points: NDArray[np.float64]
    normals: NDArray[np.float64]
    at_facets: NDArray[np.float64]
    area: NDArray[np.float64] | None = None


@dataclass(frozen=True)
class Moving:
    """Where normals are averaged, and lie in planes of symmetry, wherever a pair moves: as at the outset, so that forces do
    not jump when an angle grows. target: None where it has a facet without a normal; the contactor may still see others.
    ongoing: (m,) bool, edges of the contactor's rim beyond which its body goes on smoothly; None where none is asked for."""

    contactor: Smoothing
    target: Smoothing | None
    ongoing: NDArray[np.bool_] | None = None


@dataclass(frozen=True)
class Pair:
    """One contact pair on the free displacements.

    operator: (n, n_free) sparse; gap: (n,) weighted geometric gap, theory (F9), without offsets; scale: (n,) weighted gap
    per pressure, weight h / E.
    size: typical facet length; stiffness: E / size, pressure per length. index: (n_functions, c) the multiplier of each
    function of ``space`` and component, -1 where there is none; components: the space of each component's multipliers, in
    turn. Ties have all components (c = dim), along the axes, and a gap of zero; else c = 1, along the contactor's normal,
    and with friction c = dim, the normal first and the tangents after it, whose jump is the slip since the last step.
    """

    contact: Contact
    contactor: Surface
    target: Surface
    coupling: Coupling
    space: PressureSpace
    rows: Sparse  # (n, dim n_points): operator on all displacements
    operator: Sparse
    gap: NDArray[np.float64]
    scale: NDArray[np.float64]
    size: float
    stiffness: float
    index: NDArray[np.int64]
    components: tuple[PressureSpace, ...]
    compliance: float  # 2 (1 - nu^2) / E of both sides together: what half spaces yield, times the wave number
    points: PairPoints | None = None  # where the law is evaluated at the integration points
    interior: NDArray[np.bool_] | None = None  # (n_facets,) where "dual-P1" may have ordinary functions
    flush: FlushEdges | None = None  # the same of dual functions of either space, at small displacements
    planes: Planes | None = None  # of symmetry, at which the contactor ends; None of ties
    repeated: bool = False  # equations tie displacements together that the constraints would take one by one
    slip: Slip | None = None  # with friction
    carried: NDArray[np.bool_] | None = None  # (n,) what the target alone sees, as supports hold the contactor's point
    values: FrictionValues | None = None  # the same: its coefficient
    moving: Moving | None = None  # with finite kinematics
    gone: int | None = (
        None  # number of the history that is 1 while it does not act, of one that acts for a part of the time
    )
    away: bool = False  # whether it does not act now

    @property
    def tied(self) -> bool:
        return self.contact.kind == "tied"

    @property
    def two_way(self) -> bool:
        """Whether its multipliers are closed whatever their sign: of a tie, and of bilateral contact, theory (L16), while
        they act."""
        return self.contact.kind in TWO_WAY and not self.away

    @property
    def decided(self) -> bool:
        """Whether no law decides what is closed: all of it, whatever the sign, or nothing."""
        return self.two_way or self.away

    @property
    def frictional(self) -> bool:
        return self.slip is not None

    @property
    def normal(self) -> slice:
        """The multipliers that are pressures, of a pair that is not tied."""
        return slice(0, len(self.space))

    @property
    def tangential(self) -> slice:
        """The multipliers that friction adds, of a pair that is not tied."""
        return slice(len(self.space), len(self))

    def of_functions(self, values: Array) -> Array:
        """Values (n_functions,) for every multiplier of each function, (n,)."""
        if self.index.shape[1] == 1:
            return values
        result = np.zeros(len(self), dtype=values.dtype)
        there = self.index >= 0
        result[self.index[there]] = np.broadcast_to(values[:, None], self.index.shape)[there]
        return result

    def tangential_traction(self, multipliers: NDArray[np.float64]) -> NDArray[np.float64]:
        """Vectors (n_functions, dim) along the tangents, of values (n,) of all multipliers; zero without friction."""
        result = np.zeros((len(self.space), self.contactor.dim))
        if self.slip is None:
            return result
        along = np.where(self.index[:, 1:] >= 0, multipliers[np.maximum(self.index[:, 1:], 0)], 0.0)
        return np.asarray(np.einsum("kb,kbd->kd", along, self.slip.tangents))

    def friction(self, factors: NDArray[np.float64]) -> FrictionBound:
        """What each function of a pair with friction carries along the tangents, the model's histories being at ``factors``
        (n_histories,)."""
        assert self.values is not None
        return self.values.bound(factors)

    def at(self, factors: NDArray[np.float64]) -> Pair:
        """The pair with the friction of a moment, where the model's histories are at ``factors``, and whether it acts."""
        pair = self if self.values is None else replace(self, values=self.values.at(factors))
        return pair.acting(factors)

    def acting(self, factors: NDArray[np.float64]) -> Pair:
        """The pair, which knows whether it acts where the model's histories are at ``factors``."""
        away = self.gone is not None and bool(factors[self.gone] > 0.0)
        return self if away == self.away else replace(self, away=away)

    @property
    def steepest(self) -> NDArray[np.float64]:
        """The largest coefficient of friction that each function ever has, (n_functions,)."""
        assert self.values is not None
        return self.values.steepest

    @property
    def weight(self) -> NDArray[np.float64]:
        """int H_k of every multiplier, (n,)."""
        return self.scale * self.stiffness

    @property
    def transfer(self) -> Sparse:
        """(9 n_facets, n) sparse, multipliers -> facet-wise nodal values of whichever component each one is."""
        return (
            self.space.transfer
            if len(self.components) == 1
            else sp.hstack([space.transfer for space in self.components])
        )

    def traction(self, multipliers: NDArray[np.float64]) -> NDArray[np.float64]:
        """Facet-wise coefficients (9 n_facets, c) by component."""
        ends = np.cumsum([len(space) for space in self.components])[:-1]
        parts = np.split(multipliers, ends)
        return np.column_stack([space.transfer @ part for space, part in zip(self.components, parts)])

    @property
    def redundant(self) -> bool:
        """Whether constraints may repeat each other, so that the pressure is one of many."""
        return self.repeated or self.contact.method == "node-to-segment-two-pass"

    @property
    def smooth(self) -> bool:
        """Whether the law is another one than complementarity, which Newton's method solves from its solution on."""
        return not self.tied and self.contact.law != LAWS[0]

    def __len__(self) -> int:
        return int(self.operator.shape[0])


def by_pair(pairs: Sequence[Pair], values: NDArray[Any]) -> list[NDArray[Any]]:
    """Values of all multipliers (n,), pair by pair."""
    ends = accumulate(len(pair) for pair in pairs)
    return [values[end - len(pair) : end] for pair, end in zip(pairs, ends)]
