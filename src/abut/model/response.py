"""How an assembly answers loads that change quickly, about the state at the end of the last load step: harmonic ones, and
any over time; records that check themselves."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from abut import checks
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.model.body_forces import Centrifugal, Load
from abut.model.conditions import SLIGHTLY, vector
from abut.model.consistency import check_filled, check_loads
from abut.model.loads import Temperature
from abut.model.modes import AtTime, Buckling, Frequencies, check_time

MOST_POINTS = 100_000
Number = tuple[float, ...]


def _loads(values: Any, where: str) -> tuple[Load, ...]:
    """Loads that are forces. Raises InputError for others."""
    result = checks.records(values, where, get_args(Load))
    for i, load in enumerate(result):
        if isinstance(load, (Temperature, Centrifugal)):
            raise InputError(f"{where}[{i}]: temperatures and centrifugal forces do not vibrate; give forces")
    return result


def _damping(record: Any, where: str) -> None:
    """Check and tidy the damping that both kinds have."""
    given = record.damping
    several = isinstance(given, Sequence) and not isinstance(given, str)
    ratios = tuple(checks.finite(value, f"{where}: damping") for value in (given if several else (given,)))
    both = checks.listed(record.rayleigh, f"{where}: rayleigh", "two numbers")
    rayleigh = tuple(checks.finite(value, f"{where}: rayleigh") for value in both)
    if len(rayleigh) != 2:
        raise InputError(f"{where}: rayleigh: expected two numbers (of mass, of stiffness), got {len(rayleigh)}")
    if min((*ratios, *rayleigh), default=0.0) < 0.0:
        raise InputError(f"{where}: damping, rayleigh: expected numbers >= 0; negative ones would feed vibrations")
    object.__setattr__(record, "damping", ratios if several else ratios[0])
    object.__setattr__(record, "rayleigh", rayleigh)


def _places(values: Any, least: float, most: float, where: str) -> Number:
    """Where fields are written. Raises InputError for what lies beyond."""
    result = tuple(checks.finite(value, where) for value in checks.listed(values, where, "numbers"))
    if any(not least <= value <= most for value in result):
        raise InputError(f"{where}: expected numbers from {least:g} to {most:g}, got {list(result)}")
    return result


def _count(value: Any, least: int, where: str) -> None:
    if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= MOST_POINTS:
        raise InputError(f"{where}: expected a whole number from {least} to {MOST_POINTS}, got {value!r}")


@dataclass(frozen=True)
class Harmonic(AtTime):
    """Steady vibrations under loads that go as a cosine, over a range of frequencies: amplitude and phase.

    The modes are those of the first ``Frequencies`` of the model, about the loaded state, with what these leave out of the
    static answer added. Results are changes of that state.

    Parameters
    ----------
    between : (float, float)
        First and last frequency, in cycles per time.
    loads : sequence of loads
        Their values are amplitudes of cosines; no temperatures, no centrifugal forces, no history.
    imaginary : sequence of loads
        Amplitudes of what goes a quarter of a period ahead of these.
    base : (dim,) of float, optional
        Amplitude of a shift of everything that is held, springs' grounds too, [length].
    points : int
        Frequencies from one natural frequency to the next, both among them, closer to each other near these.
    bias : float
        How much closer: 1 is not at all.
    damping : float or sequence of float
        Share of critical damping, of all modes, or of the first, the second, ... and 0 of those beyond.
    rayleigh : (float, float)
        Of mass [1/time] and of stiffness [time]: half of the first over, and half of the second times, the angular frequency
        are added to the shares.
    fields : sequence of float
        Frequencies of which whole displacements are kept and written.
    time : float, optional
        Of the loaded state, as of ``Frequencies``.

    Raises
    ------
    InputError
        For values out of range.

    Examples
    --------
    >>> import abut
    >>> shaker = abut.Harmonic((10.0, 500.0), [abut.Force("beam.tip", (0.0, 1.0))], damping=0.02)
    >>> shaker.at([100.0, 300.0]).round(1).tolist()[:4]  # the first of 58 frequencies
    [10.0, 11.6, 13.4, 15.3]
    """

    between: Sequence[float]
    loads: Sequence[Load] = ()
    imaginary: Sequence[Load] = ()
    base: Sequence[float] | None = None
    points: int = 20
    bias: float = 3.0
    damping: float | Sequence[float] = 0.0
    rayleigh: Sequence[float] = (0.0, 0.0)
    fields: Sequence[float] = ()
    time: float | None = None

    def __post_init__(self) -> None:
        check_time(self.time, "harmonic", start=True)
        between = vector(self.between, "harmonic: between")
        if len(between) != 2 or not 0.0 <= between[0] <= between[1] or not between[1]:
            raise InputError(f"harmonic: between: expected two frequencies 0 <= first <= last > 0, got {list(between)}")
        object.__setattr__(self, "between", between)
        for name in ("loads", "imaginary"):
            object.__setattr__(self, name, _loads(getattr(self, name), f"harmonic: {name}"))
            for i, load in enumerate(getattr(self, name)):
                if load.amplitude is not None:
                    raise InputError(f"harmonic: {name}[{i}]: loads are cosines here; leave the amplitude out")
        if self.base is not None:
            object.__setattr__(self, "base", vector(self.base, "harmonic: base"))
        if not (self.loads or self.imaginary or any(self.base or ())):
            raise InputError("harmonic: nothing shakes; give loads, or base")
        _count(self.points, 1, "harmonic: points")
        if checks.finite(self.bias, "harmonic: bias") < 1.0:
            raise InputError(f"harmonic: bias: expected a number >= 1, got {self.bias!r}")
        _damping(self, "harmonic")
        object.__setattr__(self, "fields", _places(self.fields, *between, "harmonic: fields"))

    @property
    def last(self) -> float:
        """The highest frequency."""
        return float(self.between[1])

    def at(self, natural: ArrayLike) -> NDArray[np.float64]:
        """(n,) frequencies, growing; natural: those of the modes."""
        first, last = self.between
        inside = [float(value) for value in np.ravel(natural) if first < value < last]
        ends = np.unique([first, *inside, last])
        y = np.linspace(-1.0, 1.0, self.points) if self.points > 1 else np.array([-1.0])
        shares = 0.5 * (1.0 + np.sign(y) * np.abs(y) ** (1.0 / self.bias))
        parts = [low + (high - low) * shares for low, high in pairwise(ends)]
        return np.unique(np.concatenate([*parts, ends[-1:]]))


@dataclass(frozen=True)
class Transient(AtTime):
    """Vibrations over time under loads with histories of their own, which begin at rest.

    Modes and what is added to them are as of ``Harmonic``. Results are changes of the loaded state.

    Parameters
    ----------
    period : float
        How long [time].
    loads : sequence of loads
        No temperatures, no centrifugal forces. Their amplitudes are factors over this time, from 0 to 1 of it; what has none
        acts from the outset with its full value.
    steps : int
        In how many equal steps results are given. Between them, and between the points of amplitudes, loads are linear, and
        modes move exactly as these say.
    damping, rayleigh : as of ``Harmonic``
    fields : sequence of float
        Times of which whole displacements are kept and written.
    time : float, optional
        Of the loaded state, as of ``Frequencies``.

    Raises
    ------
    InputError
        For values out of range.

    Examples
    --------
    >>> import abut
    >>> blow = abut.Amplitude(((0.0, 0.0), (0.1, 1.0), (0.2, 0.0)))
    >>> abut.Transient(0.05, [abut.Force("beam.tip", (0.0, 1.0), amplitude=blow)], steps=100).at()[:3].tolist()
    [0.0, 0.0005, 0.001]
    """

    period: float
    loads: Sequence[Load] = ()
    steps: int = 200
    damping: float | Sequence[float] = 0.0
    rayleigh: Sequence[float] = (0.0, 0.0)
    fields: Sequence[float] = ()
    time: float | None = None

    def __post_init__(self) -> None:
        check_time(self.time, "transient", start=True)
        object.__setattr__(self, "period", checks.positive(self.period, "transient: period"))
        object.__setattr__(self, "loads", _loads(self.loads, "transient: loads"))
        if not self.loads:
            raise InputError("transient: nothing moves anything; give loads")
        for i, load in enumerate(self.loads):
            if load.amplitude is not None and load.amplitude.points[-1][0] > 1.0 + SLIGHTLY:
                raise InputError(f"transient: loads[{i}]: amplitude: times are shares of the period here, from 0 to 1")
        _count(self.steps, 1, "transient: steps")
        _damping(self, "transient")
        object.__setattr__(self, "fields", _places(self.fields, 0.0, self.period, "transient: fields"))

    def at(self) -> NDArray[np.float64]:
        """(steps + 1,) times."""
        return np.linspace(0.0, self.period, self.steps + 1)


Response = Harmonic | Transient
Wanted = Frequencies | Buckling | Harmonic | Transient


def check_responses(mesh: Mesh, modes: Sequence[Wanted], rigid: Collection[str], couplings: Collection[str]) -> None:
    """Raise InputError for loads that do not fit the mesh, and responses without modes. rigid, couplings: their names."""
    for wanted in modes:
        if not isinstance(wanted, (Harmonic, Transient)):
            continue
        kind = type(wanted).__name__.lower()
        if not any(isinstance(other, Frequencies) and basis_of(other, wanted) for other in modes):
            raise InputError(f"{kind}: it is made of modes; ask for frequencies, too, not complex, with diameter 0")
        for name in ("loads", "imaginary"):
            loads = getattr(wanted, name, ())
            try:
                check_filled(mesh, [(f"{name}[{i}].on", getattr(load, "on", None)) for i, load in enumerate(loads)])
                check_loads(mesh, loads, rigid, couplings)
            except InputError as error:
                raise InputError(f"{kind}: {str(error).replace('loads', name, 1)}") from None


def basis_of(modes: Frequencies | Buckling, wanted: Response) -> bool:
    """Whether a response is made of these modes."""
    return isinstance(modes, Frequencies) and not modes.phased and 0 in modes.diameters and modes.share == wanted.share
