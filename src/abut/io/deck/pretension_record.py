"""What *PRE-TENSION SECTION says."""

from __future__ import annotations

from dataclasses import dataclass

from abut.io.deck.reasons import Place


@dataclass(frozen=True)
class PreTension:
    """The surface inside a bolt that is cut open, the node whose direction 1 is the opening and its force, the normal (None:
    that of the surface); in place of the surface the number of a beam, else 0."""

    surface: str
    node: int
    normal: tuple[float, float, float] | None
    place: Place
    element: int = 0
