"""A surface as the contact core sees it: coordinates and facet connectivity, no word of cells or solids."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.sectors import Turned
from abut.types import Array


@dataclass(frozen=True)
class Surface:
    """Facets, possibly of mixed types, over a shared array of points.

    points: (n_points, dim) coordinates, dim 2 or 3, any length unit; facets need not use every point.
    kinds:  (n_facets,) uint8 codes of the facet types (``abut.cells``): line2 line3 / tri3 tri6 quad4 quad8 quad9.
    nodes:  (n_facets, 9) int32 indices into ``points``, padded with -1; order as in ``abut.cells``, so that the
            normal points out of the body.
    axisymmetric: the coordinates are (r, z), and integrals run round the axis.
    parts:  (n_facets,) numbers, where the pressure on it may jump from facets of one number to those of another.
    kin: (n_facets, 10) where the surface may touch itself (``abut.contact.self_contact``): number of the body, rank (of
            two facets the lower is the contactor), and of the undeformed body middle, normal, how far its other side may
            be, thickness.
    bulge: (n_facets, 9) how far the smooth surface lies outside of each facet, a length: coefficients of the functions of
            middle nodes of the facet of second order with the same corners (``abut.contact.bulge``); None where it is flat.
            They belong to the facets, wherever these move.
    turned: where it goes on as itself, turned, beyond the sides of a sector of cyclic symmetry.
    cells, local: (n_facets,) where each facet came from (cell index, facet number within the cell); -1 if unknown.
    """

    points: NDArray[np.float64]
    kinds: NDArray[np.uint8]
    nodes: NDArray[np.int32]
    cells: NDArray[np.int64]
    local: NDArray[np.int64]
    name: str = "surface"
    axisymmetric: bool = False
    parts: NDArray[np.int64] | None = None
    kin: NDArray[np.float64] | None = None
    bulge: NDArray[np.float64] | None = None
    turned: Turned | None = None

    @property
    def dim(self) -> int:
        """2 or 3, the length of a point; facets have one dimension less."""
        return int(self.points.shape[1])

    def around(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        """What an integral over facets is multiplied by at points (..., dim): 2 pi r round an axis, else 1."""
        return around(points, self.axisymmetric)

    def part(self, facets: Array) -> Surface:
        """Some of its facets: their numbers, or (n_facets,) bool."""
        return replace(
            self,
            kinds=np.ascontiguousarray(self.kinds[facets]),
            nodes=np.ascontiguousarray(self.nodes[facets]),
            cells=self.cells[facets],
            local=self.local[facets],
            parts=None if self.parts is None else self.parts[facets],
            kin=None if self.kin is None else self.kin[facets],
            bulge=None if self.bulge is None else self.bulge[facets],
        )

    def __repr__(self) -> str:
        kinds = ", ".join(cell.name for cell in CELLS.values() if cell.code in self.kinds) or "nothing"
        return f"Surface '{self.name}': {len(self)} facets ({kinds}) in {self.dim}D, {len(self.node_ids)} nodes"

    def __len__(self) -> int:
        return int(self.kinds.shape[0])

    @property
    def node_ids(self) -> NDArray[np.int64]:
        """Sorted indices of the points that the facets use."""
        return np.unique(self.nodes[self.nodes >= 0]).astype(np.int64)


def around(points: NDArray[np.float64], axisymmetric: bool) -> NDArray[np.float64]:
    """2 pi r at points (..., dim) in coordinates (r, z), else 1."""
    return 2.0 * np.pi * points[..., 0] if axisymmetric else np.ones(points.shape[:-1])
