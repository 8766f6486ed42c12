"""Check of the choice of contactor, by the rule of ``abut.contact.contactor_choice``, as for ``auto = true``."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.contact.contactor_choice import Choice, Side, choose, much_finer, side
from abut.contact.coupling import CouplingOptions, couple, default_reach
from abut.contact.geometry import area_vectors, facet_sizes, full_moments, mean_normals, straight
from abut.contact.sides import code, words
from abut.detection.opposing_facets import NEAR
from abut.diagnosis.finding import Finding
from abut.errors import InputError
from abut.materials.softest import contact_modulus, softest
from abut.mesh.surface import Surface
from abut.model import Contact, Model

CURES = {
    "softer": "swap contactor and target: the softer side should carry the pressure",
    "covered": "swap contactor and target, or end the facets of the contactor where the target ends",
    "kinks": "refine the target, or swap the sides",
    "finer": "swap the sides for a finer pressure, or refine the contactor",
}


def sides(model: Model, contact: Contact) -> list[Finding]:
    """Advice to swap the sides, or to refine one of them, where the pressure would gain by it."""
    where = f"contact '{contact.name}'"
    first, other = measured(model, contact)
    moduli = f"E/(1-nu^2) {first.modulus:.3g} (contactor) and {other.modulus:.3g}"
    summary = f"{moduli}, facets {first.size:.3g} and {other.size:.3g}"
    choice = choose(first, other)
    if choice.clear and choice.contactor == 1 and swap(model, contact, choice):
        what = f"contactor {words(contact.contactor)} {_against(choice, first, other)} ({summary})"
        return [Finding("advice", where, what, CURES[choice.rule])]
    if much_finer(first, other):
        what = (
            f"contactor {words(contact.contactor)} {_against(replace(choice, rule='kinks'), first, other)} ({summary})"
        )
        return [Finding("advice", where, what, "refine the target")]
    return [Finding("info", where, summary)]


def measured(model: Model, contact: Contact) -> tuple[Side, Side]:
    """Contactor and target as the choice sees them: facets within reach of each other, or, where none are so near, of the
    contact's own reach."""
    both = model.sides(contact)
    moduli = [contact_modulus(softest(model.mesh, model.materials, surface.cells)) for surface in both]
    flat = [straight(replace(surface, axisymmetric=False)) for surface in both]
    contactor, target = flat
    sizes = [facet_sizes(surface) for surface in flat]
    options = CouplingOptions(points=1, reach=default_reach(contactor, target), keep_points=True)
    at = couple(contactor, target, 0, options).points
    if at is None or not len(at.gap):
        facing, opposite = [np.arange(len(surface)) for surface in flat], np.inf
    else:
        near = np.abs(at.gap) <= NEAR * (sizes[0][at.facet] + sizes[1][at.target_facet])
        near |= not near.any()
        facing = [np.unique(at.facet[near]), np.unique(at.target_facet[near])]
        opposite = float(at.weight[near].sum())
    one, other = (
        side(size[f], full_moments(surface, 0)[f, 0], _normals(surface)[f], opposite, modulus)
        for surface, size, f, modulus in zip(flat, sizes, facing, moduli)
    )
    return one, other


def _normals(surface: Surface) -> NDArray[np.float64]:
    """One for each facet, (n_facets, dim); of each by itself where one has no area, so that its nodes have no normals."""
    try:
        return mean_normals(surface)
    except InputError:
        normal = area_vectors(surface).sum(axis=1)
    return np.asarray(normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300))


def swap(model: Model, contact: Contact, choice: Choice | None = None) -> str:
    """To swap the sides of a contact, in words; empty where the present contactor is clearly the right one, and where the
    model would be refused, or the same."""
    if contact.contactor == contact.target:
        return ""
    choice = choice or choose(*measured(model, contact))
    if choice.clear and choice.contactor == 0:
        return ""
    other = replace(contact, contactor=contact.target, target=contact.contactor)
    try:
        replace(model, contacts=[other if each is contact else each for each in model.contacts])
    except InputError:
        return ""
    return f"swap the sides (contactor = {code(contact.target)}, target = {code(contact.contactor)})"


def _against(choice: Choice, side: Side, other: Side) -> str:
    """What speaks against the contactor, after its name."""
    return {
        "softer": "is the stiffer side",
        "covered": f"has only {side.covered:.0%} of the area of its facets opposite the target, {other.covered:.0%} the "
        "other way round",
        "kinks": f"is {other.size / side.size:.2g} times finer than its curved target, whose faceting its pressure will "
        "show",
        "finer": f"is {side.size / other.size:.2g} times coarser than its target",
    }[choice.rule]
