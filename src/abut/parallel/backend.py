"""The bodies of a model on many processes: process 0 has the whole mesh and every process its part of the cells."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.bodies.stress import averaged
from abut.contact.coupling import Coupling, CouplingOptions
from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.model import Model
from abut.parallel import part
from abut.parallel.interface import couple
from abut.parallel.matrix import Distributed, reduce
from abut.parallel.partition import Piece, layout, owners, pieces, point_owners
from abut.parallel.team import Team
from abut.problem.constraints import Constraints


@dataclass(frozen=True)
class DistributedBodies:
    """As ``abut.problem.backend.Backend``, by a team. owner: (n_cells,) process of each cell, points: (n_points,) of each
    point; pieces: by process."""

    model: Model
    team: Team
    owner: NDArray[np.int64]
    points: NDArray[np.int64]
    pieces: Sequence[Piece]

    @property
    def summary(self) -> str:
        """For the log."""
        cells = [len(piece.cells) for piece in self.pieces]
        return f"{self.team.size} processes with {min(cells)} to {max(cells)} cells each"

    def assembled(self) -> DistributedBodies:
        """Have every process assemble its part."""
        arguments = [(replace(self.model.deformable, mesh=piece.mesh),) for piece in self.pieces]
        self.team.each(part.assemble, per_rank=arguments)
        return self

    def couple(self, contactor: Surface, target: Surface, degree: int, options: CouplingOptions) -> Coupling:
        """Every facet of the contactor by the process that has its cell."""
        return couple(self.team, self.owner[contactor.cells], contactor, target, degree, options)

    def internal(self, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
        """As in ``abut.problem.backend.Backend``."""
        dim = self.model.dim
        nodal = displacement.reshape(-1, dim, *displacement.shape[1:])
        arguments = [
            (nodal[piece.points].reshape(dim * len(piece.points), *displacement.shape[1:]),) for piece in self.pieces
        ]
        total = np.zeros_like(nodal)
        for piece, force in zip(self.pieces, self.team.each(part.internal, per_rank=arguments)):
            total[piece.points] += force.reshape(-1, *nodal.shape[1:])
        return total.reshape(displacement.shape)

    def reduce(self, constraints: Constraints) -> Distributed:
        """As in ``Backend``, a matrix of PETSc's."""
        dim = self.model.dim
        places = layout(constraints.free, self.points, dim, self.team.size, constraints.coupled)
        arguments = []
        for piece in self.pieces:
            rows = constraints.free[(dim * piece.points[:, None] + np.arange(dim)).ravel()].tocsc()
            used = np.flatnonzero(np.diff(rows.indptr))
            used = used[np.argsort(places.slot[used])]
            arguments.append((places.slot[used], rows[:, used].tocsr()))
        self.team.each(reduce, places.starts, places.block, per_rank=arguments)
        return Distributed(self.team, places)

    def stress(
        self, displacement: NDArray[np.float64], time: float, temperature: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """As in ``Backend``."""
        arguments = [(displacement[piece.points], temperature[piece.points]) for piece in self.pieces]
        total, count = np.zeros((len(displacement), 6)), np.zeros(len(displacement))
        sums = self.team.each(part.stresses, self.model.temperatures(time), per_rank=arguments)
        for piece, (stress, cells) in zip(self.pieces, sums):
            total[piece.points] += stress
            count[piece.points] += cells
        return averaged(total, count)


def deal_out(model: Model, team: Team) -> DistributedBodies:
    """Divide the cells of a model among the processes of a team. Raises InputError for materials that they do not know."""
    if not model.deformable.constant:
        raise InputError(
            'solve.linear "petsc" and several processes know linear elastic materials under small strains only; run without '
            'mpiexec, with linear = "auto"'
        )
    owner = owners(model.mesh, team)
    points = point_owners(model.mesh, owner)
    dealt = pieces(model.mesh, owner, team.size, points)
    team.store["owner"], team.store["pieces"] = owner, dealt
    return DistributedBodies(model, team, owner, points, dealt)
