"""Couplings of a deck, and what is prescribed at the reference nodes of couplings and rigid bodies."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from abut.decks.elastic import local_axes
from abut.io.deck.faces import connectivity
from abut.io.deck.groups import Groups
from abut.io.deck.nodal_constraints import coordinates
from abut.io.deck.reasons import DeckError, Place
from abut.io.deck.record import Coupling as Bound
from abut.io.deck.record import Deck, Numbers, Prescribed
from abut.io.deck.time_histories import Course, courses, scaled, zero
from abut.model import Amplitude, Coupling, Force, Load, Moment
from abut.model.conditions import COMPONENTS, TURNS

MOTIONS = (*COMPONENTS, *TURNS)
BESIDE = 1e-6  # of the extent of its nodes: distance of a reference from their middle that rounding does not leave


@dataclass(frozen=True)
class Motion:
    """Prescribed components of a reference: values by name, one amplitude or one for each."""

    values: dict[str, float]
    amplitude: Amplitude | None
    amplitudes: dict[str, Amplitude]


def couplings(deck: Deck, groups: Groups, plane: str | None) -> list[Coupling]:
    """The couplings of a deck with what is prescribed at their reference nodes. Raises InputError for nodes that belong to
    nothing or to too much."""
    given = courses(deck, "boundary") if deck.couplings else {}
    result = []
    for bound in merged(deck.couplings):
        _check(deck, groups, bound)
        known = components(plane)
        motion = motion_of(
            {
                MOTIONS[int(d) - 1]: c
                for (node, d), c in given.items()
                if node == bound.reference and (not bound.distributing or d in bound.directions)
            },
            known,
        )
        follow = None
        axes = 2 if plane else 3
        if not bound.distributing and not set(range(1, axes + 1)) <= bound.directions:
            follow = tuple(COMPONENTS[d - 1] for d in sorted(bound.directions) if d <= axes)
            if not follow:
                raise DeckError(
                    bound.place, "*KINEMATIC: no displacement (1, 2, 3) is coupled; solids have no rotations"
                )
        on, weights = _points(groups, bound)
        at = tuple(coordinates(deck, np.array([bound.reference]))[0][:axes].tolist())
        name = groups.free_name(bound.name)
        kind = "distributing" if bound.distributing else "kinematic"
        result.append(
            Coupling(
                name,
                on,
                kind,
                at,
                follow,
                weights,
                radius=bound.radius,
                axes=None if bound.orientation is None or follow is None else local_axes(bound.orientation, axes),
                mirrors=None,
                supports=(),
                **motion.values,
                amplitude=motion.amplitude,
                amplitudes=motion.amplitudes,
            )
        )
    return result


def held_by(deck: Deck, made: Sequence[Coupling], names: Mapping[int, tuple[str, ...]]) -> list[Coupling]:
    """Couplings of a deck with the names of the supports that hold their references, nodes of shells and beams."""
    return [
        replace(coupling, supports=names.get(bound.reference, ()))
        for coupling, bound in zip(made, merged(deck.couplings))
    ]


def components(plane: str | None) -> tuple[str, ...]:
    """Those that exist of the motion of a reference."""
    return {None: MOTIONS, "axisymmetric": ("y",)}.get(plane, ("x", "y", "rz"))


def motion_of(given: Mapping[str, Course], known: Sequence[str]) -> Motion:
    """What is prescribed, by the names of components; of those ``known``."""
    given = {name: course for name, course in given.items() if name in known}
    values = {name: scaled(course)[0] for name, course in given.items()}
    units = {name: scaled(course)[1] for name, course in given.items() if not zero(course)}
    own = {name: Amplitude(unit) for name, unit in units.items() if unit is not None}
    alike = len(own) == len(units) and len(set(own.values())) == 1
    return Motion(values, next(iter(own.values())) if alike else None, {} if alike else own)


def reference_nodes(deck: Deck) -> list[tuple[int, int]]:
    """Reference and turning node (0: none) of each rigid body, then of each coupling."""
    return [
        *((body.reference, body.turning) for body in deck.rigid),
        *((bound.reference, 0) for bound in merged(deck.couplings)),
    ]


def reference_loads(
    deck: Deck, names: Mapping[str, tuple[int, int]], plane: str | None, thickness: float
) -> Iterator[Load]:
    """Forces and moments at reference nodes. names: of a rigid body or coupling -> its reference and turning node (0: none).

    Raises InputError for moments that plane models do not have."""
    pushed = courses(deck, "force") if names else {}
    along_own = {bound.reference: bound.orientation for bound in deck.couplings if bound.distributing}
    for name, (reference, turning) in names.items():
        axes = along_own.get(reference)
        frame = np.eye(3) if axes is None else local_axes(axes, 3).frames(coordinates(deck, np.array([reference])))[0]
        alike: dict[Course | None, dict[int, float]] = {}
        for (node, direction), course in pushed.items():
            along = int(direction) - 1 if node == reference else int(direction) + 2 if node == turning else -1
            if along >= 0 and not zero(course):
                _check_plane(deck, int(node), along, plane)
                size, unit = scaled(course)
                alike.setdefault(unit, {})[along] = size / thickness
        for unit, values in alike.items():
            amplitude = None if unit is None else Amplitude(unit)
            force, moment = (
                tuple((np.array([values.get(k, 0.0) for k in range(i, i + 3)]) @ frame).tolist()) for i in (0, 3)
            )
            force, moment = force[: 2 if plane else 3], moment[2 if plane else 0 :]
            if any(force):
                yield Force(name, force, amplitude)
            if any(moment):
                yield Moment(name, moment, amplitude)


def _check_plane(deck: Deck, node: int, along: int, plane: str | None) -> None:
    if plane is not None and (along in (3, 4) or (along == 5 and plane == "axisymmetric")):
        what = (
            "nothing turns in axisymmetric models" if plane == "axisymmetric" else "plane models turn about z only (6)"
        )
        raise DeckError(
            place_of(deck, "force", node), f"*CLOAD: moment {along + 1} on node {node}: {what}; take it out"
        )


def place_of(deck: Deck, kind: str, node: int) -> Place:
    """Of the first line that gives a node a value."""
    every = [*deck.fixed, *(value for step in deck.steps for value in step.values)]
    return next(value.place for value in every if value.kind == kind and node in value.numbers)


def merged(every: Sequence[Bound]) -> list[Bound]:
    """Kinematic couplings of one reference node in the same directions made one, of nodes. Raises InputError for others
    that share one."""
    result: list[Bound] = []
    for bound in every:
        same = next((i for i, other in enumerate(result) if other.reference == bound.reference), None)
        if same is None:
            result.append(bound)
            continue
        first = result[same]
        unlike = (first.directions, first.radius, first.orientation) != (
            bound.directions,
            bound.radius,
            bound.orientation,
        )
        if first.distributing or bound.distributing or unlike:
            raise DeckError(
                bound.place,
                f"*COUPLING: node {bound.reference} is the reference of another coupling ({first.place}); only kinematic "
                "ones in the same directions, with one radius, can share it: give this one a node of its own",
            )
        result[same] = replace(first, more=(*first.more, bound))
    return result


def unlisted_notes(deck: Deck) -> list[str]:
    """Lines that hold a reference node where its *DISTRIBUTING does not list the direction: they hold nothing."""
    notes: dict[str, None] = {}
    for bound, value, direction in _unlisted(deck, "boundary"):
        notes[
            f"{value.place}: *BOUNDARY: the *DISTRIBUTING of node {bound.reference} does not list direction {direction}: "
            "the line holds nothing there"
        ] = None
    return list(notes)


def beside_notes(deck: Deck) -> list[str]:
    """Forces at the reference node of a *DISTRIBUTING COUPLING that is not amid its nodes: their moment counts here."""
    notes = []
    for bound in deck.couplings:
        forces = [v for s in deck.steps for v in s.values if v.kind == "force" and bound.reference in v.numbers]
        if not (bound.weighted and forces):
            continue
        x = coordinates(deck, bound.nodes)
        share = np.ones(len(x)) if bound.weights is None else bound.weights
        apart = coordinates(deck, np.array([bound.reference]))[0] - share @ x / share.sum()
        if np.linalg.norm(apart) > BESIDE * np.ptp(x, axis=0).max():
            notes.append(
                f"{forces[0].place}: *DISTRIBUTING COUPLING: reference node {bound.reference} is not amid its nodes: the "
                "moment of its force about the middle of these is spread over them, too, as in Abaqus; CalculiX leaves it "
                "out: put the node in the middle for that"
            )
    return notes


def _unlisted(deck: Deck, kind: str) -> Iterator[tuple[Bound, Prescribed, int]]:
    """What is prescribed of reference nodes in directions that their *DISTRIBUTING does not list."""
    every = [*deck.fixed, *(value for step in deck.steps for value in step.values)]
    for bound in deck.couplings:
        for value in every if bound.distributing else ():
            if value.kind == kind and bound.reference in value.numbers:
                yield from ((bound, value, d) for d in value.directions if d not in bound.directions)


def _check_unlisted(deck: Deck, reference: int) -> None:
    """As in CalculiX forces are spread in all directions, listed or not; moments and displacements where they are
    listed."""
    moves = ("boundary", "BOUNDARY", "displacement", (1, 2, 3))
    for kind, card, what, those in (moves, ("force", "CLOAD", "moment", (4, 5, 6))):
        for bound, value, direction in _unlisted(deck, kind):
            if bound.reference == reference and value.value != 0.0 and direction in those:
                raise DeckError(
                    value.place,
                    f"*{card}: the *DISTRIBUTING of node {reference} ({bound.place}) "
                    f"does not list direction {direction}, and transmits no {what} there; list it, or take the line out",
                )


def _check(deck: Deck, groups: Groups, bound: Bound) -> None:
    reference = bound.reference
    _check_unlisted(deck, reference)
    _check_own_axes(deck, bound)
    if reference not in deck.nodes:
        raise DeckError(bound.place, f"*COUPLING: REF NODE {reference} does not exist; give it in *NODE")
    for transform in deck.transforms:
        if reference in transform.nodes:
            raise DeckError(
                transform.place,
                f"*TRANSFORM: node {reference} is the reference of a coupling; give its forces and displacements along the "
                "global axes",
            )
    if any(reference in (body.reference, body.turning) for body in deck.rigid):
        raise DeckError(
            bound.place, f"*COUPLING: node {reference} is that of a *RIGID BODY too; give the coupling one of its own"
        )
    if bound.distributing and reference in groups.used:
        raise DeckError(
            bound.place,
            f"*DISTRIBUTING: reference node {reference} belongs to an element; give the coupling one of its own",
        )
    nodes = set(nodes_of(deck, groups, bound).tolist())
    for other in deck.couplings:
        if other.reference != reference and other.reference in nodes:
            raise DeckError(
                bound.place,
                f"*COUPLING: node {other.reference} is the reference of another coupling ({other.place}); couple the nodes "
                "of both to one reference",
            )


def _check_own_axes(deck: Deck, bound: Bound) -> None:
    """A mean motion along axes of its own takes forces and moments, in three dimensions."""
    if not bound.distributing or bound.orientation is None:
        return
    if any((bound.reference, k) in courses(deck, "boundary") for k in range(1, 7)):
        raise DeckError(
            bound.place,
            f"*COUPLING: ORIENTATION: the *DISTRIBUTING of node {bound.reference} takes forces and moments along axes of "
            "its own, and no displacements; take ORIENTATION out, and prescribe them along the global axes",
        )


def _points(groups: Groups, bound: Bound) -> tuple[str, tuple[float, ...] | None]:
    """Surface or node set in the mesh, and weights of its points where they are given."""
    if bound.distributing and bound.surface and groups.deck.surfaces[bound.surface].nodes is None:
        return groups.surface(bound.surface), None
    nodes = groups.those_used(nodes_of(groups.deck, groups, bound))
    if not len(nodes):
        raise DeckError(bound.place, "*COUPLING: none of its nodes belongs to an element; couple nodes of the body")
    name = groups.node_set(nodes, f"{bound.name} nodes")
    if bound.weights is None or len(set(bound.weights.tolist())) == 1:
        return name, None
    return name, tuple(bound.weights[np.searchsorted(bound.nodes, nodes)].tolist())


def nodes_of(deck: Deck, groups: Groups, bound: Bound) -> Numbers:
    """Of a coupling and those merged with it; the reference among them where it is a node of an element."""
    found = [bound.nodes, *(nodes_of(deck, groups, other) for other in bound.more)]
    if bound.surface:
        surface = deck.surfaces[bound.surface]
        found.append(_face_nodes(deck, groups, bound.surface) if surface.nodes is None else surface.nodes)
    own = groups.those_used(np.array([bound.reference])) if not bound.distributing else bound.nodes[:0]
    return np.unique(np.concatenate([*found, own]))


def _face_nodes(deck: Deck, groups: Groups, surface: str) -> Numbers:
    return np.concatenate([nodes.ravel() for nodes in connectivity(deck, groups.rows(surface)).values()])
