"""Pictures of triangles as PNG, without any library that draws: the report where its scripts are not built."""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

SPACING = 0.7  # pixels between the samples of a triangle: no pixel within it is missed
CHUNK = 2_000_000  # samples that are computed at once
LIFTED = 2e-3  # how far lines are drawn before the surfaces they lie on, as a share of the picture's depth

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class View:
    """Where the picture is seen from: ``axes`` (3, 3), rows right, up and towards the eye; ``middle`` (3,) of what is shown
    and ``scale``, pixels per length; width, height: pixels."""

    axes: Vector
    middle: Vector
    scale: float
    width: int
    height: int

    def places(self, points: Vector) -> Vector:
        """Pixels to the right and down, and height towards the eye, of points (..., 3)."""
        own = (points - self.middle) @ self.axes.T * self.scale
        return np.stack([0.5 * self.width + own[..., 0], 0.5 * self.height - own[..., 1], own[..., 2]], axis=-1)


def view(points: Vector, towards: Vector, width: int, height: int, up: Vector | None = None) -> View:
    """A view that holds all points (n, 3), from the direction ``towards`` (3,) the eye; ``up``: default z."""
    out = towards / np.linalg.norm(towards)
    up = np.array([0.0, 0.0, 1.0]) if up is None else up
    right = np.cross(up, out)
    if np.linalg.norm(right) < 1e-6:
        right = np.cross([0.0, 1.0, 0.0], out)
    right = right / np.linalg.norm(right)
    axes = np.stack([right, np.cross(out, right), out])
    own = points @ axes.T
    low, high = own.min(axis=0), own.max(axis=0)
    extent = np.maximum(high - low, 1e-9 * max(float((high - low).max()), 1e-300))
    scale = 0.88 * min(width / extent[0], height / extent[1])
    return View(axes, 0.5 * (low + high) @ axes, float(scale), width, height)


def ramp(stops: tuple[str, ...], share: Vector) -> Vector:
    """Colours (n, 3) from 0 to 1 of a map, given as hexadecimal numbers, at shares (n,) of its length."""
    rgb = np.array([[int(s[k : k + 2], 16) for k in (0, 2, 4)] for s in stops]) / 255.0
    at = np.clip(share, 0.0, 1.0) * (len(rgb) - 1)
    return np.stack([np.interp(at, np.arange(len(rgb)), column) for column in rgb.T], axis=-1)


def lights(triangles: Vector, seen: View) -> Vector:
    """How bright triangles (m, 3, 3) are, (m,): both their sides are lit, from the upper left."""
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]) @ seen.axes.T
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    normal *= np.where(normal[:, 2:] < 0.0, -1.0, 1.0)
    key = np.maximum(normal @ (np.array([-0.4, 0.55, 0.75]) / np.linalg.norm([0.4, 0.55, 0.75])), 0.0)
    return np.asarray(0.6 + 0.32 * key + 0.12 * normal[:, 2])


class Canvas:
    """Pixels and how near to the eye what they show is."""

    def __init__(self, seen: View) -> None:
        self.seen = seen
        self.colour = np.ones((seen.width * seen.height, 4))
        self.colour[:, 3] = 0.0
        self.near = np.full(seen.width * seen.height, -np.inf)

    def triangles(self, points: Vector, colours: Vector) -> None:
        """Triangles (m, 3, 3) with a colour (m, 3, 3) at each corner."""
        at = self.seen.places(points)
        sides = np.linalg.norm(np.roll(at, -1, axis=1)[..., :2] - at[..., :2], axis=2)
        first = sides.argmax(axis=1)  # the longest side is sampled along, the height over it across
        turn = (first[:, None] + np.arange(3)) % 3
        rows = np.arange(len(at))[:, None]
        at, colours, longest = at[rows, turn], colours[rows, turn], sides.max(axis=1)
        a, b = at[:, 1, :2] - at[:, 0, :2], at[:, 2, :2] - at[:, 0, :2]
        height = np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / np.maximum(longest, 1e-300)
        self._samples(at, colours, _count(longest), _count(height))

    def lines(self, points: Vector, colour: tuple[float, float, float]) -> None:
        """Lines (k, 2, 3), a little before what they lie on."""
        at = self.seen.places(points)
        at[..., 2] += LIFTED * max(self.seen.width, self.seen.height)
        long = np.linalg.norm(at[:, 1, :2] - at[:, 0, :2], axis=1)
        corners = at[:, [0, 1, 1]]
        self._samples(corners, np.broadcast_to(colour, corners.shape), _count(long), np.ones(len(at), dtype=np.int64))

    def _samples(self, at: Vector, colours: Vector, along: NDArray[np.int64], across: NDArray[np.int64]) -> None:
        kinds, group = np.unique(np.stack([along, across], axis=1), axis=0, return_inverse=True)
        for number, (n, m) in enumerate(kinds.tolist()):
            s, t = np.meshgrid(np.linspace(0.0, 1.0, n), np.linspace(0.0, 1.0, m) if m > 1 else [0.0])
            weights = np.stack([(1.0 - s) * (1.0 - t), s * (1.0 - t), t], axis=-1).reshape(-1, 3)
            those = np.flatnonzero(group.ravel() == number)
            for part in np.array_split(those, max(1, -(-len(those) * len(weights) // CHUNK))):
                self._put((weights @ at[part]).reshape(-1, 3), (weights @ colours[part]).reshape(-1, 3))

    def _put(self, at: Vector, colours: Vector) -> None:
        """Samples (n, 3) with colours (n, 3): of several in a pixel the nearest stays."""
        column, row = np.floor(at[:, 0]).astype(np.int64), np.floor(at[:, 1]).astype(np.int64)
        inside = (column >= 0) & (column < self.seen.width) & (row >= 0) & (row < self.seen.height)
        pixel = np.where(inside, row * self.seen.width + column, 0)
        shown = np.flatnonzero(inside & (at[:, 2] > self.near[pixel]))
        shown = shown[np.argsort(at[shown, 2], kind="stable")]  # the last one that is written stays
        self.near[pixel[shown]] = at[shown, 2]
        self.colour[pixel[shown], :3] = colours[shown]
        self.colour[pixel[shown], 3] = 1.0

    def png(self) -> bytes:
        pixels = np.round(255.0 * np.clip(self.colour, 0.0, 1.0)).astype(np.uint8)
        lines = pixels.reshape(self.seen.height, -1)
        raw = np.concatenate([np.zeros((len(lines), 1), np.uint8), lines], axis=1).tobytes()
        head = struct.pack(">IIBBBBB", self.seen.width, self.seen.height, 8, 6, 0, 0, 0)
        parts = ((b"IHDR", head), (b"IDAT", zlib.compress(raw, 6)), (b"IEND", b""))
        return b"\x89PNG\r\n\x1a\n" + b"".join(
            struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))
            for name, data in parts
        )


def _count(lengths: Vector) -> NDArray[np.int64]:
    """Samples along lengths in pixels, rounded up to one of few numbers so that many triangles are sampled alike."""
    need = np.clip(lengths / SPACING + 1.0, 2.0, 4096.0)
    return np.ceil(1.25 ** np.ceil(np.log(need) / np.log(1.25))).astype(np.int64)
