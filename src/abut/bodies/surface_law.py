"""Stresses where a material's strain along a surface and the traction on it are known: theory (Z10)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.errors import ConvergenceError
from abut.materials.elastic import LinearElastic
from abut.materials.material import FiniteMaterial, Material
from abut.materials.plane_stress import Evaluate, law

LIMIT = 20  # Newton's iterations: one for a linear material under small strains
LEFT = 1e-9  # traction left over modulus times strain, and over the traction
PLACE = ((0, 3, 5), (3, 1, 4), (5, 4, 2))  # components of a tensor's rows among xx yy zz xy yz zx

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Along:
    """What is known at points of a surface, in the undeformed axes. slope: (n, dim, dim - 1) of the displacement along
    tangents (n, dim - 1, dim), orthonormal; normal: (n, dim) unit; across: (n, dim) guess of the slope along it; hoop: (n,)
    stretch out of the plane less 1; thermal: (n,) strain of temperature; traction: (n, dim) per current area."""

    slope: Array
    tangents: Array
    normal: Array
    across: Array
    hoop: Array
    thermal: Array
    traction: Array

    def part(self, rows: Array) -> Along:
        """Some of its points: (n,) bool."""
        return Along(*(getattr(self, name)[rows] for name in self.__dataclass_fields__))


def known_law(material: Material, finite: bool, plane: str | None) -> Evaluate | None:
    """The stress of a material by its strain alone, of Green and Lagrange under finite strains; None where it hangs on the
    past, or is not to be had at a single point."""
    if material.initial(1).shape[1]:
        return None
    if not finite:
        return material.evaluate
    if plane == "stress":
        return None
    if isinstance(material, LinearElastic):  # of Saint Venant and Kirchhoff
        return material.evaluate
    return material.evaluate_finite if isinstance(material, FiniteMaterial) else None


def stress_along(evaluate: Evaluate, modulus: float, finite: bool, plane: str | None, at: Along) -> tuple[Array, Array]:
    """Stresses (n, 6), Cauchy's under finite strains, and at which points they were found, (n,) bool: the slope along the
    normal is what gives the traction, by Newton's method."""
    n, dim = at.normal.shape
    across, found = at.across.copy(), np.zeros(n, dtype=bool)
    stress, empty, one = np.zeros((n, 3, 3)), np.zeros((n, 0)), np.eye(3)
    normal, traction = np.zeros((n, 3)), np.zeros((n, 3))
    normal[:, :dim], traction[:, :dim] = at.normal, at.traction
    area = _stretched(at) if finite else np.ones(n)
    relate = law(evaluate, plane)
    for _ in range(LIMIT):
        gradient = np.zeros((n, 3, 3))
        gradient[:, 2, 2] = at.hoop
        gradient[:, :dim, :dim] = at.slope @ at.tangents + across[:, :, None] * at.normal[:, None]
        moved = one + gradient if finite else np.broadcast_to(one, gradient.shape)
        strain = 0.5 * (gradient + np.swapaxes(gradient, 1, 2)) - at.thermal[:, None, None] * one
        if finite:
            strain += 0.5 * np.swapaxes(gradient, 1, 2) @ gradient
        try:
            _, (values, tangent, _) = relate(_voigt(strain), empty)
        except ConvergenceError:
            return np.zeros((n, 6)), np.zeros(n, dtype=bool)
        stress = values[:, np.array(PLACE)]
        push = (stress @ normal[..., None])[..., 0]
        left = (moved @ push[..., None])[..., 0] - area[:, None] * traction
        stiff = tangent[:, np.array(PLACE)][:, :, :, np.array(PLACE)]
        own = np.einsum("nj,nijkl,nl->nik", normal, stiff, normal)
        slope = moved @ own @ np.swapaxes(moved, 1, 2)
        if finite:
            slope = slope + (push * normal).sum(axis=1)[:, None, None] * one
        scale = modulus * np.abs(gradient).max(axis=(1, 2)) + np.abs(traction).max(axis=1)
        size = np.abs(left[:, :dim]).max(axis=1)
        found = np.isfinite(size) & (size <= LEFT * scale)
        if found.all():
            break
        across -= np.linalg.solve(slope[:, :dim, :dim], left[:, :dim, None])[..., 0]
    if finite:
        size = np.linalg.det(moved)
        found &= size > 0.0
        stress = moved @ stress @ np.swapaxes(moved, 1, 2) / np.where(found, size, 1.0)[:, None, None]
    return _voigt(stress, 1.0), found


def _stretched(at: Along) -> Array:
    """Current over undeformed area."""
    lines = np.swapaxes(at.tangents, 1, 2) + at.slope
    if lines.shape[1] == 2:
        return np.asarray(np.linalg.norm(lines[:, :, 0], axis=1) * (1.0 + at.hoop))
    return np.asarray(np.linalg.norm(np.cross(lines[:, :, 0], lines[:, :, 1]), axis=1))


def _voigt(tensor: Array, shear: float = 2.0) -> Array:
    rows = [tensor[:, 0, 0], tensor[:, 1, 1], tensor[:, 2, 2]]
    rows += [shear * tensor[:, a, b] for a, b in ((0, 1), (1, 2), (2, 0))]
    return np.stack(rows, axis=1)
