"""A contact pair, discretised: operators on the free displacements, weighted gaps, scales."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.bodies.mirror import mirrors
from abut.cells import CELLS
from abut.contact.coupling import Couple, Coupling, couple, default_reach
from abut.contact.flush_edges import FlushEdges, second_order
from abut.contact.geometry import beside_others, facet_sizes, full_moments
from abut.contact.glued_seams import Glue, along_seams, one_place
from abut.contact.pressure_space import (
    DUAL_P1,
    PressureSpace,
    inner_facets,
    reduce,
    with_plain_facets,
)
from abut.contact.rim import Rim, body_goes_on, ends_on_target, goes_on, rim, rim_of_sides
from abut.contact.self_contact import lies_deep, with_kin
from abut.contact.shared_points import Functions, functions, one_each
from abut.contact.sides import Sides
from abut.contact.symmetry_planes import STRAIGHT, Planes, planes
from abut.contact.tangential import SlipOperators, slip_operators
from abut.mesh.surface import Surface
from abut.model import METHODS, Contact, Model
from abut.model.contact import SECOND
from abut.model.friction import friction_values
from abut.model.offset import offsets
from abut.model.symmetry import held_directions
from abut.problem.constraints import Constraints
from abut.problem.contact_normals import contact_normals
from abut.problem.coupled_surfaces import coupled
from abut.problem.friction_rows import Sides as FrictionSides
from abut.problem.friction_rows import friction_rows
from abut.problem.held_multipliers import HELD, NO_EFFECT, held, row_norms, without_held
from abut.problem.pair import WHOLE, Pair, PairPoints
from abut.problem.repeated_rows import repeats
from abut.problem.scales import scales
from abut.problem.tied_rows import tied_rows
from abut.types import Array

SQUARE = (
    0.9  # share of what is square to the contactor's rim held by supports: a plane of symmetry, up to 18 degrees off
)
SHARPNESS = (  # theory (L8)
    30.0  # c h / E of the constraint function: with 1 the pressure rings at the edge of contact, above 100 Newton does
)
STILL = 1e-9  # of the largest displacement prescribed: a plane that is moved or bent does not mirror
TRIANGLES = [CELLS[kind].code for kind in ("tri3", "tri6")]


def pairs(model: Model, constraints: Constraints, couple: Couple = couple) -> list[Pair]:
    """All contact pairs of a model. Two-pass node-to-segment makes two of one contact, each side as contactor once.
    couple: cuts and integrates, as ``abut.contact.coupling.couple``.

    Raises InputError where two surfaces do not face each other."""
    result = []
    for contact in model.contacts:
        sides = model.sides(contact)
        result.append(pair(model, contact, constraints, couple, sides))
        if contact.method == "node-to-segment-two-pass":
            back = replace(contact, contactor=contact.target, target=contact.contactor, name=contact.name + SECOND)
            result.append(pair(model, back, constraints, couple, (sides[1], sides[0])))
    if len(result) > 1 or any(each.contactor.parts is not None for each in result):
        place = one_place(model.mesh.points, glue(model))
        times = [each.contact.times for each in result]
        kept = one_each([_shared(each, place) for each in result], lambda i, j: times[i].meets(times[j]))
        result = [
            each if keep is None else _in_space(model, each, reduce(each.space, each.coupling, keep), constraints)
            for each, keep in zip(result, kept)
        ]
    tied_together = bool(model.equations or model.rigid or model.couplings)
    result = [replace(p, gone=gone(model, p.contact)) for p in result]
    return [replace(p, repeated=True) if tied_together and repeats(p.operator) else p for p in result]


def gone(model: Model, contact: Contact) -> int | None:
    """As in ``Pair``."""
    return None if contact.times.always else model.histories.index(model.opened[contact.name])


def glue(model: Model) -> list[Glue]:
    """Points of the sides of all ties that hold all the time."""
    ties = [model.sides(contact) for contact in model.contacts if contact.kind == "tied" and contact.times.always]
    return [(contactor.node_ids, target.node_ids) for contactor, target in ties]


def _shared(contact_pair: Pair, place: NDArray[np.int64]) -> Functions | None:
    """What others at the same points need to know of a pair's multipliers; nothing of ties and methods for comparison.
    place: of every point, the one that stands for it and those glued to it."""
    if contact_pair.tied or contact_pair.contact.method != METHODS[0] or not contact_pair.space.continuous:
        return None
    found = functions(contact_pair.space, contact_pair.contactor, contact_pair.coupling)
    return replace(found, node=place[found.node])


def pair(
    model: Model, contact: Contact, constraints: Constraints, couple: Couple = couple, sides: Sides | None = None
) -> Pair:
    """Cut, integrate and reduce one contact pair; sides: the model's own where left out. Raises InputError where the
    surfaces do not face each other."""
    contactor, target = model.sides(contact) if sides is None else sides
    tied = contact.kind == "tied"
    reach = reach_of(constraints, contactor, target)
    both = scales(model, contactor, target)
    seen = not tied and contact.method == METHODS[0]
    normals = contact_normals(model, contactor, target, both.share, reach, couple) if seen else None
    contactor, coupling, space = coupled(contact, contactor, target, reach, couple, normals)
    if contactor.kin is None and not (tied or model.finite) and lies_deep(contactor, target, coupling.gap_samples):
        return pair(model, contact, constraints, couple, with_kin(model.mesh, *(sides or model.sides(contact)), True))
    sizes = facet_sizes(contactor)
    size, stiffness = float(np.median(sizes)), both.young / float(np.median(sizes))
    if tied:
        tie = tied_rows(contactor, coupling, space, constraints)
        return Pair(
            contact, contactor, target, coupling, space, tie.rows, tie.free,
            gap=np.zeros(len(tie.weight)), scale=tie.weight / stiffness,
            size=size, stiffness=stiffness, index=tie.index, components=tie.components, compliance=both.compliance,
        )  # fmt: skip
    space = without_held(along_seams(space, contactor, coupling, glue(model)), contactor, coupling, constraints)
    rows = (space.transfer.T @ coupling.operator).tocsr()
    free = (rows @ constraints.free).tocsr()
    moved = row_norms(free) > NO_EFFECT * space.weight
    if not moved.all():
        space = reduce(space, coupling, moved)
        rows = (space.transfer.T @ coupling.operator).tocsr()
        free = (rows @ constraints.free).tocsr()
    constant, varying = offsets(model, contact)
    border = rim(contactor)
    beyond, sides_end = goes_on(contactor, border, target, reach), rim_of_sides(contactor)
    interior = _interior(contactor, coupling, border, beyond) if space.name == DUAL_P1 else None
    flush = None
    if not (space.ordinary or model.finite):
        smooth = body_goes_on(model.mesh, contactor, border, beyond & second_order(contactor)[border.facet])
        flush = FlushEdges.of(contactor, border, beyond, smooth)
    planes = planes_of(model, contactor, sides_end, goes_on(contactor, sides_end, target, reach), constraints)
    own_pair = Pair(
        contact, contactor, target, coupling, space, rows, free,
        gap=space.transfer.T @ coupling.gap,
        scale=space.weight / stiffness, size=size, stiffness=stiffness, index=np.arange(len(space))[:, None],
        components=(space,), compliance=both.compliance, carried=held(space, contactor, constraints),
        points=None if contact.frictional else _points(coupling, space, constraints, both.young / sizes, constant, varying),
        interior=interior, flush=flush, planes=planes,
    )  # fmt: skip
    if not contact.frictional:
        return own_pair
    assert normals is not None
    return with_friction(model, own_pair, normals, constraints)


def with_friction(model: Model, normal_pair: Pair, normals: Array, constraints: Constraints) -> Pair:
    """A pair that has pressures alone, with the multipliers of friction beside them. Its integration points go."""
    coupling = normal_pair.coupling
    assert coupling.points is not None
    slim = replace(normal_pair, coupling=replace(coupling, points=None))
    return _with_tractions(
        model, slim, slip_operators(coupling.points, normal_pair.contactor.points), normals, constraints
    )


def _with_tractions(
    model: Model, normal_pair: Pair, operators: SlipOperators, normals: Array, constraints: Constraints
) -> Pair:
    """The same with slips by ``operators``."""
    contactor, target = normal_pair.contactor, normal_pair.target
    reach, move = reach_of(constraints, contactor, target), normal_pair.moving is not None
    sides = FrictionSides(contactor, target, normals, reach, move)
    made = friction_rows(sides, normal_pair.space, normal_pair.rows, operators, constraints)
    more = made.rows.shape[0] - len(normal_pair.space)
    weight = np.concatenate([space.weight for space in made.components])
    return replace(
        normal_pair, rows=made.rows, operator=(made.rows @ constraints.free).tocsr(),
        gap=np.concatenate([normal_pair.gap, np.zeros(more)]), scale=weight / normal_pair.stiffness, index=made.index,
        components=made.components, slip=made.slip, points=None,
        carried=np.concatenate([_carried(normal_pair), made.carried]),
        values=friction_values(model, normal_pair.contact, made.slip.points),
    )  # fmt: skip


def _carried(pair: Pair) -> NDArray[np.bool_]:
    return np.zeros(len(pair), dtype=bool) if pair.carried is None else pair.carried


def _interior(contactor: Surface, coupling: Coupling, border: Rim, beyond: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Facets (n_facets,) that are covered all over, at no edge of the contactor on the target and of no target beside
    another."""
    share = coupling.covered / full_moments(contactor, 0)[:, 0]
    edge = ends_on_target(contactor, border, beyond) | beside_others(contactor)
    return np.asarray((np.abs(share - 1.0) < WHOLE) & ~edge)


