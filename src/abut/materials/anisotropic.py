"""Orthotropic and anisotropic linear elasticity, theory (A1) to (A4)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from abut import checks
from abut.axes import Axes
from abut.errors import InputError
from abut.materials.directional import Directional, mean_modulus
from abut.materials.directions import Directions, frames, uniform
from abut.materials.evaluated import Array, Evaluated
from abut.materials.material import OwnMaterial
from abut.materials.places import Places

ORDER = (0, 1, 2, 3, 5, 4)  # of 11 22 33 12 13 23 among xx yy zz xy yz zx
NOTHING = 1e-9  # entry over the largest one that is none
Triple = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class LocalElastic(OwnMaterial):
    """What linear elastic materials with directions share."""

    axes: Directions | None = None
    expansion: float | Sequence[float] = 0.0  # type: ignore[assignment]
    density: float = 0.0

    constant = True
    symmetric = True

    def __post_init__(self) -> None:
        if self.axes is not None and not isinstance(self.axes, Axes) and not callable(self.axes):
            raise InputError(f"axes: expected Axes or a function of points, got {self.axes!r}")
        if checks.finite(self.density, "density") < 0.0:
            raise InputError(f"density: expected a number >= 0, got {self.density!r}")
        if isinstance(self.expansion, Sequence):
            object.__setattr__(self, "expansion", three(self.expansion, "expansion"))
        else:
            checks.finite(self.expansion, "expansion")
        _ = self.stiffness

    @property
    def stiffness(self) -> Array:
        """(6, 6) stress by strain xx yy zz xy yz zx in local axes, shear strains doubled, force per area."""
        raise NotImplementedError

    @property
    def expansions(self) -> Array:
        """Along the local directions, (3,) per degree."""
        return np.broadcast_to(np.asarray(self.expansion, dtype=float), (3,))

    @property
    def modulus(self) -> float:
        """Geometric mean of Young's moduli along the local directions."""
        return mean_modulus(self.stiffness)

    def frame(self, points: Array) -> Array:
        """Local directions at points (n, dim), as rows (n or 1, 3, 3); (1, 3, 3) where they are the same everywhere."""
        if self.axes is None:
            return np.eye(3)[None]
        return frames(self.axes, points[:1] if uniform(self.axes) else points)

    def at(self, places: Places) -> Directional:
        """The material at points, with their axes and temperatures, as in ``LocalMaterial``."""
        swelling = places.change[:, None] * self.expansions if places.change.any() and self.expansions.any() else None
        return Directional(self.stiffness[None], self.frame(places.points), swelling)

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points, as in ``Material``, for axes that are the same everywhere,
        without a change of temperature."""
        return self._anywhere().evaluate(np.asarray(strain, dtype=float), history)

    def evaluate_finite(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points under finite strains, as in ``FiniteMaterial``: the law of Saint
        Venant and Kirchhoff; axes as for ``evaluate``."""
        return self._anywhere().evaluate_finite(np.asarray(strain, dtype=float), history)

    def _anywhere(self) -> Directional:
        if not uniform(self.axes):
            raise InputError("axes: they differ from place to place; ask for the material at some, with ``at``")
        first = self.axes.x if isinstance(self.axes, Axes) else None
        return self.at(Places(np.zeros((1, 3 if first is None else len(first))), np.zeros(1)))

    def check(self, dim: int, plane: str | None, where: str) -> None:
        """Refuse what the law cannot be used with, as in ``OwnMaterial``."""
        if isinstance(self.axes, Axes):
            self.axes.check(dim, where)
            if plane == "axisymmetric" and self.axes.kind != "rectangular":
                raise InputError(
                    f"{where}: axes: the model is axisymmetric: local directions are radial, axial and around the axis "
                    'already; take kind = "rectangular", or leave axes out'
                )
        apart = np.abs(self.stiffness[np.ix_((0, 1, 2, 3), (4, 5))]).max()
        if dim == 2 and plane != "stress" and apart > NOTHING * np.abs(self.stiffness).max():
            raise InputError(
                f"{where}: stiffness: strains in the plane make shear out of it (entries 11 22 33 12 with 13 23), which "
                "would move the body out of the plane; use a 3D model, or leave these entries 0"
            )


