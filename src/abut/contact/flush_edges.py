"""Edges at which both sides of a contact end, as at a clamp common to both, or beyond which the contactor's body goes on, as
beside glue, and what is closed there alone; theory (P26)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.cells import BY_CODE, MAX_FACET_NODES
from abut.contact.geometry import beside_others
from abut.contact.pressure_space import PressureSpace
from abut.contact.rim import Rim
from abut.mesh.surface import Surface


def second_order(surface: Surface) -> NDArray[np.bool_]:
    """Facets (n_facets,) of degree 2."""
    return np.isin(surface.kinds, [cell.code for cell in BY_CODE if cell.degree == 2])


@dataclass(frozen=True)
class FlushEdges:
    """Of a contactor with n_facets. facet: (m,) quadratic ones with such an edge, once for each; at_edge: (m, 9) bool, their
    corners on it."""

    n_facets: int
    facet: NDArray[np.int64]
    at_edge: NDArray[np.bool_]

    @classmethod
    def of(
        cls, contactor: Surface, border: Rim, beyond: NDArray[np.bool_], ongoing: NDArray[np.bool_] | None
    ) -> FlushEdges:  # fmt: skip
        """border: of the contactor; beyond, ongoing: (m,) its edges beyond which the target goes on, and the contactor's own
        body (None for nowhere). Facets between targets beside each other have none."""
        some = ~beyond if ongoing is None else ~beyond | ongoing
        here = some & (second_order(contactor) & ~beside_others(contactor))[border.facet]
        facet, ends = border.facet[here], border.ends[here]
        nodes = contactor.nodes[facet]
        count = np.array([BY_CODE[code].corners for code in contactor.kinds[facet].tolist()], dtype=np.int64)
        corner = np.arange(MAX_FACET_NODES) < count[:, None]
        return cls(len(contactor), facet, corner & (nodes[:, :, None] == ends[:, None, :]).any(axis=2))

    def alone(self, space: PressureSpace, closed: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Functions (n_functions,) at such edges that are closed while no other is in any of their facets, but for others on
        the edge. closed: (n_functions,)."""
        if not len(self.facet):
            return np.zeros(len(closed), dtype=bool)
        uses = abs(space.plain)
        sums: NDArray[np.float64] = np.asarray(uses @ closed.astype(float))
        acts: NDArray[np.bool_] = np.asarray(sums.reshape(self.n_facets, MAX_FACET_NODES) > 0.0)
        own = acts[self.facet]
        only = own & self.at_edge & ~(own & ~self.at_edge).any(axis=1, keepdims=True)
        good = acts & (acts.sum(axis=1) == 1)[:, None]
        np.logical_or.at(good, self.facet, only)
        there = np.zeros_like(acts)
        np.logical_or.at(there, self.facet, self.at_edge)
        at_edge, others = (np.asarray(uses.T @ each.ravel().astype(float) > 0.0) for each in (there, acts & ~good))
        return np.asarray(closed & at_edge & ~others)

    def on(self, space: PressureSpace, some: NDArray[np.bool_], facets: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Which of ``some`` functions (n_functions,) have given facets (n_facets,) alone."""
        others = np.repeat(~facets, MAX_FACET_NODES).astype(float)
        return np.asarray(some & ~(abs(space.plain).T @ others > 0.0))

    def facets(self, space: PressureSpace, closed: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Facets (n_facets,) of those functions."""
        return self.touched(space, self.alone(space, closed))

    def touched(self, space: PressureSpace, some: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Facets (n_facets,) of ``some`` functions (n_functions,)."""
        acts = abs(space.plain) @ some.astype(float)
        return np.asarray((acts > 0.0).reshape(self.n_facets, MAX_FACET_NODES).any(axis=1))
