"""Contact pairs for large sliding: every function of the contactor has its multiplier, whether a target is opposite or not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy.sparse as sp

from abut.contact.coupling import CouplingOptions, couple, surface_degree
from abut.contact.geometry import facet_sizes, full_moments, side_normals
from abut.contact.pressure_space import only, pressure_space
from abut.contact.tangential import frames, quarter
from abut.errors import InputError
from abut.model import LAWS, METHODS, Contact, Model
from abut.problem.constraints import Supports
from abut.problem.contact_pairs import Pair, pair, reach_of, scales
from abut.problem.friction_rows import Slip
from abut.problem.held_multipliers import without_held

NON_NEGATIVE = ("P1", "P2")  # pressures whose functions are nowhere negative: part of one may be covered


def whole_pairs(model: Model, held: Supports) -> list[Pair]:
    """All contact pairs of a model with finite kinematics, at the outset. Ties stay what they are.

    Raises InputError for what goes with small displacements only."""
    return [
        pair(model, contact, held) if contact.kind == "tied" else whole_pair(model, contact, held)
        for contact in model.contacts
    ]


def whole_pair(model: Model, contact: Contact, held: Supports) -> Pair:
    """One pair: functions of the undeformed contactor, with their weights int H_k over all of it; rows as at the outset."""
    contactor, target = model.sides(contact)
    name = _pressure(contact, surface_degree(contactor))
    degree = int(name[1])
    options = CouplingOptions(contact.integration.rule, contact.integration.points, reach_of(held, contactor, target))
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
    return own if not contact.frictional else _with_tangents(own, held)


def _with_tangents(own: Pair, held: Supports) -> Pair:
    """The same with tractions beside the pressures, where supports let the contactor's node move along them."""
    dim, n, space = own.contactor.dim, len(own.space), own.space
    axes = [held.can_move(space.node, np.broadcast_to(np.eye(dim)[a], (n, dim))) for a in range(dim)]
    _, normals = side_normals(own.contactor)
    tangents, free = frames(-normals[space.side], np.stack(axes, axis=1))
    index, first = np.full((n, dim), -1), n
    index[:, 0] = np.arange(n)
    components = [space]
    for b in range(dim - 1):
        keep = free[:, b]
        components.append(only(space, keep))
        index[keep, 1 + b] = first + np.arange(int(keep.sum()))
        first += int(keep.sum())
    weight = np.concatenate([part.weight for part in components])
    turned = (own.coupling.operator @ quarter(len(own.contactor.points))).tocsr()
    rows = sp.vstack([own.rows, components[1].transfer.T @ turned]).tocsr()
    return replace(
        own, gap=np.concatenate([own.gap, np.zeros(first - n)]), scale=weight / own.stiffness, index=index, rows=rows,
        operator=(rows @ held.free).tocsr(), prescribed=rows @ held.prescribed, components=tuple(components),
        slip=Slip((), tangents),
    )  # fmt: skip


def _pressure(contact: Contact, highest: int) -> str:
    """The pressure's space. Raises InputError for what needs small displacements."""
    where, why = f"contact '{contact.name}'", 'goes with kinematics = "small" only; leave it out'
    if contact.method != METHODS[0]:
        raise InputError(f"{where}: method: {contact.method} {why}")
    if contact.law != LAWS[0]:
        raise InputError(f"{where}: law: {contact.law if isinstance(contact.law, str) else 'a law of your own'} {why}")
    if contact.adjust:
        raise InputError(f"{where}: adjust {why}, and close the gap in the mesh")
    name = f"P{highest}" if contact.pressure == "auto" else contact.pressure
    if name not in NON_NEGATIVE:
        raise InputError(f"{where}: pressure: {name} {why}, or choose P1 or P2, whose functions are nowhere negative")
    if int(name[1]) > highest:
        raise InputError(f"{where}: pressure: {name} needs quadratic facets; choose P1 or auto")
    return name
