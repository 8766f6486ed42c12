"""Linear shells of a deck with nodes in the middle of their edges, which are nodes of the deck from then on.

They are held as both ends of their edge are held, where it is at the rim of the shell, and are as warm as both together.
Trusses are held at their hinges alone; linear membranes stay so."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from abut.io.deck.record import Coupling, Deck, Numbers, Prescribed, Step
from abut.mesh.thin.edges import edges_of, with_middles


def quadratic(deck: Deck) -> tuple[Deck, Numbers, Numbers]:
    """The deck with quadratic shells only, the nodes (m,) that are new, and the ends (m, 2) of the edges they are in the
    middle of."""
    thin = [b for b in deck.blocks if b.type.thin not in ("", "membrane") and len(edges_of(b.type.kind))]
    if not thin:
        return deck, np.empty(0, np.int64), np.empty((0, 2), np.int64)
    rows = [np.searchsorted(deck.nodes, block.nodes) for block in thin]
    points, cells, ends = with_middles(deck.points, [(block.type.kind, r) for block, r in zip(thin, rows)])
    taken = [int(deck.nodes.max()), *deck.references, *(section.node for section in deck.pretension)]
    nodes = np.concatenate([deck.nodes, max(taken) + 1 + np.arange(len(ends))])
    made = iter(
        replace(block, type=replace(block.type, kind=kind), nodes=nodes[c]) for block, (kind, c) in zip(thin, cells)
    )
    blocks = tuple(next(made) if block in thin else block for block in deck.blocks)
    times = Counter(
        np.concatenate([c[:, -len(edges_of(b.type.kind)) :].ravel() for b, (_, c) in zip(thin, cells)]).tolist()
    )
    first = len(deck.nodes)
    bars = {n for b, (_, c) in zip(thin, cells) if b.type.thin == "truss" for n in c[:, 2].tolist()}
    rim = [i for i in range(len(ends)) if times[first + i] == 1 and first + i not in bars]
    middles = _Middles(nodes[first:][rim], deck.nodes[ends[rim]])
    every = _Middles(nodes[first:], deck.nodes[ends])
    new = replace(
        deck,
        nodes=nodes,
        points=points,
        blocks=blocks,
        fixed=tuple(middles.held(value) for value in deck.fixed),
        rigid=tuple(replace(body, nodes=middles.within(body.nodes)) for body in deck.rigid),
        couplings=tuple(middles.coupled(bound) for bound in deck.couplings),
        thicknesses=every.both(deck.thicknesses),
        initial=every.mean(deck.initial),
        steps=tuple(every.warmed(middles.of_step(step)) for step in deck.steps),
    )
    return new, every.nodes, every.ends


class _Middles:
    """Nodes (m,) in the middle of edges, and the ends (m, 2) of these."""

    def __init__(self, nodes: Numbers, ends: Numbers) -> None:
        self.nodes, self.ends = nodes, ends

    def within(self, nodes: Numbers) -> Numbers:
        """Nodes with the middles of edges that have both ends among them."""
        inside = np.isin(self.ends, nodes).all(axis=1)
        return np.concatenate([nodes, self.nodes[inside]]) if inside.any() else nodes

    def held(self, value: Prescribed) -> Prescribed:
        return replace(value, numbers=self.within(value.numbers)) if value.kind == "boundary" else value

    def of_step(self, step: Step) -> Step:
        return replace(step, values=tuple(self.held(value) for value in step.values))

    def coupled(self, bound: Coupling) -> Coupling:
        """A distributing coupling keeps its nodes, by which its weights go."""
        return bound if bound.distributing else replace(bound, nodes=self.within(bound.nodes))

    def mean(self, known: Mapping[int, float]) -> dict[int, float]:
        """Values at nodes with those in the middle, where both ends have one."""
        result = dict(known)
        if known:
            for node, (a, b) in zip(self.nodes.tolist(), self.ends.tolist()):
                if a in known and b in known:
                    result[node] = 0.5 * (known[a] + known[b])
        return result

    def both(self, known: Mapping[int, tuple[float, float]]) -> dict[int, tuple[float, float]]:
        """The same of pairs of values."""
        first, second = (self.mean({node: pair[i] for node, pair in known.items()}) for i in (0, 1))
        return {node: (value, second[node]) for node, value in first.items()}

    def warmed(self, step: Step) -> Step:
        """A step with temperatures in the middle."""
        at = {n: value for value in step.values if value.kind == "temperature" for n in value.numbers.tolist()}
        new = [
            replace(at[a], numbers=np.array([node]), value=0.5 * (at[a].value + at[b].value))
            for node, (a, b) in zip(self.nodes.tolist(), self.ends.tolist())
            if a in at and b in at
        ]
        return replace(step, values=(*step.values, *new)) if new else step
