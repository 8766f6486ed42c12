"""The bodies of a model on many processes: process 0 has the whole mesh and every process its part of the cells."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from abut.bodies.continuous import add_pressures, pressure_response, pressure_stiffness
from abut.bodies.evaluation import History
from abut.bodies.inverted import Inverted
from abut.bodies.solids import Solids, TemperatureChange
from abut.bodies.stress import PointStress
from abut.bordered import Bordered, eliminated
from abut.contact.coupling import Coupling, CouplingOptions
from abut.contact.coupling_tangent import ContactLoad, CouplingTangent
from abut.contact.moving_normals import MovingNormals
from abut.dofs import dofs_at, n_dofs
from abut.materials.kernel import Since
from abut.mesh.surface import Surface
from abut.model import Model
from abut.parallel import part
from abut.parallel.interface import couple, differentiate
from abut.parallel.matrix import Distributed, reduce, tell
from abut.parallel.partition import Layout, Piece, layout, owners, pieces, point_owners
from abut.parallel.team import Kept, Team
from abut.problem.backend import Deformed
from abut.problem.constraints import Constraints
from abut.types import Array


@dataclass(frozen=True)
class DistributedBodies:
    """As ``abut.problem.backend.Backend``, by a team. owner: (n_cells,) process of each cell, points: (n_points,) of each
    point; pieces: by process; told: the change of variables that all processes know, and the layout, which stays."""

    model: Model
    team: Team
    owner: NDArray[np.int64]
    points: NDArray[np.int64]
    pieces: Sequence[Piece]
    told: list[tuple[Constraints, Layout]] = field(default_factory=list)

    @property
    def cellwise(self) -> Solids:
        """What processes integrate; pressures that are continuous belong to no part: process 0 adds them."""
        return self.model.deformable.cellwise

    @cached_property
    def pressed(self) -> Bordered | None:
        """Stiffness of these pressures at rest."""
        return pressure_stiffness(self.model.deformable)

    @property
    def summary(self) -> str:
        """For the log."""
        cells = [len(piece.cells) for piece in self.pieces]
        return f"{self.team.size} processes with {min(cells)} to {max(cells)} cells each"

    def assembled(self) -> DistributedBodies:
        """Have every process assemble its part."""
        model = self.model
        varying = (
            model.holds or model.springs or model.penetrations or model.physics or model.connectors or model.opened
        )  # a stiffness linearised anew
        again = bool(model.finite or varying)  # iterations ask for it anew
        arguments = [(replace(self.cellwise, mesh=piece.mesh), again) for piece in self.pieces]
        self.team.each(part.assemble, per_rank=arguments)
        return self

    def couple(self, contactor: Surface, target: Surface, degree: int, options: CouplingOptions) -> Coupling:
        """Every facet of the contactor by the process that has its cell."""
        return couple(self.team, self.owner[contactor.cells], contactor, target, degree, options)

    def differentiate(
        self, contactor: Surface, target: Surface, degree: int, options: CouplingOptions, load: ContactLoad,
        normals: MovingNormals,
    ) -> CouplingTangent:  # fmt: skip
        """Coupling integrals and their derivatives, as in ``Backend``; facets of the contactor are dealt out in turn."""
        return differentiate(self.team, contactor, target, degree, options, load, normals)

    def internal(self, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
        """Nodal forces of stresses, as in ``abut.problem.backend.Backend``."""
        arguments = [(share,) for share in self.shares(displacement)]
        force = self.summed(self.team.each(part.internal, per_rank=arguments), displacement)
        return force if self.pressed is None else np.asarray(force + self.pressed @ displacement)

    def shares(self, values: NDArray[np.float64]) -> list[NDArray[np.float64]]:
        """Values (dim n_points, ...) at the points of each process."""
        dim = self.model.dim
        nodal = values.reshape(-1, dim, *values.shape[1:])
        return [nodal[piece.points].reshape(n_dofs(len(piece.points), dim), *values.shape[1:]) for piece in self.pieces]

    def summed(self, shares: Sequence[NDArray[np.float64]], like: NDArray[np.float64]) -> NDArray[np.float64]:
        """Back again, sums where points belong to several; like: values at all points."""
        total = np.zeros((len(self.points), self.model.dim, *like.shape[1:]))
        for piece, share in zip(self.pieces, shares):
            total[piece.points] += share.reshape(-1, *total.shape[1:])
        return total.reshape(like.shape)

    def reduce(self, constraints: Constraints) -> Distributed:
        """The stiffness on the free displacements, as in ``Backend``, a matrix of PETSc's."""
        return with_pressures(self.reduced("stiffness", constraints), self.pressed, constraints)

    def reduced(self, tangent: str | int, constraints: Constraints, added: bool = False) -> Distributed:
        """PETSc's matrix of the tangents that the processes keep under a name or number, which they lose, but for the
        stiffness of a model whose iterations need it again, and for what is ``added`` to a stiffness."""
        places, kept = self._laid_out(constraints), self.team.keep()
        self.team.each(reduce, tangent, kept.number, places.starts, places.block, added)
        return Distributed(self.team, places, kept)

    def _laid_out(self, constraints: Constraints) -> Layout:
        """Where free displacements stand; every process knows the change of variables then."""
        if self.told and self.told[0][0] is constraints:
            return self.told[0][1]
        dim = self.model.dim
        if self.told:
            places = self.told[0][1]
        else:
            others = constraints.others
            more = None if others is None else others.at_places({"nodes": self.points, "cells": self.owner})
            places = layout(constraints.free, self.points, dim, self.team.size, constraints.coupled, more)
        arguments = []
        for piece in self.pieces:
            rows = constraints.free[dofs_at(piece.points, dim).ravel()].tocsc()
            used = np.flatnonzero(np.diff(rows.indptr))
            used = used[np.argsort(places.slot[used])]
            arguments.append((places.slot[used], rows[:, used].tocsr()))
        self.team.each(tell, per_rank=arguments)
        self.told[:] = [(constraints, places)]
        return places

    def stress(
        self, displacement: NDArray[np.float64], change: TemperatureChange, history: History | None = None
    ) -> PointStress:
        """Stresses at integration points, as in ``Backend``, gathered from all processes."""
        answers = self.team.each(part.stresses, change.bodies, per_rank=self._moved(displacement, change, history))
        self._require_sound(answers)
        groups = self.model.deformable.groups()
        result = [np.empty((len(group.cells), len(group.rule[1]), 6)) for group in groups]
        for piece, (stress, cells) in zip(self.pieces, answers):
            for values, own in zip(stress, cells):
                number, rows = self._group_and_row[piece.cells[own]].T
                for one in np.unique(number):  # groups of the whole end where blocks of cells do
                    result[one][rows[number == one]] = values[number == one]
        add_pressures(self.model.deformable, np.ascontiguousarray(displacement), change, result)
        return tuple(result)

    @cached_property
    def _group_and_row(self) -> NDArray[np.int64]:
        """Of each cell in the whole, (n_cells, 2)."""
        place = np.empty((self.model.mesh.n_cells, 2), dtype=np.int64)
        for number, group in enumerate(self.model.deformable.groups()):
            place[group.cells] = np.column_stack([np.full(len(group.cells), number), np.arange(len(group.cells))])
        return place

    def mass(self, densities: Mapping[str, float], along: Array | None = None) -> TangentOfParts:
        """The mass matrix, as in ``Backend``."""
        kept = self.team.keep()
        self.team.each(part.keep_mass, kept.number, densities, along)
        return TangentOfParts(self, kept, added=True)

    def stress_stiffness(self, stress: PointStress) -> TangentOfParts:
        """The stiffness that stresses add, as in ``Backend``."""
        kept, shares = self.team.keep(), []
        for piece in self.pieces:
            own: list[Array] = []
            for group in replace(self.cellwise, mesh=piece.mesh).groups() if len(piece.cells) else ():
                number, rows = self._group_and_row[piece.cells[group.cells]].T
                values = np.empty((len(rows), len(group.rule[1]), 6))
                for one in np.unique(number):
                    values[number == one] = stress[one][rows[number == one]]
                own.append(values)
            shares.append((tuple(own),))
        self.team.each(part.keep_stress_stiffness, kept.number, per_rank=shares)
        return TangentOfParts(self, kept, added=True)

    def deform(
        self,
        displacement: NDArray[np.float64],
        change: TemperatureChange,
        history: History | None = None,
        tangent: bool = True,
        since: Since | None = None,
    ) -> Deformed:
        """Forces, tangent and histories of deformed bodies, as in ``Backend``."""
        kept = self.team.keep() if tangent else None
        answers = self.team.each(
            part.deform,
            None if kept is None else kept.number,
            change.bodies,
            per_rank=[
                (
                    *moved,
                    None if since is None else replace(since, displacement=since.displacement[piece.points]),
                    change.elapsed,
                )
                for moved, piece in zip(self._moved(displacement, change, history), self.pieces)
            ],
        )
        self._require_sound(answers)
        force = self.summed([force for force, _, _ in answers], displacement.ravel())
        energy = sum(energy for _, energy, _ in answers)
        more = pressure_response(self.model.deformable, np.ascontiguousarray(displacement), change, tangent)
        if more is not None:
            force, energy = force + more.force, energy + float(more.energy.sum())
        slope = None if kept is None else TangentOfParts(self, kept, None if more is None else more.tangent)
        return Deformed(force, slope, energy, self._gathered([history for _, _, history in answers]))

    def _moved(
        self, displacement: NDArray[np.float64], change: TemperatureChange, history: History | None
    ) -> list[tuple[NDArray[np.float64], NDArray[np.float64] | None, History]]:
        heated, rows = change.nodes, self.history_rows
        parts = [{body: values[r[body]] for body, values in (history or {}).items() if body in r} for r in rows]
        return [
            (displacement[p.points], None if heated is None else heated[p.points], own)
            for p, own in zip(self.pieces, parts)
        ]

    @cached_property
    def history_rows(self) -> list[dict[str, NDArray[np.int64]]]:
        """For each process its rows of the histories of all bodies that have one, in its own order."""
        start = np.zeros(self.model.mesh.n_cells, dtype=np.int64)
        for group in self.model.deformable.groups():
            start[group.cells] = group.first + np.arange(len(group.cells)) * len(group.rule[1])
        result = []
        for piece in self.pieces:
            rows: dict[str, list[NDArray[np.int64]]] = {}
            for group in replace(self.cellwise, mesh=piece.mesh).groups() if len(piece.cells) else ():
                first = start[piece.cells[group.cells]]
                rows.setdefault(group.body, []).append((first[:, None] + np.arange(len(group.rule[1]))).ravel())
            result.append({body: np.concatenate(parts) for body, parts in rows.items() if body})
        return result

    def _gathered(self, parts: Sequence[History]) -> History:
        """The histories of all bodies from those of each process."""
        result: dict[str, NDArray[np.float64]] = {}
        for rows, history in zip(self.history_rows, parts):
            for body, values in history.items():
                if body not in result:
                    n = sum(len(r[body]) for r in self.history_rows if body in r)
                    result[body] = np.empty((n, values.shape[1]))
                result[body][rows[body]] = values
        return result

    def _require_sound(self, answers: Sequence[object]) -> None:
        """Raises Inverted for the first cell in the whole mesh that is inside out, as one process would."""
        unsound = [
            (int(piece.cells[answer.cell]), answer.body, answer.determinant)
            for piece, answer in zip(self.pieces, answers)
            if isinstance(answer, part.InsideOut)
        ]
        if unsound:
            raise Inverted(*min(unsound))


