"""Shells of a deck expanded into solids, as CalculiX does it: nothing after it knows that they were shells.

The nodes of the shell stay, as nodes of no element: what is said of them is said of the solid's nodes that stand for
them (``io.deck.thin_nodes``), or of a rigid body of these (a knot), where the shell has several normals at a node."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.decks.layers import by_section, edges_of, with_layers
from abut.decks.solid_blocks import free_numbers, sections_of, with_solids
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Block, Coupling, Deck, Faces, Numbers, Prescribed, Spring
from abut.io.deck.thin_record import Thin
from abut.mesh.thin.shells import Expanded, Shell, expand

CARD = "*SHELL SECTION"

Vector = NDArray[np.float64]


def with_thick_shells(deck: Deck, finite: bool, rigid: bool) -> Deck:
    """The deck with its shells, of quadratic elements, expanded. ``finite``: at large displacements; ``rigid``: where nodes
    are held or loaded the thickness stays as it is.

    Raises InputError for shells without a thickness or with cells that have no area, and for springs on their nodes."""
    deck = by_section(deck)
    blocks = [block for block in deck.blocks if block.type.thin == "shell"]
    if not blocks:
        return deck
    shells = [
        Shell(
            block.type.kind,
            np.searchsorted(deck.nodes, block.nodes),
            thickness_at(deck, block, CARD),
            offsets_of(deck, block, CARD),
            normals_at(deck, block),
            edges_of(sections_of(deck, block, "element", CARD)[0]),
        )
        for block in blocks
    ]
    try:
        solid = expand(deck.points, shells)
    except ValueError as error:
        shell, cell = error.args
        block = blocks[shell]
        raise DeckError(
            block.place, f"*ELEMENT: shell {block.ids[cell]} has no area at one of its nodes; mend the mesh"
        ) from None
    return _with_solids(deck, blocks, solid, finite, rigid)


def _with_solids(deck: Deck, blocks: list[Block], solid: Expanded, finite: bool, rigid: bool) -> Deck:
    number = free_numbers(deck, len(solid.points), [rows for _, cells in solid.cells for rows in cells])
    thin = _thin(deck, solid, number, rigid)
    if finite:
        _check_turned(deck, thin)
        thin |= {node: Thin(thin[node].own) for node in _turned(deck) & thin.keys()}
    knots = [node for node, each in thin.items() if each.along is None]
    stand_for, heights = nodes_through(deck, solid, number)
    deck = with_solids(deck, "shell", solid.points, number, [(kind, cells[0]) for kind, cells in solid.cells])
    deck = with_layers(deck, blocks, [number[cells[1:]] for _, cells in solid.cells])
    deck = replace(deck, thin={node: each for node, each in thin.items() if node not in knots})
    deck = renamed(deck, stand_for, heights)
    couplings = [_knot(deck, blocks[0], node, stand_for[node]) for node in knots]
    return replace(deck, couplings=(*deck.couplings, *couplings))


def _knot(deck: Deck, block: Block, node: int, nodes: Numbers) -> Coupling:
    return Coupling(f"knot {node}", False, node, "", nodes, frozenset(range(1, 7)), None, block.place, thin=True)


def _thin(deck: Deck, solid: Expanded, number: Numbers, rigid: bool) -> dict[int, Thin]:
    """What stands for each node of the deck that shells have: the mean over the thickness, where that is ``rigid`` of both
    sides."""
    result: dict[int, Thin] = {}
    start = np.searchsorted(solid.director, np.arange(len(solid.node) + 1))
    for i, own in enumerate(solid.node.tolist()):
        node, here = int(deck.nodes[own]), slice(start[i], start[i + 1])
        each = [(n, share) for n, share in zip(number[here].tolist(), solid.share[here].tolist()) if n >= 0]
        ends = (each[0][0], each[-1][0])
        if node in result:
            result[node] = Thin((*result[node].nodes, *ends))
            continue
        x, y, z = solid.normal[i].tolist()
        nodes, weights = ends, (0.5, 0.5)
        if not rigid:
            row = slice(solid.mean.indptr[i], solid.mean.indptr[i + 1])
            mean = dict(zip(number[solid.mean.indices[row]].tolist(), solid.mean.data[row].tolist()))
            nodes = (ends[0], *(n for n in mean if n not in ends), ends[1])
            weights = tuple(mean[n] for n in nodes)
        result[node] = Thin(nodes, (x, y, z), float(solid.thickness[i]), tuple(each[1:-1]), weights, rigid)
    return result


def nodes_through(deck: Deck, solid: Expanded, number: Numbers) -> tuple[dict[int, Numbers], dict[int, float]]:
    """All nodes through the thickness at each node of the deck that is expanded, and how far along the normal each of these
    lies over that node."""
    result: dict[int, list[int]] = {}
    used = number >= 0
    for node, each in zip(deck.nodes[solid.node[solid.director[used]]].tolist(), number[used].tolist()):
        result.setdefault(node, []).append(each)
    apart = solid.points - deck.points[solid.node[solid.director]]
    at = np.einsum("nd,nd->n", apart, solid.normal[solid.director])
    return {node: np.array(nodes, np.int64) for node, nodes in result.items()}, dict(zip(number.tolist(), at.tolist()))


def offsets_of(deck: Deck, block: Block, card: str) -> Vector:
    """(n,) of each element. card: that has sections of such elements."""
    return np.array([section.offset for section in sections_of(deck, block, "element", card)])


def thickness_at(deck: Deck, block: Block, card: str) -> Vector:
    """(n, k) at each node of each element: that of the section, or of the nodes where it says so. card: that has sections of
    such elements."""
    sections = np.array([section.thickness for section in sections_of(deck, block, "element", card)])
    given = sections[:, None] > 0.0
    own = at_nodes(deck, block, np.asarray(~given.all(axis=1)))[:, :, 0]
    return np.where(given, sections[:, None], own)


def at_nodes(deck: Deck, block: Block, asked: NDArray[np.bool_]) -> Vector:
    """(n, k, 2): both thicknesses of *NODAL THICKNESS at the nodes of each element, 0 where there is none. Raises InputError
    for elements ``asked`` (n,) without one."""
    own = np.zeros((len(deck.nodes), 2))
    for node, pair in deck.thicknesses.items():
        own[np.searchsorted(deck.nodes, node)] = pair
    result = own[np.searchsorted(deck.nodes, block.nodes)]
    bare = np.flatnonzero(asked & (result[:, :, 0] <= 0.0).any(axis=1))
    if len(bare):
        raise DeckError(
            block.place,
            f"*ELEMENT: {block.type.thin or 'element'} {block.ids[bare[0]]} has no thickness at one of its nodes; give it "
            "in *NODAL THICKNESS",
        )
    return np.asarray(result)


def normals_at(deck: Deck, block: Block) -> Vector:
    """(n, k, 3): those that are given, NaN elsewhere."""
    result = np.full((*block.nodes.shape, 3), np.nan)
    if not deck.normals:
        return result
    for i, (element, own) in enumerate(zip(block.ids.tolist(), block.nodes.tolist())):
        for k, node in enumerate(own):
            result[i, k] = deck.normals.get((element, node), np.nan)
    return result


def _turned(deck: Deck) -> set[int]:
    """Nodes with turns prescribed other than zero."""
    every = [*deck.fixed, *(value for step in deck.steps for value in step.values)]
    turns = [v for v in every if v.kind == "boundary" and v.value != 0.0 and max(v.directions) > 3]
    return {node for value in turns for node in value.numbers.tolist()}


def _check_turned(deck: Deck, thin: Mapping[int, Thin]) -> None:
    """Raise InputError for moments, and turns in equations, of nodes with one normal, which large turns would bend."""
    for value in (value for step in deck.steps for value in step.values):
        moment = value.kind == "force" and value.value != 0.0 and max(value.directions) > 3
        for node in value.numbers.tolist() if moment else ():
            if node in thin and thin[node].along is not None:
                raise DeckError(
                    value.place,
                    "*CLOAD: moments at nodes of shells need small displacements; leave NLGEOM out, or couple the nodes of "
                    "the edge to a node of its own (*COUPLING) and move that",
                )
    for equation in deck.equations:
        if any(
            direction > 3 and node in thin and thin[node].along is not None for node, direction, _ in equation.terms
        ):
            raise DeckError(
                equation.place,
                "*EQUATION: turns of nodes of shells need small displacements; leave NLGEOM out, or join the edges by *TIE",
            )


def renamed(deck: Deck, stand_for: Mapping[int, Numbers], heights: Mapping[int, float]) -> Deck:
    """The deck with nodes of solids in sets and surfaces of nodes, rigid bodies, couplings and temperatures. heights: along
    the normal over the shell's nodes."""
    shells = np.array(sorted(stand_for), np.int64)

    def all_of(nodes: Numbers) -> Numbers:
        """With those that stand for nodes of shells in their place."""
        if not np.isin(nodes, shells).any():
            return nodes
        solids = set(np.concatenate([block.nodes.ravel() for block in deck.blocks]).tolist())
        kept = [n for n in nodes.tolist() if n not in stand_for or n in solids]
        new = [stand_for[n] for n in nodes.tolist() if n in stand_for]
        return np.unique(np.concatenate([np.array(kept, np.int64), *new]))

    def of_temperature(value: Prescribed) -> list[Prescribed]:
        if value.kind != "temperature":
            return [value]
        if not value.vector[0]:
            return [replace(value, numbers=all_of(value.numbers))]
        for node in [n for n in all_of(value.numbers).tolist() if n not in heights][:1]:
            raise DeckError(
                value.place, f"*TEMPERATURE: node {node} has a gradient, and belongs to no shell; take it out"
            )
        return [_warm(value, n, heights[n]) for n in all_of(value.numbers).tolist()]

    def of_surface(surface: Faces) -> Faces:
        return surface if surface.nodes is None else replace(surface, nodes=all_of(surface.nodes))

    springs = tuple(_on_solids(deck, spring, shells) for spring in deck.springs)
    initial = dict(deck.initial)
    for node, nodes in stand_for.items():
        if node in initial:
            initial |= dict.fromkeys(nodes.tolist(), initial[node])
    return replace(
        deck,
        node_sets={name: all_of(nodes) for name, nodes in deck.node_sets.items()},
        surfaces={name: of_surface(surface) for name, surface in deck.surfaces.items()},
        rigid=tuple(replace(body, nodes=all_of(body.nodes)) for body in deck.rigid),
        couplings=tuple(_of_solids(bound, stand_for, all_of(bound.nodes)) for bound in deck.couplings),
        initial=initial,
        springs=springs,
        steps=tuple(
            replace(step, values=tuple(v for value in step.values for v in of_temperature(value)))
            for step in deck.steps
        ),
    )


