"""Nodal constraints and forces of a deck along the global axes: supports, equations and forces, with local axes
(*TRANSFORM), cyclic symmetry and nodes that belong to no element resolved."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.io.deck.equation_terms import along_axes, check
from abut.io.deck.groups import Groups
from abut.io.deck.passing_supports import Stay, check_passing, passing
from abut.io.deck.reasons import DeckError, Place
from abut.io.deck.record import CyclicSymmetry, Deck, Numbers, Transform
from abut.io.deck.sectors import partners
from abut.io.deck.thin_nodes import means, spread, straight, turns
from abut.io.deck.time_histories import Course, combine, courses, zero

Vector = NDArray[np.float64]
NOTHING: Course = ((0.0, 0.0),)
TINY = 1e-12  # of the largest coefficient: a term that is none

Point = tuple[int, int]  # node, axis 0..2
NO_DRILL = "has a moment about the normal of its shell, which nothing resists"


@dataclass(frozen=True)
class Bond:
    """A linear constraint: the sum of coefficient times displacement over (node, axis) follows ``course``. holds: the node
    of a shell, beam or truss that it supports, 0 for none."""

    terms: Mapping[Point, float]
    course: Course
    place: Place
    holds: int = 0


@dataclass(frozen=True)
class Held:
    """A node of shells, beams or trusses that is held: the solids' nodes over the thickness or in the section, and the
    course in each direction (0..5)."""

    nodes: tuple[int, ...]
    courses: tuple[tuple[int, Course], ...]


@dataclass(frozen=True)
class Bonds:
    """What holds and pushes the nodes of solids; held: the nodes of shells, beams and trusses that do so."""

    supports: Mapping[Point, Course]
    bonds: tuple[Bond, ...]
    forces: Mapping[Point, Course]
    passing: Mapping[Point, tuple[Stay, ...]]
    held: Mapping[int, Held]


def bonds(deck: Deck, groups: Groups, plane: str | None) -> Bonds:
    """Work everything out. Raises InputError for forces on nodes that nothing carries, and for what contradicts itself."""
    used = set(groups.used.tolist())
    apart = deck.references.union(found.pilot for found in deck.gathered)
    check(deck)
    axes = 2 if plane else 3
    stays = passing(deck)
    check_passing(deck, stays, {int(n) for t in deck.transforms for n in t.nodes}, used)
    lasting = {key: course for key, course in courses(deck, "boundary").items() if key not in stays}
    given = {(int(n), int(d) - 1): c for (n, d), c in lasting.items() if n not in apart}
    pushed = {(int(n), int(d) - 1): c for (n, d), c in courses(deck, "force").items() if n not in apart}
    named = {n for n, _ in (*given, *pushed)} | {n for e in deck.equations for n, _, _ in e.terms}
    local = _local_axes(deck, named)
    thin, given, pushed = _of_thin(deck, given, pushed, local, used)
    for point, course in given.items():
        if point[1] >= 3 and not zero(course):
            raise _nothing(
                deck, "boundary", point, f"cannot turn (direction {point[1] + 1}); only rigid bodies and couplings do"
            )
    supported = {point: course for point, course in given.items() if point[1] < 3}
    for point, course in pushed.items():
        if point[1] >= 3 and not zero(course):
            raise _nothing(
                deck,
                "force",
                point,
                f"carries no moment (direction {point[1] + 1}); only rigid bodies and couplings do",
            )
    pushed = {point: course for point, course in pushed.items() if point[1] < 3}
    supports, oblique = _supports(deck, {p: c for p, c in supported.items() if p[0] in used}, local, axes)
    forces = _spread({p: c for p, c in pushed.items() if p[0] in used}, local)
    own = {node: axes for node, axes in local.items() if node not in deck.thin or node in used}
    equations = [
        *thin.bonds,
        *(Bond(along_axes(e.terms, local, own, deck.thin), NOTHING, e.place) for e in deck.equations),
    ]
    for symmetry in deck.cyclic:
        equations += _cyclic(deck, groups, symmetry)
    virtual = _Virtual(
        {p: c for p, c in supported.items() if p[0] not in used}, {p: c for p, c in pushed.items() if p[0] not in used}
    )
    equations, more = _without_virtual(equations, virtual, used, deck)
    for point, course in (*more.items(), *thin.forces.items()):
        forces[point] = combine([(1.0, forces.get(point, NOTHING)), (1.0, course)])
    known = dict(supports)
    if plane == "axisymmetric":
        known |= dict.fromkeys(((n, 0) for n in _on_axis(deck, groups)), NOTHING)
    kept = [_reduced(bond, known, axes) for bond in (*oblique, *equations)]
    coming = {(int(n), int(d) - 1): each for (n, d), each in stays.items() if d <= axes}
    pushes = {p: c for p, c in forces.items() if p[1] < axes}
    return Bonds(supports, tuple(b for b in kept if b is not None), pushes, coming, _held(deck, lasting, used))


def _held(deck: Deck, lasting: Mapping[tuple[float, ...], Course], used: set[int]) -> dict[int, Held]:
    nodes = {node: each.own for node, each in deck.thin.items()}
    nodes |= {bound.reference: tuple(bound.nodes.tolist()) for bound in deck.couplings if bound.thin}
    result: dict[int, list[tuple[int, Course]]] = {}
    for (number, direction), course in lasting.items():
        node, axis = int(number), int(direction) - 1
        if node in nodes and (axis >= 3 or node not in used):  # nodes of solids have supports of their own
            result.setdefault(node, []).append((axis, course))
    return {node: Held(nodes[node], tuple(sorted(each))) for node, each in result.items()}


@dataclass(frozen=True)
class _Virtual:
    """Supports and forces at nodes of no element."""

    supported: Mapping[Point, Course]
    pushed: Mapping[Point, Course]


@dataclass(frozen=True)
class _OfThin:
    """What is said of nodes of shells, of the nodes that stand for them."""

    bonds: tuple[Bond, ...]
    forces: Mapping[Point, Course]


def _of_thin(
    deck: Deck, given: dict[Point, Course], pushed: dict[Point, Course], local: Mapping[int, Vector], used: set[int]
) -> tuple[_OfThin, dict[Point, Course], dict[Point, Course]]:
    """What nodes of shells become, and what is left of supports and forces. Nodes that are held, in equations, or shared
    with solids keep their displacement as an unknown."""
    if not deck.thin:
        return _OfThin((), {}), given, pushed
    turned = {point: c for point, c in given.items() if point[0] in deck.thin and point[1] >= 3}
    bonds = [
        Bond(terms, course, _place(deck, "boundary", (node, 0)), node)
        for node, (terms, course) in turns(deck.thin, turned, local)
    ]
    kept = {point: c for point, c in given.items() if point not in turned}
    holds = {point: point[0] for point in kept if point[0] in deck.thin and point[0] not in used}
    places = {node: e.place for e in deck.equations for node, _, _ in e.terms if node in deck.thin}
    others = {(node, axis): 0 for node in {*places, *(used & deck.thin.keys())} for axis in range(3)}
    known = others | holds
    own = {node: axes for node, axes in local.items() if node not in used}
    place = deck.blocks[0].place
    for point, node in known.items():
        at = places.get(point[0], place)
        bonds += [Bond(terms, NOTHING, at, node) for terms in means(deck.thin, [point], own)]
        bonds += [Bond(terms, NOTHING, at, node) for terms in straight(deck.thin, [point], own)]
    pushes = {point: c for point, c in pushed.items() if point[0] in deck.thin and not zero(c)}
    direct = {point: c for point, c in pushes.items() if known.get(point, point[0])}
    loaded = [point for point in direct if point[1] < 3 and point not in known]
    bonds += [Bond(terms, NOTHING, place) for terms in straight(deck.thin, loaded, local)]
    try:
        forces = spread(deck.thin, direct, local)
    except ValueError as error:
        raise _nothing(deck, "force", error.args, NO_DRILL) from None
    rest = {
        point: c for point, c in pushed.items() if point not in direct and (point[0] not in deck.thin or point[1] < 3)
    }
    return _OfThin(tuple(bonds), forces), kept, rest


def _on_axis(deck: Deck, groups: Groups) -> list[int]:
    size = float(np.ptp(deck.points, axis=0).max())
    return np.intersect1d(deck.nodes[deck.points[:, 0] <= 1e-9 * size], groups.used).tolist()


def coordinates(deck: Deck, nodes: Numbers) -> Vector:
    """Coordinates (n, 3) of nodes by number."""
    return np.asarray(deck.points[np.searchsorted(deck.nodes, nodes)])


def _local_axes(deck: Deck, named: set[int]) -> dict[int, Vector]:
    """Node -> its own axes as rows (3, 3), for those that something is said of."""
    result: dict[int, Vector] = {}
    for transform in deck.transforms:
        nodes = np.intersect1d(np.intersect1d(transform.nodes, deck.nodes), np.array(sorted(named), np.int64))
        for node, x in zip(nodes.tolist(), coordinates(deck, nodes)):
            result[node] = _axes(transform, x)
    return result


def _axes(transform: Transform, x: Vector) -> Vector:
    """Rows (3, 3) at a point; on the axis of a cylindrical one the radial direction is the one that CalculiX takes."""
    a, b = np.array(transform.a), np.array(transform.b)
    first, third = (a, np.cross(a, b)) if transform.kind == "R" else (x - a, b - a)
    if not third.any():
        raise DeckError(
            transform.place,
            "*TRANSFORM: no axes follow from two points that are one, or (TYPE=R) in one direction from the origin",
        )
    if transform.kind != "R":
        first = first - first @ third / (third @ third) * third
        if np.linalg.norm(first) <= 1e-9 * np.abs(x - a).max():
            first = _across(third)
    first, third = first / np.linalg.norm(first), third / np.linalg.norm(third)
    return _clean(np.stack([first, np.cross(third, first), third]))


def _across(along: Vector) -> Vector:
    """A direction at right angles to one, in the plane of x and y, of y and z, or along x, the first that there is."""
    x, y, z = along / np.linalg.norm(along)
    if abs(x) > 1e-10:
        return np.array([-y / x, 1.0, 0.0])
    return np.array([0.0, -z / y, 1.0]) if abs(y) > 1e-10 else np.array([1.0, 0.0, 0.0])


def _clean(rows: Vector) -> Vector:
    """Components at rounding level made zero."""
    return np.asarray(np.where(np.abs(rows) < TINY, 0.0, rows))


def _supports(
    deck: Deck, supported: Mapping[Point, Course], local: Mapping[int, Vector], axes: int
) -> tuple[dict[Point, Course], list[Bond]]:
    """Supports along the global axes, and equations for those across."""
    supports: dict[Point, Course] = {}
    oblique: list[Bond] = []
    by_node: dict[int, dict[int, Course]] = {}
    for (node, direction), course in supported.items():
        by_node.setdefault(node, {})[direction] = course
    for node, histories in by_node.items():
        if node not in local:
            supports |= {(node, d): c for d, c in histories.items() if d < axes}
            continue
        rows = local[node]
        if len(histories) == 3:
            supports |= {
                (node, k): combine([(float(rows[d, k]), c) for d, c in histories.items()]) for k in range(axes)
            }
            continue
        for d, course in histories.items():
            along = np.flatnonzero(rows[d])
            if len(along) == 1:
                k = int(along[0])
                if k < axes:
                    supports[node, k] = combine([(float(rows[d, k]), course)])
                continue
            oblique.append(
                Bond({(node, int(k)): float(rows[d, k]) for k in along}, course, _place(deck, "boundary", (node, 0)))
            )
    return supports, oblique


def _spread(pushed: Mapping[Point, Course], local: Mapping[int, Vector]) -> dict[Point, Course]:
    """Forces along the global axes."""
    parts: dict[Point, list[tuple[float, Course]]] = {}
    for (node, direction), course in pushed.items():
        row = local[node][direction] if node in local else np.eye(3)[direction]
        for k in np.flatnonzero(row).tolist():
            parts.setdefault((node, k), []).append((float(row[k]), course))
    return {point: combine(terms) for point, terms in parts.items()}


def _cyclic(deck: Deck, groups: Groups, symmetry: CyclicSymmetry) -> list[Bond]:
    """The displacement of every slave node is that of its master node, turned by one sector."""
    result, found = [], partners(deck, groups, symmetry)
    for slave, master in zip(found.slaves.tolist(), found.masters.tolist()):
        for k in range(3):
            terms = {(slave, k): 1.0}
            for j in range(3):
                terms[master, j] = terms.get((master, j), 0.0) - float(found.turn[k, j])
            result.append(Bond(terms, NOTHING, symmetry.place))
    return result


def _without_virtual(
    equations: list[Bond], virtual: _Virtual, used: set[int], deck: Deck
) -> tuple[list[Bond], dict[Point, Course]]:
    """Equations without nodes of no element, and the nodal forces that do the same work as the forces there.

    Held: the known displacement goes to the right-hand side; of nodes of shells, once others have in their place what they
    stand for, so that these pull at it and its support holds that. Free: one equation says what the displacement is; it
    goes from the others, and a force F on it pushes the other terms c_i of that equation with -F c_i / c."""
    pushed: dict[Point, Course] = {}
    bound = {point for bond in equations for point in bond.terms}
    held = {point: bond for bond in equations if bond.holds for point in bond.terms if point in virtual.supported}
    equations = [bond if bond.holds else _put_in(bond, held) for bond in equations]
    equations = [_reduced_by(bond, virtual.supported) for bond in equations]
    for point in sorted(p for p in bound if p[0] not in used and p not in virtual.supported):
        having = [i for i, bond in enumerate(equations) if abs(bond.terms.get(point, 0.0)) > 0.0]
        if not having:
            continue
        pivot = equations[having[0]]
        c = pivot.terms[point]
        for i in having[1:]:
            equations[i] = _put_in(equations[i], {point: pivot})
        force = virtual.pushed.get(point)
        if force is not None:
            for other, value in pivot.terms.items():
                if other != point:
                    pushed[other] = combine([(1.0, pushed.get(other, NOTHING)), (-value / c, force)])
        del equations[having[0]]
    for kind, given, what in (
        ("force", virtual.pushed, "carries its force"),
        ("boundary", virtual.supported, "follows it"),
    ):
        for point, course in given.items():
            if (
                point not in bound
                and not zero(course)
                and not (kind == "boundary" and _among_others(deck, point, used))
            ):
                raise _nothing(
                    deck, kind, point, f"belongs to no element and no equation in this direction; nothing {what}"
                )
    return equations, pushed


def _put_in(bond: Bond, known: Mapping[Point, Bond]) -> Bond:
    """A constraint with what others say of points in their place."""
    for point in [point for point in bond.terms if point in known]:
        by = known[point]
        share = bond.terms[point] / by.terms[point]
        terms = dict(bond.terms)
        for other, value in by.terms.items():
            terms[other] = terms.get(other, 0.0) - share * value
        terms.pop(point)
        bond = replace(bond, terms=terms, course=combine([(1.0, bond.course), (-share, by.course)]))
    return bond


def _among_others(deck: Deck, point: Point, used: set[int]) -> bool:
    """Whether the lines that move a node of no element have other nodes, which do belong to some: it is left in a set."""
    node, axis = point
    every = [*deck.fixed, *(value for step in deck.steps for value in step.values)]
    mine = [v for v in every if v.kind == "boundary" and axis + 1 in v.directions and node in v.numbers]
    return all(not used.isdisjoint(value.numbers.tolist()) for value in mine)


def _place(deck: Deck, kind: str, point: Point, moving: bool = False) -> Place:
    """Of the first line that gives a node a value; ``moving``: one in the point's direction that is not zero."""
    every = [*deck.fixed, *(value for step in deck.steps for value in step.values)]
    return next(
        v.place
        for v in every
        if v.kind == kind and point[0] in v.numbers and (not moving or (point[1] + 1 in v.directions and v.value))
    )


