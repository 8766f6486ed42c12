"""Values of a step at a place."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.materials.directions import frames, turned
from abut.materials.invariants import max_shear, principal, von_mises
from abut.model.probe import MAX_SHEAR, PRINCIPAL, REACTION, YIELDED
from abut.probing.place import OnSurface, Place
from abut.probing.sides import CONTACTOR
from abut.solution import ContactResult, ProbeResult, Step
from abut.types import Array

PLASTIC = YIELDED[0]


def read(place: Place, step: Step) -> ProbeResult:
    """The values of a step at a place. Displacement and stress are those at the mesh's points, between them by the shape
    functions of the cell; the von Mises stress is that of the stress found so. Pressure and gap likewise from the facets'
    nodes, the mean of the facets that meet at a point where they jump; NaN where there is none."""
    values: dict[str, NDArray[np.float64]] = {}
    if place.weights is not None:
        stress = np.asarray(place.weights @ step.stress)
        every = {
            "displacement": np.asarray(place.weights @ step.displacement),
            "stress": stress,
            "von-mises": von_mises(stress),
        }
        if PRINCIPAL in place.of:
            every[PRINCIPAL] = principal(stress)
        if MAX_SHEAR in place.of:
            every[MAX_SHEAR] = max_shear(stress)
        if REACTION in place.of and step.nodal_reaction is not None:
            every[REACTION] = np.asarray(place.weights @ step.nodal_reaction)
        for name in YIELDED:
            if name in place.of:
                at_points = step.remembered[name.replace("-", "_")]
                every[name] = np.asarray(place.weights @ at_points.reshape(len(step.displacement), -1))
                every[name] = every[name].ravel() if every[name].shape[1] == 1 else every[name]
        if place.probe.axes is not None:
            every = _local(every, frames(place.probe.axes, place.points))
        values |= {name.replace("-", "_"): value for name, value in every.items() if name in place.of}
    if place.surface is not None:
        contact = step.contacts[place.surface.contact]
        for name in ("pressure", "gap"):
            if name in place.of:
                values[name] = _on_facets(place.surface, _table(place.surface, contact, name), len(place.points))
    return ProbeResult(place.probe.name, place.points, place.distance, place.nodes, values)


def _local(values: dict[str, Array], frame: Array) -> dict[str, Array]:
    """Vectors and tensors (n, 6) by their components along the directions of frames (n, 3, 3), the rest as it is."""
    result = dict(values)
    for name in ("displacement", REACTION):
        if name in values:
            dim = values[name].shape[1]
            result[name] = np.einsum("nkd,nd->nk", frame[:, :dim, :dim], values[name])
    result["stress"] = np.einsum("nba,nb->na", turned(frame.transpose(0, 2, 1)), values["stress"])
    if PLASTIC in values:
        result[PLASTIC] = np.einsum("nab,nb->na", turned(frame), values[PLASTIC])
    return result


def _table(surface: OnSurface, contact: ContactResult, name: str) -> NDArray[np.float64]:
    """Values at the facets' nodes, (n_facets, 9)."""
    if name == "gap":
        return contact.gap
    return contact.pressure if surface.side == CONTACTOR else contact.target_pressure


def _on_facets(surface: OnSurface, table: NDArray[np.float64], count: int) -> NDArray[np.float64]:
    """The mean at each point over the facets that it is on and that have a value, (count,)."""
    used = surface.weights != 0.0
    each = (surface.weights * np.where(used, table[surface.facet], 0.0)).sum(axis=1)
    known = np.isfinite(each)
    total = np.bincount(surface.point[known], each[known], count)
    number = np.bincount(surface.point[known], minlength=count)
    return np.where(number > 0, total / np.maximum(number, 1), np.nan)
