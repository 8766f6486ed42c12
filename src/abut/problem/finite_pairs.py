"""Contact pairs for large sliding: every function of the contactor has its multiplier, with a target opposite or not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from abut.contact.coupling import CouplingOptions, couple
from abut.contact.function_places import places
from abut.contact.geometry import facet_products, facet_sizes, full_moments, nodal_normals
from abut.contact.pressure_space import DUAL, DUAL_P1, only, pressure_space, resolve
from abut.contact.tangential import frames, slip_operators
from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.model import Contact, Model
from abut.model.friction import friction_values
from abut.model.symmetry import held_directions
from abut.problem.constraints import Constraints
from abut.problem.contact_normals import moving_smoothing
from abut.problem.contact_pairs import pair, reach_of
from abut.problem.dual_functions import Mixture
from abut.problem.held_multipliers import held, without_held
from abut.problem.pair import Moving, Pair, Slip
from abut.problem.relative_motion import passing
from abut.problem.scales import scales


def finite_pairs(model: Model, constraints: Constraints) -> list[Pair]:
    """All contact pairs of a model with finite kinematics, at the outset. Ties stay what they are.

    Raises InputError for what goes with small displacements only."""
    made = [
        _tie(model, contact, constraints) if contact.kind == "tied" else finite_pair(model, contact, constraints)
        for contact in model.contacts
    ]
    return [replace(each, repeated=constraints.together(each.contactor.node_ids, model.dim)) for each in made]


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
    space = without_held(pressure_space(name, contactor, whole), contactor, whole, constraints)
    sizes, both = facet_sizes(contactor), scales(model, contactor, target)
    size, n = float(np.median(sizes)), len(space)
    seen = space if space.ordinary else Mixture.of(contactor, coupling, None).space(space)
    rows = (seen.transfer.T @ coupling.operator).tocsr()
    made = Pair(
        contact, contactor, target, coupling, space, rows, (rows @ constraints.free).tocsr(),
        prescribed=rows @ constraints.prescribed, gap=seen.transfer.T @ coupling.gap,
        scale=space.weight * size / both.young, size=size, stiffness=both.young / size,
        index=np.arange(n)[:, None], components=(space,), compliance=both.compliance,
        carried=held(space, contactor, constraints), moving=moving,
    )  # fmt: skip
    return made if not contact.frictional else _with_tangents(model, made, constraints)


def moving_normals(model: Model, contactor: Surface, target: Surface) -> Moving:
    """Of both sides at the outset. Raises InputError for a facet of the contactor without a normal."""
    planes = held_directions(model.mesh, model.supports)
    try:
        other = moving_smoothing(target, planes)
    except InputError:
        other = None
    return Moving(moving_smoothing(contactor, planes), other)


def _with_tangents(model: Model, whole: Pair, constraints: Constraints) -> Pair:
    """The same with tractions beside the pressures, where supports let either side move along them."""
    dim, n, space = whole.contactor.dim, len(whole.space), whole.space
    at = whole.coupling.points
    assert at is not None
    assert whole.moving is not None
    points, outward = places(whole.contactor, space, nodal_normals(whole.contactor, whole.moving.contactor))
    reach = reach_of(constraints, whole.contactor, whole.target)
    past = passing(whole.contactor, whole.target, space.node, -outward, reach, constraints)
    tangents, free = frames(-outward, past.moves)
    operators = slip_operators(at, whole.contactor.points)
    fields = [(space.transfer.T @ along).tocsr() for along in operators.along]
    index, first = np.full((n, dim), -1), n
    index[:, 0] = np.arange(n)
    components, rows, carried = [space], [whole.rows], [held(space, whole.contactor, constraints)]
    for b in range(dim - 1):
        keep = free[:, b]
        components.append(only(space, keep))
        carried.append(past.carried(tangents[:, b])[keep])
        parts = fields if dim == 2 else [sp.diags(tangents[:, b, a]) @ fields[a] for a in range(dim)]
        rows.append(sum(parts[1:], parts[0]).tocsr()[keep])
        index[keep, 1 + b] = first + np.arange(int(keep.sum()))
        first += int(keep.sum())
    weight = np.concatenate([part.weight for part in components])
    every = sp.vstack(rows).tocsr()
    return replace(
        whole, gap=np.concatenate([whole.gap, np.zeros(first - n)]), scale=weight / whole.stiffness, index=index, rows=every,
        operator=(every @ constraints.free).tocsr(), prescribed=every @ constraints.prescribed, components=tuple(components),
        coupling=replace(whole.coupling, points=None), slip=Slip(operators, tangents, points, -outward),
        values=friction_values(model, whole.contact, points), carried=np.concatenate(carried),
    )  # fmt: skip
