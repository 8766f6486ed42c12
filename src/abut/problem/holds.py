"""Supports that come and go, as a term of the balance of forces; theory (F18)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

from abut.dofs import dofs_at
from abut.errors import InputError
from abut.mesh.facets import bodies_at
from abut.model import Model
from abut.model.hold import END, STAY, Hold
from abut.model.step_ends import SAME
from abut.problem.preloads import HELD
from abut.problem.terms import MatrixTangent, Motion, Share
from abut.types import Array


@dataclass(frozen=True)
class Held:
    """A hold in the mesh. at: (n,) held components of displacements; values: (n,) what is prescribed; stays: (n,) those
    that stay where they are; stiffness: (n,)."""

    hold: Hold
    at: Array
    values: Array
    stays: Array
    stiffness: Array

    def acts(self, time: float) -> bool:
        """Whether it holds at a time."""
        until = END if self.hold.until is None else self.hold.until
        return self.hold.since + SAME < time <= until + SAME

    def target(self, place: Array, time: float) -> Array:
        """Where it leads to at a time, from ``place``, (n,)."""
        led = place * (1.0 - self.hold.way(time)) + self.values * self.hold.factor(time)
        return np.where(self.stays, place, led)


@dataclass(frozen=True)
class Holds:
    """All holds of a model, each a spring that is ``HELD`` times as stiff as a cell while it acts. given: (dim n_points,)
    forces that those that act have beside, at a state that something else than these springs has held so far."""

    parts: Sequence[Held]
    given: Array | None = None
    name: str = "holds"
    constant: bool = False

    @classmethod
    def of(cls, model: Model) -> Holds | None:
        """None where there are none."""
        return cls([_held(model, hold) for hold in model.holds]) if model.holds else None

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """Force, tangent and history at a state, as in ``Term``; its history is where each hold began, and the force it
        had last."""
        size = len(now.displacement)
        total, slope = np.zeros(size), np.zeros(size)
        history: dict[str, Array] = {}
        for i, part in enumerate(self.parts):
            hold, here = part.hold, now.displacement[part.at]
            place, kept = (
                before.history.get(f"{what}{i}", np.zeros((len(here), 1)))[:, 0] for what in ("place", "force")
            )
            if now.time <= hold.since + SAME:
                place = here if now.time > 0.0 else np.zeros_like(here)
            elif hold.until is None or now.time <= hold.until + SAME:
                kept = part.stiffness * (here - part.target(place, now.time))
                if self.given is not None:
                    kept = kept + self.given[part.at]
                total[part.at] += kept
                slope[part.at] += part.stiffness
            else:
                left = (hold.end_of_release - now.time) / (hold.end_of_release - hold.until)
                total[part.at] += max(left, 0.0) * kept
            history |= {f"place{i}": place[:, None], f"force{i}": kept[:, None]}
        return Share(total, MatrixTangent(sp.diags(slope, format="csr")), history)

    def with_forces(self, unbalanced: Array, time: float) -> Holds:
        """With the forces that bring points into balance at a state, shared by the holds that act on them then;
        unbalanced: (dim n_points,), on the side of those of stresses."""
        count = np.zeros(len(unbalanced))
        for part in self.parts:
            count[part.at] += part.acts(time)
        return replace(self, given=np.where(count > 0.0, -unbalanced / np.maximum(count, 1.0), 0.0))

    def require_places(self, displacement: Array, share: Share, time: float, off: float, end: float) -> None:
        """Raise InputError unless points, (dim n_points,) displaced, are by at most ``off`` where supports would have put
        them that are what these holds are, or the springs of holds; share: their own at this state, with forces given; time:
        a share of the ``end`` of the run."""
        for i, part in enumerate(self.parts):
            if not part.acts(time):
                continue
            place, force = share.history[f"place{i}"][:, 0], share.history[f"force{i}"][:, 0]
            beside = displacement[part.at] - part.target(place, time)
            far = np.minimum(np.abs(beside), np.abs(beside - force / part.stiffness)).max(initial=0.0)
            if far > off:
                raise InputError(
                    f"start: hold '{part.hold.name}' puts points up to {far:.3g} from where the job before has them at time "
                    f"{time * end:.6g} of this one; give it the displacement that they had there, or a later since"
                )

    def resistance(self, motions: Array) -> Array:
        """Gram matrix of motions (dim n_points, m) by what holds take of them, of the size of one."""
        total = np.zeros((motions.shape[1],) * 2)
        for part in self.parts:
            moved = motions[part.at]
            total += moved.T @ moved / len(part.at)
        return total


def _held(model: Model, hold: Hold) -> Held:
    mesh, dim = model.mesh, model.dim
    nodes = mesh.nodes_of(hold.on)
    every = dofs_at(nodes, dim).reshape(len(nodes), dim)
    columns = ["xyz".index(component) for component in hold.components]
    values = [0.0 if value == STAY else float(value) for value in hold.components.values()]
    stays = [value == STAY for value in hold.components.values()]
    stiffness = _stiffness(model, nodes)
    return Held(
        hold,
        every[:, columns].ravel(),
        np.tile(values, len(nodes)),
        np.tile(stays, len(nodes)),
        np.repeat(stiffness, len(columns)),
    )


def _stiffness(model: Model, nodes: Array) -> Array:
    """Of what holds each of some nodes, (n,)."""
    mesh = model.mesh
    touched = [np.isin(block.nodes, nodes).any(axis=1) for block in mesh.blocks]
    names = bodies_at(mesh, np.concatenate([first + np.flatnonzero(t) for t, first in zip(touched, mesh.starts)]))
    modulus = max((solid.material.modulus for solid in model.solids if solid.body in names), default=1.0)
    sizes = [np.ptp(mesh.points[b.nodes[t]], axis=1).max(axis=1) for b, t in zip(mesh.blocks, touched) if t.any()]
    extent = float(np.median(np.concatenate(sizes))) if mesh.dim == 3 and sizes else 1.0
    around = 2.0 * np.pi * mesh.points[nodes, 0] if mesh.axisymmetric else np.ones(len(nodes))
    return np.asarray(HELD * modulus * extent * np.maximum(around, around.max(initial=0.0) * 1e-3))