def _nothing(deck: Deck, kind: str, point: Point, why: str) -> DeckError:
    """The error of a value that would have no effect, with the card and line that give it."""
    card = "*CLOAD" if kind == "force" else "*BOUNDARY"
    return DeckError(
        _place(deck, kind, point, moving=True),
        f"{card}: node {point[0]} {why}; take the line out, or bind the node (*RIGID BODY, *COUPLING, *EQUATION)",
    )


def _reduced_by(bond: Bond, known: Mapping[Point, Course]) -> Bond:
    """Terms with known displacement on the right-hand side."""
    moved = {point: c for point, c in bond.terms.items() if point in known}
    if not moved:
        return bond
    course = combine([(1.0, bond.course), *((-c, known[point]) for point, c in moved.items())])
    return replace(bond, terms={p: c for p, c in bond.terms.items() if p not in known}, course=course)


def _reduced(bond: Bond, known: Mapping[Point, Course], axes: int) -> Bond | None:
    """Without terms that are known or out of the plane; None where nothing is left."""
    size = max((abs(c) for c in bond.terms.values()), default=0.0)
    bond = _reduced_by(bond, known)
    terms = {p: c for p, c in bond.terms.items() if abs(c) > TINY * size and p[1] < axes}
    if terms:
        return replace(bond, terms=terms)
    if max(abs(v) for _, v in bond.course) > TINY * max(size, max(abs(v) for c in known.values() for _, v in c)):
        raise DeckError(bond.place, "the equation contradicts the supports of its nodes; take one of them out")
    return None