@dataclass(frozen=True)
class Orthotropic(LocalElastic):
    """Orthotropic linear elasticity by engineering constants, in local axes 1, 2, 3.

    Under finite strains the law of Saint Venant and Kirchhoff, whose axes turn with the body.

    Parameters
    ----------
    young : sequence of float
        Young's moduli E1, E2, E3 [force per area], > 0.
    poisson : sequence of float
        nu12, nu13, nu23: nu12 is the strain along 2, with the sign turned, over the one along 1 under a stress along 1, so
        that nu21 = nu12 E2 / E1.
    shear : sequence of float
        Shear moduli G12, G13, G23 [force per area], > 0.
    axes : Axes or callable, optional
        The local directions, by default the global ones; in 2D the third one is out of the plane, in axisymmetric models
        around the axis. A function takes points (n, dim) and returns unit vectors (n, dim, dim), as ``Axes.frames``.
    expansion : float or sequence of float
        Thermal expansion, or that along each local direction [1/temperature].
    density : float
        Mass per volume, used by gravity.

    Raises
    ------
    InputError
        For constants out of these ranges, or with which some deformation would take no energy.

    Examples
    --------
    >>> import abut
    >>> ply = abut.Orthotropic([140e3, 10e3, 10e3], [0.3, 0.3, 0.45], [5e3, 5e3, 3.4e3], axes=abut.Axes(x=(1, 1, 0)))
    >>> round(ply.modulus)  # the geometric mean of all three
    24101
    """

    young: Sequence[float]
    poisson: Sequence[float]
    shear: Sequence[float]

    def __post_init__(self) -> None:
        for name in ("young", "poisson", "shear"):
            object.__setattr__(self, name, three(getattr(self, name), name))
        for name, pairs in (("young", ("1", "2", "3")), ("shear", ("12", "13", "23"))):
            for which, value in zip(pairs, getattr(self, name)):
                if not value > 0.0:
                    raise InputError(
                        f"{name}: {name[0].replace('y', 'E').replace('s', 'G')}{which} must be > 0, got {value!r}"
                    )
        _check_poisson(self.young, self.poisson)
        super().__post_init__()

    @cached_property
    def stiffness(self) -> Array:
        """Stiffness in the local axes, as in ``LocalElastic``."""
        (a, b, _), (xy, xz, yz) = self.young, self.poisson
        compliance = np.diag(1.0 / np.array([*self.young, *np.array(self.shear)[[0, 2, 1]]]))
        compliance[0, 1] = compliance[1, 0] = -xy / a
        compliance[0, 2] = compliance[2, 0] = -xz / a
        compliance[1, 2] = compliance[2, 1] = -yz / b
        return np.asarray(np.linalg.inv(compliance), dtype=float)


@dataclass(frozen=True)
class Anisotropic(LocalElastic):
    """Linear elasticity by 21 constants, in local axes 1, 2, 3.

    Under finite strains the law of Saint Venant and Kirchhoff, whose axes turn with the body.

    Parameters
    ----------
    constants : sequence of float
        Stiffness [force per area], the upper triangle column after column, of 11 22 33 12 13 23, shear strains doubled:
        D1111, D1122, D2222, D1133, D2233, D3333, D1112, D2212, D3312, D1212, D1113, D2213, D3313, D1213, D1313, D1123,
        D2223, D3323, D1223, D1323, D2323.
    axes : Axes or callable, optional
        As of ``Orthotropic``.
    expansion : float or sequence of float
        Thermal expansion, or that along each local direction [1/temperature].
    density : float
        Mass per volume, used by gravity.

    Raises
    ------
    InputError
        For constants with which some deformation would take no energy.
    """

    constants: Sequence[float]

    def __post_init__(self) -> None:
        values = tuple(
            checks.finite(value, "constants") for value in checks.listed(self.constants, "constants", "numbers")
        )
        if len(values) != 21:
            raise InputError(f"constants: expected 21 numbers, the upper triangle column by column, got {len(values)}")
        object.__setattr__(self, "constants", values)
        smallest, direction = _softest(self.stiffness)
        if not smallest > 0.0:
            strain = ", ".join(f"{x:.2g}" for x in direction[list(ORDER)])
            raise InputError(
                "constants: the stiffness is not positive definite: the strain 11 22 33 12 13 23 = "
                f"({strain}) takes the energy {0.5 * smallest:.3g}; check the order of the constants"
            )
        super().__post_init__()

    @cached_property
    def stiffness(self) -> Array:
        """Stiffness in the local axes, as in ``LocalElastic``."""
        result = np.zeros((6, 6))
        entries = iter(self.constants)
        for column in range(6):
            for row in range(column + 1):
                a, b = ORDER[row], ORDER[column]
                result[a, b] = result[b, a] = next(entries)
        return result


def three(values: object, name: str) -> Triple:
    """Three numbers. Raises InputError."""
    if not isinstance(values, (Sequence, np.ndarray)) or isinstance(values, str) or len(values) != 3:
        raise InputError(f"{name}: expected three numbers, got {values!r}")
    a, b, c = (checks.finite(value, name) for value in values)
    return a, b, c


def _check_poisson(young: Sequence[float], poisson: Sequence[float]) -> None:
    """Raise InputError where the compliance of normal stresses is not positive definite."""
    for (i, j), nu in zip(((0, 1), (0, 2), (1, 2)), poisson):
        limit = (young[i] / young[j]) ** 0.5
        if not abs(nu) < limit:
            one, two = f"{i + 1}{j + 1}", f"{j + 1}{i + 1}"
            raise InputError(
                f"poisson: nu{one} must lie within the square root of E{i + 1} / E{j + 1}, {limit:.6g}, got {nu!r}; nu{two} "
                f"is nu{one} E{j + 1} / E{i + 1}: they may have been exchanged"
            )
    (a, b, c), (ab, ac, bc) = young, poisson
    ba, ca, cb = ab * b / a, ac * c / a, bc * c / b
    left = 1.0 - ab * ba - bc * cb - ca * ac - 2.0 * ba * cb * ac
    if not left > 0.0:
        raise InputError(
            "poisson: the constants are not positive definite: 1 - nu12 nu21 - nu23 nu32 - nu31 nu13 - 2 nu21 nu32 nu13 "
            f"must be > 0, they give {left:.6g}; make the ratios smaller"
        )


def _softest(stiffness: Array) -> tuple[float, Array]:
    values, vectors = np.linalg.eigh(stiffness)
    smallest, largest = float(values[0]), float(np.abs(values).max())
    return (smallest if smallest > 1e-14 * largest else min(smallest, 0.0)), vectors[:, 0]
