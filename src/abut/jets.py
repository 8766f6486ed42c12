"""Functions of a few variables with their first and second derivatives, by the rules of products."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from abut.types import Array


@dataclass(frozen=True)
class Jet:
    """A scalar or vector (...), its slopes (..., n) and bends (..., n, n) by n variables."""

    value: Array
    slope: Array
    bend: Array

    @classmethod
    def linear(cls, value: Array, slope: Array) -> Jet:
        """Of a function with constant slopes."""
        return cls(value, slope, np.zeros((*slope.shape, slope.shape[-1])))

    def __add__(self, other: Jet) -> Jet:
        return Jet(self.value + other.value, self.slope + other.slope, self.bend + other.bend)

    def __sub__(self, other: Jet) -> Jet:
        return self + other.times(-1.0)

    def times(self, factor: float) -> Jet:
        """Times a number."""
        return Jet(factor * self.value, factor * self.slope, factor * self.bend)

    def __getitem__(self, component: int) -> Jet:
        return Jet(self.value[component], self.slope[component], self.bend[component])


def dot(a: Jet, b: Jet) -> Jet:
    """Of two vectors (3,)."""
    cross = np.einsum("km,kn->mn", a.slope, b.slope)
    bend = np.einsum("k,kmn->mn", a.value, b.bend) + np.einsum("k,kmn->mn", b.value, a.bend)
    return Jet(np.asarray(a.value @ b.value), a.value @ b.slope + b.value @ a.slope, bend + cross + cross.T)


def cross(a: Jet, b: Jet) -> Jet:
    """Of two vectors (3,)."""
    slope = np.cross(a.slope, b.value[:, None], axis=0) + np.cross(a.value[:, None], b.slope, axis=0)
    mixed = np.cross(a.slope[:, :, None], b.slope[:, None, :], axis=0)
    bend = (
        np.cross(a.bend, b.value[:, None, None], axis=0)
        + np.cross(a.value[:, None, None], b.bend, axis=0)
        + mixed
        + mixed.transpose(0, 2, 1)
    )
    return Jet(np.cross(a.value, b.value), slope, bend)


def angle(across: Jet, along: Jet) -> Jet:
    """The angle between -pi and pi of the direction with these components, scalars."""
    s, c = across.value, along.value
    square = s * s + c * c
    slope = (c * across.slope - s * along.slope) / square
    mixed = np.outer(across.slope, along.slope)
    numerator = c * across.bend - s * along.bend + mixed - mixed.T
    of_square = 2.0 * (s * across.slope + c * along.slope)
    bend = numerator / square - np.outer(slope, of_square) / square
    return Jet(np.arctan2(s, c), slope, 0.5 * (bend + bend.T))


def linear(jet: Jet, moved: Array) -> Jet:
    """The linear part of a function about where its variables are zero, at ``moved`` (n,)."""
    return Jet.linear(np.asarray(jet.value + jet.slope @ moved), jet.slope)
