"""Values of a result file at any position: temperatures of a thermal run, displacements of a model of the whole."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.cells import CELLS
from abut.contact.geometry import facet_sizes
from abut.errors import InputError, nearest
from abut.io.point_values import PointValues, read_values
from abut.mesh.cell_block import CellBlock
from abut.mesh.exterior import outside_of_body
from abut.mesh.mesh import Mesh
from abut.probing.cells import Boxes, boxes, locate
from abut.probing.closest_points import feet

BODY = "all"
AXES = ("x", "y", "z")
FLAT = 1e-9  # of the extent: how far points of a plane mesh lie off their plane
BESIDE = 0.5  # how far outside the mesh a point may lie, over the size of the facet there: curved faces meshed unlike


@dataclass(frozen=True)
class ResultField:
    """A number at every position, by the shape functions of the cells of a result file.

    A function of points (n, dim) -> (n,), as values of supports and loads may be. Points outside the file's mesh, but by
    less than half of a facet's size, have the value at the nearest point of its surface.

    Parameters
    ----------
    path : Path
        The file.
    array : str
        Which of its values.
    mesh : Mesh
        Its cells.
    values : (n_points,) array of float
        At the points of the mesh, NaN where there is none.
    component, body : str or int, optional
        As they were asked for.

    Raises
    ------
    InputError
        When called: for points outside, of other dimensions, or where the file has no value.
    """

    path: Path = field(metadata={"decides": False})
    array: str
    mesh: Mesh
    values: NDArray[np.float64]
    component: str | int | None = field(default=None, metadata={"decides": False})
    body: str | int | None = field(default=None, metadata={"decides": False})

    def __call__(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        if points.shape[1] != self.mesh.dim:
            raise InputError(f"{self.path}: its mesh has {self.mesh.dim} dimensions, the model {points.shape[1]}")
        inside = locate(self.mesh, self._boxes, points)
        missing = inside.outside
        with np.errstate(invalid="ignore"):
            known = np.isfinite(self.values)
            result = np.asarray(inside.weights @ np.where(known, self.values, 0.0))
        if len(missing):
            result[missing] = self._nearby(points[missing])
        lost = np.asarray(abs(inside.weights) @ (~known).astype(float)) > FLAT
        if lost.any():
            raise InputError(f"{self.path}: no value of {self.array!r} around {points[np.argmax(lost)].tolist()}")
        return result

    @cached_property
    def _boxes(self) -> tuple[Boxes, ...]:
        return boxes(self.mesh)

    def _nearby(self, points: NDArray[np.float64]) -> NDArray[np.float64]:
        surface = self.mesh.facets(outside_of_body(self.mesh, BODY))
        found = feet(surface, points)
        first = np.unique(found.point, return_index=True)[1]
        facet, weights = found.facet[first], found.weights[first]
        size = np.full(len(points), 0.0)
        size[found.point[first]] = facet_sizes(surface)[facet]
        far = np.flatnonzero(~(found.distance <= BESIDE * size))
        if len(far):
            worst = far[np.argmax(found.distance[far])]
            where = ", ".join(f"{value:.6g}" for value in points[worst])
            raise InputError(
                f"{self.path}: ({where}) lies {found.distance[worst]:.3g} outside its mesh, which reaches from "
                f"{_corner(self.mesh.points.min(axis=0))} to {_corner(self.mesh.points.max(axis=0))}; is it in the same "
                "place and unit of length?"
            )
        nodes = surface.nodes[facet]
        values = np.where(nodes >= 0, self.values[np.maximum(nodes, 0)], 0.0)
        return np.asarray(np.where(weights != 0.0, weights * values, 0.0).sum(axis=1))


def result_field(
    path: str | Path, array: str, component: str | int | None = None, body: str | int | None = None
) -> ResultField:
    """Values of a result file as a function of position, for supports and loads.

    Parameters
    ----------
    path : str or Path
        A .vtu file (of ParaView and many programs, or of an abut run), or an .frd file as text (CalculiX), of which the last
        step counts.
    array : str
        The name of the values at points: "displacement", "temperature", in .frd files "DISP", "NDTEMP".
    component : str or int, optional
        Which one of a vector or tensor: its name in the file, "x", "y", "z" of a vector, or its number from 0; left out: the
        only one.
    body : str or int, optional
        The body whose cells alone are read, by its name in the file or its number there: of an abut run, of a mesh that abut
        wrote, of a .vtu file with an array ``body`` or ``region`` of its cells, of the material in an .frd file; left out:
        all. Bodies that touch have values of their own on either side.

    Returns
    -------
    ResultField
        A function of points.

    Raises
    ------
    InputError
        For files, arrays, components and bodies that are not there.
    """
    path = checks.path(path, "result field: path")
    found = read_values(path, checks.text(array, "result field: array"))
    if isinstance(body, bool) or not isinstance(body, (str, int, type(None))):
        raise InputError(f"{path}: body: expected a name or a number, got {body!r}")
    return field_of(found, Path(path), array, component, body)


def field_of(
    found: PointValues, path: Path, array: str, component: str | int | None = None, body: str | int | None = None
) -> ResultField:
    """The same of what was read of a file. Raises InputError as ``result_field`` does."""
    number = _number(found, component, path, array)
    mesh, used = _mesh(found, path, body)
    values = found.values[used, number]
    if not np.isfinite(values).any():
        raise InputError(f"{path}: {array!r} has no values at points{'' if body is None else f' of body {body!r}'}")
    return ResultField(path, array, mesh, values, component, body)


def _number(found: PointValues, component: str | int | None, path: str | Path, array: str) -> int:
    count = found.values.shape[1]
    if component is None:
        if count != 1:
            names = found.components or tuple(AXES[:count] if count <= len(AXES) else map(str, range(count)))
            raise InputError(f"{path}: {array!r} has {count} components; say which one: {', '.join(names)}")
        return 0
    if component in found.components:
        return found.components.index(str(component))
    number = AXES.index(component) if isinstance(component, str) and component in AXES[:count] else component
    if isinstance(number, bool) or not isinstance(number, int) or not 0 <= number < count:
        known = (*found.components, *(AXES[:count] if count <= len(AXES) else ()))
        raise InputError(
            f"{path}: {array!r} has no component {component!r}{nearest(str(component), known)}; numbers go from 0 to "
            f"{count - 1}"
        )
    return number


def _mesh(found: PointValues, path: Path, body: str | int | None) -> tuple[Mesh, NDArray[np.int64]]:
    """The cells of the highest dimension that the file has, of one body where one is named, and which points of the file
    they have; of a plane one two coordinates."""
    cells = found.cells if body is None else _of_body(found, path, body)
    dims = {CELLS[kind].dim for kind in cells}
    if not dims or max(dims) < 2:
        raise InputError(f"{path}: has no cells to read between points in")
    dim = max(dims)
    cells = {kind: nodes for kind, nodes in cells.items() if CELLS[kind].dim == dim}
    used = np.unique(np.concatenate([nodes.ravel() for nodes in cells.values()]))
    points = found.points[used]
    if dim == 2:
        if np.ptp(points[:, 2]) > FLAT * float(np.ptp(points, axis=0).max()):
            raise InputError(
                f"{path}: has cells of surfaces in space; values are read in solids, or in a plane of x and y"
            )
        points = points[:, :2]
    blocks = tuple(CellBlock(kind, np.searchsorted(used, nodes).astype(np.int32)) for kind, nodes in cells.items())
    count = sum(len(block.nodes) for block in blocks)
    return Mesh(points, blocks, {BODY: np.arange(count)}), used


def _of_body(found: PointValues, path: Path, body: str | int) -> dict[str, NDArray[np.int64]]:
    """The cells of one body of a file."""
    there = sorted({int(number) for numbers in found.groups.values() for number in np.unique(numbers)})
    names = [name for name, number in found.bodies.items() if number in there]
    number = found.bodies.get(body) if isinstance(body, str) else body
    if number not in there:
        known = ", ".join(map(repr, names)) or ", ".join(map(str, there))
        raise InputError(
            f"{path}: no body {body!r}{nearest(str(body), names) if names else ''}; "
            + (f"there are {known}" if known else "the file does not tell its bodies apart")
        )
    chosen = {kind: nodes[found.groups[kind] == number] for kind, nodes in found.cells.items()}
    return {kind: nodes for kind, nodes in chosen.items() if len(nodes)}


def _corner(point: NDArray[np.float64]) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in point) + ")"
