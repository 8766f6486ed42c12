"""Random assemblies and parts with friction: every load step converges, and what it ends with meets the laws."""

from __future__ import annotations

from dataclasses import replace
from unittest import mock

import numpy as np
import pytest
from scipy.optimize import linprog

import abut
from abut.problem.linearised import Linearised
from models.assemblies_rubbing import plane, solid
from models.oracle import assembled, at_the_end, programme
from models.parts_rubbing import PARTS, press_fit
from models.units import MILLIMETRES_TO, in_units

LAWS = (
    "force balance",
    "penetration",
    "complementarity",
    "friction cone",
    "slip direction",
    "sticking",
    "friction work",
)
EDGES = 64  # of the pyramid round a cone in space: 0.12 per cent more friction than there is
ROUNDING = 1e-12  # of rigid motions, where a multiplier sees none of them
SLACK = 1e-7  # share of the loads by which balance may be missed, as far as linprog solves
DRAWS, SOLID_DRAWS = 14, 4
UNITS = (None, *MILLIMETRES_TO)


def held(model: abut.Model) -> bool:
    """Whether some pressures and tractions within their cones balance the loads on rigid bodies."""
    with mock.patch("abut.problem.assembly.require_balance"), mock.patch("abut.problem.assembly.require_unmoved"):
        system = at_the_end(assembled(model))
    own = programme(system)
    n, m = own.moved.shape
    if not m or not own.size > 0.0:
        return True
    unit = np.linalg.norm(own.moved, axis=1)
    unit[unit <= ROUNDING * unit.max()] = 1.0
    rows, load = own.moved / unit[:, None], own.load / own.size
    cones = cone_rows(system) / unit
    ones = np.ones((m, 1))
    answer = linprog(
        np.append(np.zeros(n), 1.0),
        np.block([[rows.T, -ones], [-rows.T, -ones], [cones, np.zeros((len(cones), 1))]]),
        np.concatenate([load, -load, np.zeros(len(cones))]),
        bounds=[(0.0 if push else None, None) for push in pressures(system)] + [(0.0, None)],
    )
    assert answer.status == 0, answer.message
    return bool(answer.fun < SLACK)


def pressures(system: Linearised) -> list[bool]:
    """Of all multipliers, which are pressures, that only push."""
    return [not pair.tied and i < len(pair.space) for pair in system.pairs for i in range(len(pair))]


def cone_rows(system: Linearised) -> np.ndarray:
    """t . d - mu p <= 0 in all directions d, per area."""
    result, first = [np.zeros((0, len(system)))], 0
    for pair in system.pairs:
        if pair.frictional:
            for angle in 2.0 * np.pi * np.arange(EDGES) / EDGES if pair.index.shape[1] == 3 else (0.0, np.pi):
                rows = np.zeros((len(pair.space), len(system)))
                each = np.arange(len(pair.space))
                rows[each, first + pair.index[:, 0]] = -pair.steepest / pair.space.weight
                for b, share in enumerate((np.cos(angle), np.sin(angle))[: pair.index.shape[1] - 1]):
                    there = pair.index[:, 1 + b] >= 0
                    at = pair.index[there, 1 + b]
                    rows[each[there], first + at] = share / pair.weight[at]
                result.append(rows)
        first += len(pair)
    return np.concatenate(result)


def settles(model: abut.Model) -> None:
    """It converges, or there is no equilibrium."""
    try:
        solution = abut.solve(model)
    except abut.SingularModelError as error:
        reason = str(error)
        assert not held(model), reason
        return
    assert solution.converged
    off = [check for check in solution.certificate if check.name in LAWS and not check.passed]
    assert not off


def drawn(model: abut.Model, seed: int) -> None:
    """In one of the systems of units."""
    name = UNITS[seed % len(UNITS)]
    settles(model if name is None else in_units(model, MILLIMETRES_TO[name]))


@pytest.mark.long
@pytest.mark.parametrize("seed", range(DRAWS))
def test_plane_assemblies(seed: int) -> None:
    drawn(plane(seed), seed)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(SOLID_DRAWS))
def test_solid_assemblies(seed: int) -> None:
    drawn(solid(seed), seed)


@pytest.mark.exhaustive
@pytest.mark.parametrize("seed", range(60))
def test_every_plane_assembly(seed: int) -> None:
    drawn(plane(seed), seed)


@pytest.mark.exhaustive
@pytest.mark.parametrize("seed", range(12))
def test_every_solid_assembly(seed: int) -> None:
    drawn(solid(seed), seed)


def test_loads_beyond_friction() -> None:
    """A block that tips over: the oracle finds no equilibrium either."""
    settles(plane(189))
    with pytest.raises(abut.SingularModelError, match="friction only up to its coefficient"):
        abut.solve(plane(189))


def test_a_slide_that_some_contacts_do_not_see() -> None:
    """A body pulled off: multipliers whose rigid motions are rounding are no rows of the oracle."""
    settles(in_units(plane(7035), MILLIMETRES_TO["inch"]))


@pytest.mark.long
@pytest.mark.parametrize("seed", [12, 26, 33, 38, 233])
def test_hard_ones(seed: int) -> None:
    """Piles that friction holds, of which Newton's method makes nothing, and a pin for which bold steps get stuck."""
    settles(plane(seed))


@pytest.mark.long
@pytest.mark.parametrize("seed", [171, 249, 319])
def test_contacts_pressed_by_rounding(seed: int) -> None:
    """Beside others that are pressed: their tractions were held against their own pressures, rounding against rounding."""
    settles(plane(seed))


@pytest.mark.long
@pytest.mark.parametrize("name", PARTS)
def test_parts(name: str) -> None:
    model = PARTS[name]()
    rubbing = abut.solve(model)
    assert rubbing.converged
    smooth = abut.solve(replace(model, contacts=[replace(own, friction=0.0) for own in model.contacts]))
    tried = (
        5 if name == "clevis" else 0
    )  # where it closes alone at an edge: with other functions and back, theory (P26)
    assert (
        len(rubbing.steps[0].iterations) <= 1.5 * len(smooth.steps[0].iterations) + 4.5 + tried
    )  # 1.5: of the press fit


@pytest.mark.long
@pytest.mark.parametrize("cell", ["tet4", "hex8", "tet10"])
@pytest.mark.parametrize("hub", [True, False], ids=["hub", "shaft"])
def test_press_fits_that_friction_alone_holds(cell: str, hub: bool) -> None:
    """Said to have no unique solution, or left in a state far off."""
    settles(press_fit(cell, hub=hub, around=8))
