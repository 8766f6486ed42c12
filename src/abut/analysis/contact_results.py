"""What a user reads of one contact pair at the end of a step."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from abut.analysis.beyond_sides import Beyond, Shown, facet_wise, sides_line
from abut.analysis.certificate import NOTHING, Surroundings, certificate
from abut.analysis.friction import friction_balance, friction_checks, friction_forces, friction_result
from abut.analysis.loaded_area import LOADED, loaded_parts
from abut.analysis.sides import sides_check
from abut.analysis.statistics import (
    forces_on_bodies,
    nodal_forces,
    nodal_parts,
    pressure_statistics,
    resultant,
)
from abut.contact.even_axis import even_at_axis
from abut.contact.friction_bound import FrictionBound
from abut.contact.geometry import full_moments, nodal_normals, side_normals, split_at_creases
from abut.contact.nodal_recovery import (
    ON_AXIS,
    Averages,
    at_facet_nodes,
    averages,
    carry_to_target,
    facet_node_values,
)
from abut.contact.point_values import Places, Recovery, recovered
from abut.contact.pressure_space import WEAK_SUPPORT
from abut.contact.rim import rim
from abut.contact.symmetry_planes import evened
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface
from abut.model import LAWS, METHODS
from abut.problem.pair import Pair
from abut.problem.straight_cells import of_simplices
from abut.solution import Check, ContactResult, PressureStatistics, Resultant
from abut.solution.state import OPEN


@dataclass(frozen=True)
class PairState:
    """A pair with its multipliers, their status, and the slips (n, 4) of those of friction, as in its history; limit:
    of the tangential traction, None without friction; pressure, weight int H_k, weighted gap and contact of the multipliers
    that are pressures (of a tie: all); contactor: where it is now, which that of a tie's pair is not; mended: (9 n_facets,)
    facet-wise coefficients of the pressure that is shown in place of the multipliers', of the same force, theory (Z12);
    exact: (n_facets,) facets of first order on which its nodal forces are those of bodies, None for none."""

    pair: Pair
    multipliers: NDArray[np.float64]
    status: NDArray[np.int8]
    slips: NDArray[np.float64]
    limit: FrictionBound | None
    pressure: NDArray[np.float64]
    weight: NDArray[np.float64]
    gap: NDArray[np.float64]
    closed: NDArray[np.bool_]
    contactor: Surface
    mended: NDArray[np.float64] | None = None
    exact: NDArray[np.bool_] | None = None

    @classmethod
    def of(
        cls,
        pair: Pair,
        multipliers: NDArray[np.float64],
        gap: NDArray[np.float64],
        status: NDArray[np.int8],
        slips: NDArray[np.float64] | None,
        factors: NDArray[np.float64],
        contactor: Surface,
    ) -> PairState:
        """Of all its multipliers, each (n,); slips: None where nothing has slipped yet; factors: of the model's
        histories; contactor: where it is now."""
        every = slice(None) if pair.tied else pair.normal
        slips = np.zeros((len(pair), 4)) if slips is None else slips
        pressure, weight, gap = (values[every] for values in (multipliers, pair.weight, gap))
        limit = pair.friction(factors) if pair.frictional else None
        return cls(pair, multipliers, status, slips, limit, pressure, weight, gap, status[every] != OPEN, contactor)

    def showing(self, mesh: Mesh, pressure: NDArray[np.float64] | None) -> PairState:
        """The same that shows a ``mended`` pressure; None: its own."""
        return self if pressure is None else replace(self, mended=pressure, exact=of_simplices(mesh, self.contactor))

    @cached_property
    def values(self) -> NDArray[np.float64]:
        """Facet-wise coefficients of the pressure, (9 n_facets,), or of a tie's traction, (9 n_facets, dim)."""
        pair = self.pair
        return pair.traction(self.pressure) if pair.tied else np.asarray(pair.space.transfer @ self.pressure)

    @cached_property
    def normal(self) -> NDArray[np.float64]:
        """The same of the pressure, compression positive, (9 n_facets,)."""
        return _compression(self.contactor, self.values) if self.pair.tied else self.values

    @property
    def gaps(self) -> NDArray[np.float64]:
        """The same of the gap, a length; ties have none."""
        if self.pair.tied:
            return np.zeros_like(self.normal)
        return np.asarray(self.pair.space.plain @ (self.gap / self.weight))

    @property
    def penetration(self) -> float:
        """The largest, a length."""
        return 0.0 if self.pair.tied else max(float((-self.gap / self.weight).max(initial=0.0)), 0.0)

    @property
    def forces(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Nodal forces on all points, on the contactor's side and on the target's, (n_points, dim)."""
        if self.pair.frictional:
            return friction_forces(self.pair, self.multipliers)
        return nodal_forces(self.pair.coupling, self.values, self.pair.contactor.dim)

    def loaded(self, at: Averages | None) -> NDArray[np.float64]:
        """How much of each function's area is loaded, (n_functions,), see ``loaded_parts``; ties: where they press."""
        if self.pair.tied:
            return np.ones(len(self.pressure))
        shown = self.normal if self.mended is None else self.mended
        return loaded_parts(self.pair, at, self.pressure, self.closed, shown)


EDGE = 0.05  # share of the force that functions with hardly any support may carry
LITTLE = 0.8 * WEAK_SUPPORT  # the iterations that end a step may move the edge a little
SOFTENED, SOFTENED_NOTICED = 0.3, 0.02  # gap of a softened law over the indentation: a Hertz peak loses half of that
IN_PLANE = 0.7  # of the way out of an edge along a plane's normal: nearer than 45 degrees, it ends in that plane
FAINT = 1e-3  # pressure over the largest of all contacts from which down the laws of friction are rounding of those


def contact_result(
    mesh: Mesh, state: PairState, residual: float, around: Surroundings, earlier: ContactResult | None = None
) -> ContactResult:
    """residual: of the contact law; earlier: of the step before, None in the first."""
    pair, coupling, degree = state.pair, state.pair.coupling, state.pair.coupling.degree
    forces, others = state.forces
    ids, target_ids = pair.contactor.node_ids, pair.target.node_ids
    covered = coupling.segments > 0
    at = averages(pair.contactor, coupling, state.exact) if pair.contact.method == METHODS[0] else None
    raw = facet_node_values(pair.contactor, degree, state.normal)
    loaded = state.loaded(at)
    shown = None if at is None else reported(state, at, loaded)
    nodal = raw if shown is None else shown.nodal
    share = np.where(np.isnan(raw), np.nan, 1.0) if at is None else at_facet_nodes(at.surface, at.share)
    statistics, amount = _statistics(
        mesh, state, at, nodal, share, loaded, NOTHING * max(around.reference, around.beside)
    )
    before = None if earlier is None else earlier.friction
    carried = carry_to_target(pair.contactor, pair.target, coupling.target_part, nodal)
    average = None if shown is None else shown.average
    second = (pair.contactor, forces[ids]) if pair.contact.turned else (pair.target, others[target_ids])
    result = ContactResult(
        name=pair.contact.name,
        named=pair.contact.named,
        contactor=_undeformed(mesh, pair.contactor),
        target=_undeformed(mesh, pair.target),
        force=amount.force,
        max_pressure=statistics.largest,
        area=float((0.0 if pair.away else coupling.covered.sum()) if pair.tied else state.weight @ loaded),
        max_penetration=state.penetration,
        active=int(state.closed.sum()),
        multipliers=len(state.pressure),
        removed=pair.space.removed,
        segments=int(coupling.segments.sum()),
        pressure=nodal,
        multiplier=raw,
        share=share,
        gap=np.where(covered[:, None], facet_node_values(pair.contactor, degree, state.gaps), np.nan),
        covered=covered,
        covered_share=float(coupling.covered.sum() / full_moments(pair.contactor, 0)[:, 0].sum()),
        target_pressure=carried,
        checks=(
            *_checks(state, residual, around, nodal, share, average),
            *sides_line(pair, state.values, around.at_sides),
            *sides_check(pair, around.sides, nodal, carried, NOTHING * max(around.reference, around.beside)),
        ),
        statistics=statistics,
        resultant=amount,
        contactor_forces=forces[ids],
        target_forces=others[target_ids],
        body_forces=forces_on_bodies(*second, mesh.bodies),
        friction=None
        if shown is None
        else friction_result(
            pair, shown, state.multipliers, state.status, state.slips, state.limit, before, around.reference
        ),
    )
    return _on_second(result) if pair.contact.turned else result


def _on_second(result: ContactResult) -> ContactResult:
    """The same where the contactor is the side that is named second: resultants are those on the one named first."""
    of_all, friction = result.resultant, result.friction
    return replace(
        result,
        force=-result.force,
        resultant=replace(of_all, force=-of_all.force, moment=-of_all.moment),
        friction=friction if friction is None else replace(friction, force=-friction.force),
    )


def _checks(
    state: PairState,
    residual: float,
    around: Surroundings,
    nodal: NDArray[np.float64],
    share: NDArray[np.float64],
    average: NDArray[np.float64] | None,
) -> tuple[Check, ...]:
    around = replace(around, average=average)
    pair, balanced = state.pair, friction_balance(state.pair, state.multipliers)
    largest = max(around.reference, FAINT * around.beside)
    return (
        *certificate(pair, state.values, nodal, state.penetration, residual, share, around, balanced),
        *friction_checks(pair, state.multipliers, state.status, state.slips, state.limit, largest),
        *(() if around.support is None else _edge_check(state, around.support)),
        *_softening(state),
    )


def _edge_check(state: PairState, support: NDArray[np.float64]) -> Iterator[Check]:
    """How much is carried by functions that have hardly any target opposite and no neighbour to follow. support:
    (n_functions,) int H_k over all of the contactor."""
    pair = state.pair
    force = np.maximum(state.pressure, 0.0) * pair.space.weight
    weak = pair.space.weight < LITTLE * support
    if force[weak].any():
        text = f"share of the force at nodes less than {LITTLE:.0%} of whose facets has a target opposite"
        yield Check(
            pair.contact.name, "force at the target's edge", float(force[weak].sum() / force.sum()), EDGE, text,
            pressure=float(state.pressure[~weak].max(initial=0.0)),
        )  # fmt: skip


def _softening(state: PairState) -> Iterator[Check]:
    """How far a softened law keeps the sides apart where they press, beside what they press in over the extent of contact:
    theory (L15). A line from what is worth knowing on."""
    pair = state.pair
    force = np.maximum(state.pressure, 0.0) * state.weight
    largest = float(state.pressure.max(initial=0.0))
    if pair.contact.law != LAWS[1] or pair.tied or not largest > 0.0 or pair.compliance == 0.0:
        return
    apart = float(force @ np.maximum(state.gap / state.weight, 0.0)) / float(force.sum())
    loaded = pair.space.node[(state.pressure > LOADED * largest) & (pair.space.node >= 0)]
    x = pair.contactor.points[loaded] if len(loaded) else pair.contactor.points[pair.contactor.node_ids]
    extent = max(float(np.ptp(x, axis=0).max()), pair.size)
    value = apart / (pair.compliance * largest * extent)
    if value > SOFTENED_NOTICED:
        text = "gap that the softened law leaves under pressure, over what that presses in: it is lower by half of that"
        yield Check(pair.contact.name, "softening", value, SOFTENED, text, pressure=largest, notice=SOFTENED_NOTICED)


def _undeformed(mesh: Mesh, surface: Surface) -> Surface:
    """The surface where it was at the outset, as results show it."""
    return surface if surface.points is mesh.points else replace(surface, points=mesh.points)


def _statistics(
    mesh: Mesh,
    state: PairState,
    at: Averages | None,
    nodal: NDArray[np.float64],
    share: NDArray[np.float64],
    loaded: NDArray[np.float64],
    nothing: float,
) -> tuple[PressureStatistics, Resultant]:
    """nodal, share: (n_facets, 9) reported pressure and covered share; loaded: (n_functions,) how much of each function's
    area is; nothing: pressure that is left after unloading."""
    pair, normal = state.pair, state.normal
    where = (normal > LOADED * normal.max(initial=0.0)).astype(float) if pair.tied else pair.space.plain @ loaded
    load, area = (nodal_parts(pair.coupling, at, field) for field in (normal, np.asarray(where)))
    forces, _ = state.forces
    ids, none = pair.contactor.node_ids, bool(np.abs(state.values).max(initial=0.0) <= nothing)
    return (
        pressure_statistics(state.contactor, nodal, load, area, share, nothing),
        resultant(state.contactor.points[ids], forces[ids], mesh.axisymmetric, none),
    )


def reported(state: PairState, at: Averages, loaded: NDArray[np.float64]) -> Shown:
    """The pressure at points and at the facets' nodes, with what is beyond the sides of a sector."""
    beyond = Beyond.of(state.pair)
    if beyond is None:
        return Shown(_recovered(state, at), None, at.surface, loaded)
    field = facet_wise(beyond.more, state.normal if state.mended is None else state.mended)
    every = averages(beyond.pair.contactor, beyond.pair.coupling, at.exact[beyond.more.source])
    return Shown(_recovered(replace(state, pair=beyond.pair, mended=field), every), beyond.more, beyond.own, loaded)


def _recovered(state: PairState, at: Averages) -> Recovery:
    """The pressure at points and at the facets' nodes: from averages of facet-wise coefficients, theory (P10), values at
    points, theory (P18); of cells of first order averages, sharpened where ordinary continuous functions are in contact all
    over, theory (P12), else with those on planes of symmetry mended, theory (P14); but for facets that are ``exact``."""
    pair, average = state.pair, even_at_axis(at, at.of(state.normal if state.mended is None else state.mended))
    plain, smooth = average, pair.tied or bool(state.closed.all() and pair.space.continuous and pair.space.ordinary)
    if smooth and not at.exact.all():
        sharp = at.sharpened(average, at.surface.points, _places(pair, at.surface, True).along)
        plain, smooth = (sharp, True) if pair.two_way or sharp.min() >= 0.0 else (average, False)
    if pair.planes is not None:
        planes = replace(pair.planes, uneven=pair.planes.uneven & ~at.exact)
        plain = evened(pair.contactor, at, plain, planes, smooth)
    places = _places(pair, at.surface, smooth)
    return recovered(at, average, plain, places, pair.two_way)


def _places(pair: Pair, split: Surface, smooth: bool) -> Places:
    """split: the contactor, split at its creases; smooth: closed all over."""
    _, normals = side_normals(pair.contactor)
    owner, n = split_at_creases(pair.contactor)[1], len(split.points)
    edges, (border, ends) = rim(split), np.zeros((2, n), dtype=bool)
    across = np.zeros((n, 2, split.dim))
    if pair.planes is not None:
        across = pair.planes.across[owner]
    if split.axisymmetric:
        last = np.unique(edges.ends)
        axis = last[split.points[last, 0] <= ON_AXIS * split.points[split.node_ids, 0].max()]
        across[axis, 0] = (1.0, 0.0)
    for normal in np.moveaxis(across, 1, 0):  # a surface that goes on beyond a plane is square to it
        normals = normals - (normals * normal).sum(axis=1, keepdims=True) * normal
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    out = edges.out / np.linalg.norm(edges.out, axis=1, keepdims=True)
    beyond = np.abs(np.einsum("mepa,ma->mep", across[edges.ends], out)).max(axis=2).min(axis=1) > IN_PLANE
    border[edges.ends[~beyond]] = True
    if not smooth:
        outer = slice(None) if pair.interior is None else ~pair.interior
        nodes = split.nodes[outer]
        ends[nodes[nodes >= 0]] = True
    return Places(normals, across, border, ends & border)


def _compression(contactor: Surface, traction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Normal part of the tie traction, facet-wise coefficients, compression positive."""
    normals = nodal_normals(contactor).reshape(traction.shape)
    return np.asarray(-np.einsum("ka,ka->k", normals, traction))
