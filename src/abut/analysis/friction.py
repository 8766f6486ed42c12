"""Friction of a contact at the end of a step: tractions, slips, and the lines of its certificate."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.analysis.beyond_sides import Shown
from abut.analysis.statistics import cross
from abut.contact.friction_bound import FrictionBound
from abut.contact.geometry import by_kind, function_count, nodal_normals
from abut.contact.nodal_recovery import facet_node_values
from abut.contact.smooth_friction import slip_of
from abut.contact.turned_functions import by_turn, spread
from abut.problem.pair import Pair
from abut.solution import Check, FrictionResult
from abut.solution.state import CLOSED, OPEN, SLIPPING

CONE = 1e-6  # traction beyond the bound, over the largest pressure
OPPOSED = 1e-6  # power that slip in another direction than the traction's would need, over the largest
STUCK = 1e-6  # slip that sticking points may have left, as a pressure over the largest
NEW = 0.02  # share of the friction that a step has left out
FAINT = 1e-3  # traction over the largest pressure from which down its work is not looked at by itself
WORK = 1e-6  # friction that gives work back, over the largest of one multiplier
PRESSED = 1e-6  # bound over the largest, or pressure over that of the run, below which no share of the bound is told
Vector = NDArray[np.float64]


def traction_values(pair: Pair, multipliers: Vector) -> Vector:
    """Tangential traction on the contactor as facet-wise coefficients, (9 n_facets, dim)."""
    return spread(pair.contactor, pair.space.node, pair.space.transfer, pair.tangential_traction(multipliers))


def friction_result(
    pair: Pair,
    recovery: Shown,
    multipliers: Vector,
    status: NDArray[np.int8],
    slips: Vector,
    limit: FrictionBound | None,
    earlier: FrictionResult | None = None,
    reference: float = 0.0,
) -> FrictionResult | None:
    """recovery: of the pair's pressure. multipliers, status: (n,) of the pair; slips: (n, 4), as in the history; limit:
    at the end of the step; earlier: of the step before, None in the
    first; reference: the largest pressure of the steps before; None without friction."""
    if limit is None:
        return None
    weight, states = pair.space.weight, status[pair.normal]
    area = weight if pair.slip is None or pair.slip.area is None else pair.slip.area
    traction, slip = pair.tangential_traction(multipliers), pair.tangential_traction(slips[:, 0])
    values = traction_values(pair, multipliers)
    size, bound = np.linalg.norm(traction, axis=1), _bound(limit, multipliers[pair.normal], states)
    most = _limit_at_nodes(pair, recovery, bound)
    taken = np.where(states != OPEN, -np.einsum("kd,kd->k", traction, slip), 0.0)
    work, each = float(area @ taken), _of_facets(pair, pair.space.plain @ taken[:, None])[..., 0]
    return FrictionResult(
        coefficient=float(limit.coefficients(np.maximum(multipliers[pair.normal], 0.0)).max(initial=0.0)),
        traction=_within(_along(pair, recovery, values), most),
        traction_limit=most,
        slip=_at_nodes(pair, slip),
        total_slip=_at_nodes(pair, pair.tangential_traction(slips[:, 1])),
        status=_status_at_nodes(pair, states),
        sticking_area=float(weight[states == CLOSED] @ recovery.loaded[states == CLOSED]),
        slipping_area=float(weight[states == SLIPPING] @ recovery.loaded[states == SLIPPING]),
        work=work,
        total_work=work + (0.0 if earlier is None else earlier.total_work),
        work_per_area=each,
        total_work_per_area=each + (0.0 if earlier is None else earlier.total_work_per_area),
        force=_on_contactor(pair, tangential_forces(pair, multipliers), _on_target(pair, multipliers)).sum(axis=0),
        force_by_area=float(weight @ size),
        force_limit=float(weight @ bound),
        largest_share=_largest_share(size, np.where(multipliers[pair.normal] > PRESSED * reference, bound, 0.0)),
    )


def _bound(limit: FrictionBound, pressure: Vector, status: NDArray[np.int8]) -> Vector:
    """The largest traction that each function can carry, (n_functions,); rough ones any while they are in contact."""
    if limit.rough:
        return np.where(status != OPEN, np.inf, 0.0)
    return limit.at(np.maximum(pressure, 0.0))[0]


def _limit_at_nodes(pair: Pair, recovery: Shown, bound: Vector) -> Vector:
    """The bound (n_functions,) at the facets' nodes, recovered as the traction is, (n_facets, 9)."""
    rough = bool(np.isinf(bound).any())
    shown = recovery.field(pair.space.transfer @ np.where(np.isfinite(bound), bound, 1.0))
    return np.where(shown > 0.0, np.inf, shown) if rough else np.maximum(shown, 0.0)