@dataclass(frozen=True)
class TangentOfParts:
    """As ``abut.problem.backend.Tangent``: every process has that of its part, until it is reduced; pressed: that of
    pressures that are continuous, process 0; added: to a stiffness, and reduced as often as one likes."""

    bodies: DistributedBodies
    kept: Kept
    pressed: Bordered | None = None
    added: bool = False

    def internal(self, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
        """Forces by a change of displacements, as in ``Tangent``."""
        arguments = [(share,) for share in self.bodies.shares(displacement)]
        answers = self.bodies.team.each(part.product, self.kept.number, per_rank=arguments)
        force = self.bodies.summed(answers, displacement)
        return force if self.pressed is None else np.asarray(force + self.pressed @ displacement)

    def reduce(self, constraints: Constraints) -> Distributed:
        """The tangent on the free displacements, as in ``Tangent``, once unless it is ``added``."""
        matrix = self.bodies.reduced(self.kept.number, constraints, self.added)
        return with_pressures(matrix, self.pressed, constraints)


def with_pressures(matrix: Distributed, pressed: Bordered | None, constraints: Constraints) -> Distributed:
    """A stiffness with what pressures, eliminated, add to it, which belongs to the bodies for multigrid, too."""
    return matrix if pressed is None else (matrix + eliminated(constraints.reduced(pressed))).whole()


def deal_out(model: Model, team: Team) -> DistributedBodies:
    """Divide the cells of a model among the processes of a team."""
    owner = owners(model.mesh, team)
    points = point_owners(model.mesh, owner)
    dealt = pieces(model.mesh, owner, team.size, points)
    team.store["owner"], team.store["pieces"] = owner, dealt
    return DistributedBodies(model, team, owner, points, dealt)
