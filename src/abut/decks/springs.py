"""Springs of a deck as those of a model."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from abut.errors import InputError
from abut.io.deck.groups import Groups
from abut.io.deck.nodal_constraints import coordinates
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck, Numbers, Spring
from abut.io.deck.time_histories import courses, zero
from abut.model import Spring as ModelSpring

AXES = "xyz"
RIGID = 1000.0  # stiffness of a gap without one, over that of a cube of the stiffest material as large as the model


@dataclass(frozen=True)
class _Scene:
    """What ends of springs are looked up in. stiff: stiffness
    of what counts as rigid; still: (node, direction) that are held in place."""

    deck: Deck
    groups: Groups
    dim: int
    thickness: float
    stiff: float
    still: frozenset[tuple[int, int]]


def spring_notes(deck: Deck) -> list[str]:
    """What is solved otherwise than in CalculiX."""
    notes = [
        f"{spring.place}: {spring.title}: what is not linear follows its table without NLGEOM, too; CalculiX's results are "
        "those of the slope at no elongation"
        for spring in deck.springs
        if not isinstance(spring.law, float) and not any(step.finite for step in deck.steps)
    ]
    rigid = [spring for spring in deck.springs if spring.rigid]
    return notes + [
        f"{spring.place}: *GAP: without a spring constant the gap is {RIGID:g} times as stiff as a cube of the stiffest "
        "material as large as the model, without tension when open; CalculiX takes 1e12 and 1e-3"
        for spring in rigid
    ]


def springs(deck: Deck, groups: Groups, plane: str | None, thickness: float, modulus: float) -> Iterator[ModelSpring]:
    """Springs between nodes of elements, and to nodes of none that are held, which are the ground. Springs of one card are
    together as far as they go to different nodes in order. modulus: of the stiffest material.

    Raises InputError for ends that nothing holds and for what a model cannot hold."""
    if not deck.springs:
        return
    held = {(int(n), int(d)) for (n, d), course in courses(deck, "boundary").items() if zero(course)}
    scene = _Scene(
        deck,
        groups,
        2 if plane else 3,
        thickness,
        RIGID * modulus * float(np.ptp(deck.points, axis=0).max()),
        frozenset(held),
    )
    for spring in deck.springs:
        _check(deck, spring, plane)
        try:
            yield from _translated(scene, spring)
        except DeckError:
            raise
        except InputError as error:
            raise DeckError(spring.place, f"{spring.title}: {str(error).partition(': ')[2]}") from None


def _check(deck: Deck, spring: Spring, plane: str | None) -> None:
    """Raise InputError for springs of kinds that abut does not have."""
    if plane == "axisymmetric":
        raise DeckError(
            spring.place, f"{spring.title}: springs of axisymmetric models are not read; load the nodes with *CLOAD"
        )
    if plane is not None and 3 in spring.directions:
        raise DeckError(spring.place, f"{spring.title}: direction 3: the model is plane; take the spring out")
    for node in np.unique(spring.ends).tolist():
        if node in deck.references:
            raise DeckError(
                spring.place,
                f"{spring.title}: node {node} is the reference of a rigid body or coupling, and springs are between "
                "nodes of elements; attach it to one of its points",
            )
        if spring.directions and any(node in transform.nodes for transform in deck.transforms):
            raise DeckError(
                spring.place,
                f"{spring.title}: node {node} has axes of its own (*TRANSFORM), which springs do not take in every "
                "code (CalculiX does not take them); take it out of *TRANSFORM",
            )


def _translated(scene: _Scene, spring: Spring) -> Iterator[ModelSpring]:
    between: list[tuple[int, int, int]] = []
    # By the point that the other end is, () where it has none, and whether that is the first one
    ground: dict[tuple[tuple[float, ...], bool], list[tuple[int, int]]] = {}
    used = set(scene.groups.used.tolist())
    for number, ends in zip(spring.elements.tolist(), spring.ends.tolist()):
        inside = [node for node in ends if node in used]
        for node in ends:
            if node not in used:
                _check_held(scene, spring, number, node)
        if not inside:
            raise DeckError(
                spring.place, f"{spring.title}: element {number}: no end is a node of an element; take it out"
            )
        if len(inside) == 2:
            between.append((number, *inside))
            continue
        other = next((node for node in ends if node != inside[0]), None)
        point: tuple[float, ...] = ()
        if spring.code == "SPRINGA" and other is not None:
            point = tuple(coordinates(scene.deck, np.array([other]))[0, : scene.dim].tolist())
        ground.setdefault((point, not point and ends[0] == other), []).append((number, inside[0]))
    for (point, back), each in ground.items():
        for members in _apart([(number, node, -1) for number, node in each]):
            yield _to_ground(scene, _reversed(spring) if back else spring, members, point)
    for members in _apart(between):
        yield _between(scene, spring, members)


def _check_held(scene: _Scene, spring: Spring, number: int, node: int) -> None:
    for direction in spring.directions or range(1, scene.dim + 1):
        if (node, direction) not in scene.still:
            raise DeckError(
                spring.place,
                f"{spring.title}: element {number}: node {node} belongs to no element and is not held in direction "
                f"{direction}; hold it with *BOUNDARY, so that it is the ground",
            )


def _apart(elements: Sequence[tuple[int, int, int]]) -> list[list[tuple[int, int, int]]]:
    """Elements (number, first node, second node) in groups in which nodes rise, both the first and the second ones."""
    groups: list[list[tuple[int, int, int]]] = []
    for element in sorted(elements, key=lambda each: each[1:]):
        for group in groups:
            _, first, second = group[-1]
            if element[1] > first and (element[2] > second or element[2] == second == -1):
                group.append(element)
                break
        else:
            groups.append([element])
    return groups


def _reversed(spring: Spring) -> Spring:
    """With the law of the second end's displacement, where it is given by that of the first one, which is the ground."""
    if isinstance(spring.law, float):
        return spring
    return replace(spring, law=tuple((-u, -f) for u, f in reversed(spring.law)))


