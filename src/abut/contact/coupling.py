"""Coupling of a contact pair: int H_k N_j on contactor and target and the weighted gap, integrated on segments.

The pressure functions here are facet by facet (discontinuous): row 9 f + k
is function k of contactor facet f, 9 being ``abut.cells.MAX_FACET_NODES``. The
pressure spaces of ``abut.contact.pressure_space`` are combinations of these rows. "The paper" is El-Abbasi and Bathe 2001.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut._core import couple_surfaces, plan_facets
from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.geometry import Smoothing, by_kind, facet_sizes, is_plane, nodal_normals, turning_within
from abut.contact.quadrature import moment_tolerance, rule_tables
from abut.dofs import dofs_at, n_dofs
from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.types import Array, Json, Sparse

CURVED_POINTS = {2: 6, 3: 3}  # by dimension, per direction, where the contactor's normal turns within a facet
SAME_NORMAL = 1e-9
NO_GAP = 16 * np.finfo(float).eps  # of the largest coordinate: a gap below it cannot be told from none


@dataclass(frozen=True)
class IntegrationPoints:
    """The integration points of all segments of a pair (n of them).

    facet, target_facet: (n,) of contactor and target; weight: (n,) area; gap: (n,) geometric gap, length;
    normal: (n, dim) unit, from target to contactor: theory (F1);
    pressure: (n, 9 n_facets) values of the facet-wise pressure functions;
    gap_operator: (n, dim n_points), change of the gap by a displacement.
    """

    facet: NDArray[np.int64]
    target_facet: NDArray[np.int64]
    weight: NDArray[np.float64]
    gap: NDArray[np.float64]
    normal: NDArray[np.float64]
    pressure: Sparse
    gap_operator: Sparse


@dataclass(frozen=True)
class GapSamples:
    """Gap samples: corners and middles of all n segments, with the target opposite.

    facet, target_facet: (n,) of contactor and target; gap: (n,) geometric gap, length; normal: (n, dim) unit, from target to
    contactor; contactor_shapes, target_shapes: (n, 9) shape functions of the contactor's and the target's facet, zero where
    padded.
    """

    facet: NDArray[np.int32]
    target_facet: NDArray[np.int32]
    gap: NDArray[np.float64]
    normal: NDArray[np.float64]
    contactor_shapes: NDArray[np.float64]
    target_shapes: NDArray[np.float64]


@dataclass(frozen=True)
class Coupling:
    """The integrated interface of one contact pair.

    Columns are the points of the surfaces: one shared array (``contactor.points is target.points``), or, where each
    surface brings its own, the contactor's points followed by the target's.

    operator: (9 n_facets, dim n_points) sparse, (B u)_k = int H_k (u_C - u_T) . N, theory (F5); for ``componentwise``
              coupling (9 n_facets, n_points), the same without N (one displacement component).
    contactor_part, target_part: the two terms of ``operator``, both with a plus sign.
    gap, weight: (9 n_facets,) int H_k g and int H_k over the covered part; mass: (n_facets, 9, 9) int H_k H_l.
    covered: (n_facets,) covered area; segments: (n_facets,) how many segments.
    points, gap_samples: where they were asked for.
    Integrals are in the surfaces' unit of length: areas (2D: lengths; axisymmetric: areas of the full circumference),
    ``gap`` times a length.
    """

    degree: int
    operator: Sparse
    contactor_part: Sparse
    target_part: Sparse
    gap: NDArray[np.float64]
    weight: NDArray[np.float64]
    mass: NDArray[np.float64]
    covered: NDArray[np.float64]
    segments: NDArray[np.int32]
    points: IntegrationPoints | None = None
    gap_samples: GapSamples | None = None


def default_reach(contactor: Surface, target: Surface) -> float:
    """How far apart two surfaces may lie and still be paired, a length: two of the larger facets, or a tenth of the
    contactor."""
    extent = np.ptp(contactor.points[contactor.node_ids], axis=0)
    facet = max(facet_sizes(contactor).max(), facet_sizes(target).max())
    return float(max(2.0 * facet, 0.1 * np.linalg.norm(extent)))


def no_gap(contactor: Surface, target: Surface, adjust: float) -> float:
    """Size up to which a gap counts as none: ``adjust``, or rounding of the coordinates."""
    rounding = NO_GAP * max(np.abs(s.points).max() for s in (contactor, target))
    return float(adjust + rounding)


@dataclass(frozen=True, eq=False)
class Plan:
    """Integration points per direction, and subdivisions, of each facet of both surfaces, as decided in one configuration:
    theory (Q5), (S7). With it the coupling is a smooth function of the coordinates until facets meet others."""

    contactor_points: NDArray[np.int32]
    contactor_divisions: NDArray[np.int32]
    target_points: NDArray[np.int32]
    target_divisions: NDArray[np.int32]


@dataclass(frozen=True)
class CouplingOptions:
    """How ``couple`` cuts and integrates, and what it keeps.

    rule:   "gauss" or "newton-cotes".
    points: per direction on each segment, or "auto": as many as let every facet meet its own int N_i N_j to 1e-12,
            theory (Q4), (Q5) (newton-cotes: as far as its nine points go); or what ``plan_pair`` decided.
    reach:  largest distance between the surfaces, length; see ``default_reach``. largest_gap: the same outside of the
            bodies, where overlaps may be larger; ``reach`` where left out.
    adjust: gaps and overlaps up to this size count as zero, length.
    hidden: count targets behind a nearer one, too; else each point of the contactor is paired with the nearest target
            only, theory (S12).
    componentwise: without the normal, for one displacement component (ties).
    normals: (n_facets, 9, dim) unit normals at the contactor's facets' nodes; ``nodal_normals`` where left out.
    target_across: where the target's normals are averaged, as decided in another configuration; else as it is now.
    keep_points: keep the integration points; keep_gap_samples: keep corners and middles of the segments, which takes a tenth
            of the time.
    """

    rule: str = "gauss"
    points: int | str | Plan = "auto"
    reach: float | None = None
    largest_gap: float | None = None
    adjust: float = 0.0
    hidden: bool = False
    componentwise: bool = False
    keep_points: bool = False
    keep_gap_samples: bool = False
    normals: NDArray[np.float64] | None = None
    target_across: Smoothing | None = None


def couple(
    contactor: Surface,
    target: Surface,
    degree: int,
    options: CouplingOptions = CouplingOptions(),
    only: NDArray[np.bool_] | None = None,
    across: Smoothing | None = None,
) -> Coupling:
    """Divide the contactor into segments by the target, projected along the contactor's continuous normal, and integrate
    (paper, section 4).

    degree: of the pressure functions, 0, 1 (on facet corners) or 2 (the facet's own shape functions).
    only:   (n_facets,) of the contactor, those to integrate; the rows of all others stay empty. Couplings of disjoint
            facets add up to the whole: ``abut.contact.merging``.
    across: where the contactor's normals are averaged, as decided in another configuration; else as it is now.
    Raises InputError where the two surfaces do not fit together (dimension, empty).
    """
    check_pair(contactor, target)
    facets = np.arange(len(contactor)) if only is None else np.flatnonzero(only)
    raw = couple_surfaces(
        **cutting_arguments(contactor, target, facets, options, across),
        degree=degree,
        vectorial=not options.componentwise,
        keep_points=options.keep_points,
        gap_samples=options.keep_gap_samples,
    )
    if only is not None:
        raw = _among_all(raw, facets, len(contactor))
    offset, n_points = point_columns(contactor, target)
    contactor_part = _matrix(raw["contactor"], MAX_FACET_NODES * len(contactor), n_points, 0)
    target_part = _matrix(raw["target"], MAX_FACET_NODES * len(contactor), n_points, offset)
    return Coupling(
        degree=degree,
        operator=(contactor_part - target_part).tocsr(),
        contactor_part=contactor_part,
        target_part=target_part,
        gap=raw["gap"].ravel(),
        weight=raw["weight"].ravel(),
        mass=raw["mass"],
        covered=raw["covered"],
        segments=raw["segments"],
        points=_points(raw, contactor, target) if options.keep_points else None,
        gap_samples=_gap_samples(raw) if options.keep_gap_samples else None,
    )


Couple = Callable[[Surface, Surface, int, CouplingOptions], Coupling]  # ``couple``, or what has it done by others


def check_pair(contactor: Surface, target: Surface) -> None:
    """Raises InputError where two surfaces do not fit together."""
    if contactor.dim != target.dim:
        raise InputError(f"surfaces '{contactor.name}' and '{target.name}' have different dimensions")
    if contactor.axisymmetric != target.axisymmetric:
        raise InputError(f"surfaces '{contactor.name}' and '{target.name}': only one of them is axisymmetric")
    for surface in (contactor, target):
        if len(surface) == 0:
            raise InputError(f"surface '{surface.name}' has no facets")


def cutting_arguments(
    contactor: Surface,
    target: Surface,
    facets: NDArray[np.int64],
    options: CouplingOptions,
    across: Smoothing | None,
) -> Json:
    """What the compiled core is told about the cutting and the rules for some facets of the contactor."""
    normals = nodal_normals(contactor, across) if options.normals is None else options.normals
    part = contactor if len(facets) == len(contactor) else contactor.part(facets)
    plan = _plan_part(part, target, options, normals[facets])
    if isinstance(options.points, Plan):
        plan = replace(
            plan,
            contactor_points=plan.contactor_points[facets],
            contactor_divisions=plan.contactor_divisions[facets],
        )
    reach = default_reach(contactor, target) if options.reach is None else options.reach
    return {
        "points_c": part.points,
        "kinds_c": part.kinds,
        "nodes_c": part.nodes,
        "normals": np.ascontiguousarray(normals[facets]),
        "points_t": target.points,
        "kinds_t": target.kinds,
        "nodes_t": target.nodes,
        "rules": rule_tables(options.rule),
        "order_c": plan.contactor_points,
        "order_t": plan.target_points,
        "subdivide_c": plan.contactor_divisions,
        "subdivide_t": plan.target_divisions,
        "axisymmetric": contactor.axisymmetric,
        "reach": reach,
        "largest_gap": reach if options.largest_gap is None else options.largest_gap,
        "rounding": no_gap(contactor, target, options.adjust),
        "hidden": options.hidden,
        **_kin(part, target),
        "bulge_c": _bulge(part),
        "bulge_t": _bulge(target),
    }


def _kin(contactor: Surface, target: Surface) -> Json:
    """What facets are to each other; nothing where not both sides say so."""
    none = np.zeros((0, 10))
    mine, other = contactor.kin, target.kin
    both = mine is not None and other is not None
    return {
        "kin_c": np.ascontiguousarray(mine) if both else none,
        "kin_t": np.ascontiguousarray(other) if both else none,
    }


def _bulge(surface: Surface) -> NDArray[np.float64]:
    return np.zeros((0, MAX_FACET_NODES)) if surface.bulge is None else np.ascontiguousarray(surface.bulge)


def _among_all(raw: Json, facets: NDArray[np.int64], n: int) -> Json:
    """What was integrated on some facets, at its place among all n."""
    result = dict(raw)
    for name in ("gap", "weight", "mass", "covered", "segments"):
        result[name] = np.zeros((n, *raw[name].shape[1:]), dtype=raw[name].dtype)
        result[name][facets] = raw[name]
    for name in ("contactor", "target"):
        row, column, value = raw[name]
        result[name] = MAX_FACET_NODES * facets[row // MAX_FACET_NODES] + row % MAX_FACET_NODES, column, value
    for name in ("point_contactor_facet", "gap_sample_contactor_facet"):
        if name in raw:
            result[name] = facets[raw[name]].astype(raw[name].dtype)
    return result


def plan_pair(contactor: Surface, target: Surface, options: CouplingOptions, across: Smoothing | None = None) -> Plan:
    """What ``couple`` decides about integration points and subdivisions; ``replace(options, points=...)`` holds on to it.
    Raises InputError as ``couple`` does."""
    check_pair(contactor, target)
    return _plan_part(contactor, target, options, nodal_normals(contactor, across))


def _plan_part(part: Surface, target: Surface, options: CouplingOptions, normals: NDArray[np.float64]) -> Plan:
    """normals: (n_facets, 9, dim) of the contactor or a part of it."""
    if isinstance(options.points, Plan):
        return options.points
    tables = rule_tables(options.rule)
    turning = turning_within(part, normals)
    points, divisions = _plan(part, tables, options.points, turning)
    if options.points == "auto":
        bulges = part.bulge is not None or target.bulge is not None  # enough for fits of second order
        curved = (turning > SAME_NORMAL) | bulges
        points = np.where(curved, np.maximum(points, CURVED_POINTS[part.dim]), points).astype(np.int32)
    turning = _turning_of_target(target, options.target_across)
    return Plan(points, divisions, *_plan(target, tables, options.points, turning))


def _plan(
    surface: Surface, tables: NDArray[np.float64], points: int | str, turning: NDArray[np.float64]
) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
    order, split = plan_facets(
        surface.points,
        surface.kinds,
        surface.nodes,
        tables,
        rule_tables("gauss"),
        moment_tolerance(surface.dim, turning),
        surface.axisymmetric,
    )
    if points != "auto":
        order = np.full_like(order, int(points))
    return order, split


def _turning_of_target(target: Surface, across: Smoothing | None) -> NDArray[np.float64]:
    """How far the normals of each facet turn, (n_facets,); zero where it doesn't matter, or where they cannot be found."""
    if target.dim == 2 or is_plane(target):
        return np.zeros(len(target))
    try:
        return turning_within(target, nodal_normals(target, across))
    except InputError:  # a facet without a normal at a node: the contactor may still see the others
        return np.zeros(len(target))


def point_columns(contactor: Surface, target: Surface) -> tuple[int, int]:
    """Number of the target's first point among the columns, and how many points there are."""
    if contactor.points is target.points:
        return 0, len(contactor.points)
    return len(contactor.points), len(contactor.points) + len(target.points)


def _matrix(entries: tuple[Array, ...], rows: int, n_points: int, offset: int) -> Sparse:
    row, column, value = entries
    width = value.shape[1]
    columns = dofs_at(offset + column.astype(np.int64), width).ravel()
    return sp.csr_matrix((value.ravel(), (np.repeat(row, width), columns)), shape=(rows, n_dofs(n_points, width)))


def _points(raw: dict[str, Array], contactor: Surface, target: Surface) -> IntegrationPoints:
    n, dim = raw["point_normal"].shape
    offset, n_points = point_columns(contactor, target)
    operator = sp.csr_matrix((n, n_dofs(n_points, dim)))
    for surface, name, sign, first in ((contactor, "contactor", 1.0, 0), (target, "target", -1.0, offset)):
        facet = raw[f"point_{name}_facet"]
        nodes = surface.nodes[facet]
        used = nodes >= 0
        row = np.nonzero(used)[0]
        value = sign * raw[f"point_{name}"][used][:, None] * raw["point_normal"][row]
        column = dofs_at(first + nodes[used].astype(np.int64), dim)
        operator = operator + sp.csr_matrix(
            (value.ravel(), (np.repeat(row, dim), column.ravel())), shape=operator.shape
        )
    facet = raw["point_contactor_facet"].astype(np.int64)
    columns = MAX_FACET_NODES * facet[:, None] + np.arange(MAX_FACET_NODES)
    rows = np.repeat(np.arange(n), MAX_FACET_NODES)
    size = n, MAX_FACET_NODES * len(contactor)
    pressure = sp.csr_matrix((raw["point_pressure"].ravel(), (rows, columns.ravel())), shape=size)
    pressure.eliminate_zeros()
    target_facet = raw["point_target_facet"].astype(np.int64)
    return IntegrationPoints(
        facet, target_facet, raw["point_weight"], raw["point_gap"], raw["point_normal"], pressure, operator
    )


def _gap_samples(raw: dict[str, Array]) -> GapSamples:
    names = ("contactor_facet", "target_facet", "gap", "normal", "contactor", "target")
    return GapSamples(*(raw[f"gap_sample_{name}"] for name in names))


def surface_degree(surface: Surface) -> int:
    """Degree of the displacement on a surface: 2 where any facet is quadratic."""
    return max(CELLS[kind].degree for kind, _ in by_kind(surface))
