"""Contact whose contactor supports hold: what the target alone sees of pressure and friction."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import abut
from abut.mesh import make

SOFT = abut.LinearElastic(1000.0, 0.3)
PRESS = abut.Amplitude(((0.0, 0.0), (0.25, 1.0), (1.0, 1.0)))
SLIDE = abut.Amplitude(((0.0, 0.0), (0.25, 0.0), (1.0, 1.0)))
BACK = abut.Amplitude(((0.0, 0.0), (0.25, 0.0), (0.5, 1.0), (1.0, -1.0)))
MU = 0.3


def sliding(
    held: str, base: int = 8, block: int = 6, *, until: float = 5.0, swapped: bool = False, **options: Any
) -> abut.Model:
    """A block pressed 0.02 into a base, whose top is held along ``held`` up to x = ``until``, and moved 0.05 along it; cells
    of both along the contact. The base is the contactor, unless swapped."""
    dim = 3 if "z" in held or options.pop("dim", 2) == 3 else 2
    if dim == 2:
        lower = make.rectangle((0, 4), (-1, 0), (base, 2), "quad4")
        upper = make.rectangle((1, 3), (0, 1), (block, 3), "quad4")
    else:
        lower = make.box((0, 4), (0, 2), (-1, 0), (base, base // 2, 2), "hex8")
        upper = make.box((1, 3), (0.5, 1.5), (0, 1), (block, block // 2, 2), "hex8")
    mesh = make.join({"base": lower, "block": upper})
    top = mesh.nodes_of("base.top")
    mesh = replace(mesh, node_sets={**mesh.node_sets, "held": top[mesh.points[top, 0] <= until]})
    slide = options.pop("slide", SLIDE)
    supports = [
        abut.Support("base.bottom", **dict.fromkeys("xyz"[:dim], 0)),
        abut.Support("block.top", **{"xyz"[dim - 1]: -0.02}, amplitude=PRESS),
        abut.Support("block.top", x=0.05, amplitude=slide),
        *([abut.Support("block.top", y=0)] if dim == 3 else []),
        *([abut.Support("held", **dict.fromkeys(held, 0))] if held else []),
    ]
    sides = ("block.bottom", "base.top") if swapped else ("base.top", "block.bottom")
    return abut.Model(
        mesh, [abut.Solid("base", SOFT), abut.Solid("block", SOFT)], supports,
        contacts=[abut.Contact(contactor=sides[0], target=sides[1], friction=options.pop("friction", MU))],
        plane="strain" if dim == 2 else None, solve=abut.SolveOptions(steps=options.pop("steps", 4)), **options,
    )  # fmt: skip


def drag(solution: abut.Solution) -> tuple[float, float]:
    """Force along x and pressing force at the block's top, in the last step."""
    assert solution.converged
    force = solution.steps[-1].reactions["block.top"]
    return float(force[0]), float(-force[-1])


@pytest.mark.long
@pytest.mark.parametrize("cells", [(8, 6), (24, 4)])
@pytest.mark.parametrize("held", ["x", "xy"])
@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_target_slides_under_a_held_contactor(cells: tuple[int, int], held: str, kinematics: str) -> None:
    """Coulomb's law gives mu N at a flat surface, to rounding with small displacements; finite ones lean the surface by less
    than a hundredth where it is not held. Finer contactors have more tractions than the target can tell apart."""
    along, across = drag(abut.solve(sliding(held, *cells, kinematics=kinematics)))
    assert along == pytest.approx(MU * across, rel=1e-9 if kinematics == "small" else 3e-4)


def test_as_with_the_sides_swapped() -> None:
    """On the same nodes both choices of the contactor are one discrete problem, while all of the surface is pressed."""
    one, other = (drag(abut.solve(sliding("xy", 8, 4, swapped=swapped))) for swapped in (False, True))
    assert one == pytest.approx(other, rel=1e-9)


def test_held_all_over_in_space() -> None:
    """The friction cone in 3D: tractions along and across the slide are mu N by area."""
    solution = abut.solve(sliding("xyz", 8, 4))
    rub, (_, across) = solution.steps[-1].contacts[0].friction, drag(solution)
    assert rub is not None
    assert rub.force_by_area == pytest.approx(MU * across, rel=1e-9)
    assert np.hypot(*rub.force[:2]) == pytest.approx(MU * across, rel=2e-3)  # the block widens: not all slips along x


def test_reversal() -> None:
    """The drag turns round with the motion."""
    along, across = drag(abut.solve(sliding("x", slide=BACK, steps=8)))
    assert along == pytest.approx(-MU * across, rel=1e-9)


@pytest.mark.long
@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_both_sides_held(kinematics: str) -> None:
    """Where supports move both sides past each other nothing is unknown, but the tractions are there, on the supports;
    where they hold both and nothing slips, there is none."""
    model = sliding("xy", kinematics=kinematics)
    moved = replace(model, supports=[*model.supports, abut.Support("block.bottom", x=0.05, amplitude=SLIDE)])
    last = abut.solve(moved).steps[-1]
    force = last.reactions["block.bottom"] + last.reactions["block.top"]
    assert force[0] == pytest.approx(-MU * force[1], rel=1e-9)
    still = replace(model, supports=[*model.supports, abut.Support("block.bottom", x=0)])
    rub = abut.solve(still).steps[-1].contacts[0].friction
    assert rub is not None
    assert rub.force_by_area == 0.0


@pytest.mark.long
@pytest.mark.parametrize("friction", [0.0, MU])
@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_contactor_held_in_part(friction: float, kinematics: str) -> None:
    """A contactor that is held across the surface on one half presses there too: half of the block's underside is over
    rigid ground, and it yields 39 to 40, not the 21 of the other half, as with the sides swapped."""
    solutions = [
        abut.solve(sliding("xy", until=2.01, swapped=swapped, friction=friction, kinematics=kinematics))
        for swapped in (False, True)
    ]
    (along, one), (_, other) = map(drag, solutions)
    assert one == pytest.approx(other, rel=0.01)
    assert along == pytest.approx(friction * one, rel=0.02, abs=0.005 * one)


def test_held_contactor_by_multigrid() -> None:
    """Functions of held nodes that nothing is opposite follow others and have no place on the surface: multigrid's
    preconditioner has them stand by themselves. Forces are those of the direct solver, to what both leave."""
    model = sliding("xy", 6, 4, kinematics="finite", steps=2)
    direct, multigrid = (
        drag(abut.solve(replace(model, solve=abut.SolveOptions(steps=2, linear=kind)))) for kind in ("direct", "amg")
    )
    assert multigrid == pytest.approx(direct, rel=1e-6)
