"""Pre-tension of beams, *PRE-TENSION SECTION with ELEMENT: the pair of forces at what the ends of the beam hang on.

CalculiX cuts such a beam and lets the cut close along the normal, with the force on the section's node. A beam whose ends
turn freely carries nothing but this force, whatever its own stiffness: it is taken out, and its force acts at both ends."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.io.deck.pretension_record import PreTension
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Block, Deck, Equation, Prescribed

Vector = NDArray[np.float64]
CARD = "*PRE-TENSION SECTION: ELEMENT"
CURE = "take the beam out and give its force by *CLOAD at what its two nodes hold, or a bolt of solids and SURFACE"


def without_pulled_beams(deck: Deck) -> Deck:
    """The deck with forces in place of the beams that pre-tension sections name.

    Raises InputError for elements that are no beams, beams whose ends do not hang on one node each in all directions and on
    nothing else, sections that are moved in place of pulled, and large displacements, at which the beam turns."""
    for section in deck.pretension:
        if section.element:
            deck = _pulled(deck, section)
    return replace(deck, pretension=tuple(section for section in deck.pretension if not section.element))


def _pulled(deck: Deck, section: PreTension) -> Deck:
    block = next((b for b in deck.blocks if section.element in b.ids and b.type.thin == "beam"), None)
    if block is None:
        raise DeckError(section.place, f"{CARD}={section.element}: no beam; name one")
    row = block.nodes[block.ids == section.element][0]
    first, second = int(row[0]), int(row[1 if block.code.startswith(("B31", "B21")) else 2])
    _check(deck, section, block, row.tolist())
    hung = {end: _holder(deck, section, end) for end in (first, second)}
    normal = _normal(deck, section, first, second)
    kept = [e for e in deck.equations if not {node for node, _, _ in e.terms} & {first, second}]

    def forces(value: Prescribed) -> list[Prescribed]:
        if section.node not in value.numbers:
            return [value]
        rest = value.numbers[value.numbers != section.node]
        pair = [
            replace(
                value, numbers=np.array([hung[end]]), directions=(k + 1,), value=float(sign * value.value * normal[k])
            )
            for end, sign in ((first, 1.0), (second, -1.0))
            for k in np.flatnonzero(np.abs(normal) > 1e-12).tolist()
        ]
        return [*([replace(value, numbers=rest)] if len(rest) else []), *pair]

    blocks = [_without(b, section.element) for b in deck.blocks]
    return replace(
        deck,
        points=_where_pulled(deck, hung),
        blocks=tuple(b for b in blocks if len(b.ids)),
        equations=tuple(kept),
        steps=tuple(replace(s, values=tuple(v for value in s.values for v in forces(value))) for s in deck.steps),
        notes=(
            *deck.notes,
            _note(section, hung[first], hung[second], bool(normal @ _along(deck, first, second) < 0.0)),
        ),
    )


def _note(section: PreTension, first: int, second: int, backwards: bool) -> str:
    presses = (
        "; the normal points from its second end to its first: forces > 0 press, as in CalculiX" if backwards else ""
    )
    return (
        f"{section.place}: {CARD}={section.element}: the beam is taken out, its force acts at nodes {first} and {second}; "
        f"how much it shortens is not in the results{presses}"
    )


def _normal(deck: Deck, section: PreTension, first: int, second: int) -> Vector:
    """Unit vector along which a force on the section's node pulls at the first end."""
    normal = _along(deck, first, second) if section.normal is None else np.array(section.normal)
    return np.asarray(normal / np.linalg.norm(normal))


def _along(deck: Deck, first: int, second: int) -> Vector:
    a, b = deck.points[np.searchsorted(deck.nodes, [first, second])]
    return np.asarray(b - a)


def _where_pulled(deck: Deck, hung: Mapping[int, int]) -> Vector:
    """Points with the references of distributing couplings that the beam pulls at its ends: CalculiX takes the mean of the
    nodes there, wherever the reference lies, and the force is that of the beam."""
    spread = {bound.reference for bound in deck.couplings if bound.distributing}
    points = deck.points.copy()
    for end, reference in hung.items():
        if reference in spread:
            points[np.searchsorted(deck.nodes, reference)] = points[np.searchsorted(deck.nodes, end)]
    return points


def _without(block: Block, element: int) -> Block:
    kept = block.ids != element
    return replace(block, ids=block.ids[kept], nodes=block.nodes[kept])


def _check(deck: Deck, section: PreTension, block: Block, nodes: list[int]) -> None:
    """Raise InputError for beams that more than a pair of forces stands for."""
    others = [_without(b, section.element) if b is block else b for b in deck.blocks]
    if any(np.isin(b.nodes, nodes).any() for b in others):
        raise DeckError(section.place, f"{CARD}={section.element}: other elements have nodes of the beam; {CURE}")
    if any(step.finite for step in deck.steps):
        raise DeckError(section.place, f"{CARD}={section.element}: with NLGEOM the beam turns; {CURE}")
    every = [*deck.fixed, *(value for step in deck.steps for value in step.values)]
    for value in every:
        if value.kind in ("boundary", "force") and np.isin(value.numbers, nodes).any():
            raise DeckError(value.place, f"nodes of beam {section.element} have loads or supports; {CURE}")
        if section.node in value.numbers and (value.kind, value.directions) != ("force", (1,)):
            raise DeckError(
                value.place,
                f"node {section.node} of {CARD}={section.element} takes a force in direction 1 alone; {CURE}",
            )


def _holder(deck: Deck, section: PreTension, end: int) -> int:
    """The node that an end hangs on: its displacements along x, y and z are this one's, and its turns are free."""
    named = [e for e in deck.equations if any(node == end for node, _, _ in e.terms)]
    others = {node for e in named for node, _, _ in e.terms if node != end}
    if len(others) != 1 or sorted(_direction(e) for e in named) != [1, 2, 3]:
        raise DeckError(
            section.place,
            f"{CARD}={section.element}: end {end} of the beam does not hang on one node alone, in directions 1, 2 and 3 "
            f"(*EQUATION); {CURE}",
        )
    return others.pop()


def _direction(equation: Equation) -> int:
    """Along which two nodes move alike, 0 for other equations."""
    terms = equation.terms
    alike = len(terms) == 2 and terms[0][1] == terms[1][1] and terms[0][2] == -terms[1][2]
    return terms[0][1] if alike else 0
