"""Surface meshes with a thickness as solid cells: one through the thickness, or one for each layer.

Each node gets a director: the unit normal of the surface there, the mean over the cells around it whose normals lie within
20 degrees of each other and which are equally thick. A node with several directors (at a fold, at a step in thickness) is a
knot: whoever uses the mesh couples the points of all its directors as one rigid body (CalculiX CrunchiX manual, "Shell
elements" and "Knots", which sets the 20 degrees)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.mesh.reference import reference_nodes
from abut.types import Sparse

Numbers = NDArray[np.int64]
Vector = NDArray[np.float64]
ALIKE = float(np.cos(np.radians(20.0)))  # normals that are one, if they are the mesh's
SAME = float(np.cos(np.radians(0.5)))  # the same, where one of them is given
EQUAL = 1e-9  # of the thickness: thicknesses and offsets that are equal
SOLID = {"tri3": "wedge6", "tri6": "wedge15", "quad4": "hex8", "quad8": "hex20"}
LINEAR = ("tri3", "quad4")


@dataclass(frozen=True)
class Shell:
    """Cells of one kind on a surface, linear ones of one layer. cells: (n, k) rows of points; thickness: (n, k) at the nodes
    of each [length]; offset: (n,) of the nodes from the mid-surface along the normal, over the thickness; normals: (n, k, 3)
    where they are given, NaN elsewhere; layers: (m + 1,) from 0 to 1, where these begin and end over the thickness, from
    the negative side; apart: each cell has directors of its own."""

    kind: str
    cells: Numbers
    thickness: Vector
    offset: Vector
    normals: Vector
    layers: Vector = field(default_factory=lambda: np.array([0.0, 1.0]))
    apart: bool = False


@dataclass(frozen=True)
class Expanded:
    """Solid cells. points: (p, 3), of each director from the bottom to the top, those in the middle of layers too; director:
    (p,) of each; share: (p,) of the top in where it is between bottom and top; node: (d,) the point that a director stands
    on; normal: (d, 3); thickness: (d,); cells: for each shell kind and (layers, n, 20 or 15) rows of ``points``; mean:
    (d, p) weights of the points in the mean displacement over the thickness at each director."""

    points: Vector
    director: Numbers
    share: Vector
    node: Numbers
    normal: Vector
    thickness: Vector
    cells: tuple[tuple[str, Numbers], ...]
    mean: Sparse


def expand(points: Vector, shells: Sequence[Shell]) -> Expanded:
    """The solid cells of shells. points: (n, 3). Raises ValueError for cells without an area at a node: its argument is
    the number of the shell and of the cell."""
    found = [_normals(points, shell, i) for i, shell in enumerate(shells)]
    node = np.concatenate([shell.cells.ravel() for shell in shells])
    normal = np.concatenate([n.reshape(-1, 3) for n, _ in found])
    given = np.concatenate([g.ravel() for _, g in found])
    thickness = np.concatenate([shell.thickness.ravel() for shell in shells])
    offset = np.concatenate([np.repeat(shell.offset, shell.cells.shape[1]) for shell in shells])
    alike = {layers: i for i, layers in enumerate(dict.fromkeys(tuple(shell.layers.tolist()) for shell in shells))}
    stack = np.concatenate([np.full(shell.cells.size, alike[tuple(shell.layers.tolist())]) for shell in shells])
    director, first = _directors(node, normal, given, np.column_stack([thickness, offset, stack, _apart(shells)]))
    count = len(first)
    mean = np.zeros((count, 3))
    np.add.at(mean, director, normal)
    mean /= np.linalg.norm(mean, axis=1, keepdims=True)
    through = [np.concatenate([np.ravel([layers[:-1], _middles(layers)], order="F"), layers[-1:]]) for layers in alike]
    shares = [through[i] for i in stack[first].tolist()]
    start = np.cumsum([0, *map(len, shares)])[:-1]
    column, share = np.repeat(np.arange(count), [len(each) for each in shares]), np.concatenate(shares)
    stands, thick = node[first], thickness[first]
    height = (share - 0.5 - offset[first][column]) * thick[column]
    at = points[stands][column] + height[:, None] * mean[column]
    sizes = np.cumsum([shell.cells.size for shell in shells])[:-1]
    own = [d.reshape(s.cells.shape) for s, d in zip(shells, np.split(director, sizes))]
    cells = tuple(
        (SOLID[s.kind], np.stack([stacked(start[rows] + 2 * k, s.kind in LINEAR) for k in range(len(s.layers) - 1)]))
        for s, rows in zip(shells, own)
    )
    return Expanded(at, column, share, stands, mean, thick, cells, _means(own, start, column, share))


def _means(cells: Sequence[Numbers], start: Numbers, column: Numbers, share: Vector) -> Sparse:
    """The mean over the thickness of what the solids' functions make of points, (d, p), as a sparse matrix.

    cells: rows of directors; start: (d,) the first point of each; column, share: as ``Expanded`` has director and share. At
    corners of the shell's cells displacements are a parabola over each layer (Simpson's rule). In the middle of an edge a
    layer has no point in its middle: on the face of eight nodes over the edge they are the line between both points, and
    half of how far the parabolas at both ends rise over theirs."""
    count, corner = len(start), np.zeros(len(start), bool)
    for rows in cells:
        corner[rows[:, : rows.shape[1] // 2]] = True
    lower = np.flatnonzero((np.diff(share, append=0.0) > 0.0) & (np.arange(len(share)) - start[column] & 1 == 0))
    own, high = column[lower], share[lower + 2] - share[lower]  # layers by their points lower, lower + 1, lower + 2
    line = sp.coo_array(
        (np.tile(high / 2.0, 2), (np.tile(own, 2), np.concatenate([lower, lower + 2]))), (count, len(share))
    ).tocsr()
    rise = sp.coo_array(
        (
            np.concatenate([-high / 3.0, 2.0 * high / 3.0, -high / 3.0]),
            (np.tile(own, 3), np.concatenate([lower, lower + 1, lower + 2])),
        ),
        (count, len(share)),
    ).tocsr()
    ends: dict[int, tuple[int, int]] = {}
    for rows in cells:
        half = rows.shape[1] // 2
        for k in range(half):
            ends |= {
                middle: (a, b)
                for a, b, middle in rows[:, [k, (k + 1) % half, half + k]].tolist()
                if middle not in ends and not corner[middle]
            }
    middles, pairs = list(ends), np.array(list(ends.values()), np.int64).reshape(-1, 2)
    at = np.concatenate([np.flatnonzero(corner), np.repeat(middles, 2).astype(np.int64)])
    of = np.concatenate([np.flatnonzero(corner), pairs.ravel()])
    weight = np.concatenate([np.ones(int(corner.sum())), np.full(pairs.size, 0.5)])
    return (line + sp.coo_array((weight, (at, of)), (count, count)).tocsr() @ rise).tocsr()


def _apart(shells: Sequence[Shell]) -> Numbers:
    """A number for each node of each cell: that of the cell where its directors are its own, 0 elsewhere."""
    ends = np.cumsum([0, *(len(shell.cells) for shell in shells)])
    each = [
        np.repeat(
            1 + first + np.arange(len(s.cells)) if s.apart else np.zeros(len(s.cells), np.int64), s.cells.shape[1]
        )
        for first, s in zip(ends.tolist(), shells)
    ]
    return np.concatenate(each)


def _middles(layers: Sequence[float]) -> Vector:
    edges = np.array(layers)
    return np.asarray((edges[1:] + edges[:-1]) / 2.0)


def _normals(points: Vector, shell: Shell, which: int) -> tuple[Vector, NDArray[np.bool_]]:
    """Unit normals (n, k, 3) at the nodes of each cell, and which (n, k) of them were given."""
    x = points[shell.cells]
    slopes = slopes_at_nodes(shell.kind)
    along = np.einsum("akd,nkx->nadx", slopes, x)
    result = np.cross(along[:, :, 0], along[:, :, 1])
    size = np.linalg.norm(result, axis=2, keepdims=True)
    extent = np.ptp(x, axis=1).max(axis=1)
    flat = (size[..., 0] <= 1e-10 * extent[:, None] ** 2).any(axis=1)
    if flat.any():
        raise ValueError(which, int(np.flatnonzero(flat)[0]))
    result /= size
    given = np.asarray(~np.isnan(shell.normals).any(axis=2))
    result[given] = shell.normals[given] / np.linalg.norm(shell.normals[given], axis=1, keepdims=True)
    return result, given


def slopes_at_nodes(kind: str) -> Vector:
    """Derivatives (nodes, functions, 2) of the shape functions of a cell at its nodes, from its monomials."""
    at = reference_nodes(kind)
    powers = [(0, 0), (1, 0), (0, 1)] + ([(1, 1)] if kind == "quad4" else [])
    if kind not in LINEAR:
        powers += [(2, 0), (1, 1), (0, 2)] + ([(2, 1), (1, 2)] if kind == "quad8" else [])
    r, s = at.T

    def monomials(a: int, b: int) -> list[Vector]:
        """Derived a times along r and b times along s."""
        result = []
        for p, q in powers:
            factor = (p if a else 1) * (q if b else 1)
            result.append(factor * r ** max(p - a, 0) * s ** max(q - b, 0))
        return result

    values = np.linalg.inv(np.array(monomials(0, 0)).T)  # rows: monomials, columns: functions
    return np.stack([np.array(monomials(1, 0)).T @ values, np.array(monomials(0, 1)).T @ values], axis=2)


def _directors(node: Numbers, normal: Vector, given: NDArray[np.bool_], own: Vector) -> tuple[Numbers, Numbers]:
    """The director of each node of a cell, and of each director the first of these that has it. Given normals come first,
    else the cells in their order. own: (n, 4) thickness, offset, number of the layers, of the cell where it has its own, in
    which those of one are alike."""
    result = np.full(len(node), -1, np.int64)
    firsts: list[int] = []
    order = np.argsort(node, kind="stable")
    starts = np.flatnonzero(np.diff(node[order], prepend=-1))
    for here in np.split(order, starts[1:]):
        left = here[np.argsort(~given[here], kind="stable")]
        while len(left):
            lead = left[0]
            limit = SAME if given[lead] else ALIKE
            close = normal[left] @ normal[lead] > limit
            mine = close & (np.abs(own[left] - own[lead]) <= EQUAL * np.array([own[lead, 0], 1.0, 1.0, 1.0])).all(
                axis=1
            )
            mine[0] = True
            result[left[mine]] = len(firsts)
            firsts.append(int(lead))
            left = left[~mine]
    return result, np.array(firsts, np.int64)


def stacked(bottom: Numbers, linear: bool) -> Numbers:
    """Rows of the expanded points of the solid cells of a layer, of which each node has one below, one halfway and one
    above. bottom: (n, k) of those below at the nodes of cells."""
    top = bottom + 2
    if linear:
        return np.concatenate([bottom, top], axis=1)
    corners = bottom.shape[1] // 2
    return np.concatenate(
        [bottom[:, :corners], top[:, :corners], bottom[:, corners:], top[:, corners:], bottom[:, :corners] + 1], axis=1
    )
