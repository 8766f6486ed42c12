"""How far what is prescribed moves anything."""

from __future__ import annotations

from collections.abc import Sequence

from abut.model.conditions import COMPONENTS, Rigid, Support
from abut.model.coupling import Coupling
from abut.model.hold import STAY, Hold


def largest_prescribed(
    supports: Sequence[Support], referenced: Sequence[Rigid | Coupling], holds: Sequence[Hold]
) -> float:
    """The largest displacement that is prescribed as a number."""
    fixed = [(getattr(s, name), s.amplitude) for s in supports for name in (*COMPONENTS, "normal")]
    rigid = [(getattr(body, name), body.history(name)) for body in referenced for name in COMPONENTS]
    held = [(value, hold.amplitude) for hold in holds for value in hold.components.values() if value != STAY]
    values = [(v, 1.0 if history is None else history.largest) for v, history in (*fixed, *rigid, *held)]
    return max((abs(float(v)) * f for v, f in values if v is not None and not callable(v)), default=0.0)
