"""Random assemblies: whatever engineers put together is solved, and rightly, in whatever units they do it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.state import Saved
from assemblies import MILLIMETRES_TO, PLANE, in_units
from oracle import assembled, exact, final, programme, solvable

pytest.importorskip("quadprog")

SMALL = 60, 2000  # multipliers and displacements up to which dense matrices and quadprog take no time
SAME = 1e-7  # of the largest pressure
NONE = 1e-12  # of Young's modulus: pressures where nothing presses, by rounding of the gaps
UNITS_SAME = 1e-6  # numbers in other units are rounded differently, which long beams and loose fits enlarge
DRAWS = 35


def solved(model: abut.Model) -> tuple[abut.Solution | None, Saved | None]:
    """The solution, and what is saved of it; None for a model whose loads pull a body off: nothing but that is a reason."""
    kept: list[Saved] = []
    try:
        solution = abut.solve(model, on_step=lambda _, saved: kept.append(saved))
    except abut.SingularModelError as error:
        assert "the loads pull it off its contact" in str(error)
        assert not solvable(programme(assembled(model).system))
        return None, None
    assert solution.converged
    return solution, kept[-1]


def agrees_with_quadprog(model: abut.Model, saved: Saved) -> None:
    """The pressures of the last step against a method that shares nothing with ours but the matrices."""
    own = assembled(model)
    expected = exact(programme(final(model, own, saved.inside)))
    assert np.abs(saved.pressure - expected).max() <= SAME * np.abs(expected).max() + nothing(model)


def nothing(model: abut.Model) -> float:
    return NONE * max(solid.material.young for solid in model.solids)


def pressures(solution: abut.Solution) -> NDArray[np.float64]:
    return np.concatenate([np.nan_to_num(contact.pressure).ravel() for contact in solution.contacts])


def check(build: Callable[[np.random.Generator], abut.Model], seed: int, units: tuple[str, ...]) -> None:
    model = build(np.random.default_rng(seed))
    solution, saved = solved(model)
    others = {name: solved(in_units(model, MILLIMETRES_TO[name]))[0] for name in units}
    if solution is None or saved is None:
        assert not any(others.values())
        return
    if len(saved.pressure) <= SMALL[0] and solution.dofs <= SMALL[1]:
        agrees_with_quadprog(model, saved)
    here = pressures(solution)
    for name, other in others.items():
        assert other is not None, name
        unit = MILLIMETRES_TO[name].force / MILLIMETRES_TO[name].length ** 2
        assert np.abs(pressures(other) / unit - here).max() <= UNITS_SAME * np.abs(here).max() + nothing(model), name


@pytest.mark.parametrize("seed", range(DRAWS))
def test_plane_assemblies(seed: int) -> None:
    check(list(PLANE.values())[seed % len(PLANE)], seed, ("m", "um", "inch")[seed % 3 : seed % 3 + 1])


@pytest.mark.long
@pytest.mark.parametrize("seed", range(DRAWS, 300))
def test_more_plane_assemblies(seed: int) -> None:
    check(list(PLANE.values())[seed % len(PLANE)], seed, tuple(MILLIMETRES_TO))
