"""Changes of volume of bodies that hardly admit any, beside what their pressure explains: theory (E13)."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.bodies.cell_growth import cell_growth, keeping
from abut.bodies.corner_pressures import CORNERS, KIND
from abut.bodies.integration import LOCKING, bulk_over_shear
from abut.bodies.solids import Array, Group, Solids, TemperatureChange
from abut.bodies.stress import PointStress
from abut.bodies.volumes import point_volumes
from abut.materials.material import Material, linear, volume_preserving
from abut.materials.places import is_local
from abut.solution.volume_change import Growth, VolumeChange

ROUNDED = 1e-10  # displacements over the size of a cell from which down its strains are rounding: doubles hold 1e-16


@dataclass(frozen=True)
class _Part:
    """Cells of one type of a body, or the corners of tetrahedra whose pressures these are. places: (n, dim), undeformed;
    volume, growth, explained: (n,) undeformed volume, what it grows by, and what pressure and heat make of that;
    strain: the largest of a cell; size: of the smallest, a length."""

    body: str
    places: Array
    volume: Array
    growth: Array
    explained: Array
    strain: float
    size: float


def volume_change(
    solids: Solids, displacement: Array, stress: PointStress, temperature: TemperatureChange
) -> VolumeChange | None:
    """None where no body keeps its volume, or none is strained. displacement: (n_points, dim); stress: at the integration
    points under it."""
    found = list(_parts(solids, displacement, stress, temperature))
    strain = max((part.strain for part in found), default=0.0)
    smallest = min((part.size for part in found), default=1.0)
    if strain <= ROUNDED * float(np.abs(displacement).max(initial=0.0)) / smallest:
        return None
    told = [
        _of_body(body, [part for part in found if part.body == body], strain)
        for body in dict.fromkeys(part.body for part in found)
    ]
    return max(told, key=lambda one: one.worst.unexplained)


def _keeps(solids: Solids, body: str) -> bool:
    """Whether it is far stiffer against changes of volume than of shape, or will be as it flows; no body in plane stress,
    where the thickness gives way."""
    material = solids.materials[body]
    rest = linear(material)
    if solids.plane == "stress" or rest is None or is_local(material):
        return False
    return rest.poisson > LOCKING or volume_preserving(material)


def _parts(solids: Solids, displacement: Array, stress: PointStress, temperature: TemperatureChange) -> Iterator[_Part]:
    for number, body in enumerate(solids.materials):
        if not _keeps(solids, body):
            continue
        for group, values in zip(solids.groups(), stress):
            own = solids.body_of[group.cells] == number
            if own.any():
                part = replace(group, nodes=np.ascontiguousarray(group.nodes[own]), cells=group.cells[own])
                yield _part(solids, body, part, displacement, values[own], temperature)


def _part(
    solids: Solids, body: str, group: Group, displacement: Array, stress: Array, temperature: TemperatureChange
) -> _Part:
    corners = group.kind == KIND and solids.integration.get(body) == "mixed"
    made = cell_growth(solids, group, displacement, corners, temperature.strain(solids, group))
    size, weights = point_volumes(solids, group, group.rule), keeping(group.rule, corners)
    tension = (size * stress[..., :3].mean(axis=-1)) @ weights / (size @ weights)
    explained = made.hot + made.volume * tension / _bulk(solids.materials[body])
    length = float(size.sum(axis=1).min()) ** (1.0 / displacement.shape[1])
    volume, growth, explained = (column.ravel() for column in (made.volume, made.growth, explained))
    places = solids.points[group.nodes].mean(axis=1)
    if corners:  # of all cells about each
        at, row = np.unique(group.nodes[:, :CORNERS], return_inverse=True)
        places = solids.points[at]
        total = sp.csr_matrix((np.ones(row.size), (row.ravel(), np.arange(row.size))))
        volume, growth, explained = (np.asarray(total @ column) for column in (volume, growth, explained))
    return _Part(body, places, volume, growth, explained, float(made.strain.max()), length)


def _bulk(material: Material) -> float:
    """Modulus at rest, force per area."""
    rest = linear(material)
    assert rest is not None
    return bulk_over_shear(rest.poisson) * rest.young / (2.0 * (1.0 + rest.poisson))


def _of_body(body: str, parts: list[_Part], strain: float) -> VolumeChange:
    places, volume, growth, explained = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("places", "volume", "growth", "explained")
    )
    worst, most = int(np.abs((growth - explained) / volume).argmax()), int(np.abs(growth / volume).argmax())

    def of(rows: NDArray[np.int64] | int) -> Growth:
        total = volume[rows].sum()
        return Growth(float(growth[rows].sum() / total), float(explained[rows].sum() / total))

    return VolumeChange(body, of(worst), places[worst], of(most), places[most], of(np.arange(len(volume))), strain)
