"""Contact at current positions, for large sliding: gaps, slips and forces of a pair with their exact derivatives."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.cells import MAX_FACET_NODES
from abut.contact.block_rows import added_up, block_rows, in_place, weights_of_rows
from abut.contact.corners import at_corners, edge_on
from abut.contact.coupling import Coupling, CouplingOptions, couple, surface_degree
from abut.contact.coupling_tangent import CouplingTangent, Differentiate, differentiated
from abut.contact.flush_edges import FlushEdges
from abut.contact.geometry import Smoothing, facet_sizes, full_moments, nodal_normals
from abut.contact.moving_normals import MovingNormals, NormalPattern, normal_pattern
from abut.contact.pressure_space import DUAL_P1, PressureSpace
from abut.contact.rim import Rim, goes_on, rim
from abut.contact.slip_points import Past, SlipPoints
from abut.mesh.surface import Surface
from abut.problem.adjusted_gaps import BARELY, with_adjusted
from abut.problem.current_friction import Rubbing, Tangents
from abut.problem.current_slips import Seen, contact_load, either, with_friction
from abut.problem.dual_functions import Mixed, Mixture, dual_share, inner_now, mixed_part
from abut.problem.edge_functions import Following, led
from abut.problem.edge_trials import DUAL, INNER, TRIED, anew, trials
from abut.problem.first_touch import Sides, apart
from abut.problem.frame import PairFrame
from abut.problem.gap_fit import MovedSides, Sight, fit_change
from abut.problem.kinematics import ContactNow, Kinematics, Placed
from abut.problem.pair import TOUCHING, Pair
from abut.problem.sample_gaps import facets_apart
from abut.problem.tangent_frames import Frames, anchors, tangents_2d
from abut.solution.state import ContactHistory
from abut.types import Sparse

Array = NDArray[np.float64]
SAME_FIT = 1e-2  # of their size at closed multipliers: what fits may differ by from those that belong to a state
SAME_PRESSURE = 1e-3  # of the largest: a pressure, as a gap times the stiffness of a facet, up to which they may too
RUBBING = 1e-2  # the same with friction, where states depend on their past anyway
KNOWN = 0.05  # share of a function that the last step's points must cover, for its slip to be looked at there
NEAR = 2.0  # facets between the surfaces up to which they are paired, beside what they have moved in the step
OVERLAP = 1e-6  # facets by which surfaces overlap, beyond rounding
GIVING = 8.0  # the same where a law of one's own lets them into each other


@dataclass(frozen=True)
class Current(Kinematics):
    """A pair, not tied, whose surfaces are looked at where they are. pair: as from ``finite_pair``; differentiate: what cuts
    and integrates, here or on several processes; adjusted: as from ``taken_off``, None for nothing."""

    differentiate: Differentiate = differentiated
    adjusted: Array | None = None

    def frame(self, known: ContactHistory, before: Placed, near: Placed | None) -> PairFrame:
        """What is fixed of the pair during a step, as in ``Kinematics``: functions and fits that belong to ``before``,
        theory (P9), (G15), unless those of the last step serve; functions follow others by where the step ends; points
        for slips that are covered there only."""
        frame = PairFrame(known.past, anew(known.inner), known.following, known.fit)
        frame = self._with_following(self._with_functions(frame, before, self._inner), near or before)
        return frame if near is None else self._with_late(frame, before, near, np.ones_like(near.closed))

    def settled(self, frame: PairFrame, before: Placed, end: Placed) -> PairFrame:
        """The frame that belongs to the end of a step, as in ``Kinematics``."""
        late = self._with_late(self._with_functions(frame, end, self._tried), before, end, end.closed)
        return self._with_following(late, end, settled=True)

    def _with_functions(
        self, frame: PairFrame, now: Placed, functions: Callable[[Array, Placed], Array]
    ) -> PairFrame:  # fmt: skip
        """With the functions that belong there, from those known, and with fits; the same object where they are there
        already, fits nearly."""
        fit = self.fit(now.displacement) if self.fits else None
        known = np.full(len(self.pair.contactor), DUAL) if frame.inner is None else frame.inner
        inner = known if self.pair.space.ordinary else functions(known, now)
        same = np.array_equal(known == INNER, inner == INNER) and self._fitted(frame.fit, fit, now)
        if same and np.array_equal(known, inner):
            return frame
        return replace(frame, inner=inner, fit=frame.fit if same else fit)

    def _inner(self, known: Array, now: Placed) -> Array:
        """With the ordinary functions of "dual-P1" inside what is closed now, both (n_facets,)."""
        if self.pair.space.name != DUAL_P1:
            return known
        inner = self.inner(now.displacement, now.closed)
        return np.where(inner > 0.0, INNER, np.where(known == INNER, DUAL, known))

    def _tried(self, known: Array, end: Placed) -> Array:
        """The same at the end of a step, with those that are tried, or refused, at edges as in ``FlushEdges``."""
        known, closed = self._inner(known, end), end.closed[self.pair.normal]
        contactor, target = self.surfaces(end.displacement)
        border, moving = rim(contactor), self.pair.moving
        beyond = goes_on(contactor, border, target, NEAR * self._facet)
        flush = FlushEdges.of(contactor, border, beyond, None if moving is None else moving.ongoing)
        apart = np.ones(len(contactor), dtype=bool)
        if (known == TRIED).any():
            at = self.shown(end.displacement).gap_samples
            assert at is not None
            apart = facets_apart(at, at.gap + end.offset, len(contactor))
        return trials(self.pair.space, flush, known, closed, apart)

    def _fitted(self, known: Array | None, fit: Array | None, now: Placed) -> bool:
        """Whether a known fit serves where another belongs: of its size and of the largest pressure, at multipliers that
        are closed."""
        pair, touching = self.pair, now.closed[self.pair.normal]
        if fit is None:
            return True
        if known is None or not touching.any():
            return False
        weight, down = pair.weight[pair.normal], pair.space.transfer.T
        change, size = (np.abs(down @ each / weight)[touching].max() for each in (fit - known, fit))
        most = (RUBBING if pair.frictional else SAME_PRESSURE) * now.multipliers[pair.normal].max()
        return bool(change <= SAME_FIT * size or pair.stiffness * change <= most)

    def _with_following(self, frame: PairFrame, near: Placed, settled: bool = False) -> PairFrame:
        """With which functions follow which at the state ``near``; settled: where that matters."""
        now = self.following(near.displacement, near.closed, near.offset)
        known = np.arange(len(now.to)) if frame.following is None else frame.following
        if np.array_equal(now.to, known) or (settled and not now.matters(known, near.closed[self.pair.normal])):
            return frame
        return replace(frame, following=now.to)

    def _with_late(self, frame: PairFrame, before: Placed, near: Placed, asked: NDArray[np.bool_]) -> PairFrame:
        """With points for the multipliers asked for, (n,), that were hardly covered before."""
        if frame.past is None:
            return frame
        past = self.with_late(frame.past, before.displacement, near.displacement, asked)
        return frame if past is frame.past else replace(frame, past=past)

    def touching(self, rest: Placed, frame: PairFrame) -> NDArray[np.bool_]:
        """What is closed at the outset, as in ``Kinematics``."""
        pair, now = self.pair, self.at(frame, rest, rest.displacement)
        seen = ~bare(now.pair)
        if rest.away or pair.two_way:
            return pair.of_functions(seen & (not rest.away))
        weight = (
            pair.weight[pair.normal] if pair.smooth else now.pair.space.weight
        )  # of what the gap is integrated over
        return pair.of_functions((now.gap[pair.normal] <= TOUCHING * pair.size * weight) & seen)

    def at(self, frame: PairFrame, now: Placed, before: Array) -> ContactNow:
        """Gaps, slips and forces at a state, as in ``Kinematics``, theory (G1), (G2)."""
        contactor, target = self.surfaces(now.displacement)
        multipliers, options = now.multipliers, self._options(now.displacement - before)
        mixture = self._mixture(contactor, target, frame.inner)
        unmixed = self.pair if frame.following is None else led(self.pair, frame.following)
        unmixed = replace(unmixed, away=True) if now.away else unmixed
        pair = unmixed if mixture is None else mixed_part(unmixed, mixture)
        down = weights_of_rows(pair.space.transfer.T)
        normals = self._normals.at(contactor)
        tangents = self._tangents(contactor, normals, multipliers)
        load = contact_load(pair, multipliers, tangents)
        by = self.differentiate(contactor, target, pair.coupling.degree, options, load, normals)
        by = by if frame.fit is None else replace(by, gap_value=by.gap_value + frame.fit)
        points, dim = len(contactor.points), contactor.dim
        operators = added_up(down, by.operators, points)
        along = operators[0]
        mixed = None if mixture is None else Mixed.of(mixture.change(contactor, by.weight), by, unmixed)
        weight = np.asarray(down @ by.weight_value)
        gap, by_position = self._gaps(down, by, mixed, now.offset)
        bending = by.force_tangent.tocsr()
        found = ContactNow(
            replace(
                pair, contactor=contactor, target=target, space=replace(pair.space, weight=weight),
                rows=block_rows(in_place(along[..., :dim], operators), points).tocsr(),
            ),
            gap, by_position, bending if mixed is None else bending + mixed.pressed(multipliers[pair.normal]),
            np.zeros(len(pair.space), dtype=bool),
        )  # fmt: skip
        if not pair.frictional:
            return found
        assert frame.past is not None
        seen = Seen(pair, found.pair.contactor, target, normals, tangents, by, down, operators, mixed)
        past = frame.past if frame.following is None else self._led(frame.past, frame.following)
        made, without = self._rubbed(seen, past, multipliers)
        turned = tangents_2d(normals, *self._anchors) if tangents is None else tangents.now.tangents
        return with_friction(found, made, turned, without)

    def _led(self, past: Past, to: NDArray[np.int64]) -> Past:
        """With the slips at which functions close added to those of the functions that they follow."""
        along, n = self.pair.index[:, 1:], len(self.pair.space)
        leader = np.where((to >= 0)[:, None], along[to], -1)
        both = (along >= 0) & (leader >= 0)
        shift = np.zeros_like(past.shift)
        np.add.at(shift, leader[both] - n, past.shift[along[both] - n])
        return replace(past, shift=shift)

    def _rubbed(self, seen: Seen, past: Past, multipliers: Array) -> tuple[Rubbing, NDArray[np.bool_]]:
        """With slips from where they count, and the functions (n_functions,) whose slip does not."""
        made, unknown = seen.rubbed(past.points, multipliers), ~self._covers(past.points, KNOWN)
        shift = past.shift
        if past.late is not None:
            late, other = unknown & self._covers(past.late, BARELY), seen.rubbed(past.late, multipliers)
            unknown &= ~late
            made = either(made, other, self.pair.of_functions(late)[self.pair.tangential])
        return replace(made, slip=made.slip - shift), unknown

    def _covers(self, points: SlipPoints, share: float) -> NDArray[np.bool_]:
        """(n_functions,) of which points cover so much."""
        covered = self.pair.space.plain.T @ points.moments(len(self.pair.contactor))
        return np.asarray(covered >= share * self.pair.weight[self.pair.normal])

    def _gaps(self, down: Sparse, by: CouplingTangent, mixed: Mixed | None, offset: float) -> tuple[Array, Sparse]:
        """Weighted gaps (n_functions,) with their derivative, theory (G2), (G16); where the law looks at the mean gap, as if
        the whole function was covered, theory (G17)."""

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

    @cached_property
    def fits(self) -> bool:
        """Whether gaps are fitted: those of dual functions on quadratic facets, and where facets bulge."""
        pair, quadratic = self.pair, self.pair.space.degree < surface_degree(self.pair.contactor)
        bulges = pair.contactor.bulge is not None or pair.target.bulge is not None
        return (quadratic or bulges) and not pair.space.ordinary

    def fit(self, displacement: Array) -> Array:
        """What the fit adds to int N_k g at a displacement, (9 n_facets,), theory (G15)."""
        contactor, target = self.surfaces(displacement)
        sides = MovedSides(self.pair.contactor, self.pair.target, contactor, target)
        sight = Sight.of(contactor, target, self._options(), self._across)
        share = dual_share(sight.covered(len(contactor)) / full_moments(contactor, 0)[:, 0])
        return fit_change(sides, sight, self._across, share)

    def past(self, displacement: Array, closed: NDArray[np.bool_]) -> Past | None:
        """From where the next step's slip counts, of a converged state with multipliers (n,) closed there; None
        without friction."""
        if not self.pair.frictional:
            return None
        points = self._points(displacement)
        shift = self._apart(points, displacement)
        return Past(
            points, np.where(self.pair.of_functions(closed[self.pair.normal])[self.pair.tangential], 0.0, shift)
        )

    def with_late(self, past: Past, before: Array, now: Array, asked: NDArray[np.bool_]) -> Past:
        """With points at displacements ``now`` for those of the functions asked for, (n,) multipliers, that were hardly
        covered at ``before``, the last converged ones. The same object where there are none."""
        unknown = ~self._covers(past.points, KNOWN)
        late = asked[self.pair.normal] & unknown
        missing = late if past.late is None else late & ~self._covers(past.late, BARELY)
        if not missing.any():
            return past
        used = np.flatnonzero(abs(self.pair.space.plain) @ late.astype(float))
        points = self._points(now).on(np.unique(used // MAX_FACET_NODES))
        late = unknown & self._covers(points, BARELY)
        shift = np.where(self.pair.of_functions(late)[self.pair.tangential], self._apart(points, before), past.shift)
        return Past(past.points, shift, points) if late.any() else past

    def _points(self, displacement: Array) -> SlipPoints:
        options = self._options()
        return SlipPoints.of(*self.surfaces(displacement), self.pair.coupling.degree, options, self._across)

    def _apart(self, points: SlipPoints, displacement: Array) -> Array:
        """Weighted slips (n_tangential,) at which what is apart at a displacement closes, theory (G20)."""
        contactor, target = self.surfaces(displacement)
        normals = self._normals.at(contactor)
        sides = Sides(contactor, target, normals.values, nodal_normals(target, self._target_across))
        slip = apart(points, sides)
        mixture = self._mixture(contactor, target, None)
        pair = self.pair if mixture is None else mixed_part(self.pair, mixture)
        if contactor.dim == 2:
            return np.asarray(pair.components[1].transfer.T @ slip[:, 0])
        turned = self._frames.at(contactor, normals).tangents
        return np.asarray(np.einsum("nd,nbd->nb", pair.space.transfer.T @ slip, turned).ravel()[self._kept])

    def shown(self, displacement: Array, points: bool = False) -> Coupling:
        """With what results ask for beside it, the gaps at samples adjusted; points: integration points, too."""
        options = replace(self._options(), keep_gap_samples=True, keep_points=points)
        contactor, target = self.surfaces(displacement)
        seen = couple(contactor, target, self.pair.coupling.degree, options, across=self._across)
        if self.adjusted is None:
            return seen
        return replace(seen, gap_samples=with_adjusted(self.pair.space, contactor, seen, self.adjusted))

    def gaps(self, space: PressureSpace, seen: Coupling, offset: float, fit: Array | None) -> Array:
        """Mean gaps times what is covered, (n_functions,), in a coupling as from ``shown``; space: of the pair there;
        offset: as in ``Placed``; fit: as in ``PairFrame``."""
        gap, weight = (space.transfer.T @ part for part in (seen.gap if fit is None else seen.gap + fit, seen.weight))
        return np.asarray(gap + (offset if self.adjusted is None else offset + self.adjusted) * weight)

    def goes_on(self, here: Pair, border: Rim) -> NDArray[np.bool_]:
        """Edges (m,) of the rim beyond which the target goes on, ``here`` being the pair with surfaces as they are now."""
        return goes_on(here.contactor, border, here.target, NEAR * self._facet)

    def inner(self, displacement: Array, closed: NDArray[np.bool_]) -> Array:
        """Where the functions of "dual-P1" are the ordinary ones, (n_facets,) 1 or 0, with multipliers (n,) closed there."""
        contactor, target = self.surfaces(displacement)
        options = self._options()
        share = couple(contactor, target, 0, options, across=self._across).covered / full_moments(contactor, 0)[:, 0]
        return inner_now(self.pair.space, contactor, target, share, closed[self.pair.normal], NEAR * self._facet)

    def following(self, displacement: Array, closed: NDArray[np.bool_], offset: float) -> Following:
        """Which functions follow others where the pair is now, with multipliers (n,) closed; those that overlap there count
        as closed, too, but not of a surface that may touch itself: it sees its back through thin parts. offset: what is
        added to all gaps."""
        contactor, target = self.surfaces(displacement)
        sharp = bool(at_corners(self.pair.space).any())
        options = replace(self._options(), keep_points=sharp)
        covered = couple(contactor, target, self.pair.coupling.degree, options, across=self._across)
        beside = edge_on(self.pair.space, target, covered, self._facet)
        here = closed[self.pair.normal]
        if contactor.kin is None:
            gap, weight = (self.pair.space.plain.T @ each for each in (covered.gap, covered.weight))
            added = offset if self.adjusted is None else offset + self.adjusted
            here = here | (gap + added * weight < -OVERLAP * self._facet * self.pair.weight[self.pair.normal])
        return Following.of(self.pair.space, contactor, covered, here, beside)

    def _mixture(self, contactor: Surface, target: Surface, inner: Array | None) -> Mixture | None:
        """None where no function is a dual one. How far a target may be away to count as one does not depend on the step."""
        if self.pair.space.ordinary:
            return None
        covered = couple(contactor, target, self.pair.coupling.degree, self._options(), across=self._across)
        return Mixture.of(contactor, covered, inner)

    def _options(self, moved: Array | None = None) -> CouplingOptions:
        """moved: (dim n_points,) in the step so far, None for nothing."""
        rule, way = self.pair.contact.integration, 0.0
        if moved is not None:
            nodes = moved.reshape(-1, self.pair.contactor.dim)[self._nodes]
            way = float(np.linalg.norm(nodes, axis=1).max(initial=0.0))
        near = NEAR if isinstance(self.pair.contact.law, str) else GIVING
        reach = near * self._facet
        fixed = None if self.pair.space.ordinary else reach  # what is covered decides which functions these are
        return CouplingOptions(
            rule.rule, rule.points, reach + 2.0 * way, largest_gap=fixed, target_across=self._target_across
        )

    @property
    def _across(self) -> Smoothing:
        assert self.pair.moving is not None
        return self.pair.moving.contactor

    @property
    def _target_across(self) -> Smoothing | None:
        assert self.pair.moving is not None
        return self.pair.moving.target

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


def bare(pair: Pair) -> NDArray[np.bool_]:
    """(n_functions,) with hardly any target opposite now: they carry no pressure."""
    return np.asarray(pair.space.weight < BARELY * pair.weight[pair.normal])
