"""A contact pair's coupling with its derivatives by the coordinates of both surfaces, theory (T1).

What ``abut.contact.coupling.couple`` integrates is differentiated as it computes it: places where nodes are projected,
clipping, integration points, normals, areas, rays. Only decisions are constants: which facets meet and hide each other,
numbers of integration points and subdivisions, creases.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, reduce
from operator import add

import numpy as np
from numpy.typing import NDArray

from abut._core import couple_tangent
from abut.cells import MAX_FACET_NODES
from abut.contact.block_rows import CompressedRows, block_rows, in_place, interleaved
from abut.contact.coupling import CouplingOptions, check_pair, cutting_arguments, point_columns
from abut.contact.geometry import Smoothing
from abut.contact.moving_normals import MovingNormals, normal_pattern
from abut.dofs import n_places
from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.types import Array, Json, Sparse


@dataclass(frozen=True)
class ContactLoad:
    """Coefficients of the facet-wise functions. pressure: (9 n_facets,); traction: (9 n_facets, dim) vectors, of which the
    part square to the normal counts; turned: (9 n_facets,) in 2D, along the normal turned by a right angle; or None."""

    pressure: Array
    traction: Array | None = None
    turned: Array | None = None


@dataclass(frozen=True)
class CouplingTangent:
    """One contact pair's coupling with its derivatives. Columns are dim times the points of
    ``abut.contact.coupling.Coupling``.

    gap_value, weight_value: (9 n_facets,) int H_k g and int H_k.
    operators: of 9 n_facets rows, blocks (n, 1, dim) of int H_k (N_C - N_T) N and, with tractions, beside each other
               (n, 1, dim + dim^2) with what a unit traction along each axis does to the nodes, in 2D (n, 1, 2 dim) with that
               of one along the normal turned by a right angle: theory (T6).
    force:     (dim n_points,) what pressure and tractions do to the nodes: theory (T1).
    force_tangent: (dim n_points, dim n_points), its derivative at constant p and t; not symmetric.
    by_points, by_normals: of 9 n_facets rows, blocks (n, 2, dim), derivatives of int H_k g and int H_k by points and by the
               nodal normals that differ; turning: (dim m, dim n_points) how these follow the points.
    """

    gap_value: NDArray[np.float64]
    weight_value: NDArray[np.float64]
    operators: CompressedRows
    force: NDArray[np.float64]
    force_tangent: Sparse
    by_points: CompressedRows
    by_normals: CompressedRows
    turning: Sparse

    @cached_property
    def gap(self) -> Sparse:
        """(9 n_facets, dim n_points), derivative of int H_k g."""
        return self.slope(np.array([1.0, 0.0])).tocsr()

    @cached_property
    def weight(self) -> Sparse:
        """(9 n_facets, dim n_points), derivative of int H_k."""
        return self.slope(np.array([0.0, 1.0])).tocsr()

    def slope(self, shares: Array) -> Sparse:
        """(9 n_facets, dim n_points) in blocks, derivative of so much of int H_k g and of int H_k, (2,)."""
        normals, points = ((shares @ parts[0])[:, None] for parts in (self.by_normals, self.by_points))
        dim = points.shape[2]
        by_normals = block_rows(in_place(normals, self.by_normals), n_places(self.turning.shape[0], dim))
        by_points = block_rows(in_place(points, self.by_points), n_places(self.turning.shape[1], dim))
        return by_points + by_normals @ self.turning


def coupling_tangent(
    contactor: Surface,
    target: Surface,
    degree: int,
    options: CouplingOptions,
    pressure: Array,
    traction: Array | None = None,
    only: NDArray[np.bool_] | None = None,
    across: Smoothing | None = None,
) -> CouplingTangent:
    """Differentiate ``couple(contactor, target, degree, options, only, across)`` by the surfaces' points: theory (T1).

    pressure, traction: as in ``ContactLoad``.
    Gaps that ``couple`` takes as none, being within ``options.adjust`` or rounding, change like others.
    Raises InputError where surfaces or coefficients do not fit together, and for componentwise coupling.
    """
    check_pair(contactor, target)
    _check_load(contactor, options, pressure, traction)
    normals = normal_pattern(contactor, across).at(contactor)
    return differentiated(contactor, target, degree, options, ContactLoad(pressure, traction), normals, only)


def differentiated(
    contactor: Surface,
    target: Surface,
    degree: int,
    options: CouplingOptions,
    load: ContactLoad,
    normals: MovingNormals,
    only: NDArray[np.bool_] | None = None,
) -> CouplingTangent:
    """The same, unchecked, with the contactor's normals as they are now."""
    raw = of_facets(contactor, target, degree, options, load, normals, only)
    return assembled([raw], normals.turning(point_columns(contactor, target)[1]))