def planes_of(
    model: Model, contactor: Surface, border: Rim, beyond: NDArray[np.bool_], constraints: Constraints
) -> Planes:
    """Where a contactor's smooth sides end at planes of symmetry: supports hold what is square to their rim, where it is,
    but not their normal, and the target ends there too. A body's whole outside goes on there, round an edge. border: of the
    sides; beyond: (m,) where the target goes on."""
    mirrored = ~beyond
    out = border.out / np.linalg.norm(border.out, axis=1, keepdims=True)
    for end in border.ends.T:
        mirrored &= constraints.held_share(end, out) > SQUARE
        mirrored &= constraints.held_share(end, border.normal) < HELD
        moved = constraints.prescribed.reshape(-1, contactor.dim, constraints.prescribed.shape[1])[end]
        mirrored &= np.abs(np.einsum("md,mdh->mh", out, moved)).max(axis=1, initial=0.0) <= STILL * constraints.largest
    mesh, at = model.mesh, np.flatnonzero(mirrored)
    cells = contactor.cells[border.facet[at]]
    mirrored[at] = mirrors(model.deformable, cells, mesh.points[border.ends[at, 0]], out[at])
    corners = np.concatenate([np.full(len(block.nodes), CELLS[block.kind].corners) for block in mesh.blocks])
    uneven = corners[contactor.cells] == 3 if contactor.dim == 2 else np.isin(contactor.kinds, TRIANGLES)
    return planes(contactor, _square_to_planes(model, border), mirrored, uneven)


