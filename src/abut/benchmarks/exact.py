"""Exact solutions of linear elasticity with frictionless contact on a plane, in closed form."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.materials.elastic import LinearElastic, lame

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Waves:
    """Sum of terms a z^n cos(k . s + f), z the last coordinate, s the others; closed under differentiation.

    terms: rows (a, n, k (dim - 1 numbers), f)."""

    terms: tuple[tuple[float, int, tuple[float, ...], float], ...]

    def __call__(self, x: Array) -> Array:
        """Values (n,) at points (n, dim)."""
        s, z = x[:, :-1], x[:, -1]
        return np.asarray(sum((a * z**n * np.cos(s @ np.array(k) + f) for a, n, k, f in self.terms), np.zeros(len(x))))

    def __add__(self, other: Waves) -> Waves:
        """The sum; terms alike are made one, and those without amplitude left out."""
        total: dict[tuple[int, tuple[float, ...], float], float] = {}
        for a, n, k, f in self.terms + other.terms:
            total[n, k, f] = total.get((n, k, f), 0.0) + a
        return Waves(tuple((a, n, k, f) for (n, k, f), a in total.items() if a))

    def times(self, factor: float, power: int = 0) -> Waves:
        """factor z^power times this."""
        return Waves(tuple((factor * a, n + power, k, f) for a, n, k, f in self.terms))

    def along(self, axis: int) -> Waves:
        """Derivative by a coordinate."""
        if self.terms and axis == len(self.terms[0][2]):
            return Waves(tuple((a * n, n - 1, k, f) for a, n, k, f in self.terms if n))
        return Waves(tuple((-a * k[axis], n, k, f - 0.5 * np.pi) for a, n, k, f in self.terms))


@dataclass(frozen=True)
class WaveField:
    """A displacement field of waves, one for each component, in a material (2D: plane strain)."""

    components: tuple[Waves, ...]
    material: LinearElastic

    def displacement(self, x: Array) -> Array:
        """(n, dim) at points (n, dim)."""
        return np.stack([u(x) for u in self.components], axis=1)

    def gradient(self, x: Array) -> Array:
        """(n, dim, dim), [i, j] the derivative of component i along j."""
        dim = len(self.components)
        return np.stack([np.stack([u.along(j)(x) for j in range(dim)], axis=1) for u in self.components], axis=1)

    def stress(self, x: Array) -> Array:
        """(n, dim, dim)."""
        lambda_, mu = lame(self.material, "strain")
        slope = self.gradient(x)
        trace = np.trace(slope, axis1=1, axis2=2)[:, None, None]
        return lambda_ * trace * np.eye(len(self.components)) + mu * (slope + np.swapaxes(slope, 1, 2))

    def body_force(self, x: Array) -> Array:
        """-div sigma = -(lambda + mu) grad div u - mu laplace u, (n, dim)."""
        lambda_, mu = lame(self.material, "strain")
        result = []
        for i, u in enumerate(self.components):
            force = Waves(())
            for j, other in enumerate(self.components):
                force += other.along(j).along(i).times(-lambda_ - mu) + u.along(j).along(j).times(-mu)
            result.append(force(x))
        return np.stack(result, axis=1)


def full_contact(
    pressure: Waves, level: Waves, slides: Sequence[Waves], curves: Sequence[Waves], material: LinearElastic
) -> WaveField:
    """A field whose plane z = 0 carries the pressure and no shear, and moves to z = ``level``.

    pressure, level, slides (dim - 1, the displacement along the plane) and curves (dim, the terms in z^2) must not depend
    on z. Two bodies with the same pressure and level, whatever their materials, slides and curves, are in contact.

    With u_s = slide - z grad level + z^2 curve the shear strain vanishes on z = 0, and u_z = level + z g + z^2 curve has
    the normal stress (lambda + 2 mu) g + lambda div slide there.
    """
    field = WaveField((), material)
    lambda_, mu = lame(material, "strain")
    slope = pressure.times(-1.0)
    for i, slide in enumerate(slides):
        slope = slope + slide.along(i).times(-lambda_)
    tangential = [
        slide + level.along(i).times(-1.0, 1) + curve.times(1.0, 2)
        for i, (slide, curve) in enumerate(zip(slides, curves))
    ]
    normal = level + slope.times(1.0 / (lambda_ + 2.0 * mu), 1) + curves[-1].times(1.0, 2)
    return replace(field, components=(*tangential, normal))


@dataclass(frozen=True)
class EdgeOfContact:
    """The symmetric field of order r^(3/2) at an edge of contact: closed for x < 0, open for x > 0, no shear on z = 0.

    The third term of Williams' series for a crack that lies at x > 0. Pressure strength sqrt(-x) for x < 0; opening of
    either body (1 - nu^2) 4 strength / (3 E) x^(3/2) for x > 0. Plane strain; in 3D the second coordinate plays no part.
    ``upper``: whether the body lies at z > 0.

    With zeta the complex position, seen from the crack, phi = a zeta^(3/2) and psi = -a/2 zeta^(3/2) in
    2 mu (u + i v) = kappa phi - zeta conj(phi') - conj(psi), a = -strength / 3 (Muskhelishvili).
    """

    strength: float
    material: LinearElastic
    upper: bool

    def displacement(self, x: Array) -> Array:
        """(n, dim) at points (n, dim)."""
        zeta, a, kappa, mu = self._complex(x)
        root = np.sqrt(zeta)
        moved = a * (kappa * zeta * root - 1.5 * zeta * np.conj(root) + 0.5 * np.conj(zeta * root)) / (2.0 * mu)
        result = np.zeros(x.shape)
        result[:, 0], result[:, -1] = -moved.real, moved.imag * (1.0 if self.upper else -1.0)
        return result

    def gradient(self, x: Array) -> Array:
        """(n, dim, dim), [i, j] the derivative of component i along j."""
        zeta, a, kappa, mu = self._complex(x)
        root = np.sqrt(zeta)
        turned = zeta * root / np.maximum(np.abs(zeta), 1e-300)  # zeta conj(zeta^(-1/2))
        by_zeta = 1.5 * a * (kappa * root - np.conj(root)) / (2.0 * mu)
        by_conjugate = a * (-0.75 * turned + 0.75 * np.conj(root)) / (2.0 * mu)
        along, across = by_zeta + by_conjugate, 1j * (by_zeta - by_conjugate)
        sign = -1.0 if self.upper else 1.0  # the crack lies at x > 0: seen from it, x is turned round; below, z as well
        result = np.zeros((*x.shape, x.shape[1]))
        result[:, 0, 0], result[:, 0, -1] = along.real, sign * across.real
        result[:, -1, 0], result[:, -1, -1] = sign * along.imag, across.imag
        return result

    def pressure(self, x: Array) -> Array:
        """On z = 0, (n,)."""
        return self.strength * np.sqrt(np.maximum(-x[:, 0], 0.0))

    def _complex(self, x: Array) -> tuple[NDArray[np.complex128], float, float, float]:
        _, mu = lame(self.material, "strain")
        zeta = -x[:, 0] + 1j * np.abs(x[:, -1])
        return zeta, -self.strength / 3.0, 3.0 - 4.0 * self.material.poisson, mu