def _on_solids(deck: Deck, spring: Spring, shells: Numbers) -> Spring:
    """A spring on the nodes halfway through the thickness, at corners of shells."""
    ends = spring.ends.copy()
    for node in np.intersect1d(ends, shells).tolist():
        middle = deck.thin[node].middle if node in deck.thin else 0
        if not middle:
            raise DeckError(
                spring.place,
                f"{spring.title}: node {node}: springs on beams, trusses, knots and the middle of a shell's edge are not "
                "supported; use corners of shells, or nodes of solids",
            )
        ends[spring.ends == node] = middle
    return replace(spring, ends=ends)


def _warm(value: Prescribed, node: int, height: float) -> Prescribed:
    """The temperature at a node at a height along the normal over the shell's nodes."""
    return replace(value, numbers=np.array([node], np.int64), value=value.value + height * value.vector[0])


def _of_solids(bound: Coupling, stand_for: Mapping[int, Numbers], nodes: Numbers) -> Coupling:
    """A coupling of the nodes that stand for its own; they share the weight of the node."""
    if bound.weights is None or np.array_equal(nodes, bound.nodes):
        return replace(bound, nodes=nodes)
    weights = dict.fromkeys(nodes.tolist(), 0.0)
    for node, weight in zip(bound.nodes.tolist(), bound.weights.tolist()):
        own = stand_for.get(node, np.array([node])).tolist()
        weights |= {n: weights[n] + weight / len(own) for n in own}
    return replace(bound, nodes=nodes, weights=np.array([weights[n] for n in nodes.tolist()]))