def _to_ground(
    scene: _Scene, spring: Spring, members: Sequence[tuple[int, int, int]], point: tuple[float, ...]
) -> ModelSpring:
    nodes = scene.groups.node_set(np.array([node for _, node, _ in members]), f"spring-{members[0][0]}")
    name = _name(scene, spring, members)
    laws = _law(scene, spring, len(members))
    return ModelSpring(name, nodes, point=point or None, **laws)


def _between(scene: _Scene, spring: Spring, members: Sequence[tuple[int, int, int]]) -> ModelSpring:
    """From the second to the first node: the law is one of the first's displacement less the second's; along the line it is
    one of the lengthening, whichever is first."""
    first, second = (_set(scene, [each[i] for each in members], members[0][0], i) for i in (1, 2))
    return ModelSpring(_name(scene, spring, members), second, first, **_law(scene, spring, len(members)))


def _set(scene: _Scene, nodes: list[int], number: int, end: int) -> str:
    numbers: Numbers = np.array(nodes, np.int64)
    return scene.groups.node_set(numbers, f"spring-{number}-{end}")


def _name(scene: _Scene, spring: Spring, members: Sequence[tuple[int, int, int]]) -> str:
    whole = len(members) == len(spring.elements)
    return scene.groups.free_name(spring.name if whole else f"{spring.name}-{members[0][0]}")


def _law(scene: _Scene, spring: Spring, count: int) -> Mapping[str, Any]:
    """Of all springs together, per unit thickness; beyond a table's ends the force is constant, as in CalculiX."""
    key = AXES[spring.directions[0] - 1] if spring.directions else "along"
    times = count / scene.thickness
    if isinstance(spring.law, float):
        return {key: spring.law * times}
    (first, low), (last, high) = spring.law[0], spring.law[-1]
    if spring.code == "GAPUNI":  # on beyond its ends
        times *= scene.stiff if spring.rigid else 1.0
        return {key: [(u, f * times) for u, f in spring.law]}
    width = last - first
    table = [(first - width, low), *spring.law, (last + width, high)] if width > 0.0 else spring.law
    return {key: [(u, f * times) for u, f in table]}
