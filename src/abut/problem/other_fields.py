"""Fields beside displacements: their free values, and those that are prescribed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.dofs import DISPLACEMENT, Dofs
from abut.errors import InputError, SingularModelError
from abut.model import Model
from abut.types import Array, Sparse


@dataclass(frozen=True)
class OtherFields:
    """A change of variables as that of displacements, beside it. dofs: of all fields; free: (n, n_free) of the values after
    displacements, n_free counting all unknowns; prescribed: (n, n_histories)."""

    dofs: Dofs
    free: Sparse
    prescribed: Array

    def values(self, free: Array, factors: Array) -> Array:
        """(n,), by the unknowns and the factors of the histories."""
        return np.asarray(self.free @ free + self.prescribed @ factors)

    def whole(self, displacing: Sparse) -> Sparse:
        """Derivative (n_values, n_free) of all values; displacing: of the displacements."""
        return sp.vstack([displacing, self.free], format="csr")

    def largest(self, values: Array) -> Array:
        """The largest of each field's values (n_values,) at every unknown, (n_free,); of displacements where they move."""
        result = np.zeros(self.free.shape[1])
        moving = result.size - np.unique(self.free.indices).size
        for name, part in self.dofs.named(np.abs(values)).items():
            columns = slice(0, moving) if name == DISPLACEMENT else self._columns(name)
            result[columns] = part.max(initial=0.0)
        return result

    def at_places(self, by: Mapping[str, Array]) -> Array:
        """What is given ``by`` place, for "nodes" and "cells" (places,), at every unknown that is no displacement, in order;
        zero for those of other places."""
        result = np.zeros(self.free.shape[1], dtype=np.int64)
        first = self.dofs.range_of(DISPLACEMENT).stop
        for field in self.dofs.fields[1:]:
            rows = self.dofs.of(field.name) - first
            given = by.get(field.at, np.zeros(field.places, dtype=np.int64))
            here = self.free[rows.ravel()].tocoo()
            result[here.col] = np.repeat(given, field.components)[here.row]
        return result[result.size - self.free.nnz :]

    def _columns(self, name: str) -> NDArray[np.int64]:
        """Unknowns of a field."""
        at, first = self.dofs.range_of(name), self.dofs.range_of(DISPLACEMENT).stop
        return np.unique(self.free[at.start - first : at.stop - first].indices)


def other_fields(model: Model, n_moving: int) -> OtherFields | None:
    """Of a model, None without; n_moving: free displacements, whose unknowns come first. Raises InputError and
    SingularModelError for what is prescribed twice or nowhere."""
    dofs = model.dofs
    if not model.physics and len(dofs.fields) == 1:
        return None
    first = dofs.range_of(DISPLACEMENT).stop
    if model.solve.linear not in ("auto", "direct", "petsc"):
        what = "physics needs" if model.physics else "connectors need"
        raise InputError(f'solve.linear: "{model.solve.linear}" knows displacements alone; {what} "direct"')
    prescribed = np.zeros((dofs.size - first, len(model.histories)))
    held = np.zeros(len(prescribed), dtype=bool)
    for i, item in enumerate(model.physics):
        for part in item.held(model, dofs):
            at = np.asarray(part.dofs).ravel() - first
            if (at < 0).any():
                raise InputError(f"physics[{i}]: displacements are prescribed by supports")
            if held[at].any():
                raise SingularModelError(f"physics[{i}]: values are prescribed twice; take one of them out")
            held[at] = True
            prescribed[at, model.histories.index(part.amplitude)] = np.broadcast_to(part.values, at.shape)
    rows = np.flatnonzero(~held)
    columns = n_moving + np.arange(len(rows))
    free = sp.csr_matrix((np.ones(len(rows)), (rows, columns)), shape=(len(held), n_moving + len(rows)))
    return OtherFields(dofs, free, prescribed)