Differentiate = Callable[[Surface, Surface, int, CouplingOptions, ContactLoad, MovingNormals], CouplingTangent]


def of_facets(
    contactor: Surface,
    target: Surface,
    degree: int,
    options: CouplingOptions,
    load: ContactLoad,
    normals: MovingNormals,
    only: NDArray[np.bool_] | None = None,
) -> Json:
    """What some facets of the contactor, or all, have in it, for ``assembled``: nearly all of the work."""
    facets = np.arange(len(contactor)) if only is None else np.flatnonzero(only)
    offset, n_points = point_columns(contactor, target)
    raw = couple_tangent(
        **cutting_arguments(contactor, target, facets, replace(options, normals=normals.values), None),
        degree=degree,
        pressure=np.ascontiguousarray(load.pressure.reshape(-1, MAX_FACET_NODES)[facets], dtype=float),
        traction=_of_facets(load.traction, facets, (MAX_FACET_NODES, contactor.dim)),
        turned=_of_facets(load.turned, facets, (MAX_FACET_NODES,)),
        normal_numbers=np.ascontiguousarray(normals.numbers[facets]),
        target_offset=offset,
        n_points=n_points,
        tangential=load.traction is not None or load.turned is not None,
    )
    return raw if len(facets) == len(contactor) else _among_all(raw, facets, len(contactor))


def assembled(parts: Sequence[Json], turning: Sparse) -> CouplingTangent:
    """The whole from what disjoint facets have in it. turning: as in ``CouplingTangent``."""
    dim = parts[0]["load"].shape[1]
    normals, points = (n_places(n, dim) for n in turning.shape)
    loaded, load = (np.concatenate([part[name] for part in parts]) for name in ("loaded", "load"))
    force = np.stack([np.bincount(loaded, along, points).astype(float) for along in load.T], axis=1)
    by_points, by_normals = (
        reduce(add, [block_rows(part[name], columns) for part in parts])
        for name, columns in (("force_by_points", points), ("force_by_normals", normals))
    )
    operators, of_points, of_normals = (
        interleaved([part[name] for part in parts]) for name in ("operators", "moment_by_points", "moment_by_normals")
    )
    return CouplingTangent(
        sum(part["gap"] for part in parts), sum(part["weight"] for part in parts), operators, force.ravel(),
        (by_points + by_normals @ turning).tocsr(), of_points, of_normals, turning,
    )  # fmt: skip


def _check_load(contactor: Surface, options: CouplingOptions, pressure: Array, traction: Array | None) -> None:
    n = MAX_FACET_NODES * len(contactor)
    if options.componentwise:
        raise InputError("a componentwise coupling has no normal, and no derivative: leave 'componentwise' out")
    if pressure.shape != (n,):
        raise InputError(f"the pressure on '{contactor.name}' has shape {pressure.shape}, not ({n},)")
    if traction is not None and traction.shape != (n, contactor.dim):
        raise InputError(f"the traction on '{contactor.name}' has shape {traction.shape}, not ({n}, {contactor.dim})")


def _of_facets(values: Array | None, facets: NDArray[np.int64], shape: tuple[int, ...]) -> NDArray[np.float64]:
    if values is None:
        return np.zeros((0, *shape))
    return np.ascontiguousarray(values.reshape(-1, *shape)[facets], dtype=float)


def _among_all(raw: Json, facets: NDArray[np.int64], n: int) -> Json:
    """What was integrated on some facets, in rows of all n."""
    rows = (MAX_FACET_NODES * facets[:, None] + np.arange(MAX_FACET_NODES)).ravel()
    result = dict(raw)
    for name in ("gap", "weight"):
        result[name] = np.zeros(MAX_FACET_NODES * n)
        result[name][rows] = raw[name]
    for name in ("operators", "moment_by_points", "moment_by_normals"):
        value, column, start = raw[name]
        count = np.zeros(MAX_FACET_NODES * n, dtype=np.int32)
        count[rows] = np.diff(start)
        result[name] = value, column, np.concatenate([[0], np.cumsum(count)]).astype(np.int32)
    return result
