"""Sides of a sector of cyclic symmetry: of what is meshed, each side continues as the other one, turned."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

NEAR = 1e-3  # of the sides' extent: distance within which nodes on both sides, one turned, count as the same
WHOLE = 1e-6  # of the number of sectors: one that is not whole does not close
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Turned:
    """Points ``nodes`` (n,) are where ``partners`` (n,) come to by x -> turn @ x + shift, and move as these do, turned: turn
    (dim, dim), shift (dim,) a length."""

    nodes: NDArray[np.int64]
    partners: NDArray[np.int64]
    turn: Array
    shift: Array

    def power(self, k: int) -> tuple[Array, Array]:
        """Turn and shift of ``k`` sectors on."""
        turn, shift = np.eye(len(self.turn)), np.zeros(len(self.turn))
        for _ in range(abs(k)):
            turn, shift = self.turn @ turn, self.turn @ shift + self.shift
        return (turn, shift) if k >= 0 else (turn.T, -turn.T @ shift)

    @property
    def sectors(self) -> int:
        """How many make a whole turn; 0 where none do."""
        cosine = 0.5 * (np.trace(self.turn) - (len(self.turn) - 2))
        count = 2.0 * np.pi / max(float(np.arccos(np.clip(cosine, -1.0, 1.0))), 1e-12)
        return round(count) if abs(count - round(count)) < WHOLE * count else 0


@dataclass(frozen=True)
class Matched:
    """Which point of the other side each of a side is, (n,); turn: (dim, dim) of it, by a positive angle where ``forward``;
    distance: (n,) by which they miss each other; fits: every point has one of its own."""

    match: NDArray[np.int64]
    turn: Array
    forward: bool
    distance: Array
    fits: bool


def matched(side: Array, other: Array, sectors: float, origin: Array, axis: Array | None = None) -> Matched:
    """Points of one side of a sector, (n, dim), and of the other, (m, dim), which is turned by one of ``sectors`` about an
    axis through ``origin`` (dim,), along ``axis`` (3,) in 3D."""
    x, y = side - origin, other - origin
    size = float(np.ptp(np.concatenate([x, y]), axis=0).max())
    turns = [rotation(sign * 2.0 * np.pi / sectors, axis) for sign in (1.0, -1.0)]
    found = [cKDTree(y @ turn.T).query(x) for turn in turns]
    best = int(found[1][0].max() < found[0][0].max())
    distance, match = (np.asarray(part) for part in found[best])
    fits = bool(distance.max() <= NEAR * size) and len(np.unique(match)) == len(match)
    return Matched(match, turns[best], best == 0, distance, fits)


def rotation(angle: float, axis: Sequence[float] | Array | None = None) -> Array:
    """Rotation matrix (Rodrigues) about an ``axis`` (3,) of any length; in the plane where left out."""
    if axis is None:
        return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    e = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    cross = np.array([[0.0, -e[2], e[1]], [e[2], 0.0, -e[0]], [-e[1], e[0], 0.0]])
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross)
