"""How far the functions of a pressure space are dual ones at large sliding, theory (G14)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.cells import MAX_FACET_NODES
from abut.contact.block_rows import block_rows
from abut.contact.coupling import Coupling
from abut.contact.coupling_tangent import CouplingTangent
from abut.contact.facet_area import area_change
from abut.contact.geometry import beside_others, full_moments
from abut.contact.pressure_space import PressureSpace, inner_facets, partly_dual
from abut.contact.rim import ends_on_target, goes_on, rim
from abut.contact.slip_points import SlipNow
from abut.dofs import n_places
from abut.mesh.surface import Surface
from abut.problem.current_friction import Rubbing, Tangents
from abut.problem.pair import WHOLE, Pair
from abut.types import Sparse

CLOSE = 1.0 - WHOLE  # covered share of a facet from which up its functions are the dual ones
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Mixture:
    """Dual and ordinary functions on the facets of a contactor as the target covers them. share: (n_facets,) of the dual
    ones; least: (n_facets,) the facet that it is taken from; covered, area: (n_facets,) of each facet."""

    share: Array
    least: NDArray[np.int64]
    covered: Array
    area: Array

    @classmethod
    def of(cls, contactor: Surface, coupling: Coupling, inner: Array | None) -> Mixture:
        """Of a coupling by functions of the facets' corners. A facet and all that have a point with it covered wholly: dual
        functions; one not covered at all: ordinary ones. A dual function is negative on a part of its facet, which must not
        be all that is covered; and the gap at a node, which it gives, may be that beyond the edge of the target.

        inner: (n_facets,) above zero where functions are the ordinary ones in this step; None for nowhere."""
        n = len(contactor)
        covered, area = coupling.weight.reshape(n, -1).sum(axis=1), full_moments(contactor, 0)[:, 0]
        least = _least_around(contactor, covered / area)
        share = dual_share((covered / area)[least])
        return cls(share if inner is None else np.where(inner > 0.0, 0.0, share), least, covered, area)

    def space(self, dual: PressureSpace) -> PressureSpace:
        """The space of these functions, of that of the dual ones."""
        return partly_dual(dual, self.share)

    def change(self, contactor: Surface, by_weight: Sparse) -> Sparse:
        """Derivative of ``share`` by all positions, for each function of the facets, (9 n_facets, dim n_points).

        by_weight: that of int H_k, the same shape."""
        between = np.flatnonzero((self.share > 0.0) & (self.share < 1.0))
        of = self.least[between]
        covered = _of_facets(of, len(self.share)).T @ by_weight
        ratio = sp.diags(self.covered[of] / self.area[of])
        slope = 2.0 / CLOSE**2 * self.covered[of] / self.area[of] ** 2
        by_share = sp.diags(slope) @ (covered - ratio @ area_change(contactor, of))
        return (_of_facets(between, len(self.share)) @ by_share).tocsr()


@dataclass(frozen=True)
class Mixed:
    """What the change of ``Mixture.share`` adds to the derivatives of a pair. change: of the share, (9 n_facets, dim
    n_points); by: the pair's coupling; differences: dual less ordinary functions by component, (9 n_facets, n) each."""

    change: Sparse
    by: CouplingTangent
    differences: Sequence[Sparse]

    @classmethod
    def of(cls, change: Sparse, by: CouplingTangent, pair: Pair) -> Mixed:
        """Of a pair with dual functions all over."""
        return cls(change, by, [(part.transfer - part.plain).tocsr() for part in pair.components])

    def moment(self, value: Array) -> Sparse:
        """Of integrals, (n, dim n_points), that are ``value`` (9 n_facets,) facet by facet."""
        return (self.differences[0].T @ sp.diags(value) @ self.change).tocsr()

    def pressed(self, pressure: Array) -> Sparse:
        """Of the forces of pressures (n,), (dim n_points, dim n_points)."""
        return (self._along().T @ sp.diags(self.differences[0] @ pressure) @ self.change).tocsr()

    def rubbed_in_plane(self, made: Rubbing, slip: SlipNow, along: Array) -> Rubbing:
        """Of slips and of the forces of tractions (n,) in 2D."""
        apart = self.differences[1]
        slopes = apart.T @ sp.diags(slip.value[:, 0]) @ self.change
        bending = (self._along(turned=True).T @ sp.diags(apart @ along) @ self.change).tocsr()
        return replace(
            made,
            by_position=(made.by_position + slopes).tocsr(),
            bending=bending if made.bending is None else made.bending.tocsr() + bending,
        )

    def rubbed_in_space(self, made: Rubbing, slip: SlipNow, tangents: Tangents) -> Rubbing:
        """The same in 3D."""
        apart, each = self.differences[0], tangents.now.tangents
        moved = [apart.T @ sp.diags(slip.value[:, a]) @ self.change for a in range(3)]
        along = [sum(sp.diags(each[:, b, a]) @ moved[a] for a in range(3)) for b in range(2)]
        n = len(each)
        order = np.arange(2 * n).reshape(2, n).T.ravel()  # two of a function side by side
        slopes = sp.vstack(along).tocsr()[order][tangents.kept]
        value, column, start = self.by.operators
        square = block_rows((value[..., 3:].reshape(-1, 3, 3), column, start), n_places(self.by.turning.shape[1], 3))
        pulled = sp.diags((apart @ tangents.traction).ravel()) @ sp.kron(self.change, np.ones((3, 1)), format="csr")
        bending = square.T.tocsr() @ pulled
        return replace(
            made,
            by_position=(made.by_position + slopes).tocsr(),
            bending=bending if made.bending is None else made.bending.tocsr() + bending,
        )

    def _along(self, turned: bool = False) -> Sparse:
        """Forces of unit pressures, facet by facet, (9 n_facets, dim n_points); turned: in 2D of unit tractions."""
        value, column, start = self.by.operators
        points = self.by.turning.shape[1]
        dim = 3 if value.shape[2] in (3, 12) else 2
        value = value[..., dim:] if turned else value[..., :dim]
        return block_rows((value, column, start), n_places(points, dim)).tocsr()


