"""*COUPLING with *KINEMATIC or *DISTRIBUTING, *KINEMATIC COUPLING and *DISTRIBUTING COUPLING of a deck."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from abut.errors import nearest
from abut.io.deck.cards import Card, Line, key, of
from abut.io.deck.elastic_cards import orientation
from abut.io.deck.mesh_cards import MeshCards
from abut.io.deck.model_cards import one_node
from abut.io.deck.reasons import Reasons
from abut.io.deck.record import Coupling, Numbers, Orientation

NONE = np.empty(0, np.int64)
KINDS = ("KINEMATIC", "DISTRIBUTING")
ALL = frozenset(range(1, 7))


def couplings(cards: Sequence[Card], mesh: MeshCards, reasons: Reasons) -> tuple[Coupling, ...]:
    """All couplings; ``reasons`` gets what is wrong with them."""
    result: list[Coupling] = []
    for i, card in enumerate(cards):
        with reasons.gathered():
            if card.key == "COUPLING":
                result.append(_coupling(card, cards, cards[i + 1] if i + 1 < len(cards) else None, mesh))
            elif card.key == "KINEMATICCOUPLING":
                result += _by_lines(card, cards, mesh)
            elif card.key == "DISTRIBUTINGCOUPLING":
                result.append(_weighted(card, cards, mesh))
            elif card.key in KINDS and (i == 0 or cards[i - 1].key != "COUPLING"):
                raise card.error("it must follow its *COUPLING card; move it there")
    return tuple(result)


def _coupling(card: Card, cards: Sequence[Card], following: Card | None, mesh: MeshCards) -> Coupling:
    reference, name = one_node(card, "REF NODE", mesh), card.need("SURFACE")
    if name.upper() not in mesh.surfaces:
        raise card.unknown(f"no surface named {name!r}{nearest(name, [s.name for s in mesh.surfaces.values()])}")
    surface = mesh.surfaces[name.upper()]
    if surface.empty:
        raise card.unknown(f"surface '{name}' is empty")
    if following is None or following.key not in KINDS:
        raise card.error("the kind is missing; write *KINEMATIC or *DISTRIBUTING in the next line")
    directions = _directions(following)
    distributing = following.key == "DISTRIBUTING"
    if key(following.get("WEIGHTING METHOD", "UNIFORM") or "") != "UNIFORM":
        raise following.error(
            "WEIGHTINGMETHOD: weights over the distance are not read; take UNIFORM, or write *DISTRIBUTING COUPLING"
        )
    if key(following.get("COUPLING", "CONTINUUM") or "") != "CONTINUUM":
        raise following.error("COUPLING=STRUCTURAL: solids have displacements only; take CONTINUUM")
    label = card.get("CONSTRAINT NAME") or f"coupling of {surface.name}"
    return Coupling(
        label, distributing, reference, surface.name, NONE, directions, None, card.place,
        radius=_radius(card), orientation=_axes(card, cards, frozenset() if distributing else directions),
    )  # fmt: skip


def _radius(card: Card) -> float | None:
    if not card.has("INFLUENCE RADIUS"):
        return None
    given = card.get("INFLUENCE RADIUS") or ""
    try:
        radius = float(given)
    except ValueError:
        radius = 0.0
    if not 0.0 < radius < np.inf:
        raise card.error(f"INFLUENCE RADIUS: expected a number > 0, got {given!r}")
    return radius


def _axes(card: Card, cards: Sequence[Card], directions: frozenset[int]) -> Orientation | None:
    """Of a coupling of some directions; nothing turns where nodes follow in all of them."""
    name = card.get("ORIENTATION")
    if name is None or {1, 2, 3} <= directions:
        return None
    known = {label.upper(): other for other in of(cards, "ORIENTATION") if (label := other.get("NAME"))}
    if name.upper() not in known:
        raise card.unknown(f"no orientation named {name!r}{nearest(name.upper(), known)}")
    axes = orientation(known[name.upper()])
    return axes


def _directions(card: Card) -> frozenset[int]:
    """First and last direction, line by line; without any, all."""
    result: set[int] = set()
    for line in card.lines:
        if line.text(0):
            first = line.integer(0, "first direction")
            last = line.integer(1, "last direction", first)
            if not first <= last <= 6:
                raise line.error(f"directions {first} to {last}: expected numbers from 1 to 6, in order")
            result |= set(range(first, last + 1))
    return frozenset(result) or ALL


def _by_lines(card: Card, cards: Sequence[Card], mesh: MeshCards) -> Iterator[Coupling]:
    """*KINEMATIC COUPLING: nodes and directions, line by line."""
    reference = one_node(card, "REF NODE", mesh)
    alike: dict[frozenset[int], list[Numbers]] = {}
    card.first("nodes and directions")
    for line in card.lines:
        directions = ALL
        if line.text(1):
            first = line.integer(1, "first direction")
            last = line.integer(2, "last direction", first)
            if not first <= last <= 6:
                raise line.error(f"directions {first} to {last}: expected numbers from 1 to 6, in order")
            directions = frozenset(range(first, last + 1))
        alike.setdefault(directions, []).append(mesh.existing(line, 0))
    for directions, nodes in alike.items():
        yield Coupling(
            f"coupling to {reference}",
            False,
            reference,
            "",
            np.unique(np.concatenate(nodes)),
            directions,
            None,
            card.place,
            orientation=_axes(card, cards, directions),
        )


def _point_elements(name: str, cards: Sequence[Card]) -> Iterator[Line]:
    """The lines of elements DCOUP3D and DCOUP2D in a set, which their own card or an *ELSET with numbers makes."""
    listed = {
        text
        for card in of(cards, "ELSET")
        if (card.get("ELSET") or "").upper() == name.upper() and not card.has("GENERATE")
        for line in card.lines
        for text in line.fields
    }
    for card in of(cards, "DCOUP"):
        own = (card.get("ELSET") or "").upper() == name.upper()
        yield from (line for line in card.lines if own or line.text(0) in listed)


def _weighted(card: Card, cards: Sequence[Card], mesh: MeshCards) -> Coupling:
    """*DISTRIBUTING COUPLING: nodes with weights; its reference node is that of an element DCOUP3D or DCOUP2D."""
    name = card.need("ELSET")
    lines = list(_point_elements(name, cards))
    if len(lines) != 1:
        raise card.error(f"ELSET={name}: expected one element DCOUP3D or DCOUP2D, with the reference node")
    line = lines[0]
    reference = line.integer(1, "reference node")
    if reference not in mesh.numbers:
        raise line.unknown(f"node {reference} does not exist; give it in *NODE")
    weights: dict[int, float] = {}
    card.first("nodes and weights")
    for line in card.lines:
        weight = line.number(1, "weight", 1.0)
        if not weight > 0.0:
            raise line.error(f"weight: expected a number > 0, got {weight:g}")
        weights |= dict.fromkeys(mesh.existing(line, 0).tolist(), weight)
    nodes = np.array(sorted(weights), np.int64)
    return Coupling(
        f"coupling to {reference}", True, reference, "", nodes, ALL, np.array([weights[n] for n in nodes]), card.place,
        weighted=True,
    )  # fmt: skip
