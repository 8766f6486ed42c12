"""The mesh of a deck with its names: bodies from sections, surfaces and node sets, as ``io.raw.RawMesh``."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

from abut.errors import InputError
from abut.io.deck.faces import FreeFaces, Rows, connectivity, element_nodes, free_faces, surface_rows
from abut.io.deck.reader import read_mesh_only
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck, Numbers, Section
from abut.io.deck.time_histories import BODY_LOADS
from abut.io.raw import RawMesh


@dataclass(frozen=True)
class Piece:
    """A body: the connected elements of a section that integrate and are loaded alike."""

    name: str
    section: Section
    integration: str
    codes: tuple[str, ...]
    elements: Numbers


def pieces(deck: Deck) -> tuple[Piece, ...]:
    """The bodies of a deck. Raises InputError for elements without a section."""
    every = np.concatenate([block.ids for block in deck.blocks]) if deck.blocks else np.empty(0, np.int64)
    left = np.setdiff1d(every, np.concatenate([np.empty(0, np.int64), *(s.elements for s in deck.sections)]))
    if len(left):
        more = f" and {len(left) - 1} more" if len(left) > 1 else ""
        place = next(block.place for block in deck.blocks if left[0] in block.ids)
        raise DeckError(place, f"*ELEMENT: element {left[0]}{more} without *SOLID SECTION; give their set a section")
    part = _parts(deck)
    result: list[Piece] = []
    for section in deck.sections:
        parts = _split(deck, section.elements, part)
        for i, (integration, codes, elements) in enumerate(parts, start=1):
            name = section.name if len(parts) == 1 else f"{section.name}-{i}"
            result.append(Piece(name, section, integration, codes, elements))
    return tuple(result)


def _parts(deck: Deck) -> Numbers:
    """For each of ``deck.nodes`` the number of the connected part it is in."""
    size = len(deck.nodes)
    ends = [(b.nodes[:, :1].repeat(b.nodes.shape[1], 1).ravel(), b.nodes.ravel()) for b in deck.blocks]
    ends.append((deck.hinges[:, 0], deck.hinges[:, 1]))
    a, b = (np.searchsorted(deck.nodes, np.concatenate(end)) for end in zip(*ends))
    graph = csr_matrix((np.ones(len(a)), (a, b)), shape=(size, size))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.int64)


def _split(deck: Deck, elements: Numbers, part: Numbers) -> list[tuple[str, tuple[str, ...], Numbers]]:
    """Connected elements that integrate alike, have the same gravity and centrifugal forces and go together, in the order of
    their lowest numbers: (integration, types, elements)."""
    parts: dict[tuple[int, str, int], tuple[set[str], list[Numbers]]] = {}
    loaded = [value.numbers for step in deck.steps for value in step.values if value.kind in BODY_LOADS]
    loaded += [absence.elements for absence in deck.absences]
    for block in deck.blocks:
        each = np.intersect1d(elements, block.ids)
        if not len(each):
            continue
        at = part[np.searchsorted(deck.nodes, element_nodes(block, each)[:, 0])]
        loads = (
            np.unique([np.isin(each, numbers) for numbers in loaded], axis=1, return_inverse=True)[1] if loaded else 0
        )
        for number, load in dict.fromkeys(zip(at.tolist(), np.broadcast_to(loads, at.shape).tolist())):
            here = (at == number) & (loads == load)
            mark = hash(tuple(bool(np.isin(each[here][0], numbers)) for numbers in loaded))
            codes, members = parts.setdefault((number, block.type.integration, mark), (set(), []))
            codes.add(block.code)
            members.append(each[here])
    result = [(key[1], tuple(sorted(codes)), np.sort(np.concatenate(m))) for key, (codes, m) in parts.items()]
    return sorted(result, key=lambda each: int(each[2][0]))


class Groups:
    """Collects the named groups of a mesh; names that are taken get an ending. Node sets and surfaces"""

    def __init__(self, deck: Deck) -> None:
        self.deck = deck
        self.used = np.unique(np.concatenate([block.nodes.ravel() for block in deck.blocks] or [np.empty(0, np.int64)]))
        self._groups: dict[str, dict[str, Numbers]] = {}
        self._sets: dict[bytes, str] = {}
        self._faces: dict[bytes, str] = {}
        self._others: set[str] = set()
        self._free: FreeFaces | None = None
        self._rows: dict[str, Rows] = {}
        self._named_sets = {np.intersect1d(n, self.used).tobytes(): name for name, n in deck.node_sets.items()}

    def those_used(self, nodes: Numbers) -> Numbers:
        """Of some nodes those of elements, each once, in order."""
        nodes = np.unique(nodes)
        at = np.minimum(np.searchsorted(self.used, nodes), len(self.used) - 1)
        return nodes[self.used[at] == nodes] if len(self.used) else nodes[:0]

    def body(self, name: str, elements: Numbers) -> str:
        parts: dict[str, list[Numbers]] = {}
        for block in self.deck.blocks:
            here = np.intersect1d(elements, block.ids)
            if len(here):
                parts.setdefault(block.type.kind, []).append(element_nodes(block, here))
        return self._add(name, {kind: np.concatenate(here) for kind, here in parts.items()})

    def rows(self, name: str) -> Rows:
        """Facets of a surface of the deck."""
        if name not in self._rows:
            if self._free is None:
                self._free = free_faces(self.deck)
            self._rows[name] = surface_rows(self.deck, self.deck.surfaces[name], self._free)
        return self._rows[name]

    def surface(self, name: str) -> str:
        """A surface of the deck by name: its name in the mesh."""
        return self.facets(self.rows(name), name)

    def facets(self, rows: Rows, name: str) -> str:
        """Facets as a surface; a surface with the same ones is used again."""
        key = np.unique(rows, axis=0).tobytes()
        if key not in self._faces:
            self._faces[key] = self.new_surface(rows, name)
        return self._faces[key]

    def new_surface(self, rows: Rows, name: str) -> str:
        return self._add(name, connectivity(self.deck, rows), "surface")

    def node_set(self, nodes: Numbers, name: str) -> str:
        """Nodes that elements use as a set, called like the deck's own set of them; one with the same nodes serves again."""
        nodes = np.unique(np.asarray(nodes, dtype=np.int64))
        key = nodes.tobytes()
        if key not in self._sets:
            self._sets[key] = self.new_node_set(nodes, self._named_sets.get(key, name))
        return self._sets[key]

    def new_node_set(self, nodes: Numbers, name: str) -> str:
        return self._add(name, {"point": nodes[:, None]}, "nodes")

    def free_name(self, name: str) -> str:
        """A name that no group has, for something else."""
        free, count = name, 1
        while free in self._groups or free in self._others:
            count += 1
            free = f"{name}-{count}"
        self._others.add(free)
        return free

    def __contains__(self, name: str) -> bool:
        """Whether a group has this name."""
        return name in self._groups

    def _add(self, name: str, parts: dict[str, Numbers], ending: str = "body") -> str:
        free, count = name, 1
        while free in self._groups or free in self._others:
            free = f"{name}-{ending}" + (f"-{count}" if count > 1 else "")
            count += 1
        self._groups[free] = parts
        return free

    def raw(self) -> RawMesh:
        """The mesh with everything collected so far."""
        at = self.deck.nodes
        groups = {
            n: {kind: np.searchsorted(at, numbers) for kind, numbers in p.items()} for n, p in self._groups.items()
        }
        return RawMesh(self.deck.points, groups)


