"""Contact pairs for large sliding: every function of the contactor has its multiplier, with a target opposite or not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from abut.contact.coupling import CouplingOptions, couple, surface_degree
from abut.contact.function_places import places
from abut.contact.geometry import facet_sizes, full_moments
from abut.contact.pressure_space import only, pressure_space
from abut.contact.tangential import frames, slip_operators
from abut.errors import InputError
from abut.model import Contact, Model
from abut.model.friction import friction_values
from abut.problem.constraints import Supports
from abut.problem.contact_pairs import Pair, pair, reach_of
from abut.problem.friction_rows import Slip
from abut.problem.held_multipliers import without_held
from abut.problem.scales import scales


def whole_pairs(model: Model, held: Supports) -> list[Pair]:
    """All contact pairs of a model with finite kinematics, at the outset. Ties stay what they are.

    Raises InputError for what goes with small displacements only."""
    return [
        pair(model, contact, held) if contact.kind == "tied" else whole_pair(model, contact, held)
        for contact in model.contacts
    ]


def whole_pair(model: Model, contact: Contact, held: Supports) -> Pair:
    """One pair: functions of the undeformed contactor, with their weights over all of it, theory (G3); rows as at the
    outset."""
    contactor, target = model.sides(contact)
    name = _pressure(contact, surface_degree(contactor))
    degree = int(name[1])
    rule, reach = contact.integration, reach_of(held, contactor, target)
    options = CouplingOptions(rule.rule, rule.points, reach, keep_points=contact.frictional)
    coupling = couple(contactor, target, degree, options)
    whole = replace(coupling, weight=full_moments(contactor, degree).ravel())
    space = without_held(pressure_space(name, contactor, whole), contactor, whole, held)
    sizes, both = facet_sizes(contactor), scales(model, contactor, target)
    size, n = float(np.median(sizes)), len(space)
    rows = (space.transfer.T @ coupling.operator).tocsr()
    own = Pair(
        contact, contactor, target, coupling, space, rows, (rows @ held.free).tocsr(), prescribed=rows @ held.prescribed,
        gap=space.transfer.T @ coupling.gap, scale=space.weight * size / both.young, size=size,
        stiffness=both.young / size, index=np.arange(n)[:, None], components=(space,), compliance=both.compliance,
    )  # fmt: skip
    return own if not contact.frictional else _with_tangents(model, own, held)


def _with_tangents(model: Model, own: Pair, held: Supports) -> Pair:
    """The same with tractions beside the pressures, where supports let the contactor's node move along them."""
    dim, n, space = own.contactor.dim, len(own.space), own.space
    at = own.coupling.points
    assert at is not None
    points, outward = places(own.contactor, space)
    axes = [held.can_move(space.node, np.broadcast_to(np.eye(dim)[a], (n, dim))) for a in range(dim)]
    tangents, free = frames(-outward, np.stack(axes, axis=1))
    operators = slip_operators(at, own.contactor.points)
    fields = [(space.transfer.T @ along).tocsr() for along in operators.along]
    index, first = np.full((n, dim), -1), n
    index[:, 0] = np.arange(n)
    components, rows = [space], [own.rows]
    for b in range(dim - 1):
        keep = free[:, b]
        components.append(only(space, keep))
        parts = fields if dim == 2 else [sp.diags(tangents[:, b, a]) @ fields[a] for a in range(dim)]
        rows.append(sum(parts[1:], parts[0]).tocsr()[keep])
        index[keep, 1 + b] = first + np.arange(int(keep.sum()))
        first += int(keep.sum())
    weight = np.concatenate([part.weight for part in components])
    every = sp.vstack(rows).tocsr()
    return replace(
        own, gap=np.concatenate([own.gap, np.zeros(first - n)]), scale=weight / own.stiffness, index=index, rows=every,
        operator=(every @ held.free).tocsr(), prescribed=every @ held.prescribed, components=tuple(components),
        coupling=replace(own.coupling, points=None), slip=Slip(operators, tangents, points, -outward),
        values=friction_values(model, own.contact, points),
    )  # fmt: skip


def _pressure(contact: Contact, highest: int) -> str:
    """The pressure's space. Raises InputError for quadratic pressure on linear facets."""
    name = f"P{highest}" if contact.pressure == "auto" else contact.pressure
    if int(name[1]) > highest:
        raise InputError(f"contact '{contact.name}': pressure: {name} needs quadratic facets; choose P1 or auto")
    return name