def dual_share(covered: Array) -> Array:
    """Share of dual functions on facets of which the target covers ``covered``, both (n_facets,): the square leaves every
    function a positive integral over whatever is covered, be it where the dual one is negative."""
    return np.asarray(np.minimum(covered / CLOSE, 1.0) ** 2)


def mixed_part(pair: Pair, mixture: Mixture) -> Pair:
    """A pair with the functions of a mixture."""
    space, *others = (mixture.space(part) for part in pair.components)
    return replace(pair, space=space, components=(space, *others))


def _of_facets(facets: NDArray[np.int64], n: int) -> Sparse:
    """(9 n, len(facets)): the functions of each of some facets."""
    rows = (MAX_FACET_NODES * facets[:, None] + np.arange(MAX_FACET_NODES)).ravel()
    columns = np.repeat(np.arange(len(facets)), MAX_FACET_NODES)
    return sp.csr_matrix((np.ones(len(rows)), (rows, columns)), shape=(MAX_FACET_NODES * n, len(facets)))


def _least_around(contactor: Surface, values: Array) -> NDArray[np.int64]:
    """The facet with the least of values (n_facets,) among each facet and those that have a point with it, (n_facets,)."""
    order = np.argsort(values, kind="stable")
    rank = np.empty(len(order), dtype=np.int64)
    rank[order] = np.arange(len(order))
    facet, local = np.nonzero(contactor.nodes >= 0)
    at = contactor.nodes[facet, local]
    lowest = np.full(len(contactor.points), len(order))
    np.minimum.at(lowest, at, rank[facet])
    result = rank.copy()
    np.minimum.at(result, facet, lowest[at])
    return np.asarray(order[result])


def inner_now(
    space: PressureSpace, contactor: Surface, target: Surface, whole: Array, closed: NDArray[np.bool_], near: float
) -> Array:
    """Where functions of "dual-P1" are the ordinary ones, (n_facets,) 1 or 0, theory (P9): well inside closed contact.

    whole: (n_facets,) covered share; closed: (n_functions,) bool; near: a length, how far apart the surfaces may be."""
    border = rim(contactor)
    edge = ends_on_target(contactor, border, goes_on(contactor, border, target, near))
    interior = (whole > 1.0 - WHOLE) & ~edge & ~beside_others(contactor)
    return inner_facets(space, contactor, interior, closed).astype(float)
