"""Where a probe reads: its points in cells, or at nodes, and on the surfaces of a contact."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix

from abut.contact.sides import words
from abut.errors import InputError
from abut.materials.material import history_fields
from abut.mesh.exterior import outside_of_body
from abut.mesh.mesh import Mesh
from abut.model import Contact, Model
from abut.model.probe import IN_BODIES, NAMED_ONLY, ON_CONTACTS, POINTS, QUANTITIES, YIELDED, Probe
from abut.probing.cells import NEAR, Boxes, boxes, locate
from abut.probing.closest_points import feet
from abut.probing.sides import CONTACTOR, TARGET, Side, choose


@dataclass(frozen=True)
class OnSurface:
    """Points on one side of a contact. contact: its number in the model; side: "contactor" or "target"; point, facet: (k,)
    which point has a foot on which facets; weights: (k, 9) shape functions of the facet there."""

    contact: int
    side: str
    point: NDArray[np.int64]
    facet: NDArray[np.int64]
    weights: NDArray[np.float64]


@dataclass(frozen=True)
class Place:
    """Where a probe reads.

    of: quantities; points, distance, nodes: as in ``abut.solution.ProbeResult``; weights: (n, n_points) from the values at
    the mesh's points to those at the probe's, CSR, None where nothing of the bodies is asked for; surface: likewise for
    the contact; notes: choices that were made, in words.
    """

    probe: Probe
    of: tuple[str, ...]
    points: NDArray[np.float64]
    distance: NDArray[np.float64] | None
    nodes: NDArray[np.int64] | None
    weights: csr_matrix | None
    surface: OnSurface | None
    notes: tuple[str, ...] = ()


def find_places(model: Model) -> tuple[Place, ...]:
    """The places of all probes of a model. Raises InputError for the first that is not on it."""
    around = boxes(model.mesh) if any(probe.on is None for probe in model.probes) else ()
    return tuple(find_place(model, probe, around) for probe in model.probes)


def find_place(model: Model, probe: Probe, around: Sequence[Boxes] = ()) -> Place:
    """The place of one probe; around: ``boxes`` of the mesh, made here where left out. Raises InputError for points outside
    all bodies, and where a pressure or gap is asked for that does not exist, or of more than one contact."""
    mesh = model.mesh
    points, distance, nodes = _points(mesh, probe)
    side = choose(model, probe, points)
    if side is not None and _reads_across(model, probe, side, points):
        side, nodes_on = replace(side, role=CONTACTOR), None
    else:
        nodes_on = nodes
    of = _quantities(model, probe, side)
    notes: list[str] = []
    weights = None
    if set(of) & set(IN_BODIES):
        if nodes is not None:
            entries = np.ones(len(nodes)), (np.arange(len(nodes)), nodes)
            weights = csr_matrix(entries, shape=(len(nodes), len(mesh.points)))
        else:
            weights, said = _in_cells(model, probe, around or boxes(mesh), points)
            notes += said
    surface = None
    if side is not None and set(of) & set(ON_CONTACTS):
        surface, said = _on_surface(model, probe, side, points, nodes_on)
        notes += said
    return Place(probe, of, points, distance, nodes, weights, surface, tuple(notes))


def _reads_across(model: Model, probe: Probe, side: Side, points: NDArray[np.float64]) -> bool:
    """Whether a probe on the target is read where the contactor is nearest to it: which side has the gap was abut's choice,
    and what a probe reads does not depend on that."""
    contact = model.contacts[side.contact]
    if side.role == CONTACTOR or not contact.first or not (probe.of is None or "gap" in probe.of):
        return False
    return not bool(feet(model.sides(contact)[0], points).beside.all())


def _points(
    mesh: Mesh, probe: Probe
) -> tuple[NDArray[np.float64], NDArray[np.float64] | None, NDArray[np.int64] | None]:
    """Coordinates (n, dim), distance along a line, numbers of nodes."""
    if probe.on is not None:
        nodes = np.unique(mesh.nodes_of(probe.on)).astype(np.int64)
        return mesh.points[nodes], None, nodes
    if probe.line is None:
        return np.array([probe.at], dtype=float), None, None
    start, end = np.array(probe.line)
    share = np.linspace(0.0, 1.0, probe.points or POINTS)
    return (1.0 - share[:, None]) * start + share[:, None] * end, share * float(np.linalg.norm(end - start)), None


def _quantities(model: Model, probe: Probe, side: Side | None) -> tuple[str, ...]:
    known = {name for material in model.materials.values() for name in history_fields(material)}
    absent = [name for name in YIELDED if name.replace("-", "_") not in known]
    if probe.of is None:
        there = () if side is None else ON_CONTACTS if side.role == CONTACTOR else ON_CONTACTS[:1]
        left = (*absent, *NAMED_ONLY)
        return tuple(name for name in QUANTITIES if name in (*IN_BODIES, *there) and name not in left)
    for name in probe.of:
        if name in absent:
            raise InputError(f"probe '{probe.name}': no body of the model may yield; take {name} out of its 'of'")
    if "gap" in probe.of and side is not None and side.role != CONTACTOR:
        contact = model.contacts[side.contact]
        raise InputError(
            f"probe '{probe.name}': the gap of contact '{contact.name}' is known on its contactor "
            f"{words(contact.contactor)}, but the probe lies on its target {words(contact.target)}; put it on the "
            "contactor, or take gap out of its 'of'"
        )
    return probe.of


def _in_cells(
    model: Model, probe: Probe, around: Sequence[Boxes], points: NDArray[np.float64]
) -> tuple[csr_matrix, list[str]]:
    inside = locate(model.mesh, around, points, probe.body)
    outside = inside.outside
    if len(outside):
        raise InputError(_outside(model, probe, points[outside], len(points)))
    shared = Counter(bodies for bodies in inside.bodies if len(bodies) > 1)
    notes = []
    for bodies, count in shared.items():
        what = "it lies" if len(points) == 1 else f"{count} of its points lie"
        names = " and ".join(f"'{name}'" for name in bodies)
        notes.append(
            f"probe '{probe.name}': {what} in {names}; read in '{bodies[0]}' (body = \"{bodies[1]}\" for the other)"
        )
    return inside.weights, notes


def _outside(model: Model, probe: Probe, points: NDArray[np.float64], count: int) -> str:
    """Message for the points that lie in no cell, (m, dim), of ``count``."""
    mesh = model.mesh
    names = list(mesh.bodies) if probe.body is None else [probe.body]
    away = {name: feet(mesh.facets(outside_of_body(mesh, name)), points[:1]).distance[0] for name in names}
    nearest = min(names, key=lambda name: float(away[name]))
    where = "(" + ", ".join(f"{value:.6g}" for value in points[0]) + ")"
    if count > 1:
        where = f"{len(points)} of its {count} points, the first at {where},"
    if probe.body is None:
        what = f"outside every body, {away[nearest]:.3g} from the nearest, '{nearest}'"
    else:
        what = f"outside body '{nearest}', {away[nearest]:.3g} from it"
    cure = "move it" if count == 1 else "move its ends"
    if model.contacts:
        cure += ', or ask for what is on contact surfaces only (of = ["pressure", "gap"])'
    lies = "lie" if count > 1 and len(points) > 1 else "lies"
    return f"probe '{probe.name}': {where} {lies} {what}; {cure}"


def _on_surface(
    model: Model, probe: Probe, side: Side, points: NDArray[np.float64], nodes: NDArray[np.int64] | None
) -> tuple[OnSurface, list[str]]:
    contact: Contact = model.contacts[side.contact]
    surface = model.sides(contact)[side.role == TARGET]
    if nodes is not None:
        facet, local = np.nonzero((surface.nodes >= 0) & np.isin(surface.nodes, nodes))
        point = np.searchsorted(nodes, surface.nodes[facet, local])
        weights = np.zeros((len(facet), surface.nodes.shape[1]))
        weights[np.arange(len(facet)), local] = 1.0
        return OnSurface(side.contact, side.role, point, facet, weights), []
    found = feet(surface, points)
    if found.beside.all():
        raise InputError(
            f"probe '{probe.name}': no point of it lies over surface '{surface.name}' of contact '{contact.name}'; move it, "
            "or take pressure and gap out of its 'of'"
        )
    notes = []
    farthest = float(found.distance[~found.beside].max())
    if not found.touching[~found.beside].all() and farthest > NEAR * float(
        np.ptp(surface.points[surface.node_ids], axis=0).max()
    ):
        notes.append(
            f"probe '{probe.name}': points up to {farthest:.3g} off surface '{surface.name}' are projected onto it"
        )
    return OnSurface(side.contact, side.role, found.point, found.facet, found.weights), notes
