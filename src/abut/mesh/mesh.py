"""The mesh record, which can be read from files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from abut.mesh.cell_block import CellBlock
from abut.mesh.read import read_mesh
from abut.mesh.record import MeshRecord

__all__ = ["CellBlock", "Mesh"]


@dataclass(frozen=True, repr=False)
class Mesh(MeshRecord):
    """Points and cells with names.

    points:    (n_points, dim) float64, dim 2 or 3, any length unit.
    blocks:    cells by type; cell numbers run through the blocks in order.
    bodies:    name -> (n,) int64 cell numbers, sorted.
    surfaces:  name -> (n, 2) int64 rows (cell number, local facet number).
    node_sets: name -> (n,) int64 point numbers, sorted.
    axisymmetric: the coordinates are (r, z) with r >= 0, and integrals run round the axis.
    notes:     what was changed when the mesh was read, in words.

    Arrays of other types, lists, and arrays that are not contiguous are copied. Raises InputError for other shapes, and
    numbers of points, cells and facets that are not whole or do not fit.

    >>> import numpy as np
    >>> import abut
    >>> from abut.mesh.mesh import CellBlock
    >>> mesh = abut.Mesh(
    ...     points=np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]),
    ...     blocks=(CellBlock("quad4", np.array([[0, 1, 2, 3]], dtype=np.int32)),),
    ...     bodies={"plate": np.array([0])},
    ...     surfaces={"right": np.array([[0, 1]])},  # its second edge
    ... )
    >>> mesh.nodes_of("right").tolist()
    [1, 2]
    """

    @classmethod
    def read(cls, path: str | Path) -> Mesh:
        """Read a Gmsh ``.msh`` (2.2 or 4.1), ``.vtu``, or Abaqus or CalculiX ``.inp`` file and check it.

        Raises InputError for a file that is missing, truncated, of another kind, or whose mesh is unsound.
        """
        return read_mesh(cls, Path(path))
