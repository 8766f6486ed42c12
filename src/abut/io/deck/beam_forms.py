"""The form of a beam's section, as *BEAM SECTION and *BEAM GENERAL SECTION give it."""

from __future__ import annotations

from abut.io.deck.cards import Card, key


def form_of(card: Card) -> tuple[str, tuple[float, float], float]:
    """Form (``mesh.thin.beams.OUTLINES``), widths and wall, 0 of solid ones. CIRC has diameters, PIPE the radius outside.

    Raises InputError for other forms and for sizes that are none."""
    kind = key(card.get("SECTION", "RECT") or "")[:4]  # CalculiX reads four letters
    if kind not in ("RECT", "CIRC", "PIPE", "BOX"):
        raise card.error(
            f"SECTION={card.get('SECTION')}: RECT, CIRC, PIPE and BOX alone are supported; model the part with shells or "
            "solids"
        )
    line = card.first("widths")
    first = line.number(0, "radius" if kind == "PIPE" else "width")
    if kind == "PIPE":
        form, widths, walls = "pipe", (2.0 * first, 2.0 * first), [line.number(1, "wall")]
    elif kind == "BOX":
        form, widths = "box", (first, line.number(1, "second width"))
        walls = [line.number(2 + i, "wall") for i in range(4)]
    else:
        form, widths, walls = (
            "ellipse" if kind == "CIRC" else "rectangle",
            (first, line.number(1, "second width", first)),
            [],
        )
    if not min(widths) > 0.0:
        raise line.error(f"width: expected a number > 0, got {min(widths):g}")
    if len(set(walls)) > 1:
        told = ", ".join(f"{wall:g}" for wall in walls)
        raise line.error(
            f"walls {told}: boxes with different walls are not supported; give four equal ones, or use shells"
        )
    if walls and not 0.0 < walls[0] < min(widths) / 2.0:
        raise line.error(f"wall: expected a number > 0 and < {min(widths) / 2.0:g}, half the section, got {walls[0]:g}")
    return form, widths, walls[0] if walls else 0.0