def read_abaqus(path: Path) -> RawMesh:
    """The mesh of a deck. Bodies are the connected parts of the sections' element sets; without sections the sets that
    *ELEMENT names, or connected elements where these do not part the mesh. Surfaces of nodes that make up no faces are
    node sets.

    Raises InputError for decks that cannot be read."""
    deck = read_mesh_only(path)
    groups = Groups(deck)
    if not deck.blocks:
        raise InputError(f"{path}: the deck has no *ELEMENT cards")
    if deck.sections:
        for piece in pieces(deck):
            groups.body(piece.name, piece.elements)
    else:
        every = np.concatenate([block.ids for block in deck.blocks])
        parts = [(name, members) for name, members in deck.element_sets.items() if len(members)]
        joined = np.concatenate([np.empty(0, np.int64), *(members for _, members in parts)])
        for name, members in parts if np.array_equal(np.sort(joined), np.sort(every)) else [("", every)]:
            groups.body(name, members)
    for name, surface in deck.surfaces.items():
        if surface.empty:
            continue
        try:
            groups.new_surface(groups.rows(name), name)
        except InputError:
            if surface.nodes is None:
                raise
            groups.new_node_set(np.intersect1d(surface.nodes, groups.used), name)
    for name, nodes in deck.node_sets.items():
        members = np.intersect1d(nodes, groups.used)
        if len(members):
            groups.new_node_set(members, name)
    return replace(groups.raw(), notes=deck.notes)
