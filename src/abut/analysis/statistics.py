"""Statistics of a contact: of the reported pressure over the loaded area, and of the nodal forces.

Forces and moments come from the multiplier's nodal forces, never from integrating nodal pressures.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from abut._core import shape_functions
from abut.analysis.loaded_area import LOADED
from abut.cells import CELLS, MAX_FACET_NODES
from abut.contact.coupling import Coupling
from abut.contact.geometry import by_kind, full_moments, node_coordinates, pressure_kind
from abut.contact.nodal_recovery import Averages
from abut.mesh.surface import Surface
from abut.solution import PressureStatistics, Resultant

SUPPORTED = 0.5 - 1e-6  # covered share of a point's support from which on its pressure counts
SAME = 1e-9  # of the largest: pressures that differ by less are the same
NONE = 1e-9  # shape function that is zero
NO_RESULTANT = 1e-9  # resultant over the sum of the nodal forces' sizes, below which it has no line of action
PERCENT = 0.95


def supported(surface: Surface, share: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which nodes' pressures count, (n_facets, 9): corners with enough of their support covered, and nodes between such.

    share: (n_facets, 9) covered share of each node's support, NaN where padded."""
    result = np.zeros(share.shape, dtype=bool)
    for kind, facets in by_kind(surface):
        cell = CELLS[kind]
        functions, _ = shape_functions(CELLS[pressure_kind(kind, 1)].code, node_coordinates(kind))
        low = share[facets, : cell.corners] < SUPPORTED
        result[facets, : cell.nodes] = low @ functions.T < NONE
    return result


def nodal_parts(coupling: Coupling, at: Averages | None, field: NDArray[np.float64]) -> NDArray[np.float64]:
    """Integral of a field (9 n_facets,) over the covered part, divided among the nodes of each facet, (n_facets, 9), by the
    corners' functions; with node-to-segment contact (no ``at``) by the tributary areas of nodes."""
    values = field.reshape(-1, MAX_FACET_NODES)
    if at is None:
        return coupling.weight.reshape(-1, MAX_FACET_NODES) * values
    return np.asarray(np.einsum("fik,fk->fi", at.moments, values))


def pressure_statistics(
    surface: Surface,
    pressure: NDArray[np.float64],
    load: NDArray[np.float64],
    area: NDArray[np.float64],
    share: NDArray[np.float64],
    nothing: float = 0.0,
) -> PressureStatistics:
    """Largest, mean and 95th percentile of the pressure over the loaded area.

    pressure: (n_facets, 9) at the facets' own nodes, NaN where padded; load, area: (n_facets, 9) normal force and loaded
    area that each of them stands for; share: (n_facets, 9) covered share of their supports, NaN where padded; nothing:
    largest pressure that is taken for none. The mean is the force over the area, at most the largest. The percentile is
    that of the pressures at nodes, each at the middle of its area in their order, linear between them. Nodes less than half
    covered count where no others carry anything, as under an edge of the target.
    """
    covered, counted = share > 0.0, supported(surface, share)
    if not (pressure[counted] > LOADED * pressure[covered].max(initial=0.0)).any():  # all of it is at an edge
        counted = covered
    partly = covered & ~counted
    largest = float(pressure[counted].max()) if counted.any() else 0.0
    aside = float(pressure[partly].max()) if partly.any() else 0.0
    aside = aside if aside > max(LOADED * largest, nothing) else np.nan
    if not largest > nothing:
        none = np.full(surface.dim, np.nan)
        return PressureStatistics(largest, none, aside, np.nan, np.nan, 0.0)
    facet, local = np.nonzero(counted & (pressure >= (1.0 - SAME) * largest))
    place = surface.points[surface.nodes[facet[0], local[0]]]
    loaded = counted & (area > 0.0)
    total = float(area[loaded].sum())
    mean = min(float(load[counted].sum()) / total, largest) if total > 0.0 else np.nan
    return PressureStatistics(
        largest, place.copy(), aside, mean, quantile(pressure[loaded], area[loaded], PERCENT), total
    )


