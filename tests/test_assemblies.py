"""Random assemblies: whatever engineers put together is solved, and rightly, in whatever units they do it."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.state import Saved
from assemblies import MILLIMETRES_TO, PLANE, in_units
from assemblies_solid import SOLID
from oracle import assembled, exact, final, programme, solvable

pytest.importorskip("quadprog")

SMALL = 60, 2000  # multipliers and displacements up to which dense matrices and quadprog take no time
SAME = 1e-7  # of the largest pressure
NONE = 1e-12  # of Young's modulus: pressures where nothing presses, by rounding of the gaps
UNITS_SAME = 1e-5  # rounding, which long beams enlarge, and which decides how curved facets with a common edge are cut
DRAWS, SOLID_DRAWS = 35, 8


def solved(model: abut.Model) -> tuple[abut.Solution, Saved] | None:
    """The solution, and what is saved of it; None for a model whose loads pull a body off: nothing but that is a reason."""
    kept: list[Saved] = []
    try:
        solution = abut.solve(model, on_step=lambda _, saved: kept.append(saved))
    except abut.SingularModelError as error:
        reason = str(error)
    else:
        assert solution.converged
        return solution, kept[-1]
    assert "the loads pull it off its contact" in reason
    assert not solvable(programme(assembled(model).system))
    return None


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
    here = solved(model)
    others = {name: solved(in_units(model, MILLIMETRES_TO[name])) for name in units}
    if here is None:
        assert not any(others.values())
        return
    solution, saved = here
    if len(saved.pressure) <= SMALL[0] and solution.dofs <= SMALL[1]:
        agrees_with_quadprog(model, saved)
    expected = pressures(solution)
    for name, other in others.items():
        assert other is not None, name
        unit = MILLIMETRES_TO[name].force / MILLIMETRES_TO[name].length ** 2
        off = np.abs(pressures(other[0]) / unit - expected).max()
        assert off <= UNITS_SAME * np.abs(expected).max() + nothing(model), name


def drawn(kinds: Mapping[str, Callable[[np.random.Generator], abut.Model]], seed: int) -> None:
    """The kinds in turn, and one of the units."""
    check(list(kinds.values())[seed % len(kinds)], seed, tuple(MILLIMETRES_TO)[seed % 3 : seed % 3 + 1])


@pytest.mark.parametrize("seed", range(DRAWS))
def test_plane_assemblies(seed: int) -> None:
    drawn(PLANE, seed)


@pytest.mark.parametrize("seed", range(SOLID_DRAWS))
def test_solid_assemblies(seed: int) -> None:
    drawn(SOLID, seed)


@pytest.mark.long
@pytest.mark.parametrize("seed", range(300))
def test_every_plane_assembly(seed: int) -> None:
    check(list(PLANE.values())[seed % len(PLANE)], seed, tuple(MILLIMETRES_TO))


@pytest.mark.long
@pytest.mark.parametrize("seed", range(30))
def test_every_solid_assembly(seed: int) -> None:
    check(list(SOLID.values())[seed % len(SOLID)], seed, tuple(MILLIMETRES_TO))
