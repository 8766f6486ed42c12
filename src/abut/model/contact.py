"""A contact pair as the user states it."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from abut import checks
from abut.contact.laws import Law
from abut.contact.sides import Names, label, listed, normalised, words
from abut.errors import InputError
from abut.model.conditions import Amplitude, History

KINDS = ("contact", "tied")
PRESSURES = ("auto", "P0", "P1", "P1-discontinuous", "P2", "P2-discontinuous", "dual", "dual-P1")
LAWS = ("complementarity", "constraint-function")
METHODS = ("segment-to-segment", "node-to-segment", "node-to-segment-two-pass")
RULES = ("gauss", "newton-cotes")
ROUGH = "rough"  # friction that never slips
AT_NODES = ("auto", "P1", "P2", "dual", "dual-P1")  # pressures that go with friction


@dataclass(frozen=True)
class Integration:
    """Quadrature on segments: ``points`` per direction, or "auto" (exact on straight facets)."""

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
    """A contact pair. The contactor carries the pressure. ``contactor`` and ``target`` are names of surfaces or bodies, or
    lists of them, which have one pressure: every point of the contactor faces the nearest target along its normal; of a
    body, the part of its boundary that can meet the other side.

    ``offset`` is added to the geometric gap (negative: interference), in the mesh's length unit, in full from the start or
    times ``amplitude``; ``adjust`` (length): initial gaps and overlaps up to this size count as zero, before the offset is
    added; ``epsilon`` smooths the constraint function (dimensionless, relative to the square of a reference pressure);
    ``method``: the node-to-segment ones are for comparison only. ``law``: "complementarity", "constraint-function" or
    a law of your own (``abut.contact.laws.Law``). ``friction``: Coulomb's coefficient, or "rough" for surfaces that never
    slip while they touch; the result then depends on the order of the loads, and on the load steps.

    >>> import abut
    >>> press_fit = abut.Contact("shaft.side", "hub.bore", offset=-0.02)  # 0.02 of interference on the radius
    >>> press_fit.name
    'shaft.side-hub.bore'
    """

    contactor: Names
    target: Names
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
    friction: float | str = 0.0

    def __post_init__(self) -> None:
        for side in ("contactor", "target"):
            object.__setattr__(self, side, normalised(getattr(self, side), f"contact '{self.name}': {side}"))
        if not self.name:
            object.__setattr__(self, "name", f"{label(self.contactor)}-{label(self.target)}")
        where = f"contact '{self.name}'"
        checks.choice(self.kind, f"{where}: kind", KINDS)
        checks.choice(self.pressure, f"{where}: pressure", PRESSURES)
        if isinstance(self.law, str) or not isinstance(self.law, Law):
            checks.choice(self.law, f"{where}: law", LAWS)
        checks.choice(self.method, f"{where}: method", METHODS)
        if self.method != METHODS[0] and (self.kind, self.law, self.pressure) != ("contact", LAWS[0], "auto"):
            raise InputError(
                f"{where}: method {self.method} is a reference for comparison: it knows only kind contact, law "
                "complementarity and pressure auto; leave them out, or use segment-to-segment"
            )
        if self.law == LAWS[1] and self.pressure.startswith("dual"):
            raise InputError(
                f"{where}: pressure {self.pressure} with law {self.law}: that law looks at the pressure point by point, "
                "where dual functions are negative; leave pressure out, or the law"
            )
        self._check_friction(where)
        checks.positive(self.epsilon, f"{where}: epsilon")
        checks.finite(self.offset, f"{where}: offset")
        if checks.finite(self.adjust, f"{where}: adjust") < 0.0:
            raise InputError(f"{where}: adjust: expected a length >= 0, got {self.adjust!r}")
        if self.amplitude is not None and not isinstance(self.amplitude, Amplitude):
            raise InputError(f"{where}: amplitude: expected an Amplitude, got {type(self.amplitude).__name__}")
        both = [name for name in listed(self.contactor) if name in listed(self.target)]
        if both:
            raise InputError(f"{where}: contactor and target are the same surface {words(both)}")

    @property
    def frictional(self) -> bool:
        """Whether there is friction."""
        return self.friction != 0.0

    @property
    def coefficient(self) -> float:
        """Of friction; infinite for "rough"."""
        return math.inf if self.friction == ROUGH else float(self.friction)

    def _check_friction(self, where: str) -> None:
        if self.friction != ROUGH:
            if isinstance(self.friction, str):
                raise InputError(f'{where}: friction: expected a coefficient >= 0 or "rough", got {self.friction!r}')
            if checks.finite(self.friction, f"{where}: friction") < 0.0:
                raise InputError(f"{where}: friction: expected a coefficient >= 0, got {self.friction!r}")
        if not self.frictional:
            return
        if self.kind == "tied":
            raise InputError(f"{where}: friction: a tie holds in all directions; leave friction or kind out")
        if self.method != METHODS[0] or self.law != LAWS[0]:
            raise InputError(
                f"{where}: friction: goes with method segment-to-segment and law complementarity; leave out the others"
            )
        if self.pressure not in AT_NODES:
            raise InputError(
                f"{where}: friction: needs a pressure at nodes, one of {', '.join(AT_NODES)}, got {self.pressure!r}"
            )
