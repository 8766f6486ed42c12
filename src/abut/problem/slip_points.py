"""What friction at large sliding remembers of a step: its integration points, looked at in new positions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.cells import MAX_FACET_NODES
from abut.contact.coupling import Coupling
from abut.contact.coupling_tangent import normal_derivative
from abut.contact.geometry import Smoothing, nodal_normals
from abut.contact.tangential import turned
from abut.mesh.surface import Surface
from abut.types import Sparse

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SlipPoints:
    """Integration points (n of them) of the last converged step: constants of the next one, theory (G6).

    facet, target_facet: (n,); weight: (n,) area; pressure, own, other: (n, 9) values of the facet-wise pressure functions
    and of the shape functions of the contactor's and the target's facet."""

    facet: NDArray[np.int64]
    target_facet: NDArray[np.int64]
    weight: Array
    pressure: Array
    own: Array
    other: Array

    @classmethod
    def of(cls, contactor: Surface, target: Surface, coupling: Coupling) -> SlipPoints:
        """Of a coupling with its points kept."""
        at = coupling.points
        assert at is not None
        dim, n = contactor.dim, len(at.weight)
        entries = at.gap_operator.tocoo()
        along = entries.data * at.normal[entries.row, entries.col % dim]
        shapes = sp.csr_matrix((along, (entries.row, entries.col // dim)), shape=(n, at.gap_operator.shape[1] // dim))
        width = MAX_FACET_NODES
        column = width * at.facet[:, None] + np.arange(width)
        row = np.broadcast_to(np.arange(n)[:, None], column.shape)
        values = at.pressure[row.ravel(), column.ravel()] if column.size else 0.0  # SciPy takes no empty index
        pressure = np.broadcast_to(np.asarray(values).ravel(), column.size).reshape(column.shape)
        return cls(
            at.facet, at.target_facet, at.weight, pressure,
            _picked(shapes, contactor.nodes[at.facet]), -_picked(shapes, target.nodes[at.target_facet]),
        )  # fmt: skip

    @classmethod
    def from_array(cls, values: Array) -> SlipPoints:
        """From ``array``."""
        facets = np.rint(values[:, :2]).astype(np.int64)
        parts = np.split(values[:, 3:], 3, axis=1)
        return cls(facets[:, 0], facets[:, 1], values[:, 2], *parts)

    @property
    def array(self) -> Array:
        """All of it, (n, 30), for a restart."""
        return np.column_stack([self.facet, self.target_facet, self.weight, self.pressure, self.own, self.other])

    def moments(self, n_facets: int) -> Array:
        """int H_k over what was covered, facet by facet, (9 n_facets,)."""
        result = np.zeros((n_facets, MAX_FACET_NODES))
        np.add.at(result, self.facet, self.weight[:, None] * self.pressure)
        return result.ravel()


@dataclass(frozen=True)
class SlipNow:
    """Weighted slips facet by facet, one column a component: value (9 n_facets, c); by_position: c derivatives
    (9 n_facets, dim n_points)."""

    value: Array
    by_position: tuple[Sparse, ...]


def slip_now(points: SlipPoints, contactor: Surface, target: Surface, across: Smoothing | None = None) -> SlipNow:
    """Of theory (G6), at the positions of two surfaces over one array of points: sum w H (x_C - x_T) . tau in 2D (c = 1),
    with tau the normal turned by a right angle; in 3D (c = 3) the part of x_C - x_T square to the normal."""
    x, dim = contactor.points, contactor.dim
    mine, its = contactor.nodes[points.facet], target.nodes[points.target_facet]
    difference = _shapes(points.own, mine, len(x)) - _shapes(points.other, its, len(x))
    apart = np.asarray(difference @ x)
    fields = -nodal_normals(contactor, across)[points.facet]
    sum_ = np.einsum("qj,qja->qa", points.own, fields)
    length = np.linalg.norm(sum_, axis=1)
    normal = sum_ / length[:, None]
    turning = _normal_change(points, contactor, across, normal, length)
    gather = _gather(points, len(contactor))
    moved = [sp.kron(difference, np.eye(dim)[[a]], format="csr") for a in range(dim)]
    if dim == 2:
        tangent = turned(normal)
        value = np.einsum("qa,qa->q", apart, tangent)
        # d tau = turned (d N): d . d tau = d . (-dN_y, dN_x)
        change = (
            sp.diags(tangent[:, 0]) @ moved[0] + sp.diags(tangent[:, 1]) @ moved[1]
            + sp.diags(apart[:, 1]) @ turning[0] - sp.diags(apart[:, 0]) @ turning[1]
        )  # fmt: skip
        return SlipNow(np.asarray(gather @ value)[:, None], ((gather @ change).tocsr(),))
    height = np.einsum("qa,qa->q", apart, normal)
    rise = sum(sp.diags(normal[:, a]) @ moved[a] + sp.diags(apart[:, a]) @ turning[a] for a in range(dim))
    changes = [moved[a] - sp.diags(height) @ turning[a] - sp.diags(normal[:, a]) @ rise for a in range(dim)]
    flat = apart - height[:, None] * normal
    return SlipNow(np.asarray(gather @ flat), tuple((gather @ change).tocsr() for change in changes))


def _normal_change(
    points: SlipPoints, contactor: Surface, across: Smoothing | None, normal: Array, length: Array
) -> list[Sparse]:
    """Derivative of each component of the unit normal at the points by all positions, (n, dim n_points) each."""
    dim, width = contactor.dim, MAX_FACET_NODES
    n, size = len(points.weight), width * len(contactor)
    column = (width * points.facet[:, None] + np.arange(width)).ravel()
    row = np.repeat(np.arange(n), width)
    weigh = sp.csr_matrix(((points.own / length[:, None]).ravel(), (row, column)), shape=(n, size))
    nodal = normal_derivative(contactor, across)
    raw = [-(weigh @ nodal[a::dim]) for a in range(dim)]
    along = sum(sp.diags(normal[:, a]) @ raw[a] for a in range(dim))
    return [(raw[a] - sp.diags(normal[:, a]) @ along).tocsr() for a in range(dim)]


def _gather(points: SlipPoints, n_facets: int) -> Sparse:
    """(9 n_facets, n): sum of w H over the points."""
    width = MAX_FACET_NODES
    row = (width * points.facet[:, None] + np.arange(width)).ravel()
    column = np.repeat(np.arange(len(points.weight)), width)
    values = (points.weight[:, None] * points.pressure).ravel()
    return sp.csr_matrix((values, (row, column)), shape=(width * n_facets, len(points.weight)))


def _shapes(values: Array, nodes: NDArray[np.int32], n_points: int) -> Sparse:
    used = nodes >= 0
    row = np.nonzero(used)[0]
    return sp.csr_matrix((values[used], (row, nodes[used])), shape=(len(nodes), n_points))


def _picked(matrix: Sparse, nodes: NDArray[np.int32]) -> Array:
    """Entries of each row at the nodes of its facet, (n, 9), zero where padded."""
    used = nodes >= 0
    result = np.zeros(nodes.shape)
    result[used] = np.asarray(matrix[np.nonzero(used)[0], nodes[used]]).ravel()
    return result
