"""Bodies that pass through each other where no contact keeps them apart: the certificate's line "bodies apart"."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from abut.mesh.passing import passing
from abut.mesh.surface import Surface
from abut.model import Model
from abut.solution.contacts import Check

NAMED = 3  # pairs of bodies
LIMIT = 1.0  # what is told at most


def _rows(surface: Surface) -> NDArray[np.int64]:
    return np.column_stack([surface.cells, surface.local])


def bodies_apart(model: Model, displacement: NDArray[np.float64]) -> Iterator[Check]:
    """A line that warns of bodies that lie in each other in the end, (n_points, dim) displaced, by more than a part of a
    facet;
    none where there are none, and for a single body."""
    if len(model.mesh.bodies) < 2:
        return
    joined = [(_rows(contactor), _rows(target)) for contactor, target in map(model.sides, model.contacts)]
    found = passing(model.mesh, model.mesh.points + displacement, joined)
    if not found:
        return
    before = {frozenset(one.bodies) for one in passing(model.mesh, model.mesh.points, joined)}
    told = []
    for one in found[:NAMED]:
        place = ", ".join(f"{value:.4g}" for value in one.place)
        already = ", as in the mesh" if frozenset(one.bodies) in before else ""
        told.append(f"'{one.bodies[0]}' lies {one.depth:.3g} in '{one.bodies[1]}' at ({place}){already}")
    more = f", and {len(found) - NAMED} more pairs" if len(found) > NAMED else ""
    yield Check(
        "", "bodies apart", min(found[0].share, LIMIT), LIMIT,
        f"how deep bodies lie in each other without a contact or a tie, in facets: {'; '.join(told)}{more}", notice=0.0,
    )  # fmt: skip
