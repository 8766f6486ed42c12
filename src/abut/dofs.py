"""Unknowns by field and place: the only file that knows where in a vector of values they stand.

A field has the same number of components at each of its places (nodes, cells or bodies), those of one place side by side.
Fields follow one another in a ``Dofs``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.types import Sparse

DISPLACEMENT = "displacement"


def dofs_at(places: NDArray[np.integer[Any]] | int, components: int) -> NDArray[np.int64]:
    """All components at places (...) of a field: (..., components)."""
    first = components * np.asarray(places, dtype=np.int64)
    return np.asarray(first[..., None] + np.arange(components))


def n_dofs(places: int, components: int) -> int:
    """How many a field has."""
    return places * components


def n_places(dofs: int, components: int) -> int:
    """How many places a field of so many unknowns has."""
    return dofs // components


def n_components(dofs: int, places: int) -> int:
    """How many components a field of so many unknowns has."""
    return dofs // places


def place_of(dofs: Any, components: int) -> Any:
    """The place that an unknown of a field belongs to; of an integer, or of arrays."""
    return dofs // components


def component_of(dofs: Any, components: int) -> Any:
    """Its component."""
    return dofs % components


@dataclass(frozen=True)
class Field:
    """Unknowns of one kind. name; places: how many; components at each; at: what the places are, "nodes", "cells" or
    "bodies", in the order of the mesh."""

    name: str
    places: int
    components: int = 1
    at: str = "nodes"

    @property
    def size(self) -> int:
        """How many unknowns."""
        return n_dofs(self.places, self.components)


@dataclass(frozen=True)
class Dofs:
    """The unknowns of several fields in one vector of values (size,), displacements (``DISPLACEMENT``, at nodes) first."""

    fields: tuple[Field, ...]

    @property
    def size(self) -> int:
        """How many values."""
        return sum(field.size for field in self.fields)

    def field(self, name: str) -> Field:
        """Raises KeyError for a name that there is not."""
        return {field.name: field for field in self.fields}[name]

    def range_of(self, name: str) -> slice:
        """Where the values of a field stand."""
        first = sum(field.size for field in self.fields[: self.fields.index(self.field(name))])
        return slice(first, first + self.field(name).size)

    def of(self, name: str, places: NDArray[np.integer[Any]] | None = None) -> NDArray[np.int64]:
        """Where the components of a field at places (...) stand, all places without: (..., components)."""
        field = self.field(name)
        chosen = np.arange(field.places) if places is None else places
        return self.range_of(name).start + dofs_at(chosen, field.components)

    def named(self, values: NDArray[np.float64]) -> dict[str, NDArray[np.float64]]:
        """Values (size,) by field, (places, components)."""
        return {f.name: values[self.range_of(f.name)].reshape(f.places, f.components) for f in self.fields}


def widened(matrix: Sparse, unknowns: int) -> Sparse:
    """A matrix with columns of zeros for further unknowns, up to so many."""
    rows = matrix.tocsr()
    return sp.csr_matrix((rows.data, rows.indices, rows.indptr), shape=(rows.shape[0], unknowns))