def _square_to_planes(model: Model, border: Rim) -> Rim:
    """The rim with directions out of it in which supports hold its ends, where one is near: facets of a round surface lean
    out of a plane by a part of their turn."""
    found = held_directions(model.mesh, model.supports)
    if found is None:
        return border
    out = border.out / np.linalg.norm(border.out, axis=1, keepdims=True)
    number, direction = found.at(border.ends[:, 0])
    along = (out[number] * direction).sum(axis=1)
    order = np.argsort(np.abs(along), kind="stable")  # the nearest is written last
    order = order[np.abs(along[order]) > STRAIGHT]
    out[number[order]] = (np.sign(along)[:, None] * direction)[order]
    return replace(border, out=out)


def with_plain_functions(model: Model, earlier: Pair, constraints: Constraints, active: NDArray[np.bool_]) -> Pair:
    """A pair of dual functions with the ordinary ones at edges where both sides end, theory (P26), and one of the space
    "dual-P1" with them well inside closed contact; any other as it is.

    active: (n,) bool, the multipliers in contact."""
    inner, closed = np.zeros(len(earlier.contactor), dtype=bool), active[earlier.normal]
    if earlier.interior is not None:
        inner = inner_facets(earlier.space, earlier.contactor, earlier.interior, closed)
    if earlier.flush is not None:
        inner = inner | earlier.flush.facets(earlier.space, closed)
    if not inner.any():
        return earlier
    return _in_space(
        model, earlier, with_plain_facets(earlier.space, earlier.contactor, earlier.coupling, inner), constraints
    )


def _in_space(model: Model, earlier: Pair, space: PressureSpace, constraints: Constraints) -> Pair:
    """A pair, not tied, with another space."""
    rows = (space.transfer.T @ earlier.coupling.operator).tocsr()
    points, at = earlier.points, earlier.coupling.points
    if points is not None and at is not None:
        points = replace(points, test=(at.pressure @ space.transfer).tocsr())
    changed = replace(
        earlier, space=space, components=(space,), index=np.arange(len(space))[:, None], rows=rows,
        operator=(rows @ constraints.free).tocsr(), points=points,
        gap=space.transfer.T @ earlier.coupling.gap, scale=space.weight / earlier.stiffness,
        carried=held(space, earlier.contactor, constraints),
    )  # fmt: skip
    if earlier.slip is None:
        return changed
    return _with_tractions(model, changed, earlier.slip.operators, earlier.slip.at_facets, constraints)


def _points(
    coupling: Coupling, space: PressureSpace, constraints: Constraints, stiffness: NDArray[np.float64],
    constant: float, varying: NDArray[np.float64],
) -> PairPoints | None:  # fmt: skip
    if coupling.points is None:
        return None
    at = coupling.points
    return PairPoints(
        test=(at.pressure @ space.transfer).tocsr(), weight=at.weight, stiffness=SHARPNESS * stiffness[at.facet],
        gap=at.gap + constant, operator=(at.gap_operator @ constraints.free).tocsr(),
        prescribed=at.gap_operator @ constraints.prescribed + varying,
    )  # fmt: skip


def reach_of(constraints: Constraints, contactor: Surface, target: Surface) -> float:
    """How far apart the surfaces may lie at the outset and still be paired, a length."""
    return default_reach(contactor, target) + 2.0 * constraints.largest
