"""Contact at current positions, for large sliding: gaps, slips and forces of a pair with their exact derivatives."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.block_rows import added_up, block_rows, in_place, weights_of_rows
from abut.contact.coupling import Coupling, CouplingOptions, couple
from abut.contact.coupling_tangent import ContactLoad, CouplingTangent, Differentiate, differentiated
from abut.contact.geometry import Smoothing, facet_sizes, full_moments, smoothing
from abut.contact.moving_normals import MovingNormals, NormalPattern, normal_pattern
from abut.mesh.surface import Surface
from abut.problem.adjusted import BARELY, with_adjusted
from abut.problem.contact_pairs import Pair
from abut.problem.dual_functions import Mixed, Mixture, inner_now, mixed_part
from abut.problem.edge_functions import Following, led
from abut.problem.rubbing import Rubbing, Tangents, rub_in_plane, rub_in_space
from abut.problem.slip_points import SlipPoints, slip_now
from abut.problem.tangent_frames import Frames, anchors, tangents_2d
from abut.types import Sparse

Array = NDArray[np.float64]
KNOWN = 0.05  # share of a function that the last step must have covered, for its slip to count
NEAR = 2.0  # facets between the surfaces up to which they are paired, beside what they have moved in the step
GIVING = 8.0  # the same where a law of one's own lets them into each other


@dataclass(frozen=True)
class ContactNow:
    """A pair at a state. pair: with surfaces, rows (of the forces) and weights as they are now; gap: (n,) weighted gaps and
    slips; by_position: (n, dim n_points) their derivative; bending: (dim n_points, dim n_points) derivative of the contact
    forces; without_history: (n_functions,) whose slip does not count."""

    pair: Pair
    gap: Array
    by_position: Sparse
    bending: Sparse
    without_history: NDArray[np.bool_]


@dataclass(frozen=True)
class Place:
    """Where a pair is. displacement, before: (dim n_points,) now and at the end of the last step; points: of that step,
    None without friction; offset: what is added to all gaps now; inner: (n_facets,) not zero where functions of a dual
    space are the ordinary ones in this step, None for nowhere; following: (n_functions,) which one each follows in this
    step, None for itself."""

    displacement: Array
    before: Array
    points: SlipPoints | None
    offset: float
    inner: Array | None = None
    following: Array | None = None


@dataclass(frozen=True)
class Current:
    """A pair, not tied, whose surfaces are looked at where they are. pair: as from ``whole_pair``; differentiate: what cuts
    and integrates, here or on several processes; adjusted: as from ``taken_off``, None for nothing."""

    pair: Pair
    differentiate: Differentiate = differentiated
    adjusted: Array | None = None

    def at(self, place: Place, multipliers: Array) -> ContactNow:
        """Gaps, forces and derivatives with multipliers (n,). As in theory (G1), (G2)."""
        contactor, target = self.surfaces(place.displacement)
        options = self._options(place.displacement - place.before)
        mixture = self._mixture(contactor, target, options, place.inner)
        unmixed = self.pair if place.following is None else led(self.pair, place.following.astype(np.int64))
        pair = unmixed if mixture is None else mixed_part(unmixed, mixture)
        down = weights_of_rows(pair.space.transfer.T)
        normals = self._normals.at(contactor)
        tangents = self._tangents(contactor, normals, multipliers)
        load = _load(pair, multipliers, tangents)
        by = self.differentiate(contactor, target, pair.coupling.degree, options, load, normals)
        points, dim = len(contactor.points), contactor.dim
        operators = added_up(down, by.operators, points)
        along = operators[0]
        mixed = None if mixture is None else Mixed.of(mixture.change(contactor, by.weight), by, unmixed)
        weight = np.asarray(down @ by.weight_value)
        gap, by_position = self._gaps(down, by, mixed, place.offset)
        bending = by.force_tangent.tocsr()
        now = ContactNow(
            replace(
                pair, contactor=contactor, target=target, space=replace(pair.space, weight=weight),
                rows=block_rows(in_place(along[..., :dim], operators), points).tocsr(),
            ),
            gap, by_position, bending if mixed is None else bending + mixed.pressed(multipliers[pair.normal]),
            np.zeros(len(pair.space), dtype=bool),
        )  # fmt: skip
        if not pair.frictional:
            return now
        assert place.points is not None
        slip = slip_now(place.points, contactor, target, normals)
        if tangents is None:
            turned = tangents_2d(normals, *self._anchors)
            part = weights_of_rows(pair.components[1].transfer.T)
            made = rub_in_plane(part, by, added_up(part, by.operators, points), slip)
            if mixed is not None:
                made = mixed.rubbed_in_plane(made, slip, multipliers[pair.tangential])
        else:
            square = in_place(along[..., dim:].reshape(-1, dim, dim), operators)
            turned, made = tangents.now.tangents, rub_in_space(down, by, square, slip, tangents, contactor)
            if mixed is not None:
                made = mixed.rubbed_in_space(made, slip, tangents)
        covered = pair.space.plain.T @ place.points.moments(len(contactor))
        return _with(now, made, turned, covered < KNOWN * pair.weight[pair.normal])

    def _gaps(self, down: Sparse, by: CouplingTangent, mixed: Mixed | None, offset: float) -> tuple[Array, Sparse]:
        """Weighted gaps (n_functions,) with their derivative, theory (G2), (G15); where the law looks at the mean gap, as if
        the whole function was covered, theory (G16)."""

        def moment(shares: Array) -> tuple[Array, Sparse]:
            value = shares[0] * by.gap_value + shares[1] * by.weight_value
            slope = (down @ by.slope(shares)).tocsr()
            return np.asarray(down @ value), slope if mixed is None else slope + mixed.moment(value)

        means = self.pair.smooth
        if self.adjusted is None and not means:
            return moment(np.array([1.0, offset]))
        (gap, by_gap), (weight, by_weight) = moment(np.array([1.0, 0.0])), moment(np.array([0.0, 1.0]))
        added = np.full(len(gap), offset) if self.adjusted is None else offset + self.adjusted
        if not means:
            return gap + added * weight, (by_gap + sp.diags(added) @ by_weight).tocsr()
        whole = self.pair.weight[self.pair.normal]
        seen = weight >= BARELY * whole
        share = np.where(seen, whole / np.where(seen, weight, 1.0), 0.0)
        mean = np.where(seen, gap / np.where(seen, weight, 1.0), 0.0)
        return whole * (mean + added), (sp.diags(share) @ (by_gap - sp.diags(mean) @ by_weight)).tocsr()

    def surfaces(self, displacement: Array) -> tuple[Surface, Surface]:
        """Contactor and target at a displacement (dim n_points,)."""
        points = np.ascontiguousarray(self.pair.contactor.points + displacement.reshape(-1, self.pair.contactor.dim))
        return replace(self.pair.contactor, points=points), replace(self.pair.target, points=points)

    def points(self, displacement: Array) -> SlipPoints:
        """The integration points at a displacement, from which the next step's slip counts."""
        options = self._options(np.zeros_like(displacement))
        return SlipPoints.of(*self.surfaces(displacement), self.pair.coupling.degree, options, self._across)

    def shown(self, displacement: Array, points: bool = False) -> Coupling:
        """With what results ask for beside it, the gaps at samples adjusted; points: integration points, too."""
        options = replace(self._options(np.zeros_like(displacement)), keep_gap_samples=True, keep_points=points)
        contactor, target = self.surfaces(displacement)
        seen = couple(contactor, target, self.pair.coupling.degree, options, across=self._across)
        if self.adjusted is None:
            return seen
        return replace(seen, gap_samples=with_adjusted(self.pair.space, contactor, seen, self.adjusted))

    def inner(self, displacement: Array, closed: NDArray[np.bool_]) -> Array:
        """Where the functions of "dual-P1" are the ordinary ones, (n_facets,) 1 or 0, with multipliers (n,) closed there."""
        contactor, target = self.surfaces(displacement)
        options = self._options(np.zeros_like(displacement))
        share = couple(contactor, target, 0, options, across=self._across).covered / full_moments(contactor, 0)[:, 0]
        return inner_now(self.pair.space, contactor, target, share, closed[self.pair.normal], NEAR * self._facet)

    def following(self, displacement: Array, closed: NDArray[np.bool_]) -> Following:
        """Which functions follow others where the pair is now, with multipliers (n,) closed."""
        contactor, target = self.surfaces(displacement)
        options = self._options(np.zeros_like(displacement))
        covered = couple(contactor, target, self.pair.coupling.degree, options, across=self._across)
        return Following.of(self.pair.space, contactor, covered, closed[self.pair.normal])

    def _mixture(
        self, contactor: Surface, target: Surface, options: CouplingOptions, inner: Array | None
    ) -> Mixture | None:
        """None where no function is a dual one."""
        if self.pair.space.ordinary:
            return None
        covered = couple(contactor, target, self.pair.coupling.degree, options, across=self._across)
        return Mixture.of(contactor, covered, inner)

    def _options(self, moved: Array) -> CouplingOptions:
        rule = self.pair.contact.integration
        nodes = self._nodes
        way = np.linalg.norm(moved.reshape(-1, self.pair.contactor.dim)[nodes], axis=1).max(initial=0.0)
        near = NEAR if isinstance(self.pair.contact.law, str) else GIVING
        return CouplingOptions(rule.rule, rule.points, reach=near * self._facet + 2.0 * float(way))

    @cached_property
    def _across(self) -> Smoothing:
        """Creases are those of the undeformed contactor: forces do not jump when an angle grows."""
        return smoothing(self.pair.contactor)

    @cached_property
    def _nodes(self) -> NDArray[np.int64]:
        return np.union1d(self.pair.contactor.node_ids, self.pair.target.node_ids)

    @cached_property
    def _facet(self) -> float:
        return float(max(facet_sizes(self.pair.contactor).max(), facet_sizes(self.pair.target).max()))

    @cached_property
    def _anchors(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        return anchors(self.pair.contactor, self.pair.space)

    @cached_property
    def _frames(self) -> Frames:
        assert self.pair.slip is not None
        return Frames.of(self.pair.contactor, self.pair.space, self.pair.slip.tangents)

    @cached_property
    def _normals(self) -> NormalPattern:
        return normal_pattern(self.pair.contactor, self._across)

    @cached_property
    def _kept(self) -> NDArray[np.int64]:
        """Of two tractions a function, in 3D, those that have multipliers."""
        return np.concatenate([2 * np.flatnonzero(self.pair.index[:, 1 + b] >= 0) + b for b in range(2)])

    def _tangents(self, contactor: Surface, normals: MovingNormals, multipliers: Array) -> Tangents | None:
        """With their tractions; None in 2D, and without friction."""
        if contactor.dim == 2 or not self.pair.frictional:
            return None
        index = self.pair.index[:, 1:]
        along = np.where(index >= 0, multipliers[np.maximum(index, 0)], 0.0)
        return Tangents(self._frames, self._frames.at(contactor, normals), along, self._kept)


def _load(pair: Pair, multipliers: Array, tangents: Tangents | None) -> ContactLoad:
    pressure = pair.space.transfer @ multipliers[pair.normal]
    if tangents is not None:
        return ContactLoad(pressure, traction=pair.space.transfer @ tangents.traction)
    if pair.frictional:
        return ContactLoad(pressure, turned=pair.components[1].transfer @ multipliers[pair.tangential])
    return ContactLoad(pressure)


def _with(now: ContactNow, made: Rubbing, tangents: Array, without_history: NDArray[np.bool_]) -> ContactNow:
    """The same with friction; tangents: (n_functions, dim - 1, dim)."""
    assert now.pair.slip is not None
    return ContactNow(
        replace(
            now.pair,
            rows=sp.vstack([now.pair.rows, made.rows], format="csr"),
            slip=replace(now.pair.slip, tangents=tangents),
        ),
        np.concatenate([now.gap, made.slip]),
        sp.vstack([now.by_position, made.by_position], format="csr"),
        now.bending if made.bending is None else (now.bending + made.bending.tocsr()),
        without_history,
    )