def _along(pair: Pair, recovery: Shown, values: Vector) -> Vector:
    """Tractions (9 n_facets, dim) at the facets' nodes, (n_facets, 9, dim), along the surface there: components that are
    recovered one by one leave it by a little where it is curved."""
    traction = recovery.vectors(values)
    if not recovery.fits:
        return traction
    normal = nodal_normals(pair.contactor)
    return np.asarray(traction - np.einsum("fkd,fkd->fk", traction, normal)[..., None] * normal)


def _within(traction: Vector, most: Vector) -> Vector:
    """Tractions (n_facets, 9, dim) no larger than a bound (n_facets, 9): where stick and slip meet, values that are
    recovered one by one may be by a little."""
    size = np.linalg.norm(traction, axis=-1)
    over = size > most
    return np.asarray(traction * np.where(over, most / np.where(over, size, 1.0), 1.0)[..., None])


def _largest_share(size: Vector, bound: Vector) -> float:
    """Of the bound, where it is more than rounding."""
    some = np.isfinite(bound) & (bound > PRESSED * bound[np.isfinite(bound)].max(initial=0.0))
    return float((size[some] / bound[some]).max()) if some.any() else float("nan")


def tangential_forces(pair: Pair, multipliers: Vector) -> Vector:
    """Nodal forces of friction alone on all points, (n_points, dim)."""
    forces = pair.rows[pair.tangential].T @ multipliers[pair.tangential]
    return np.asarray(forces).reshape(-1, pair.contactor.dim)


def _at_nodes(pair: Pair, values: Vector) -> Vector:
    """Vectors (n_functions, dim) at the facets' nodes, (n_facets, 9, dim), NaN where padded."""
    return _of_facets(pair, spread(pair.contactor, pair.space.node, pair.space.plain, values))


def _of_facets(pair: Pair, at_rows: Vector) -> Vector:
    """Facet-wise coefficients (9 n_facets, c) at the facets' nodes, (n_facets, 9, c)."""
    degree = pair.coupling.degree
    return np.stack([facet_node_values(pair.contactor, degree, component) for component in at_rows.T], axis=-1)


def _status_at_nodes(pair: Pair, status: NDArray[np.int8]) -> NDArray[np.int32]:
    """Status (n_functions,) at the facets' nodes, (n_facets, 9), 0 where padded; a node that has no function of its own, as
    in the middle of an edge, has the highest of the facet."""
    uses = pair.space.plain.copy()
    uses.data = np.ones_like(uses.data)
    rows = uses.multiply(status[None, :].astype(float)).tocsr().max(axis=1).toarray().reshape(-1, 9)
    result = np.where(pair.contactor.nodes >= 0, rows.max(axis=1, keepdims=True), 0.0)
    for kind, facets in by_kind(pair.contactor):
        n = function_count(kind, pair.coupling.degree)
        result[facets, :n] = rows[facets, :n]
    return result.astype(np.int32)


def friction_forces(pair: Pair, multipliers: Vector) -> tuple[Vector, Vector]:
    """Nodal forces of pressure and friction on all points, on the contactor's side and on the target's, (n_points, dim)."""
    force = np.asarray(pair.rows.T @ multipliers).reshape(-1, pair.contactor.dim)
    pressed = pair.coupling.target_part.T @ (pair.space.transfer @ multipliers[pair.normal])
    mine = _on_contactor(pair, force, _on_target(pair, multipliers) - pressed)
    return mine, force - mine


def touches_itself(pair: Pair) -> bool:
    """Whether points of the contactor are the target's, too."""
    both = pair.contactor.node_ids, pair.target.node_ids
    return pair.contactor.kin is not None and len(np.intersect1d(*both)) > 0


def _on_contactor(pair: Pair, force: Vector, on_target: Vector) -> Vector:
    """What of nodal forces (n_points, dim) acts on the contactor: all of its nodes', or, of a body that touches itself, what
    is not ``on_target`` (dim n_points,)."""
    if touches_itself(pair):
        return np.asarray(force - on_target.reshape(force.shape))
    mine = np.zeros((len(force), 1), dtype=bool)
    mine[pair.contactor.node_ids] = True
    return np.where(mine, force, 0.0)


def _on_target(pair: Pair, multipliers: Vector) -> Vector:
    """Nodal forces of tractions on the target (dim n_points,), of a body that touches itself; else zero."""
    if not touches_itself(pair):
        return np.zeros(pair.rows.shape[1])
    assert pair.slip is not None
    flat = pair.contactor.dim == 2
    along = (
        [pair.components[1].transfer @ multipliers[pair.tangential]] if flat else traction_values(pair, multipliers).T
    )
    parts = zip(pair.slip.operators.along, along, strict=True)
    return np.asarray(sum(operator.T @ values for operator, values in parts))


def _creep(pair: Pair, size: Vector, bound: Vector) -> Vector:
    """Slip (n_functions,) that the constraint function leaves to points that stick under tractions of that size, twice over
    for what is left of its residual; none with Coulomb's law itself."""
    if not pair.smooth:
        return np.zeros(len(size))
    epsilon = float(np.sqrt(pair.contact.epsilon))
    return 2.0 * slip_of(size, np.where(np.isfinite(bound), bound, 0.0), epsilon) / pair.stiffness


