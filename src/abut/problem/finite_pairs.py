"""Contact pairs for large sliding: every function of the contactor has its multiplier, with a target opposite or not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.contact.coupling import CouplingOptions, couple
from abut.contact.flush_edges import second_order
from abut.contact.geometry import facet_products, facet_sizes, full_moments, nodal_normals
from abut.contact.glued_seams import along_seams
from abut.contact.pressure_space import DUAL, DUAL_P1, pressure_space, resolve
from abut.contact.rim import body_goes_on, rim
from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.model import Contact, Model
from abut.model.symmetry import held_directions
from abut.problem.constraints import Constraints
from abut.problem.contact_normals import moving_smoothing
from abut.problem.contact_pairs import glue, gone, pair, reach_of, with_friction
from abut.problem.dual_functions import Mixture
from abut.problem.held_multipliers import held, without_held
from abut.problem.pair import Moving, Pair
from abut.problem.scales import scales
from abut.problem.sector_sides import has_own_ends


def finite_pairs(model: Model, constraints: Constraints) -> list[Pair]:
    """All contact pairs of a model with finite kinematics, at the outset. Ties stay what they are.

    Raises InputError for what goes with small displacements only."""
    made = [
        _tie(model, contact, constraints) if contact.kind == "tied" else finite_pair(model, contact, constraints)
        for contact in model.contacts
    ]
    return [
        replace(each, repeated=constraints.together(each.contactor.node_ids, model.dim), gone=gone(model, each.contact))
        for each in made
    ]


def _tie(model: Model, contact: Contact, constraints: Constraints) -> Pair:
    made = pair(model, contact, constraints)
    return replace(made, moving=moving_normals(model, made.contactor, made.target))


def finite_pair(model: Model, contact: Contact, constraints: Constraints) -> Pair:
    """One pair: functions of the undeformed contactor, with their weights over all of it, theory (G3); rows as at the
    outset."""
    contactor, target = model.sides(contact)
    name, degree = resolve(contact.pressure, contactor, free_edge=contact.pressure != "auto")
    if contact.frictional and name == DUAL_P1:
        name = DUAL  # the law of friction looks at pressure and traction node by node
    rule, reach = contact.integration, reach_of(constraints, contactor, target)
    moving = moving_normals(model, contactor, target)
    options = CouplingOptions(
        rule.rule, rule.points, reach, keep_points=contact.frictional, target_across=moving.target
    )  # fmt: skip
    coupling = couple(contactor, target, degree, options, across=moving.contactor)
    whole = replace(coupling, weight=full_moments(contactor, degree).ravel(), mass=facet_products(contactor, degree))
    own = replace(contactor, turned=None) if has_own_ends(contact, contactor, True) else contactor
    space = along_seams(pressure_space(name, own, whole), contactor, whole, glue(model))
    space = without_held(space, contactor, whole, constraints)
    sizes, both = facet_sizes(contactor), scales(model, contactor, target)
    size, n = float(np.median(sizes)), len(space)
    if not space.ordinary:
        moving = replace(moving, ongoing=_ongoing(model, contactor))
    seen = space if space.ordinary else Mixture.of(contactor, coupling, None).space(space)
    rows = (seen.transfer.T @ coupling.operator).tocsr()
    made = Pair(
        contact, contactor, target, coupling, space, rows, (rows @ constraints.free).tocsr(),
        gap=seen.transfer.T @ coupling.gap,
        scale=space.weight * size / both.young, size=size, stiffness=both.young / size,
        index=np.arange(n)[:, None], components=(space,), compliance=both.compliance,
        carried=held(space, contactor, constraints), moving=moving,
    )  # fmt: skip
    if not contact.frictional:
        return made
    return with_friction(model, made, nodal_normals(contactor, moving.contactor), constraints)


def _ongoing(model: Model, contactor: Surface) -> NDArray[np.bool_]:
    """Of facets of second order, as in ``Moving``."""
    border = rim(contactor)
    return body_goes_on(model.mesh, contactor, border, second_order(contactor)[border.facet])


def moving_normals(model: Model, contactor: Surface, target: Surface) -> Moving:
    """Of both sides at the outset. Raises InputError for a facet of the contactor without a normal."""
    planes = held_directions(model.mesh, model.supports)
    try:
        other = moving_smoothing(target, planes)
    except InputError:
        other = None
    return Moving(moving_smoothing(contactor, planes), other)
