"""Cell and facet types: names, codes shared with the compiled core, node counts, facets, VTK numbering.

Node order is VTK's for every type (hex27 face nodes: -x +x -y +y -z +z, then the centre), except that wedges have a
positive volume when nodes 0 1 2 turn counter-clockwise seen from the top (as in Gmsh, Abaqus and what ParaView draws).
Facet node lists turn so that the normal points out of the cell; in 2D a facet runs counter-clockwise around the cell, so
that its outward normal is the tangent turned by -90 degrees.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class CellType:
    """One cell or facet type: ``code`` is the number the compiled core knows it by."""

    name: str
    code: int
    dim: int
    nodes: int
    corners: int
    degree: int
    vtk: int
    facets: tuple[tuple[str, tuple[int, ...]], ...] = ()


def _edges(kind: str, *nodes: tuple[int, ...]) -> tuple[tuple[str, tuple[int, ...]], ...]:
    return tuple((kind, n) for n in nodes)


_TET4 = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
_TET10 = ((0, 2, 1, 6, 5, 4), (0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (0, 3, 2, 7, 9, 6))
_HEX8 = ((0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7))
_HEX20 = (
    (0, 4, 7, 3, 16, 15, 19, 11),
    (1, 2, 6, 5, 9, 18, 13, 17),
    (0, 1, 5, 4, 8, 17, 12, 16),
    (3, 7, 6, 2, 19, 14, 18, 10),
    (0, 3, 2, 1, 11, 10, 9, 8),
    (4, 5, 6, 7, 12, 13, 14, 15),
)
_HEX27 = tuple((*facet, 20 + i) for i, facet in enumerate(_HEX20))
_WEDGE6 = ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5))
_WEDGE15 = (
    (0, 2, 1, 8, 7, 6),
    (3, 4, 5, 9, 10, 11),
    (0, 1, 4, 3, 6, 13, 9, 12),
    (1, 2, 5, 4, 7, 14, 10, 13),
    (2, 0, 3, 5, 8, 12, 11, 14),
)


def _wedge(tri: str, quad: str, nodes: tuple[tuple[int, ...], ...]) -> tuple[tuple[str, tuple[int, ...]], ...]:
    return tuple((tri if i < 2 else quad, n) for i, n in enumerate(nodes))


_ALL = (
    CellType("line2", 0, 1, 2, 2, 1, 3),
    CellType("line3", 1, 1, 3, 2, 2, 21),
    CellType("tri3", 2, 2, 3, 3, 1, 5, _edges("line2", (0, 1), (1, 2), (2, 0))),
    CellType("tri6", 3, 2, 6, 3, 2, 22, _edges("line3", (0, 1, 3), (1, 2, 4), (2, 0, 5))),
    CellType("quad4", 4, 2, 4, 4, 1, 9, _edges("line2", (0, 1), (1, 2), (2, 3), (3, 0))),
    CellType("quad8", 5, 2, 8, 4, 2, 23, _edges("line3", (0, 1, 4), (1, 2, 5), (2, 3, 6), (3, 0, 7))),
    CellType("quad9", 6, 2, 9, 4, 2, 28, _edges("line3", (0, 1, 4), (1, 2, 5), (2, 3, 6), (3, 0, 7))),
    CellType("tet4", 7, 3, 4, 4, 1, 10, _edges("tri3", *_TET4)),
    CellType("tet10", 8, 3, 10, 4, 2, 24, _edges("tri6", *_TET10)),
    CellType("hex8", 9, 3, 8, 8, 1, 12, _edges("quad4", *_HEX8)),
    CellType("hex20", 10, 3, 20, 8, 2, 25, _edges("quad8", *_HEX20)),
    CellType("hex27", 11, 3, 27, 8, 2, 29, _edges("quad9", *_HEX27)),
    CellType("wedge6", 12, 3, 6, 6, 1, 13, _wedge("tri3", "quad4", _WEDGE6)),
    CellType("wedge15", 13, 3, 15, 6, 2, 26, _wedge("tri6", "quad8", _WEDGE15)),
)

CELLS: dict[str, CellType] = {cell.name: cell for cell in _ALL}
BY_CODE: tuple[CellType, ...] = _ALL
MAX_FACET_NODES = 9  # what is kept for each node or pressure function of a facet comes in rows of as many, padded