def friction_balance(pair: Pair, multipliers: Vector) -> tuple[float, float] | None:
    """Relative errors of force and moment between the two sides with pressure and traction; None without friction.

    With small displacements a traction acts across a gap g on one line on the contactor and on another on the target: of
    the moments, this couple g N x t is left out, theory (R12)."""
    if pair.slip is None:
        return None
    dim, ids = pair.contactor.dim, pair.contactor.node_ids
    force, points = np.asarray(pair.rows.T @ multipliers).reshape(-1, dim), pair.contactor.points
    size = max(0.5 * float(np.abs(force).sum()), 1e-300)
    turn = 0.0
    if not pair.contactor.axisymmetric:
        extent = float(np.ptp(points[ids], axis=0).max())
        moment = cross(points - points[ids].mean(axis=0), force).sum(axis=0)
        turn = float(np.abs(moment - _couple(pair, multipliers)).max()) / (size * extent)
    return float(np.abs(force.sum(axis=0)).max()) / size, turn


def _couple(pair: Pair, multipliers: Vector) -> Vector:
    """Of the tractions across gaps, (3,), in 2D (1,); theory (R12)."""
    assert pair.slip is not None
    dim, arms = pair.contactor.dim, pair.slip.operators.arms
    if arms is None:
        return np.zeros(3 if dim == 3 else 1)
    along = pair.tangential_traction(multipliers)
    if dim == 3:
        parts = by_turn(pair.contactor, pair.space.node, pair.space.transfer)
        return np.asarray(sum(np.cross(part.T @ arms, along @ turn.T).sum(axis=0) for turn, part in parts))
    # turned normals are square to N and of unit length at every point
    size = np.einsum("kd,kd->k", along, pair.slip.tangents[:, 0])[:, None]
    return np.asarray((pair.space.transfer.T @ arms * size).sum(axis=0))


def _left_out(pair: Pair, new: Vector, bound: Vector) -> float:
    """Share of the bound (n_functions,) at functions that carry no friction in the step, since they have no past."""
    along = pair.index[:, 1:]
    none = np.where(along >= 0, new[np.maximum(along, 0)], 0.0).max(axis=1, initial=0.0) > 0.0
    force = bound * pair.space.weight
    return float(force[none].sum() / max(float(force.sum()), 1e-300))


def friction_checks(
    pair: Pair,
    multipliers: Vector,
    status: NDArray[np.int8],
    slips: Vector,
    limit: FrictionBound | None,
    largest: float,
) -> tuple[Check, ...]:
    """What a solution with friction must meet at every multiplier. limit: at the end of the step, None without
    friction; largest: pressure, now or in a step before."""
    if limit is None:
        return ()
    name, states = pair.contact.name, status[pair.normal]
    pressure = np.maximum(multipliers[pair.normal], 0.0)
    traction, slip = pair.tangential_traction(multipliers), pair.tangential_traction(slips[:, 0])
    size, way = np.linalg.norm(traction, axis=1), np.linalg.norm(slip, axis=1)
    bound = _bound(limit, pressure, states)
    largest = max(largest, float(pressure.max(initial=0.0)), 1e-300)
    slips_now, sticks = states == SLIPPING, states == CLOSED
    power = np.einsum("kd,kd->k", traction, slip)
    against = (size * way + power)[slips_now]
    faint = FAINT * largest * float(way[states != OPEN].max(initial=0.0))  # of what is pressed by rounding alone
    most = max(float((size * way).max(initial=0.0)), largest**2 / pair.stiffness * WORK, faint, 1e-300)
    held = sticks & (way * pair.stiffness <= STUCK * largest)  # "sticking" allows for that slip, whichever way it goes
    work = -(power * pair.space.weight)[(states != OPEN) & ~held]
    unit = max(1e-300, float(np.abs(work).max(initial=0.0)), most * float(pair.space.weight.max(initial=1e-300)))
    left_out = _left_out(pair, slips[:, 3], np.where(np.isfinite(bound), bound, pressure))
    values = (
        ("friction cone", max(float((size - bound).max(initial=0.0)), 0.0) / largest, CONE,
         "tangential traction beyond the coefficient times the pressure, over the largest pressure"),
        ("slip direction", float(against.max(initial=0.0)) / most, OPPOSED,
         "power that is missing because slip is not opposite to the traction, over the largest"),
        ("sticking", float((way - _creep(pair, size, bound))[sticks].max(initial=0.0)) * pair.stiffness / largest, STUCK,
         "slip of sticking points in the step, as a pressure over the largest pressure"),
        ("friction work", max(0.0, -float(work.min(initial=0.0))) / unit, WORK,
         "work that friction gives back at a point in the step, over the largest that it takes"),
        ("friction left out", left_out, NEW,
         "share of what friction can carry where none counts in the step, as the target was not opposite before"),
    )  # fmt: skip
    return tuple(Check(name, *line, pressure=largest) for line in (values if left_out else values[:-1]))
