"""Contact at current positions, for large sliding: gaps, slips and forces of a pair with their exact derivatives."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.coupling import Coupling, CouplingOptions, couple
from abut.contact.coupling_tangent import coupling_tangent
from abut.contact.geometry import Smoothing, facet_sizes, full_moments, smoothing
from abut.contact.tangential import SlipOperators, quarter, slip_operators, turned
from abut.mesh.surface import Surface
from abut.problem.contact_pairs import Pair
from abut.problem.dual_functions import Mixture, inner_now
from abut.problem.slip_points import SlipNow, SlipPoints, slip_now
from abut.problem.tangent_frames import Anchors, Frames, anchors
from abut.types import Sparse

Array = NDArray[np.float64]
KNOWN = 0.05  # share of a function that the last step must have covered, for its slip to count
NEAR = 2.0  # facets between the surfaces up to which they are paired, beside what they have moved in the step


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
    None without friction; offset: what is added to the gap now; inner: (n_facets,) not zero where functions of a dual space
    are the ordinary ones in this step, None for nowhere."""

    displacement: Array
    before: Array
    points: SlipPoints | None
    offset: float
    inner: Array | None = None


@dataclass(frozen=True)
class Current:
    """A pair, not tied, whose surfaces are looked at where they are. pair: as from ``whole_pair``."""

    pair: Pair

    def at(self, place: Place, multipliers: Array) -> ContactNow:
        """Gaps, forces and derivatives with multipliers (n,). As in theory (G1), (G2)."""
        contactor, target = self.surfaces(place.displacement)
        options, degree = self._options(place.displacement - place.before), self.pair.coupling.degree
        coupling = couple(contactor, target, degree, options, across=self._across)
        mixture = None if self.pair.space.ordinary else Mixture.of(contactor, coupling, place.inner)
        pair = self.pair if mixture is None else _mixed(self.pair, mixture)
        p = multipliers[pair.normal]
        by = coupling_tangent(contactor, target, degree, options, pair.space.transfer @ p, across=self._across)
        down, offset = pair.space.transfer.T, place.offset
        weight = np.asarray(down @ coupling.weight)
        slope = down @ (by.gap if offset == 0.0 or by.weight is None else by.gap + offset * by.weight)
        bending, mixing = by.force_tangent, None
        if mixture is not None:
            mixing = mixture.change(contactor, by.weight)
            slope = slope + self._differences[0].T @ sp.diags(coupling.gap + offset * coupling.weight) @ mixing
            bending = bending + coupling.operator.T @ sp.diags(self._differences[0] @ p) @ mixing
        now = ContactNow(
            replace(
                pair, contactor=contactor, target=target, coupling=coupling, space=replace(pair.space, weight=weight),
                rows=(down @ coupling.operator).tocsr(),
            ),
            np.asarray(down @ coupling.gap + offset * weight), slope.tocsr(), bending,
            np.zeros(len(pair.space), dtype=bool),
        )  # fmt: skip
        return self._with_friction(now, place, options, multipliers, mixing) if pair.frictional else now

    def surfaces(self, displacement: Array) -> tuple[Surface, Surface]:
        """Contactor and target at a displacement (dim n_points,)."""
        points = np.ascontiguousarray(self.pair.contactor.points + displacement.reshape(-1, self.pair.contactor.dim))
        return replace(self.pair.contactor, points=points), replace(self.pair.target, points=points)

    def points(self, displacement: Array) -> SlipPoints:
        """The integration points at a displacement, from which the next step's slip counts."""
        options = replace(self._options(np.zeros_like(displacement)), keep_points=True)
        surfaces = self.surfaces(displacement)
        return SlipPoints.of(*surfaces, couple(*surfaces, self.pair.coupling.degree, options, across=self._across))

    def inner(self, displacement: Array, closed: NDArray[np.bool_]) -> Array:
        """Where the functions of "dual-P1" are the ordinary ones, (n_facets,) 1 or 0, with multipliers (n,) closed there."""
        contactor, target = self.surfaces(displacement)
        options = self._options(np.zeros_like(displacement))
        share = couple(contactor, target, 0, options, across=self._across).covered / full_moments(contactor, 0)[:, 0]
        return inner_now(self.pair.space, contactor, target, share, closed[self.pair.normal], self.near)

    @property
    def near(self) -> float:
        """How far apart the surfaces may be where they are paired, a length."""
        return NEAR * self._facet

    def shown(self, displacement: Array) -> Coupling:
        """With what results ask for beside it."""
        options = replace(self._options(np.zeros_like(displacement)), keep_gap_samples=True)
        return couple(*self.surfaces(displacement), self.pair.coupling.degree, options, across=self._across)

    def _options(self, moved: Array) -> CouplingOptions:
        rule = self.pair.contact.integration
        nodes = self._nodes
        way = np.linalg.norm(moved.reshape(-1, self.pair.contactor.dim)[nodes], axis=1).max(initial=0.0)
        return CouplingOptions(rule.rule, rule.points, reach=self.near + 2.0 * float(way))

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
    def _differences(self) -> list[Sparse]:
        """Dual less ordinary functions, by component, (9 n_facets, n) each."""
        return [(part.transfer - part.plain).tocsr() for part in self.pair.components]

    @cached_property
    def _anchors(self) -> Anchors:
        return anchors(self.pair.contactor, self.pair.space)

    @cached_property
    def _frames(self) -> Frames:
        assert self.pair.slip is not None
        return Frames.of(self.pair.contactor, self._anchors, self.pair.slip.tangents)

    def _with_friction(
        self, now: ContactNow, place: Place, options: CouplingOptions, multipliers: Array, mixing: Sparse | None
    ) -> ContactNow:
        """The same with slips, and forces of the tractions, theory (G4), (G6)."""
        pair, now_pair = self.pair, now.pair
        assert place.points is not None
        slip = slip_now(place.points, now_pair.contactor, now_pair.target, self._across)
        rubbed = self._in_plane if now_pair.contactor.dim == 2 else self._in_space
        made = rubbed(now_pair, slip, options, multipliers, mixing)
        covered = pair.space.plain.T @ place.points.moments(len(now_pair.contactor))
        assert pair.slip is not None
        moved = replace(pair.slip, operators=made.operators, tangents=made.tangents)
        return ContactNow(
            replace(now_pair, rows=sp.vstack([now_pair.rows, made.rows]).tocsr(), slip=moved),
            np.concatenate([now.gap, made.slip]),
            sp.vstack([now.by_position, made.by_position]).tocsr(),
            (now.bending + made.bending).tocsr(),
            covered < KNOWN * pair.weight[pair.normal],
        )  # fmt: skip

    def _in_plane(
        self, now_pair: Pair, slip: SlipNow, options: CouplingOptions, multipliers: Array, mixing: Sparse | None
    ) -> Rubbing:
        """2D: forces of a traction are those of a pressure, turned by a right angle at every point."""
        part = now_pair.components[1].transfer
        turn = quarter(len(now_pair.contactor.points))
        traction = multipliers[self.pair.tangential]
        along = part @ traction
        by = coupling_tangent(
            now_pair.contactor, now_pair.target, now_pair.coupling.degree, options, along, across=self._across
        )
        turned_rows = (now_pair.coupling.operator @ turn).tocsr()
        change, bending = part.T @ slip.by_position[0], turn.T @ by.force_tangent
        if mixing is not None:
            change = change + self._differences[1].T @ sp.diags(slip.value[:, 0]) @ mixing
            bending = bending + turned_rows.T @ sp.diags(self._differences[1] @ traction) @ mixing
        return Rubbing(
            rows=part.T @ turned_rows, slip=np.asarray(part.T @ slip.value[:, 0]), by_position=change, bending=bending,
            tangents=turned(self._anchors.normals(now_pair.contactor, self._across))[:, None],
            operators=SlipOperators((turned_rows,), now_pair.coupling.gap[:, None]),
        )  # fmt: skip

    def _in_space(
        self, now_pair: Pair, slip: SlipNow, options: CouplingOptions, multipliers: Array, mixing: Sparse | None
    ) -> Rubbing:
        """3D: two components along tangents that turn with the surface."""
        pair, x = now_pair, now_pair.contactor.points
        kept = replace(options, keep_points=True)
        at = couple(now_pair.contactor, now_pair.target, now_pair.coupling.degree, kept, across=self._across).points
        assert at is not None
        operators = slip_operators(at, x)
        fields = [pair.space.transfer.T @ along for along in operators.along]
        value = pair.space.transfer.T @ slip.value
        change = [pair.space.transfer.T @ by for by in slip.by_position]
        if mixing is not None:
            apart = self._differences[0]
            change = [by + apart.T @ sp.diags(slip.value[:, a]) @ mixing for a, by in enumerate(change)]
        tangents, by_tangent = self._frames.at(now_pair.contactor, self._across)
        rows, slips, slopes, bending = [], [], [], sp.csr_matrix((x.size, x.size))
        traction = np.zeros((len(pair.space), 3))
        for b, by in enumerate(by_tangent):
            has = pair.index[:, 1 + b] >= 0
            t = np.where(has, multipliers[np.maximum(pair.index[:, 1 + b], 0)], 0.0)
            traction += t[:, None] * tangents[:, b]
            parts = [by[a::3] for a in range(3)]
            rows.append(sum(sp.diags(tangents[:, b, a]) @ fields[a] for a in range(3)).tocsr()[has])
            slips.append(np.einsum("nd,nd->n", value, tangents[:, b])[has])
            slopes.append(
                sum(
                    sp.diags(tangents[:, b, a]) @ change[a] + sp.diags(value[:, a]) @ parts[a] for a in range(3)
                ).tocsr()[has]
            )
            bending = bending + sum(fields[a].T @ sp.diags(t) @ parts[a] for a in range(3))
        if mixing is not None:
            bending = bending + sum(operators.along[a].T @ sp.diags(apart @ traction[:, a]) @ mixing for a in range(3))
        by_force = coupling_tangent(
            now_pair.contactor, now_pair.target, now_pair.coupling.degree, options, np.zeros(len(now_pair.coupling.gap)),
            pair.space.transfer @ traction, across=self._across,
        )  # fmt: skip
        return Rubbing(
            sp.vstack(rows),
            np.concatenate(slips),
            sp.vstack(slopes),
            bending + by_force.force_tangent,
            tangents,
            operators,
        )


def _mixed(pair: Pair, mixture: Mixture) -> Pair:
    space, *others = (mixture.space(part) for part in pair.components)
    return replace(pair, space=space, components=(space, *others))


@dataclass(frozen=True)
class Rubbing:
    """What friction adds, m rows. rows: (m, dim n_points) of the forces; slip: (m,) weighted; by_position: its derivative;
    bending: derivative of the forces; tangents: (n_functions, dim - 1, dim); operators: of the slip, facet by facet."""

    rows: Sparse
    slip: Array
    by_position: Sparse
    bending: Sparse
    tangents: Array
    operators: SlipOperators
