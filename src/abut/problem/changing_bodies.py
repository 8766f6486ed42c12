"""Bodies of which some go and come back, as a term of the balance of forces; theory (F20)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp

from abut.bodies.assemble import Response, is_symmetric, respond, stiffness
from abut.bodies.solids import Solids, TemperatureChange
from abut.bodies.stress import PointStress, point_stress
from abut.materials.material import linear
from abut.model import Model, Removal
from abut.problem.body_terms import heated, lasting
from abut.problem.loads import Loads
from abut.problem.terms import MatrixTangent, Motion, Share
from abut.types import Array, Sparse

FAINT = 1e-9  # stiffness of a body that is away over its own, or over that of the softest body: nodes follow what they touch
STILL = 1e-8  # of the diagonal of that: nodes that touch nothing stay
FORCE, PLACE, ORIGIN = "force of ", "place of ", "origin of "  # what names in the history begin with


@dataclass(frozen=True)
class Passing:
    """A body that goes. solids: it alone; nodes: its own; faint: stiffness over all points while it is away."""

    body: str
    solids: Solids
    removals: Sequence[Removal]
    nodes: Array
    faint: Sparse

    def now(self, time: float) -> Removal | None:
        """The removal that counts in the step that ends at a time, None while the body never was away."""
        found = [r for r in self.removals if r.away(time) or r.back < time]
        return max(found, key=lambda removal: removal.until) if found else None


@dataclass(frozen=True)
class ChangingBodies:
    """All bodies. always: those that stay; a body that came back is one at rest where its nodes were then, strained ones as
    they were laid out."""

    model: Model
    loads: Loads
    always: Solids
    parts: Sequence[Passing]
    name: str = "bodies"
    constant: bool = False

    @classmethod
    def of(cls, model: Model, loads: Loads) -> ChangingBodies:
        """Of a model with removals."""
        names = list(dict.fromkeys(removal.body for removal in model.removals))
        solids = model.deformable
        stay = {body: material for body, material in solids.materials.items() if body not in names}
        softest = min((material.modulus for material in stay.values()), default=np.inf)
        parts = []
        for body in names:
            own = replace(solids, materials={body: solids.materials[body]})
            faint = FAINT * min(1.0, softest / solids.materials[body].modulus) * _at_rest(own)
            faint = (faint + STILL * sp.diags(faint.diagonal())).tocsr()
            removals = [removal for removal in model.removals if removal.body == body]
            parts.append(Passing(body, own, removals, model.mesh.nodes_of(body), faint))
        return cls(model, loads, replace(solids, materials=stay), parts)

    @cached_property
    def symmetric(self) -> bool:
        """Whether tangents are."""
        return is_symmetric(self.model.deformable)

    def evaluate(self, before: Motion, now: Motion) -> Share:
        """Force, tangent and history at a state, as in ``Term``. Its history: of materials by body; of each body that
        goes the forces at its nodes while it is there, where these are then, and where they are while it is away."""
        moved = now.displacement.reshape(self.model.mesh.points.shape)
        change = lasting(self.model, heated(self.model, self.loads, now), before, now)
        found = respond(self.always, moved, change, before.history or None)
        force, tangent, history = found.force, found.tangent, dict(found.history)
        for part in self.parts:
            removal = part.now(now.time)
            if removal is not None and removal.away(now.time):
                own, kept = self._away(part, removal, before.history, now)
            else:
                own, kept = self._there(part, removal, before.history, moved, change)
            force, tangent, history = force + own.force, tangent + own.tangent, {**history, **own.history, **kept}
        return Share(
            force, MatrixTangent(tangent), history, self.symmetric, None if self.model.small_strains else np.nan
        )

    def stress(self, motion: Motion) -> PointStress:
        """Stresses at integration points, as in ``Bodies``; none in bodies that are away."""
        moved = motion.displacement.reshape(self.model.mesh.points.shape)
        change, every = heated(self.model, self.loads, motion), self.model.deformable
        whole = [np.zeros((len(group.cells), len(group.rule[1]), 6)) for group in every.groups()]
        _fill(whole, every, self.always, point_stress(self.always, moved, change, motion.history or None))
        for part in self.parts:
            removal = part.now(motion.time)
            if removal is None or not removal.away(motion.time):
                there = self._since(part, removal, motion.history, moved, change)
                _fill(whole, every, there[0], point_stress(*there))
        return whole

    def _there(
        self,
        part: Passing,
        removal: Removal | None,
        before: Mapping[str, Array],
        moved: Array,
        change: TemperatureChange,
    ) -> tuple[Response, dict[str, Array]]:
        found = respond(*self._since(part, removal, before, moved, change))
        kept = {FORCE: found.force.reshape(moved.shape)[part.nodes], PLACE: moved[part.nodes]}
        if removal is not None:
            kept[ORIGIN] = before[ORIGIN + part.body]
        return found, {what + part.body: values for what, values in kept.items()}

    def _since(
        self,
        part: Passing,
        removal: Removal | None,
        before: Mapping[str, Array],
        moved: Array,
        change: TemperatureChange,
    ) -> tuple[Solids, Array, TemperatureChange, Mapping[str, Array] | None]:
        """A body that is there: as it is at rest, its displacement from there, what it has been heated by since, and its
        history."""
        history = {part.body: before[part.body]} if part.body in before else None
        if removal is None or removal.strained:
            return part.solids, moved, change, history
        origin = np.zeros_like(moved)
        origin[part.nodes] = before[ORIGIN + part.body]
        earlier = heated(self.model, self.loads, Motion(removal.back, np.zeros(moved.size)))
        degrees = {body: value - earlier.bodies.get(body, 0.0) for body, value in change.bodies.items()}
        nodes = None if change.nodes is None or earlier.nodes is None else change.nodes - earlier.nodes
        solids = part.solids
        if solids.kinematics == "finite":
            solids = replace(solids, mesh=replace(solids.mesh, points=solids.mesh.points + origin))
        return solids, moved - origin, TemperatureChange(degrees, nodes, change.elapsed), history

    def _away(
        self, part: Passing, removal: Removal, before: Mapping[str, Array], now: Motion
    ) -> tuple[Response, dict[str, Array]]:
        moved = now.displacement.reshape(self.model.mesh.points.shape)
        nothing = np.zeros((len(part.nodes), self.model.dim))
        kept, place = (before.get(what + part.body, nothing) for what in (FORCE, PLACE))
        force, change = np.zeros_like(moved), np.zeros_like(moved)
        change[part.nodes] = moved[part.nodes] - place
        if now.time < removal.gone:
            force[part.nodes] = kept * (removal.gone - now.time) / (removal.gone - removal.until)
        history = {FORCE: kept, PLACE: place, ORIGIN: moved[part.nodes]}
        found = Response(force.ravel() + part.faint @ change.ravel(), part.faint, _initial(part), np.zeros(0))
        return found, {what + part.body: values for what, values in history.items()}


def _initial(part: Passing) -> dict[str, Array]:
    points = sum(len(group.cells) * len(group.rule[1]) for group in part.solids.groups() if group.body)
    return {part.body: np.asarray(part.solids.materials[part.body].initial(points))} if points else {}


def _at_rest(solids: Solids) -> Sparse:
    linearised = {body: linear(material) or material for body, material in solids.materials.items()}
    return stiffness(replace(solids, materials=linearised, kinematics="small"))


def _fill(whole: Sequence[Array], every: Solids, some: Solids, stress: PointStress) -> None:
    """Write stresses of some bodies to those of all."""
    for group, values in zip(some.groups(), stress):
        for of_all, target in zip(every.groups(), whole):
            if of_all.kind == group.kind and of_all.integration == group.integration:
                at = np.minimum(np.searchsorted(of_all.cells, group.cells), len(of_all.cells) - 1)
                found = of_all.cells[at] == group.cells
                target[at[found]] = values[found]
