"""A contact pair as the user states it."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from abut import checks
from abut.contact.laws import Law
from abut.contact.sides import Names, code, label, normalised
from abut.errors import InputError
from abut.model.conditions import Amplitude, History
from abut.model.contact_times import ContactTimes
from abut.model.given_friction import ROUGH, Friction, checked

SECOND = " (second pass)"  # what the name of a two-pass contact the other way round ends with
KINDS = ("contact", "tied", "bilateral")
TWO_WAY = KINDS[1:]  # which carry tension as they carry pressure
PRESSURES = ("auto", "P0", "P1", "P1-discontinuous", "P2", "P2-discontinuous", "dual", "dual-P1")
LAWS = ("complementarity", "constraint-function")
METHODS = ("segment-to-segment", "node-to-segment", "node-to-segment-two-pass")
GEOMETRIES = ("curved", "faceted")
RULES = ("gauss", "newton-cotes")
SIDES = ("first", "second", "contactor", "target")
STATED = {"decides": False}  # of fields that say how the sides were named, and do not decide the solution


@dataclass(frozen=True)
class Integration:
    """Quadrature on segments.

    Parameters
    ----------
    rule : str
        "gauss" or "newton-cotes".
    points : int or str
        Per direction, or "auto": exact on straight facets.

    Raises
    ------
    InputError
        For a rule or a number that does not exist.
    """

    rule: str = "gauss"
    points: int | str = "auto"

    def __post_init__(self) -> None:
        checks.choice(self.rule, "integration.rule", RULES)
        if self.points == "auto":
            return
        low, high = (2, 9) if self.rule == "newton-cotes" else (1, 16)
        if isinstance(self.points, bool) or not isinstance(self.points, int) or not low <= self.points <= high:
            raise InputError(
                f"integration.points: expected 'auto' or {low}..{high} for {self.rule}, got {self.points!r}"
            )


@dataclass(frozen=True)
class Contact:
    """Two sides that touch.

    Every point of one side faces the nearest point of the other along its normal. One of the two, the contactor, carries
    the pressure; the other is its target. Which one is abut's choice (``abut.contact.contactor_choice``), made as the
    model is built, and never changes what a key means: resultants are those on ``first``. ``contactor`` and ``target``,
    in place of the two, force the choice; resultants are those on the contactor then. A contact of a ``Model`` has both,
    and ``chosen`` says why abut took that side.

    With friction the result depends on the order of the loads, and on the load steps.

    Parameters
    ----------
    first, second : str or sequence of str
        Surfaces or bodies, or lists of them, which have one pressure; of a body, the part of its boundary that can meet
        the other side.
    name : str
        For results; made of the sides where left out.
    kind : str
        "contact"; "tied", in all directions; "bilateral", which never opens and slides freely: its gap is zero, its
        pressure of either sign (theory (L16)).
    pressure : str
        Space of the pressure: "auto", or one of ``docs/theory/pressure-spaces.md``.
    law : str or Law
        "complementarity", "constraint-function", or a law of your own (``abut.contact.laws.Law``).
    epsilon : float
        Smooths the constraint function; dimensionless, relative to the square of a reference pressure, that of friction
        by its square root.
    method : str
        "segment-to-segment"; the node-to-segment ones are for comparison only.
    integration : Integration
        Quadrature on segments.
    offset : float
        Added to the geometric gap [length], negative: interference; in full from the start, or times ``amplitude``.
    adjust : float
        Initial gaps and overlaps up to this size count as zero, before the offset is added [length].
    amplitude : Amplitude, optional
        Of the offset over time.
    friction : float, str, function or sequence of (float, float)
        Coulomb's coefficient; an expression of x, y and z ("0.1 + 0.2*x") or a function of position, points (n, dim) ->
        (n,), both taken in the undeformed mesh; pairs of pressure [force per area] and coefficient, linear between and
        constant outside; or "rough" for surfaces that never slip while they touch.
    friction_amplitude : Amplitude, optional
        Factor of the coefficient over time; constant where left out.
    geometry : str
        "curved" takes what the smooth surface bulges out over flat facets off the gap (theory (S14)), "faceted" does
        not; flat surfaces do not differ.
    since, until, released : float, optional
        It acts from one time up to another one, at which its forces are taken off, at once or in a straight line up to
        ``released``; theory (L18). A tie that begins later holds the surfaces together as they are then.
    contactor, target : str or sequence of str
        In place of ``first`` and ``second``.
    chosen : str
        Why this side is the contactor; set by ``Model``.

    Raises
    ------
    InputError
        For values that do not exist or do not go together.

    Examples
    --------
    >>> import abut
    >>> press_fit = abut.Contact("shaft.side", "hub.bore", offset=-0.02)  # 0.02 of interference on the radius
    >>> press_fit.name
    'shaft.side-hub.bore'
    >>> forced = abut.Contact(contactor="shaft.side", target="hub.bore")
    """

    first: Names = field(default="", metadata=STATED)
    second: Names = field(default="", metadata=STATED)
    name: str = ""
    kind: str = "contact"
    pressure: str = "auto"
    law: str | Law = "complementarity"
    epsilon: float = 1e-12
    method: str = "segment-to-segment"
    integration: Integration = field(default_factory=Integration)
    offset: float = 0.0
    adjust: float = 0.0
    amplitude: History = None
    friction: Friction = 0.0
    friction_amplitude: History = None
    geometry: str = "curved"
    since: float = field(default=0.0, kw_only=True)
    until: float | None = field(default=None, kw_only=True)
    released: float | None = field(default=None, kw_only=True)
    contactor: Names = field(default="", kw_only=True)
    target: Names = field(default="", kw_only=True)
    chosen: str = field(default="", kw_only=True, compare=False, metadata=STATED)

    def __post_init__(self) -> None:
        self._check_sides()
        if not self.name:
            object.__setattr__(self, "name", "-".join(map(label, self.named)))
        where = f"contact '{self.name}'"
        checks.choice(self.kind, f"{where}: kind", KINDS)
        checks.choice(self.pressure, f"{where}: pressure", PRESSURES)
        if isinstance(self.law, str) or not isinstance(self.law, Law):
            checks.choice(self.law, f"{where}: law", LAWS)
        checks.choice(self.method, f"{where}: method", METHODS)
        checks.choice(self.geometry, f"{where}: geometry", GEOMETRIES)
        if self.method != METHODS[0] and (self.kind, self.law, self.pressure) != ("contact", LAWS[0], "auto"):
            raise InputError(
                f"{where}: method {self.method} is a reference for comparison: it knows only kind contact, law "
                "complementarity and pressure auto; leave them out, or use segment-to-segment"
            )
        if self.law == LAWS[1] and self.pressure.startswith("dual") and not self.frictional:
            raise InputError(
                f"{where}: pressure {self.pressure} with law {self.law}: that law looks at the pressure point by point, "
                "where dual functions are negative; leave pressure out, or the law"
            )
        if not self.times.checked(where).always and self.method != METHODS[0]:
            raise InputError(f"{where}: since, until: go with method segment-to-segment; leave the other one out")
        self._check_bilateral(where)
        self._check_friction(where)
        checks.positive(self.epsilon, f"{where}: epsilon")
        checks.finite(self.offset, f"{where}: offset")
        if checks.finite(self.adjust, f"{where}: adjust") < 0.0:
            raise InputError(f"{where}: adjust: expected a length >= 0, got {self.adjust!r}")
        if self.amplitude is not None and not isinstance(self.amplitude, Amplitude):
            raise InputError(f"{where}: amplitude: expected an Amplitude, got {type(self.amplitude).__name__}")

    @property
    def named(self) -> tuple[Names, Names]:
        """The two sides as the user named them; resultants are those on the first one."""
        return (self.first, self.second) if self.first else (self.contactor, self.target)

    @property
    def turned(self) -> bool:
        """Whether abut took the side that is named second for the contactor."""
        return self.contactor != self.named[0]

    def forced(self, contactor: Names, target: Names) -> Contact:
        """The same with these sides, whatever abut would choose."""
        return replace(self, first="", second="", chosen="", contactor=contactor, target=target)

    def with_choice(self, number: int, reason: str) -> Contact:
        """The same with the side ``number`` (0 or 1 of those named) for the contactor, and why."""
        sides = self.named
        return replace(self, contactor=sides[number], target=sides[1 - number], chosen=reason)

    @property
    def times(self) -> ContactTimes:
        """While it acts."""
        return ContactTimes(self.since, self.until, self.released)

    @property
    def locking(self) -> tuple[Amplitude, ...]:
        """As of its ``times``."""
        return self.times.locking

    @property
    def frictional(self) -> bool:
        """Whether there is friction."""
        return self.friction != 0.0

    def _check_sides(self) -> None:
        given = [side for side in SIDES if not isinstance(getattr(self, side), str) or getattr(self, side)]
        where = f"contact '{self.name}'" if self.name else "contact"
        for side in given:
            object.__setattr__(self, side, normalised(getattr(self, side), f"{where}: {side}"))
        if given not in ([*SIDES[:2]], [*SIDES[2:]]) and not (self.chosen and len(given) == len(SIDES)):
            got = ", ".join(f"{side} = {code(getattr(self, side))}" for side in given) or "none"
            raise InputError(
                f"{where}: name two surfaces, of which abut chooses the contactor, or both contactor and target, not some "
                f"of each (got {got})"
            )
        if self.first and self.contactor and {*self.named} != {self.contactor, self.target}:
            raise InputError(
                f"{where}: its sides are {code(self.first)} and {code(self.second)}, not {code(self.contactor)} and "
                f"{code(self.target)}; to give a contact other sides, or roles, use its method forced(contactor, target)"
            )

    def _check_bilateral(self, where: str) -> None:
        if self.kind != KINDS[2]:
            return
        if len({*self.named}) == 1:
            raise InputError(f"{where}: kind bilateral: a surface cannot keep its distance from itself; name two")
        if self.frictional:
            raise InputError(
                f"{where}: friction: bilateral contact slides freely; leave friction out, or take kind contact"
            )
        if self.law != LAWS[0]:
            raise InputError(
                f"{where}: law: bilateral contact is an equation for the gap; leave law out, or take kind contact"
            )

    def _check_friction(self, where: str) -> None:
        object.__setattr__(self, "friction", checked(self.friction, f"{where}: friction"))
        self._check_friction_amplitude(f"{where}: friction_amplitude")
        if not self.frictional:
            return
        if self.kind == "tied":
            raise InputError(f"{where}: friction: a tie holds in all directions; leave friction or kind out")
        if self.method != METHODS[0]:
            raise InputError(f"{where}: friction: goes with method segment-to-segment; leave the other one out")
        if not isinstance(self.law, str):
            raise InputError(
                f"{where}: friction: a law of your own looks at the gap and the pressure alone; leave friction out, or take "
                f"law {' or '.join(LAWS)}"
            )

    def _check_friction_amplitude(self, where: str) -> None:
        if self.friction_amplitude is None:
            return
        if not isinstance(self.friction_amplitude, Amplitude):
            raise InputError(f"{where}: expected an Amplitude, got {type(self.friction_amplitude).__name__}")
        if not self.frictional or self.friction == ROUGH:
            raise InputError(f"{where}: there is no coefficient that it could multiply; leave it out, or give friction")
        if any(factor < 0.0 for _, factor in self.friction_amplitude.points):
            raise InputError(f"{where}: expected factors >= 0, since the coefficient cannot be negative")
