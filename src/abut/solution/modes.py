"""Results about the state at the end of a run: natural frequencies and buckling loads, with their modes."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from abut.brief import brief
from abut.solution.contacts import Check

RESIDUAL = 1e-6  # frequencies are off by about its square
ORTHOGONAL = 1e-6
MISSING = 0.5  # nothing between 0 and 1
FREQUENCIES, COMPLEX, BUCKLING = "frequencies", "complex frequencies", "buckling"
GROWS = 1e-5  # rate of growth over the size of the eigenvalue: below it there is none but for rounding, where two modes meet


@dataclass(frozen=True)
class ModesResult:
    """Modes about the state at the end of the last step.

    kind: "frequencies", "complex frequencies" or "buckling"; values: (n,) ascending, frequencies in cycles per time
    (negative where the state is unstable: -sqrt(-lambda) / 2 pi), or factors of the state's stresses; eigenvalues: (n,)
    squares of angular frequencies, or the factors; shapes: (n, n_points, dim), of frequencies with a modal mass of 1, of
    buckling with a largest displacement of 1; participation, effective: (n, k) factors of participation and effective
    masses for unit motions of the whole along the axes, then turns about the axes through the origin (3D: k = 6, 2D: 3,
    axisymmetric: 1, along the axis); mass: (k,) of the whole for the same motions; none of these for buckling: k = 0.
    residual, orthogonality: the largest over all modes, relative; missing: modes that were not found below the last one,
    None where that is not known.

    Complex frequencies: motions exp(growth t) cos(2 pi value t), in order of size; growth: (n,) rates per time, positive
    where a mode is unstable; eigenvalues: the real parts; shapes: real parts, with ``imaginary`` (n, n_points, dim) the
    others, so that x^H M x = 1 and the largest component is real; slips: whether anything slips, without which there is
    nothing to make them complex; no participation; orthogonality: NaN, as they are not orthogonal. Else none of these.
    whirl: with Coriolis forces (n,), how the whole goes round, seen from the body that turns: 1 in circles with the
    rotation, -1 against it, 0 to and fro; else none.

    diameter: nodal diameters of vibrations of a whole of alike sectors; from 1 on each frequency comes twice, shapes are
    real parts of the modelled sector's and ``imaginary`` the others, in the next sector by an angle of 2 pi diameter over
    the number of sectors later; no participation.
    """

    kind: str
    values: NDArray[np.float64]
    eigenvalues: NDArray[np.float64]
    shapes: NDArray[np.float64]
    participation: NDArray[np.float64]
    effective: NDArray[np.float64]
    mass: NDArray[np.float64]
    residual: float
    orthogonality: float
    missing: int | None
    growth: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))
    imaginary: NDArray[np.float64] = field(default_factory=lambda: np.zeros((0, 0, 0)))
    slips: bool = False
    diameter: int = 0
    whirl: NDArray[np.float64] = field(default_factory=lambda: np.zeros(0))

    __repr__ = brief

    def __len__(self) -> int:
        return len(self.values)

    @property
    def words(self) -> str:
        """What these are, with the nodal diameter where there is one."""
        return f"{self.kind} of nodal diameter {self.diameter}" if self.diameter else self.kind

    @property
    def unstable(self) -> NDArray[np.bool_]:
        """(n,) complex frequencies that grow, by more than rounding; else none."""
        if self.kind != COMPLEX:
            return np.zeros(len(self), dtype=bool)
        return np.asarray(self.growth > GROWS * np.hypot(self.growth, 2.0 * np.pi * self.values))

    @property
    def certificate(self) -> tuple[Check, ...]:
        """Residual, orthogonality, and modes that are missing."""
        left = (
            "" if self.missing is not None else "the factors of this direct solver do not tell how many modes there are"
        )
        if self.kind == COMPLEX:
            return (
                Check("", f"{self.words}: residual", self.residual, RESIDUAL,
                      "root of the energy that one more inverse iteration changes a mode by, over the mode's"),
                Check("", f"{self.words}: missing modes", float("nan"), MISSING, "modes below the last that are not given",
                      unknown="no count tells how many complex modes there are"),
            )  # fmt: skip
        return (
            Check("", f"{self.words}: residual", self.residual, RESIDUAL,
                  "root of the energy that one more inverse iteration changes a mode by, over the mode's"),
            Check("", f"{self.words}: orthogonality", self.orthogonality, ORTHOGONAL,
                  "largest product of two modes of size 1"),
            Check("", f"{self.words}: missing modes", float("nan") if left else float(self.missing or 0), MISSING,
                  "modes below the last one that a count by Sylvester's law of inertia finds beyond those given",
                  unknown=left),
        )  # fmt: skip
