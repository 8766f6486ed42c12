"""Preloads: bolts that are tightened, by a section inside a body whose two sides are drawn together."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.contact.geometry import area_vectors
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.mesh.section import cut_open, plane_rows, shank
from abut.model.conditions import Amplitude, History, check_amplitude, vector
from abut.model.loads import NodalForce

SIDES = (" section 1", " section 2")  # what names of the node sets on both sides end with
SMALL = 1e-12  # component of a unit normal that is rounding


@dataclass(frozen=True)
class Preload:
    """A section of a body whose two sides are drawn together, as tightening does to the shank of a bolt; theory (F15).

    Parameters
    ----------
    name : str
        Of the preload.
    body : str
        The body, which abut cuts open at the cells next to a plane.
    point, normal : (dim,) of float, optional
        The plane [length]; left out: across the middle of the body's thinnest part, away from contacts.
    surface : str, optional
        In place of ``body``: a surface that runs between the cells of a body, all the way through; ``normal``, if given, is
        the direction of the force.
    force : float, optional
        Tension [force], of what is modelled: half of it for half a bolt; axisymmetric: of the full circumference.
    shortening : float, optional
        In place of it: how far the sides are drawn over each other [length].
    amplitude : Amplitude, optional
        Factor over time; the ramp where left out.
    lock : float, optional
        Time from which on the shortening stays what ``force`` has made of it, as with a nut that is no longer turned.

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.

    Examples
    --------
    >>> import abut
    >>> tightened = abut.Amplitude(((0.0, 0.0), (0.5, 1.0)))
    >>> m12 = abut.Preload("M12", body="bolt", force=45e3, amplitude=tightened, lock=0.5)
    """

    name: str
    body: str = ""
    point: tuple[float, ...] | None = None
    normal: tuple[float, ...] | None = None
    surface: str = ""
    force: float | None = None
    shortening: float | None = None
    amplitude: History = None
    lock: float | None = None

    def __post_init__(self) -> None:
        where = f"preload '{self.name}'"
        checks.text(self.name, f"{where}: name")
        for side in ("body", "surface"):
            if not isinstance(getattr(self, side), str):
                raise InputError(f"{where}: {side}: expected a name, got {getattr(self, side)!r}")
        if bool(self.body) == bool(self.surface):
            raise InputError(f"{where}: give either body or surface")
        if (self.force is None) == (self.shortening is None):
            raise InputError(f"{where}: give either force or shortening")
        for name in ("force", "shortening"):
            if getattr(self, name) is not None:
                checks.finite(getattr(self, name), f"{where}: {name}")
        for name in ("point", "normal"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, vector(getattr(self, name), f"{where}: {name}"))
        if self.normal is not None and not any(self.normal):
            raise InputError(f"{where}: normal: a direction needs a component other than zero")
        if self.body and (self.point is None) != (self.normal is None):
            raise InputError(f"{where}: point and normal go together; give both or neither")
        if self.surface and self.point is not None:
            raise InputError(f"{where}: point goes with body; leave it out, the surface is the section")
        check_amplitude(self.amplitude, where)
        if self.lock is not None:
            checks.finite(self.lock, f"{where}: lock")
            if self.force is None:
                raise InputError(f"{where}: lock goes with force; a shortening keeps what its amplitude says")
            if not self.lock > 0.0:
                raise InputError(f"{where}: lock: expected a time after the start, got {self.lock:g}")

    @property
    def locking(self) -> tuple[Amplitude, ...]:
        """A history with a corner where the shortening is locked, none without: a load step must end there."""
        return () if self.lock is None else (Amplitude(((0.0, 0.0), (self.lock, 0.0), (1.0, 1.0))),)

    @property
    def sides(self) -> tuple[str, str]:
        """Node sets of the points before and beyond the section, in the same order."""
        return f"{self.name}{SIDES[0]}", f"{self.name}{SIDES[1]}"


@dataclass(frozen=True)
class Section:
    """A preload's section in the mesh that is cut open. before, beyond: (n,) points of both sides, which coincide; normal:
    (dim,) unit vector from the one to the other, along which a shortening draws them together."""

    preload: Preload
    before: NDArray[np.int64]
    beyond: NDArray[np.int64]
    normal: NDArray[np.float64]


def sections(mesh: Mesh, preloads: Sequence[Preload]) -> list[Section]:
    """Of preloads whose sections are cut open."""
    result = []
    for preload in preloads:
        before, beyond = (mesh.node_sets[name] for name in preload.sides)
        normal = np.array(preload.normal)
        normal = normal / np.linalg.norm(normal)
        normal[np.abs(normal) < SMALL] = 0.0
        result.append(Section(preload, before, beyond, normal))
    return result


def cut_sections(
    mesh: Mesh, preloads: Sequence[Preload], touching: Sequence[str], loads: Sequence[object]
) -> tuple[Mesh, tuple[Preload, ...]]:
    """The mesh cut open at every preload, where it is not yet, and the preloads with their planes. touching: surfaces of
    contacts, which sections that abut finds keep away from. Raises InputError for sections that are none."""
    result: list[Preload] = []
    names: set[str] = set()
    for i, preload in enumerate(preloads):
        where = f"preloads[{i}]"
        if preload.name in names:
            raise InputError(f"{where}.name: '{preload.name}' is used twice; give each preload its own name")
        names.add(preload.name)
        for name in ("point", "normal"):
            value = getattr(preload, name)
            if value is not None and len(value) != mesh.dim:
                raise InputError(f"{where}.{name}: expected {mesh.dim} numbers, got {len(value)}")
        if all(side in mesh.node_sets for side in preload.sides) and preload.normal is not None:
            result.append(preload)
            continue
        mesh, placed = _cut(mesh, preload, touching, where)
        _check_loads(mesh, placed, loads, where)
        result.append(placed)
    _check_open(mesh, names)
    return mesh, tuple(result)


def _check_open(mesh: Mesh, names: Collection[str]) -> None:
    """Raise InputError for a mesh that is cut open for a preload of another name: nothing would hold its sides together."""
    for first in mesh.node_sets:
        name = first.removesuffix(SIDES[0])
        if name in names or name == first or (second := f"{name}{SIDES[1]}") not in mesh.node_sets:
            continue
        before, beyond = mesh.node_sets[first], mesh.node_sets[second]
        apart = len(before) != len(beyond) or np.isin(before, beyond).any()
        if not apart and len(before) and (mesh.points[before] == mesh.points[beyond]).all():
            raise InputError(
                f"preloads: the mesh is cut open at the section of '{name}', and no preload has that name: nothing would "
                "hold both sides together. Give the mesh that the model was made of (that of a model is cut), or keep the "
                "preload: with shortening = 0 the section stays closed"
            )


def _cut(mesh: Mesh, preload: Preload, touching: Sequence[str], where: str) -> tuple[Mesh, Preload]:
    if preload.surface:
        checks.known(preload.surface, mesh.surfaces, f"{where}.surface", "surface")
        rows = mesh.surfaces[preload.surface]
        if preload.normal is None:
            preload = replace(preload, normal=_mean_normal(mesh, rows))
        mesh = cut_open(mesh, rows, preload.sides, where)
        return mesh, preload
    checks.known(preload.body, mesh.bodies, f"{where}.body", "body")
    point, normal = preload.point, preload.normal
    if point is None or normal is None:
        names = [name for name in touching if name in mesh.surfaces]
        avoid = np.unique(np.concatenate([np.empty(0, np.int64), *(mesh.nodes_of(name) for name in names)]))
        found = shank(mesh, preload.body, avoid, where)
        point, normal = (tuple(part.tolist()) for part in found)
    unit = np.array(normal) / np.linalg.norm(normal)
    rows = plane_rows(mesh, preload.body, np.array(point), unit, where)
    return cut_open(mesh, rows, preload.sides, where), replace(preload, point=point, normal=normal)


def _mean_normal(mesh: Mesh, rows: NDArray[np.int64]) -> tuple[float, ...]:
    """Of all facets, out of the cells that they belong to."""
    total = area_vectors(mesh.facets(rows)).reshape(-1, mesh.dim).sum(axis=0)
    return tuple((total / np.linalg.norm(total)).tolist())


def _check_loads(mesh: Mesh, preload: Preload, loads: Sequence[object], where: str) -> None:
    """Forces at nodes would act twice where a node has been doubled."""
    doubled = mesh.node_sets[preload.sides[1]]
    for i, load in enumerate(loads):
        if isinstance(load, NodalForce) and np.isin(mesh.nodes_of(load.on), doubled).any():
            raise InputError(
                f"{where}: loads[{i}], a force at nodes of '{load.on}', acts at nodes of the section; move it"
            )
