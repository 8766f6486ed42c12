"""Laws of the compiled core: what integrates cells without a way through Python."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from abut._core import Cells, Hyperelastic, PointLaw, integrate_hyperelastic, integrate_isotropic
from abut.materials.evaluated import Array
from abut.types import Array as AnyArray

Pattern = tuple[AnyArray, AnyArray, AnyArray]  # indptr, indices and values of the stiffness, to which is added
Unsound = tuple[int, float] | None  # a cell without a sound deformation, and its determinant


@dataclass(frozen=True)
class Wanted:
    """What to integrate, None for what not. force: (n_points, dim), added to; tangent; stress: (cells q, 6), written, under
    finite strains Cauchy's; energy: (cells,), written by laws that know it; after: (cells q, h), the new history."""

    force: Array | None = None
    tangent: Pattern | None = None
    stress: Array | None = None
    energy: Array | None = None
    after: Array | None = None


@dataclass(frozen=True)
class Since:
    """From where Newton's method came to a displacement. displacement: (n_points, dim), of an iteration, or what a guess
    starts from."""

    displacement: Array
    guessed: bool = False


@dataclass(frozen=True)
class At:
    """Where to integrate: cells with a rule, constants (cells, m), plane_stress, displacement (n_points, dim) or None,
    thermal strains (cells, n_nodes) or None, history before, (cells q, h), and under finite strains from where
    Newton's method came. change: (cells q,) how much warmer the points became, of materials that take the temperature
    themselves."""

    cells: Cells
    constants: Array
    plane_stress: bool
    displacement: Array | None
    thermal: Array | None
    before: Array | None = None
    change: Array | None = None
    since: Since | None = None

    @property
    def earlier(self) -> tuple[Array | None, bool]:
        """From where Newton's method came, for the compiled core."""
        return (None, False) if self.since is None else (self.since.displacement, self.since.guessed)


class Kernel(Protocol):
    """name: of its kind, those of all kernels differ; together: bodies that have it are integrated at once, with constants
    by cell, and have no history."""

    @property
    def name(self) -> str: ...

    @property
    def together(self) -> bool: ...

    def integrate(self, at: At, wanted: Wanted) -> Unsound:
        """Adds and writes what is wanted, in place."""
        ...


@dataclass(frozen=True)
class Isotropic:
    """Linear elasticity under small strains; constants: lambda and mu."""

    name: str = "isotropic"
    together: bool = True

    def integrate(self, at: At, wanted: Wanted) -> Unsound:
        """Forces, tangents and stresses of cells by the compiled law, as in ``Kernel``."""
        constants = at.constants
        if at.plane_stress:
            lambda_, mu = constants.T
            constants = np.column_stack([2.0 * lambda_ * mu / (lambda_ + 2.0 * mu), mu])
        integrate_isotropic(
            at.cells,
            constants,
            at.plane_stress,
            at.displacement,
            at.thermal,
            wanted.force,
            wanted.tangent,
            wanted.stress,
        )
        return None


@dataclass(frozen=True)
class HyperelasticKernel:
    """A hyperelastic law under finite strains by two constants."""

    law: Hyperelastic
    together: bool = True

    @property
    def name(self) -> str:
        """Of the compiled law, as in ``Kernel``."""
        return f"hyperelastic {self.law.value}"

    def integrate(self, at: At, wanted: Wanted) -> Unsound:
        """Forces, tangents and stresses of cells by the compiled law, as in ``Kernel``."""
        return integrate_hyperelastic(
            at.cells, at.constants, self.law, at.plane_stress, at.displacement, at.thermal, wanted.force, wanted.tangent,
            wanted.stress, wanted.energy, *at.earlier,
        )  # fmt: skip


@dataclass(frozen=True)
class PointKernel:
    """A law at points, which may have a history; finite: in the space of logarithmic strains."""

    law: PointLaw
    finite: bool
    name: str = "point"
    together: bool = False

    def integrate(self, at: At, wanted: Wanted) -> Unsound:
        """Forces, tangents and stresses of cells by the compiled law, as in ``Kernel``."""
        return self.law.integrate(
            at.cells, self.finite, at.plane_stress, at.displacement, at.thermal, at.before, wanted.force, wanted.tangent,
            wanted.stress, wanted.energy, wanted.after, *at.earlier,
        )  # fmt: skip


@dataclass(frozen=True)
class Compiled:
    """The kernel of a material, and its constants where bodies are integrated together."""

    kernel: Kernel
    constants: tuple[float, ...] = (0.0, 0.0)
