"""The line "resolution" where a body ends on one that goes on: the pressure rises to the edges of a post on a block, as
under a rigid punch, 1 / sqrt(1 - (x / a)^2), and a facet or two do not show how."""

from __future__ import annotations

import pytest

import abut
from abut.mesh.make import box, join, rectangle
from abut.solution import Check

STEEL = abut.LinearElastic(210e3, 0.3)


def line(model: abut.Model) -> Check:
    return next(check for check in abut.solve(model).certificate if check.name == "resolution")


def post(cell: str, across: int, block: int, swap: bool = False, wide: float = 3.0, soft: float = 1.0) -> abut.Model:
    """A post, 1 wide, of so many facets across, on a block ``wide`` of so many facets per unit; soft: its modulus over the
    block's, then without Poisson's effect."""
    sides, half = ("post.bottom", "block.top"), 0.5 * wide
    if cell == "tet10":
        low = box((-half, half), (-half, half), (-1.0, 0.0), (round(wide * block), round(wide * block), block), cell)
        high = box((-0.5, 0.5), (-0.5, 0.5), (0.0, 1.0), (across,) * 3, cell)
    else:
        low = rectangle((-half, half), (-1.0, 0.0), (round(wide * block), block), cell)
        high = rectangle((-0.5, 0.5), (0.0, 1.0), (across, across), cell)
    mesh = join({"block": low, "post": high})
    axes = "xyz" if cell == "tet10" else "xy"
    held = dict.fromkeys(axes, 0.0)
    pushed = dict.fromkeys(axes[:-1], 0.0) | {axes[-1]: -0.001} if soft == 1.0 else {axes[-1]: -0.001}
    supports = [abut.Support("block.bottom", **held), abut.Support("post.top", **pushed)]
    if soft != 1.0:
        supports.append(abut.Support("post.left", x=0.0))
    of_post = STEEL if soft == 1.0 else abut.LinearElastic(soft * 210e3, 0.0)
    return abut.Model(
        mesh, [abut.Solid("block", STEEL), abut.Solid("post", of_post)],
        supports, contacts=[abut.Contact(contactor=sides[swap], target=sides[not swap])],
        plane=None if cell == "tet10" else "strain",
    )  # fmt: skip


@pytest.mark.parametrize(
    ("cell", "across", "block", "swap"),
    [
        ("tet10", 2, 1, False),
        ("quad8", 2, 1, False),
        ("quad4", 2, 2, False),
        ("quad4", 3, 3, False),
        ("quad4", 6, 2, True),
    ],
)
def test_two_or_three_facets_across_are_not_enough(cell: str, across: int, block: int, swap: bool) -> None:
    """Whichever body's facets carry the pressure, between that one's ends or the other's: a warning, as forces are right."""
    found = line(post(cell, across, block, swap))
    assert found.warns
    assert found.value == 1.0


@pytest.mark.parametrize("cell", ["quad4", "quad8"])
def test_four_pass(cell: str) -> None:
    assert line(post(cell, 4, 4)).verdict == "pass"


def test_a_pressure_that_is_the_same_all_over_needs_none() -> None:
    """A post so soft that the block stays plane, and free to widen: its pressure is that of its squeeze."""
    assert line(post("quad4", 2, 2, soft=1e-4)).value == 0.0


def test_flush_bodies_have_no_such_edge() -> None:
    """Where both end, the pressure of like bodies has no peak."""
    assert line(post("quad8", 2, 2, wide=1.0)).value == 0.0
