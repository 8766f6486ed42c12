"""The mesh record, which can be read from files."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from abut import checks
from abut.mesh.cell_block import CellBlock
from abut.mesh.read import read_mesh
from abut.mesh.record import MeshRecord

__all__ = ["CellBlock", "Mesh"]


@dataclass(frozen=True, repr=False)
class Mesh(MeshRecord):
    """Points and cells with names.

    Arrays of other types, lists, and arrays that are not contiguous are copied.

    Parameters
    ----------
    points : (n_points, dim) array of float
        Coordinates, dim 2 or 3 [length].
    blocks : tuple of CellBlock
        Cells by type; cell numbers run through the blocks in order.
    bodies : mapping of str to (n,) array of int
        Cell numbers, sorted.
    surfaces : mapping of str to (n, 2) array of int
        Rows (cell number, local facet number).
    node_sets : mapping of str to (n,) array of int
        Point numbers, sorted.
    axisymmetric : bool
        The coordinates are (r, z) with r >= 0, and integrals run round the axis.
    notes : tuple of str
        What was changed when the mesh was read, in words.
    shells : tuple of str
        Bodies that are shells made solid (``thicken``, decks).
    beams : tuple of str
        Bodies that are beams or trusses made solid.

    Raises
    ------
    InputError
        For other shapes, and numbers of points, cells and facets that are not whole or do not fit.

    Examples
    --------
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
        return read_mesh(cls, checks.path(path, "Mesh.read: path"))
