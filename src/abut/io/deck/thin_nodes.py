"""What is prescribed at nodes of shells, said of the nodes of the solids that stand for them.

With u_b and u_t of the nodes at both sides, n the normal and h the thickness, the displacement of the shell's node is
(u_b + u_t) / 2, and its turn n x (u_t - u_b) / h, beside one about n that nothing resists."""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from abut.io.deck.thin_record import Thin
from abut.io.deck.time_histories import Course, combine

Vector = NDArray[np.float64]
Point = tuple[int, int]  # node, axis 0..2; turns 3..5
SMALL = 1e-9  # coefficients that are none, and the part of a moment along the normal
Row = tuple[dict[Point, float], Course]


def means(thin: Mapping[int, Thin], wanted: Collection[Point], local: Mapping[int, Vector]) -> list[dict[Point, float]]:
    """Terms whose sum is zero: a node's displacement along an axis (of its own where it has some) less the mean of those
    that stand for it, for those ``wanted``."""
    result = []
    for node, axis in wanted:
        terms: dict[Point, float] = {(node, axis): 1.0}
        terms |= {(n, k): -c for (n, k), c in _shares(thin[node], _row(node, axis, local)).items()}
        result.append(terms)
    return result


def straight(
    thin: Mapping[int, Thin], wanted: Collection[Point], local: Mapping[int, Vector]
) -> list[dict[Point, float]]:
    """Terms whose sum is zero: the displacement along an axis of each node between those that stand for the shell's node
    less that on the straight line from the first to the last of these. Where the thickness is not rigid the part of the axis
    along the normal does not count: it changes there as it does inside the shell, which bends over edges that bulge by
    Poisson's ratio."""
    return [terms for node, axis in wanted for terms in _between(thin[node], _row(node, axis, local))]


def _row(node: int, axis: int, local: Mapping[int, Vector]) -> Vector:
    return np.asarray(local[node][axis] if node in local else np.eye(3)[axis])


def _between(thin: Thin, direction: Vector) -> list[dict[Point, float]]:
    row = direction
    if not thin.rigid and thin.along is not None:
        normal = np.array(thin.along)
        row = direction - (direction @ normal) * normal
    ends = thin.nodes[0], thin.nodes[-1]
    every = [
        {
            (n, int(k)): c * float(row[k])
            for n, c in ((node, 1.0), (ends[0], share - 1.0), (ends[1], -share))
            for k in np.flatnonzero(np.abs(row) > SMALL)
        }
        for node, share in thin.inner
    ]
    return [terms for terms in every if terms]


def spread(
    thin: Mapping[int, Thin], pushed: Mapping[Point, Course], local: Mapping[int, Vector]
) -> dict[Point, Course]:
    """Forces and moments at nodes of shells as forces at those that stand for them. Raises ValueError for a moment about
    the normal: its argument is the node and the direction."""
    parts: dict[Point, list[tuple[float, Course]]] = {}
    for (node, direction), course in pushed.items():
        axes = local.get(node, np.eye(3))
        each = thin[node]
        if direction < 3:
            shares = _shares(each, axes[direction])
        else:
            moment = axes[direction - 3]
            if each.along is None or abs(float(moment @ np.array(each.along))) > SMALL:
                raise ValueError(node, direction)
            shares = _difference(each, np.cross(moment, np.array(each.along)))
        for point, share in shares.items():
            parts.setdefault(point, []).append((share, course))
    return {point: combine(terms) for point, terms in parts.items()}


def turns(
    thin: Mapping[int, Thin], given: Mapping[Point, Course], local: Mapping[int, Vector]
) -> list[tuple[int, Row]]:
    """Rows (node, (terms, course)) that prescribe turns; the turn about the normal, which is free, is eliminated."""
    by_node: dict[int, dict[int, Course]] = {}
    for (node, direction), course in given.items():
        by_node.setdefault(node, {})[direction - 3] = course
    result = []
    for node, histories in by_node.items():
        each = thin[node]
        normal = np.array(each.along)
        about = local.get(node, np.eye(3))[list(histories)]
        drill = about @ normal
        keep = np.eye(len(about)) if np.abs(drill).max() < SMALL else np.linalg.svd(drill[:, None])[0][:, 1:].T
        for weights in keep:
            terms = _difference(each, np.cross(weights @ about, normal))
            if terms:
                course = combine([(float(w), c) for w, c in zip(weights, histories.values())])
                result.append((node, (terms, course)))
    return result


def turn_terms(node: int, thin: Thin, about: Vector) -> dict[Point, float]:
    """Terms of the turn of a shell's node about an axis (3,), with that about the normal, which nothing resists, as an
    unknown of its own: (-node, 0), a point of no element."""
    normal = np.array(thin.along)
    drill = float(about @ normal)
    return _difference(thin, np.cross(about, normal)) | ({(-node, 0): drill} if abs(drill) > SMALL else {})


def _shares(thin: Thin, direction: Vector) -> dict[Point, float]:
    """A vector in parts at each node."""
    return {
        (node, int(k)): float(direction[k]) * share * thin.stretch[k]
        for node, share in thin.shares
        for k in np.flatnonzero(np.abs(direction) > SMALL)
    }


def _difference(thin: Thin, direction: Vector) -> dict[Point, float]:
    """A vector over the thickness at the last node, and its opposite at the first."""
    ends = ((thin.nodes[0], -1.0 / thin.apart), (thin.nodes[-1], 1.0 / thin.apart))
    return {
        (node, int(k)): c * float(direction[k]) for node, c in ends for k in np.flatnonzero(np.abs(direction) > SMALL)
    }
