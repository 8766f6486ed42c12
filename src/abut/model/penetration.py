"""Pressure penetration: a fluid that gets between the two sides of a contact; a record that checks itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.cells import BY_CODE
from abut.contact.sides import Sides
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface
from abut.model.conditions import History, check_amplitude, vector
from abut.model.contact import PRESSURES, Contact
from abut.types import Array

OF_FACETS = ("P0", "P1-discontinuous", "P2-discontinuous")  # pressure spaces whose functions belong to facets


@dataclass(frozen=True)
class Penetration:
    """A fluid under pressure that enters a contact wherever it is open and connected to the fluid's side; theory (F19).

    Its pressure acts on both surfaces, along their own normals, from ``source`` on, over all that is open, and on through
    what is closed by less than the fluid's pressure. Where contact presses more than the fluid it seals; what lies behind
    is dry.

    Parameters
    ----------
    contact : str
        Name of the contact.
    source : str or (dim,) of float
        Where the fluid comes from: a node set or surface that has points of one of the contact's sides, or a point,
        whose nearest node counts [length].
    value : float
        Pressure of the fluid [force/area], > 0.
    amplitude : Amplitude, optional
        Factor over time; the ramp where left out.
    name : str
        For results; that of ``contact`` where left out.

    Raises
    ------
    InputError
        For values that are no such things.

    Examples
    --------
    >>> import abut
    >>> abut.Penetration("gasket", source="vessel.bore", value=10.0).name
    'gasket'
    """

    contact: str
    source: str | tuple[float, ...]
    value: float
    amplitude: History = None
    name: str = ""

    def __post_init__(self) -> None:
        checks.text(self.contact, "penetration: contact")
        where = f"penetration of '{self.contact}'"
        if not self.name:
            object.__setattr__(self, "name", self.contact)
        checks.text(self.name, f"{where}: name")
        if not isinstance(self.source, str):
            object.__setattr__(self, "source", vector(self.source, f"{where}: source"))
        object.__setattr__(self, "value", checks.positive(self.value, f"{where}: value"))
        check_amplitude(self.amplitude, where)
        if self.amplitude is not None and min(factor for _, factor in self.amplitude.points) < 0.0:
            raise InputError(f"{where}: amplitude: a fluid has no negative pressure; give factors >= 0")

    def pressure(self, time: float) -> float:
        """At a time."""
        return self.value * (time if self.amplitude is None else self.amplitude(time))


def check_penetrations(
    mesh: Mesh, penetrations: Sequence[Penetration], contacts: Sequence[Contact]
) -> tuple[Penetration, ...]:
    """Penetrations with names of their own. Raises InputError for contacts and places that there are none of."""
    result: list[Penetration] = []
    by_name = {contact.name: contact for contact in contacts}
    for i, item in enumerate(penetrations):
        where = f"penetrations[{i}]"
        checks.known(item.contact, by_name, f"{where}.contact", "contact")
        contact = by_name[item.contact]
        if contact.kind != "contact" or contact.method != "segment-to-segment":
            raise InputError(
                f"{where}.contact: contact '{item.contact}' ({contact.kind}, {contact.method}) cannot open for a fluid; "
                'name one of kind = "contact", method = "segment-to-segment"'
            )
        if contact.pressure in OF_FACETS:
            raise InputError(
                f'{where}.contact: pressures of single facets (pressure = "{contact.pressure}") have no edge that a fluid '
                f"could come to; leave pressure out in contact '{item.contact}', or take one of "
                f"{', '.join(name for name in PRESSURES if name not in OF_FACETS)}"
            )
        if isinstance(item.source, str):
            checks.known(item.source, [*mesh.surfaces, *mesh.node_sets], f"{where}.source", "surface or node set")
        elif len(item.source) != mesh.dim:
            raise InputError(f"{where}.source: expected {mesh.dim} numbers, got {len(item.source)}")
        names, name, count = [other.name for other in result], item.name, 2
        while name in names:
            name, count = f"{item.name} {count}", count + 1
        result.append(replace(item, name=name))
    return tuple(result)


def corners(surface: Surface) -> NDArray[np.int64]:
    """Points that are corners of facets, sorted."""
    found = [surface.nodes[surface.kinds == code, : BY_CODE[code].corners].ravel() for code in np.unique(surface.kinds)]
    return np.unique(np.concatenate([np.zeros(0, np.int64), *found])).astype(np.int64)


def source_nodes(mesh: Mesh, penetration: Penetration, sides: Sides) -> NDArray[np.int64]:
    """Corners of the contactor at which the fluid begins; those next to what the target has of the source, where the
    contactor has nothing. Raises InputError where neither side has."""
    contactor, target = (corners(side) for side in sides)
    if not isinstance(penetration.source, str):
        away = _nearest(mesh.points, np.concatenate([contactor, target]), np.array([penetration.source]))
        given: Array = away
    else:
        given = mesh.nodes_of(penetration.source)
    here = np.intersect1d(contactor, given)
    if len(here):
        return here
    there = np.intersect1d(target, given)
    if not len(there):
        raise InputError(
            f"penetration '{penetration.name}': source: {penetration.source!r} has no point of either side of contact "
            f"'{penetration.contact}'; name a surface that meets them, or give a point"
        )
    return np.unique(_nearest(mesh.points, contactor, mesh.points[there]))


def _nearest(points: Array, nodes: NDArray[np.int64], places: Array) -> NDArray[np.int64]:
    """Of some nodes the nearest to each place."""
    return np.array([nodes[np.argmin(np.linalg.norm(points[nodes] - place, axis=1))] for place in places])
