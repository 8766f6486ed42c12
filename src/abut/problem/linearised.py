"""A problem near a state: balance of forces and gaps, both affine in displacements and multipliers, and rows of the laws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.problem.laws import LawRows
from abut.problem.pair import Pair, by_pair
from abut.problem.restraint import Restraint
from abut.problem.terms import Share
from abut.solution.state import State
from abut.types import Array, Operator, Sparse

Vector = NDArray[np.float64]
NOTHING = 1e-300  # size of what is not there


@dataclass(frozen=True)
class Rows:
    """The laws of all pairs near the present state, in the unknowns: residual + by_displacement du + by_pressure dp = 0.

    ``decoupled`` rows hold nothing but their own pressure. ``symmetric``: all others are minus the rows of the operator.
    by_gap, by_multiplier: (n, n) derivatives by the weighted gaps and, these apart, by the multipliers; None where a law
    looks at points.
    """

    residual: Vector
    by_displacement: Operator
    by_pressure: Operator
    decoupled: NDArray[np.bool_]
    symmetric: bool
    by_gap: Sparse | None = None
    by_multiplier: Sparse | None = None

    @property
    def fixed(self) -> Vector:
        """Change of the pressures that decoupled rows give at once; zero for all others."""
        diagonal = np.where(self.decoupled, self.by_pressure.diagonal(), 1.0)
        return np.where(self.decoupled, -self.residual / diagonal, 0.0)


@dataclass(frozen=True)
class Expansion:
    """A state of finite deformation that a problem is linearised about. at: (n_free,) displacements; unbalanced: (n_free,)
    forces of stresses less loads there; reference: size of forces against which that is judged; symmetric: the stiffness;
    rounding: what double precision may leave of forces that balance each other."""

    at: Vector
    unbalanced: Vector
    reference: float
    symmetric: bool
    rounding: float = 0.0


@dataclass(frozen=True)
class Linearised:
    """K q - B^T p = f, theory (F6), and weighted gaps g = B q + C p + g0, theory (F9), near a state: exactly where
    the problem is constant, so that K, B and C are the same objects at every state and a linear solver keeps its factors.

    factors: (n_histories,) of the histories at ``time``; stiffness K: (n_free, n_free); load f: (n_free,); operator B:
    (n, n_free), all pairs stacked; offset g0: (n,); compliance C: (n, n) where displacements have been condensed,
    theory (V4), else None; motions: (n_free, m) rigid motions that supports leave free; restraint: what holds bodies where
    contact lets go; forces: f before condensation; unit: size of the stiffness' entries, before condensation;
    about: under finite deformation, else None; B q is then B (q - at). Contact forces may have other columns than gaps have
    rows: F^T p with ``pushing`` F (n, n_free); bending: (n_free, n_free) their derivative, which K has with opposite sign;
    forgotten: (n,) multipliers of friction without a past, which carry nothing; shares: of the terms by name, without their
    tangents, none where the problem is constant; sizes: (n_free,) what residuals are judged against where there are fields
    beside displacements; even: the stiffness is symmetric; largest: nodal force of a term that is not constant, of all
    displacements, so that bodies that supports alone move are judged against their reactions (theory (D13)).
    """

    time: float
    factors: Vector
    stiffness: Operator
    load: Vector
    pairs: Sequence[Pair]
    operator: Operator
    offset: Vector
    motions: NDArray[np.float64]
    restraint: Restraint
    forces: Vector
    unit: float
    compliance: NDArray[np.float64] | None = None
    about: Expansion | None = None
    pushing: Operator | None = None
    forgotten: NDArray[np.bool_] | None = None
    bending: Operator | None = None
    shares: Mapping[str, Share] = field(default_factory=dict)
    sizes: Vector | None = None
    even: bool = True
    largest: float = 0.0

    def __len__(self) -> int:
        """Number of multipliers."""
        return int(self.operator.shape[0])

    def split(self, values: Array) -> list[Array]:
        """Values of all multipliers, pair by pair."""
        return by_pair(self.pairs, values)

    def join(self, values: Sequence[Array]) -> Array:
        return np.concatenate(values) if len(values) else np.zeros(0)

    @property
    def tied(self) -> NDArray[np.bool_]:
        """(n,) multipliers that are closed whatever happens."""
        return self.join([np.full(len(pair), pair.two_way) for pair in self.pairs]).astype(bool)

    @property
    def away(self) -> NDArray[np.bool_]:
        """(n,) multipliers of contacts that do not act."""
        return self.join([np.full(len(pair), pair.away) for pair in self.pairs]).astype(bool)

    @property
    def scale(self) -> Vector:
        """(n,) weighted gap per pressure, theory (L2)."""
        return self.join([pair.scale for pair in self.pairs])

    @property
    def weight(self) -> Vector:
        """(n,) int H_k."""
        return self.join([pair.weight for pair in self.pairs])

    @property
    def columns(self) -> Operator:
        """(n, n_free): forces by multiplier; the operator where nothing else is said."""
        return self.operator if self.pushing is None else self.pushing

    @property
    def symmetric(self) -> bool:
        """Whether the stiffness is."""
        return self.even if self.about is None else self.about.symmetric

    def same_matrices(self, other: Linearised) -> bool:
        """Whether stiffness, operator and compliance are the very objects of another state's."""
        mine, its = ((s.stiffness, s.operator, s.compliance) for s in (self, other))
        return all(a is b for a, b in zip(mine, its))

    def internal(self, state: State) -> Vector:
        """K q: nodal forces of stresses on the free displacements; the longest product of all."""
        return np.asarray(self.stiffness @ state.unknowns)

    def unbalanced(self, state: State, internal: Vector | None = None) -> Vector:
        """K q - B^T p - f; internal: K q where it is known."""
        if self.about is not None:  # K q would lose digits: a turn moves points far without forces
            residual = self.about.unbalanced + self.stiffness @ (state.unknowns - self.about.at)
        else:
            residual = (self.internal(state) if internal is None else internal) - self.load
        if len(state.multipliers):
            residual = residual - self.columns.T @ state.multipliers
        return np.asarray(residual)

    def relative(self, residual: Vector, largest: float) -> Vector:
        """A residual (n_free,) over the largest force, that of other fields over their own, where anything acts in them at
        the state that this is near to."""
        if self.sizes is None:
            return residual / largest
        return residual / np.where(self.sizes > 0.0, self.sizes, max(largest, NOTHING))

    def gap(self, state: State) -> Vector:
        """Weighted gaps of all multipliers, (n,)."""
        if not len(self.offset):
            return self.offset
        gap = self.offset + self.operator @ (state.unknowns if self.about is None else state.unknowns - self.about.at)
        return np.asarray(gap if self.compliance is None else gap + self.compliance @ state.multipliers)

    def rows(self, laws: Sequence[LawRows]) -> Rows:
        """The laws of all pairs in terms of the unknowns."""
        if not self.pairs:
            none = np.zeros(0)
            return Rows(none, self.operator, sp.csr_matrix((0, 0)), none.astype(bool), self.symmetric)
        by_displacement, by_compliance, first = [], [], 0
        for pair, law in zip(self.pairs, laws):
            here = slice(first, first + len(pair))
            first += len(pair)
            gaps = pair.points.operator if law.at_points and pair.points is not None else self.operator[here]
            by_displacement.append(sp.csr_matrix(law.by_gap @ gaps))
            if self.compliance is not None:
                empty = law.at_points  # all displacements of such pairs have been kept
                by_compliance.append(
                    np.zeros((len(pair), len(self.compliance))) if empty else law.by_gap @ self.compliance[here]
                )
        at_points = any(law.at_points for law in laws)
        by_pressure = _diagonal([law.by_pressure for law in laws])
        return Rows(
            residual=np.concatenate([law.residual for law in laws]),
            by_displacement=by_displacement[0] if len(laws) == 1 else sp.vstack(by_displacement).tocsr(),
            by_pressure=by_pressure if self.compliance is None else by_pressure.toarray() + np.vstack(by_compliance),
            decoupled=np.concatenate([law.decoupled for law in laws]),
            symmetric=self.symmetric and not at_points and all(law.symmetric for law in laws),
            by_gap=None if at_points else _diagonal([law.by_gap for law in laws]),
            by_multiplier=by_pressure,
        )


def _diagonal(blocks: Sequence[Sparse]) -> Sparse:
    """Square matrices one after the other along the diagonal."""
    return blocks[0].tocsr() if len(blocks) == 1 else sp.block_diag(blocks).tocsr()