def quantile(values: NDArray[np.float64], weight: NDArray[np.float64], share: float) -> float:
    """The value below which a share of the weight lies; values, weight: (n,). Equal values count as one; between them it
    is linear, each at the middle of its weight. NaN for none."""
    if not len(values):
        return float("nan")
    step = SAME * float(np.abs(values).max())
    _, first, level = np.unique(
        np.round(values / step) if step > 0.0 else values, return_index=True, return_inverse=True
    )
    weights = np.bincount(level.ravel(), weight)
    middle = np.cumsum(weights) - 0.5 * weights
    return float(np.interp(share * weights.sum(), middle, values[first]))


def nodal_forces(
    coupling: Coupling, values: NDArray[np.float64], dim: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Forces of the multiplier on all points, on the contactor's side and on the target's, each (n_points, dim); in 2D per
    unit thickness, axisymmetric of the full circumference.

    values: facet-wise coefficients of the pressure (9 n_facets,), of a tie's traction (9 n_facets, dim)."""
    on_contactor, other = (np.asarray(part.T @ values) for part in (coupling.contactor_part, coupling.target_part))
    return on_contactor.reshape(-1, dim), -other.reshape(-1, dim)


def resultant(
    points: NDArray[np.float64], forces: NDArray[np.float64], axisymmetric: bool = False, nothing: bool = False
) -> Resultant:
    """Force, moment about the origin of coordinates, and centre of pressure of nodal forces; points, forces: (n, dim).

    The centre of pressure is the point of the resultant's line of action (in 3D the central axis of forces and moments)
    nearest to the mean of the points, weighted by their forces' components along the resultant: on a plane contact without
    friction the point in it where the force acts. It is NaN where forces cancel, so that there is no such line, and where
    they are ``nothing``. In coordinates (r, z) the resultant lies in the axis, and its moment is zero.
    """
    dim = points.shape[1]
    force = forces.sum(axis=0)
    moment = np.zeros(1) if axisymmetric else cross(points, forces).sum(axis=0)
    centre = np.full(dim, np.nan)
    along = np.array([0.0, force[1]]) if axisymmetric else force
    size = float(np.linalg.norm(along))
    if not nothing and size > NO_RESULTANT * float(np.linalg.norm(forces, axis=1).sum()):
        weight = forces @ along / size**2
        middle = points.mean(axis=0)
        centre = middle + weight @ (points - middle)
        if axisymmetric:
            centre[0] = 0.0
        else:
            left = cross(points - centre, forces).sum(axis=0)
            turned = np.array([force[1], -force[0]]) * left if dim == 2 else np.cross(force, left)
            centre = centre + turned / size**2
    return Resultant(force, moment, centre)


def cross(arms: NDArray[np.float64], forces: NDArray[np.float64]) -> NDArray[np.float64]:
    """Moments of forces (n, dim) with arms (n, dim): (n, 1) about z in 2D, (n, 3) in 3D."""
    if arms.shape[1] == 2:
        return (arms[:, 0] * forces[:, 1] - arms[:, 1] * forces[:, 0])[:, None]
    return np.asarray(np.cross(arms, forces))


def forces_on_bodies(
    surface: Surface, forces: NDArray[np.float64], bodies: Mapping[str, NDArray[np.int64]]
) -> dict[str, NDArray[np.float64]]:
    """Resultants (dim,) of a surface's nodal forces by the body that it belongs to; they add up to that of all.

    bodies: name -> cell numbers; forces: (n_nodes, dim) at ``surface.node_ids``. A node that facets of several bodies share
    divides its force in proportion to the areas of these facets.
    """
    area = full_moments(surface, 0)[:, 0]
    facet, local = np.nonzero(surface.nodes >= 0)
    ids, node = np.unique(surface.nodes[facet, local], return_inverse=True)
    node = node.ravel()
    total = np.bincount(node, area[facet], minlength=len(ids))
    result = {}
    for name, cells in bodies.items():
        inside = np.isin(surface.cells, cells)
        if inside.any():
            part = np.bincount(node, np.where(inside, area, 0.0)[facet], minlength=len(ids)) / total
            result[name] = part @ forces
    return result
