"""The certificate's line "loaded area without target", of targets that cover few facets."""

from __future__ import annotations

import pytest

import abut
from abut.mesh.make import join, rectangle


def narrow(width: float, aside: float) -> tuple[float, bool]:
    """The line of a block, ``width`` facets of the plate wide and off a node by ``aside``, that is pressed on it."""
    middle = 8.0 + aside
    mesh = join({
        "plate": rectangle((0.0, 16.0), (-6.0, 0.0), (16, 6), "quad4"),
        "block": rectangle((middle - 0.5 * width, middle + 0.5 * width), (0.0, 4.0), (8, 8), "quad4"),
    })  # fmt: skip
    solution = abut.solve(abut.Model(
        mesh, [abut.Solid(body, abut.LinearElastic(1e3, 0.3)) for body in mesh.bodies],
        [abut.Support("plate.bottom", x=0, y=0), abut.Support("block.top", x=0, y=-0.01)], plane="strain",
        contacts=[abut.Contact(contactor="plate.top", target="block.bottom")],
    ))  # fmt: skip
    (check,) = (check for check in solution.certificate if check.name == "loaded area without target")
    return check.value, check.passed


def test_few_facets_are_no_fault() -> None:
    """Blocks two, three and four facets wide, wherever they stand, are no fault. One that covers whole facets is without
    fault by the line; even pressure on half of the two facets at its ends makes 0.5 over its width, and pressure is higher
    there. One that is narrower than a facet is seen."""
    for width in (2.0, 3.0, 4.0):
        assert narrow(width, 0.5 * (width % 2.0))[0] == pytest.approx(0.0, abs=1e-9)
        assert all(narrow(width, aside)[0] < 0.6 / width for aside in (0.25, 0.5, 0.75))
    assert narrow(1.0, 0.0)[0] == pytest.approx(0.5)  # half of two facets
    assert narrow(0.5, 0.0) == (pytest.approx(0.75), False)
    assert narrow(0.3, 0.25)[1] is False
