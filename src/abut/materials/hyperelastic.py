"""Hyperelastic materials for finite deformation, theory (D3), (D4)."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from abut import checks
from abut._core import Hyperelastic
from abut.errors import InputError
from abut.materials.elastic import LinearElastic, lame
from abut.materials.kernel import Compiled, HyperelasticKernel
from abut.materials.material import Array, Evaluated
from abut.materials.volume_split import LogSquared, Powers, SquareLog, VolumeLaw, VolumeSplit

VOLUMETRIC = ("square-log", "log-squared", "isochoric")
LAWS = {
    "log-squared": Hyperelastic.LOG_SQUARED, "square-log": Hyperelastic.SQUARE_LOG, "isochoric": Hyperelastic.ISOCHORIC,
}  # fmt: skip


@dataclass(frozen=True)
class NeoHooke:
    """Compressible neo-Hookean material, for kinematics "finite".

    Given by ``young`` and ``poisson``, or by ``shear`` and one of ``bulk`` and ``lame``.

    Parameters
    ----------
    young : float, optional
        Young's modulus as small strains see it [force per area], > 0.
    poisson : float, optional
        Poisson's ratio as small strains see it.
    shear : float, optional
        Shear modulus mu [force per area], > 0.
    bulk : float, optional
        Bulk modulus K = lambda + 2 mu / 3 [force per area], > 0.
    lame : float, optional
        Lame's first constant lambda [force per area].
    volumetric : str
        The energy of volume changes, with J = det F. "square-log": lambda/2 ((J^2 - 1)/2 - ln J); "log-squared":
        lambda/2 (ln J)^2; both beside mu/2 (tr C - 3) - mu ln J. "isochoric": K/2 (J - 1)^2, beside mu/2 (J^(-2/3) tr C
        - 3), for materials that hardly change their volume.
    density : float
        Mass per undeformed volume, used by gravity.
    expansion : float
        Thermal expansion [1/temperature], used by temperature changes.

    Raises
    ------
    InputError
        For constants that are out of range or do not go together.

    Examples
    --------
    >>> import abut
    >>> rubber = abut.NeoHooke(shear=0.8, bulk=400.0, volumetric="isochoric")
    >>> round(rubber.linear.poisson, 4)
    0.499
    """

    young: float | None = None
    poisson: float | None = None
    shear: float | None = None
    bulk: float | None = None
    lame: float | None = None
    volumetric: str = "square-log"
    density: float = 0.0
    expansion: float = 0.0

    def __post_init__(self) -> None:
        checks.choice(self.volumetric, "volumetric", VOLUMETRIC)
        given = [name for name in ("young", "poisson", "shear", "bulk", "lame") if getattr(self, name) is not None]
        if given not in (["young", "poisson"], ["shear", "bulk"], ["shear", "lame"]):
            raise InputError(
                "constants: expected young and poisson, shear and bulk, or shear and lame; got "
                f"{' and '.join(given) or 'none of them'}"
            )
        for name in given:
            checks.finite(getattr(self, name), name)
        if self.shear is not None:
            checks.positive(self.shear, "shear")
            if not self.moduli[0] + 2.0 * self.shear / 3.0 > 0.0:
                what = f"bulk: expected a number > 0, got {self.bulk!r}"
                raise InputError(
                    what if self.lame is None else f"lame: expected more than -2/3 of shear, got {self.lame!r}"
                )
        LinearElastic(self.linear.young, self.linear.poisson, self.density, self.expansion)

    @property
    def moduli(self) -> tuple[float, float]:
        """Lame's constants lambda and mu, force per area."""
        if self.shear is None:
            return lame(LinearElastic(float(self.young or 0.0), float(self.poisson or 0.0)), None)
        if self.lame is not None:
            return self.lame, self.shear
        return float(self.bulk or 0.0) - 2.0 * self.shear / 3.0, self.shear

    @property
    def linear(self) -> LinearElastic:
        """The material that it is under small strains."""
        lambda_, mu = self.moduli
        poisson = 0.5 * lambda_ / (lambda_ + mu)
        return LinearElastic(2.0 * mu * (1.0 + poisson), poisson, self.density, self.expansion)

    @property
    def constant(self) -> bool:
        """False, as in ``Material``."""
        return False

    @property
    def small(self) -> bool:
        """False, as in ``OwnMaterial``."""
        return False

    @property
    def modulus(self) -> float:
        """Young's modulus at rest."""
        return self.linear.young

    def initial(self, n: int) -> Array:
        """It has no history: (n, 0)."""
        return np.zeros((n, 0))

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        """Stresses, tangents and histories at n points, as in ``Material``, for small strains."""
        return self.linear.evaluate(strain, history)

    def compiled(self, finite: bool) -> Compiled | None:
        """The compiled law, as in ``OwnMaterial``."""
        if not finite:
            return self.linear.compiled(False)
        lambda_, mu = self.moduli
        first = lambda_ + 2.0 * mu / 3.0 if self.volumetric == "isochoric" else lambda_
        return Compiled(HyperelasticKernel(LAWS[self.volumetric]), (first, mu))

    def volume_split(self, finite: bool) -> VolumeSplit | None:
        """What the change of volume alone adds to energy and stress, as in ``OwnMaterial``."""
        lambda_, mu = self.moduli
        if not lambda_ > 0.0:
            return None
        if not finite:
            return self.linear.volume_split(False)
        laws: dict[str, VolumeLaw] = {
            "square-log": SquareLog(lambda_), "log-squared": LogSquared(lambda_), "isochoric": Powers([0.5 * lambda_]),
        }  # fmt: skip
        rest = replace(self, young=None, poisson=None, shear=mu, bulk=2.0 * mu / 3.0, lame=None)
        return VolumeSplit(rest, laws[self.volumetric])
