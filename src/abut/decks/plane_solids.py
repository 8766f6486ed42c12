"""Plane and axisymmetric elements of decks that have several kinds of them, or of several thicknesses, or solids beside: as
solids, as CalculiX does it (CrunchiX manual, "Plane stress", "Plane strain" and "Axisymmetric elements").

Each becomes one solid: as thick as its section says, of axisymmetric ones a sector of 2 degrees. Both sides move in x and y
as the node between them does; along z plane strain holds them, in plane stress they move apart by themselves, and those of
a sector stay on its sides. Beside axisymmetric elements thicknesses and forces are those of the whole turn, of which the
sector has 1/180."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.decks.plane import solid_planes
from abut.decks.solid_blocks import free_numbers, sections_of
from abut.decks.thin import at_nodes, renamed
from abut.io.deck.elements import LAYER
from abut.io.deck.faces import free_faces
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Block, Deck, Equation, Faces, Numbers, Prescribed
from abut.io.deck.thin_record import Thin
from abut.mesh.thin.shells import LINEAR, stacked

SECTORS = 180
HALF = float(np.pi / SECTORS)  # of a sector's angle
EDGES = 2  # faces S1, S2 of the solid are its sides; those of the edges come after
BEYOND = 1e-9  # of the largest radius: on the axis
NOTE = (
    "plane and axisymmetric elements become solids, one across, as the deck has several kinds or thicknesses of them, or "
    "solids beside"
)

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class _Layer:
    """Elements of one kind and thickness, or with one at each node. cells: (n, k) rows of ``nodes`` (m,); points: (m, 3, 3)
    below, halfway, above."""

    block: Block
    nodes: Numbers
    cells: Numbers
    points: Vector


def plane_notes(deck: Deck) -> list[str]:
    """What becomes of such elements."""
    if not solid_planes(deck):
        return []
    if not _turned(deck):
        return [NOTE]
    return [
        f"{NOTE}: a sector of 2 degrees; forces in the results are those of the sector, times {SECTORS} of the whole turn"
    ]


def with_solid_planes(deck: Deck) -> Deck:
    """The deck with such elements as solids; what is thin is solid already.

    Raises InputError for elements without a section, axisymmetric ones on the axis, and nodes that are references of rigid
    bodies and couplings as well."""
    if not solid_planes(deck):
        return deck
    turned = _turned(deck)
    layers = _layers(deck, turned)
    own = np.unique(np.concatenate([layer.nodes for layer in layers]))
    solids = [block.nodes.ravel() for block in deck.blocks if block.type.plane is None]
    shared = np.intersect1d(own, np.concatenate([np.empty(0, np.int64), *solids]))
    _check(deck, layers[0].block, own)
    number = free_numbers(deck, sum(3 * len(layer.nodes) for layer in layers), [_used(layers)])
    points = np.concatenate([layer.points.reshape(-1, 3) for layer in layers])
    through = np.split(number.reshape(-1, 3), np.cumsum([len(layer.nodes) for layer in layers])[:-1])
    thin, equations, held = _bound(deck, layers, through, shared)
    stand_for = _through(layers, through)
    edges = _edges(deck, layers)
    deck = _at_edges(deck, np.concatenate([layer.block.ids for layer in layers]), edges)
    deck = _without_z(deck, np.setdiff1d(own, shared))
    made = [
        replace(
            layer.block,
            type=replace(layer.block.type, kind=LAYER[layer.block.type.kind], plane=None),
            nodes=each.ravel()[stacked(3 * layer.cells, layer.block.type.kind in LINEAR)],
        )
        for layer, each in zip(layers, through)
    ]
    new = number >= 0
    deck = replace(
        deck,
        nodes=np.concatenate([deck.nodes, number[new]]),
        points=np.concatenate([deck.points, points[new]]),
        blocks=(*(block for block in deck.blocks if block.type.plane is None), *made),
    )
    deck = renamed(deck, stand_for, {})
    deck = replace(
        deck,
        thin={**deck.thin, **thin},
        equations=(*deck.equations, *equations),
        fixed=(*deck.fixed, *(Prescribed("boundary", held, (3,), 0.0, "", deck.blocks[0].place) for _ in held[:1])),
    )
    return _of_sector(deck) if turned else deck


def _turned(deck: Deck) -> bool:
    return any(block.type.plane == "axisymmetric" for block in deck.blocks)


def _layers(deck: Deck, turned: bool) -> list[_Layer]:
    result = []
    for block in (block for block in deck.blocks if block.type.plane is not None):
        round_ = block.type.plane == "axisymmetric"
        given = np.array([section.thickness for section in sections_of(deck, block, "element", "*SOLID SECTION")])
        each = np.zeros(len(given)) if round_ else given / (SECTORS if turned else 1)
        for thickness in np.unique(each).tolist():
            here = each == thickness
            nodes, rows = np.unique(block.nodes[here], return_inverse=True)
            part = replace(block, ids=block.ids[here], nodes=block.nodes[here])
            cells = rows.reshape(part.nodes.shape)
            at = deck.points[np.searchsorted(deck.nodes, nodes)]
            thick = np.full((len(nodes), 1), thickness)
            if not (thickness or round_):
                own = at_nodes(deck, part, np.ones(len(part.ids), bool))[:, :, 0]
                thick[cells.ravel(), 0] = own.ravel() / (SECTORS if turned else 1)
            result.append(_Layer(part, nodes, cells, _across(at, cells, thick, block)))
    return result


def _across(at: Vector, cells: Numbers, thickness: Vector, block: Block) -> Vector:
    """Points (m, 3, 3) below, halfway and above; above is where elements turn clockwise seen from there.
    thickness: (m, 1)."""
    height = np.array([-1.0, 0.0, 1.0])
    x = at[cells[0, :3], :2]
    if np.linalg.det(x[1:] - x[0]) < 0.0:
        height = -height
    result = np.repeat(at[:, None], 3, axis=1)
    if block.type.plane != "axisymmetric":
        result[:, :, 2] += height * thickness / 2.0
        return result
    if at[:, 0].min() <= BEYOND * at[:, 0].max():
        raise DeckError(
            block.place,
            "*ELEMENT: axisymmetric elements beside elements of another kind become sectors of 2 degrees, which need radii "
            "> 0; leave a hole along the axis",
        )
    result[:, :, 0] = at[:, :1] * np.cos(height * HALF)
    result[:, :, 2] = at[:, :1] * np.sin(height * HALF)
    return result


def _used(layers: Sequence[_Layer]) -> Numbers:
    """Rows of the points of all layers that solids have."""
    starts = np.cumsum([0, *(3 * len(layer.nodes) for layer in layers)])
    return np.concatenate(
        [
            (start + stacked(3 * layer.cells, layer.block.type.kind in LINEAR)).ravel()
            for start, layer in zip(starts.tolist(), layers)
        ]
    )


def _bound(
    deck: Deck, layers: Sequence[_Layer], through: Sequence[Numbers], shared: Numbers
) -> tuple[dict[int, Thin], list[Equation], Numbers]:
    """What stands for each node, the equations that keep both sides as one, and the nodes held along z."""
    thin: dict[int, Thin] = {}
    equations: list[Equation] = []
    held: list[int] = []
    solids = set(shared.tolist())
    for layer, rows in zip(layers, through):
        plane, place = layer.block.type.plane, layer.block.place
        cosine, tangent = (np.cos(HALF), np.tan(HALF)) if plane == "axisymmetric" else (1.0, 0.0)
        signs = np.sign(layer.points[:, :, 2] - layer.points[:, 1:2, 2])
        for node, ends, sign in zip(layer.nodes.tolist(), rows.tolist(), signs.tolist()):
            low, middle, high = ends
            first = {k: {(high, k): 1.0 / (cosine if k == 1 else 1.0)} for k in (1, 2)}  # what moves as the node does
            base = _base(deck, node, thin, solids)
            if base is None:
                thin[node] = Thin((low, high), stretch=(1.0 / cosine, 1.0, 1.0))
            else:
                equations += [_sum(place, first[k], {p: -c for p, c in base[k].items()}) for k in (1, 2)]
            for k in (1, 2):
                equations.append(_sum(place, {(low, k): 1.0}, {(high, k): -1.0}))
                if middle >= 0:
                    equations.append(_sum(place, {(middle, k): 1.0}, {p: -c for p, c in first[k].items()}))
            held += [middle] if middle >= 0 else []
            if plane == "strain":
                held += [low, high]
            elif plane == "stress":
                equations.append(_sum(place, {(low, 3): 1.0}, {(high, 3): 1.0}))
            else:
                equations += [
                    _sum(place, {(n, 3): 1.0}, {(high, 1): -side * tangent})
                    for n, side in ((low, sign[0]), (high, sign[2]))
                ]
    return thin, equations, np.unique(np.array(held, np.int64))


def _base(
    deck: Deck, node: int, made: dict[int, Thin], solids: set[int]
) -> dict[int, dict[tuple[int, int], float]] | None:
    """What moves in x and y as a node does, where something else stands for it already."""
    if node in solids and node not in deck.thin:
        return {k: {(node, k): 1.0} for k in (1, 2)}
    thin = deck.thin.get(node, made.get(node))
    if thin is None:
        return None
    return {k: {(n, k): share * thin.stretch[k - 1] for n, share in thin.shares} for k in (1, 2)}


def _sum(place: object, *parts: dict[tuple[int, int], float]) -> Equation:
    return Equation(tuple((n, k, c) for part in parts for (n, k), c in part.items()), place)  # type: ignore[arg-type]


def _through(layers: Sequence[_Layer], through: Sequence[Numbers]) -> dict[int, Numbers]:
    """All nodes of solids at each node."""
    result: dict[int, list[int]] = {}
    for layer, rows in zip(layers, through):
        for node, ends in zip(layer.nodes.tolist(), rows.tolist()):
            result.setdefault(node, []).extend(n for n in ends if n >= 0)
    return {node: np.array(nodes, np.int64) for node, nodes in result.items()}


def _edges(deck: Deck, layers: Sequence[_Layer]) -> Numbers:
    """Free edges (n, 2) of elements: element, face of its solid."""
    flat = free_faces(replace(deck, blocks=tuple(layer.block for layer in layers))).rows
    return np.stack([flat[:, 0], flat[:, 1] + EDGES + 1], axis=1)


def _at_edges(deck: Deck, elements: Numbers, edges: Numbers) -> Deck:
    """Faces and pressures of such elements on those of the solids."""

    def of_surface(surface: Faces) -> Faces:
        faces: list[tuple[Numbers, int]] = []
        for members, face in surface.faces:
            here = np.isin(members, elements)
            if not here.all():
                faces.append((members[~here], face))
            if not here.any():
                continue
            if face:
                faces.append((members[here], face + EDGES))
                continue
            free = edges[np.isin(edges[:, 0], members)]
            faces += [(free[free[:, 1] == number, 0], int(number)) for number in np.unique(free[:, 1])]
        return replace(surface, faces=tuple(faces))

    def of_value(value: Prescribed) -> list[Prescribed]:
        here = np.isin(value.numbers, elements) if value.kind == "pressure" else np.zeros(len(value.numbers), bool)
        if not here.any():
            return [value]
        shifted = replace(
            value, numbers=value.numbers[here], directions=tuple(face + EDGES for face in value.directions)
        )
        return [shifted] if here.all() else [replace(value, numbers=value.numbers[~here]), shifted]

    return replace(
        deck,
        surfaces={name: of_surface(surface) for name, surface in deck.surfaces.items()},
        steps=tuple(
            replace(step, values=tuple(v for value in step.values for v in of_value(value))) for step in deck.steps
        ),
    )


def _without_z(deck: Deck, nodes: Numbers) -> Deck:
    """The deck without supports of nodes of such elements alone out of their plane, which do not move there.

    Raises InputError for such as are not 0."""

    def kept(values: Sequence[Prescribed]) -> tuple[Prescribed, ...]:
        return tuple(left for value in values for left in _in_plane(value, nodes))

    return replace(
        deck, fixed=kept(deck.fixed), steps=tuple(replace(step, values=kept(step.values)) for step in deck.steps)
    )


def _in_plane(value: Prescribed, nodes: Numbers) -> list[Prescribed]:
    here = np.isin(value.numbers, nodes)
    if value.kind not in ("boundary", "force") or max(value.directions) <= 2 or not here.any():
        return [value]
    if value.value != 0.0:
        what = "*CLOAD" if value.kind == "force" else "*BOUNDARY"
        raise DeckError(
            value.place,
            f"{what}: node {value.numbers[here][0]} of plane or axisymmetric elements moves in x and y; give "
            "directions 1 and 2",
        )
    parts = [replace(value, numbers=value.numbers[~here])] if not here.all() else []
    inside = tuple(d for d in value.directions if d <= 2)
    return [*parts, *([replace(value, numbers=value.numbers[here], directions=inside)] if inside else [])]


def _of_sector(deck: Deck) -> Deck:
    """The deck with the forces of a sector."""
    steps = tuple(
        replace(
            step,
            values=tuple(
                replace(value, value=value.value / SECTORS) if value.kind == "force" else value for value in step.values
            ),
        )
        for step in deck.steps
    )
    return replace(deck, steps=steps)


def _check(deck: Deck, block: Block, nodes: Numbers) -> None:
    """Raise InputError for nodes that are references."""
    for node in np.intersect1d(nodes, sorted(deck.references)).tolist()[:1]:
        raise DeckError(
            block.place,
            f"*ELEMENT: node {node} is a reference, or shells or beams meet there at an angle; give the plane or "
            "axisymmetric element a node of its own",
        )
