"""Motions that contact resists by its facets alone, held in the mean while bodies move far, theory after (V14)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.bodies.mean_turn import mean_turn
from abut.bodies.rigid_modes import FREE, RigidModes, motions
from abut.dofs import dofs_at, n_dofs
from abut.mesh.mesh import Mesh
from abut.model import Model
from abut.problem.backend import Serial
from abut.problem.free_modes import FreeModeSprings
from abut.problem.neutral_motions import SAME, Neutral, neutral_motions
from abut.problem.restraint import Restraint
from abut.problem.terms import Motion, Share
from abut.solution.state import State
from abut.types import Array, Sparse

POINTS = 48  # of a body over which its mean motion is taken: enough for a mean, few enough for a sparse tangent


@dataclass(frozen=True)
class HeldBody:
    """The neutral motions of one body. nodes: (n,) points over which their mean is taken; on: for each motion points of the
    body with which it goes; fields: of each as in ``Neutral``."""

    nodes: NDArray[np.int64]
    on: Sequence[NDArray[np.int64]]
    fields: Sequence[Array]


@dataclass(frozen=True)
class HeldMotions:
    """What resists the motions over a load step: a force proportional to how far they go in it, along the body on whose
    surface they are, which does no work on other rigid motions. stiffness: force over displacement; noise: share of the
    forces that facets put on them."""

    model: Model
    bodies: Sequence[HeldBody]
    stiffness: float
    noise: float
    name: str = "held motions"
    constant: bool = False

    @classmethod
    def of(cls, model: Model, rigid: RigidModes, neutral: Neutral, stiffness: float) -> HeldMotions | None:
        """None where there are none. stiffness: of a point of the bodies."""
        if not len(neutral.noise):
            return None
        bodies = []
        for group in np.unique(neutral.group):
            own = np.flatnonzero(neutral.group == group)
            points = {int(g): _spread(model.mesh, rigid, int(g)) for g in (group, *neutral.on[own])}
            fields = [neutral.fields[int(i)] for i in own]
            bodies.append(HeldBody(points[int(group)], [points[int(g)] for g in neutral.on[own]], fields))
        return cls(model, bodies, stiffness, float(neutral.noise.max()))

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """Force, tangent and history at a state, as in ``Term``; history: "force", (m,) on each motion of unit size."""
        rows = self.rows(before.displacement)
        force = self.stiffness * (rows @ (now.displacement - before.displacement))
        tangent = Serial(self.model, (self.stiffness * (rows.T @ rows)).tocsr())
        return Share(rows.T @ force, tangent, {"force": force})

    def rows(self, displacement: Array) -> Sparse:
        """How far the motions go by displacements of all points, (m, dim n_points), where bodies have moved."""
        points = self.model.mesh.points
        moved = points + displacement.reshape(points.shape)
        found = [row for body in self.bodies for row in self._of_body(body, points, moved)]
        return sp.vstack([sp.csr_matrix((0, points.size)), *found], format="csr")

    def _of_body(self, body: HeldBody, points: Array, moved: Array) -> list[Sparse]:
        """The same of one body. Motions that are one but for noise count once."""
        x = moved[body.nodes]
        centre = x.mean(axis=0)
        size = max(float(np.abs(x - centre).max()), 1e-300)

        def mean_of(nodes: NDArray[np.int64]) -> Array:
            arms = (moved[nodes] - centre) / size
            return np.linalg.pinv(motions(arms, self.model.mesh.axisymmetric).reshape(arms.size, -1))

        own, found, known = mean_of(body.nodes), list[Sparse](), list[Array]()
        for on, field in zip(body.on, body.fields):
            share = own @ self._gone(points[on], moved[on], field, x).ravel()
            share = share / np.linalg.norm(share)
            share = share - sum((other * (other @ share) for other in known), np.zeros_like(share))
            left = float(np.linalg.norm(share))
            if left > SAME:
                known.append(share / left)
                row = self._at(body.nodes, known[-1] @ own)
                found.append(row if on is body.nodes else row - self._at(on, known[-1] @ mean_of(on)))
        return found

    def _at(self, nodes: NDArray[np.int64], values: Array) -> Sparse:
        """A row (1, dim n_points) with the values (dim n,) of some nodes."""
        dim = self.model.dim
        columns = dofs_at(nodes, dim).ravel()
        shape = (1, n_dofs(len(self.model.mesh.points), dim))
        return sp.csr_matrix((values, (np.zeros(len(columns), np.int64), columns)), shape=shape)

    def _gone(self, points: Array, moved: Array, field: Array, x: Array) -> Array:
        """A motion, that has gone with the body of ``points`` to where these have ``moved``, at points x (n, dim)."""
        middle, now = points.mean(axis=0), moved.mean(axis=0)
        dim, even = points.shape[1], np.full(len(points), 1.0 / len(points))
        turn = np.eye(dim) if self.model.mesh.axisymmetric else mean_turn(points - middle, moved, even)[:dim, :dim]
        back = (x - now) @ turn + middle
        return np.asarray((back @ field[:-1] + field[-1]) @ turn.T)


def _spread(mesh: Mesh, rigid: RigidModes, group: int) -> NDArray[np.int64]:
    """Points of a group of bodies, evenly among all of them."""
    nodes = np.unique(np.concatenate([mesh.nodes_of(name) for name in rigid.groups[group]]))
    return nodes[np.unique(np.linspace(0, len(nodes) - 1, POINTS).round().astype(np.int64))]


def held_force(springs: FreeModeSprings, state: State) -> float | None:
    """The largest force in a state that holds motions which contact does not, or hardly; None where there are none."""
    held = state.history.of(HeldMotions.name).get("force")
    if held is None:
        return springs.force(state.unknowns) if len(springs) else None
    return max(springs.force(state.unknowns), float(np.abs(held).max(initial=0.0)))


def neutral_in(model: Model, held: Restraint, loads: Sequence[Array]) -> tuple[Neutral, Array | None]:
    """The motions of a model that contact resists by its facets alone: those that must be held, and, where bodies move far,
    (n_modes, k) those that loads themselves bring to rest.

    loads: nodal forces (dim n_points,) at the end of each load step. Where bodies move far, motions of surfaces without
    curvature are none of them: nothing resists these anywhere."""
    neutral = neutral_motions(held.rigid, held.steady, held.pairs)
    if not model.finite:
        return neutral, None
    neutral = neutral.only(neutral.noise > FREE)
    points, numbers = model.mesh.points, range(len(neutral.noise))
    settled = np.array(
        [any(_settles(points, held.rigid, neutral, i, load) for load in loads) for i in numbers], dtype=bool
    )
    return neutral.only(~settled), neutral.motions[:, settled]


def _settles(points: Array, rigid: RigidModes, neutral: Neutral, number: int, load: Array) -> bool:
    """Whether a load brings a motion to rest: that of a ball to the bottom of a bowl.

    Along the screw of a motion m = L x + t the load f, whose work on it is f . m, does more by f . L m; where that turns it
    back within a radian, and by more than noise, it comes to rest by itself."""
    field, motion = neutral.fields[number], neutral.motions[:, number]
    inside = np.abs(rigid.modes @ motion).reshape(points.shape).max(axis=1) > 0.0
    bent = np.where(inside[:, None], (points @ field[:-1] + field[-1]) @ field[:-1], 0.0)
    back, along = -float(bent.ravel() @ load), abs(float(motion @ (rigid.modes.T @ load)))
    turning = float(np.linalg.norm(field[:-1], 2))  # radians over a unit of the motion
    return back > turning * max(along, float(neutral.noise[number]) * float(np.abs(load).sum()))
