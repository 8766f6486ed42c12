"""The form of a beam's section, as *BEAM SECTION and *BEAM GENERAL SECTION give it."""

from __future__ import annotations

from abut.io.deck.cards import Card, key

ORDER = (2, 3, 0, 1)  # of the four walls on the card, which are those at the sides 1, 2, -1, -2


def form_of(card: Card) -> tuple[str, tuple[float, float], tuple[float, ...]]:
    """Form (``mesh.thin.beams.OUTLINES``), widths, and walls at the sides -1, -2, 1, 2, 0 of solid ones. CIRC has diameters,
    PIPE the radius outside, BOX its walls in the order ``ORDER``.

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
        form, widths, walls = "pipe", (2.0 * first, 2.0 * first), [line.number(1, "wall")] * 4
    elif kind == "BOX":
        form, widths = "box", (first, line.number(1, "second width"))
        walls = [line.number(2 + i, "wall") for i in ORDER]
    else:
        form, widths, walls = (
            "ellipse" if kind == "CIRC" else "rectangle",
            (first, line.number(1, "second width", first)),
            [],
        )
    if not min(widths) > 0.0:
        raise line.error(f"width: expected a number > 0, got {min(widths):g}")
    for width, pair in zip(widths, (walls[0::2], walls[1::2])):
        for wall in pair:
            if not 0.0 < wall < width / 2.0:
                raise line.error(f"wall: expected a number > 0 and < {width / 2.0:g}, half the section, got {wall:g}")
    return form, widths, tuple(walls) or (0.0,) * 4
