"""Random assemblies: whatever engineers put together is solved, and rightly, in whatever units they do it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from itertools import pairwise
from typing import Any
from unittest import mock

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.mesh import make
from abut.solution import Saved
from models.assemblies import PLANE
from models.assemblies_solid import SOLID
from models.oracle import assembled, at_the_end, exact, programme, solvable
from models.units import MILLIMETRES_TO, in_units

pytest.importorskip("quadprog")

SMALL = 60, 2000  # multipliers and displacements up to which dense matrices and quadprog take no time
SAME = 1e-7  # of the largest pressure
NONE = 1e-12  # of Young's modulus: pressures where nothing presses, by rounding of the gaps
UNITS_SAME = 1e-5  # rounding, which long beams enlarge
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
    with mock.patch("abut.problem.assembly.require_balance"), mock.patch("abut.problem.assembly.require_unmoved"):
        assert not solvable(programme(at_the_end(assembled(model))))
    return None


def agrees_with_quadprog(model: abut.Model, saved: Saved) -> None:
    """The pressures of the last step against a method that shares nothing with ours but the matrices."""
    own = assembled(model)
    expected = exact(programme(at_the_end(own, saved.inside)))
    assert np.abs(saved.state.multipliers - expected).max() <= SAME * np.abs(expected).max() + nothing(model)


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
    if len(saved.state.multipliers) <= SMALL[0] and solution.dofs <= SMALL[1]:
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


@pytest.mark.long
@pytest.mark.parametrize("seed", range(DRAWS))
def test_plane_assemblies(seed: int) -> None:
    drawn(PLANE, seed)


@pytest.mark.parametrize("seed", range(SOLID_DRAWS))
def test_solid_assemblies(seed: int) -> None:
    drawn(SOLID, seed)


@pytest.mark.exhaustive
@pytest.mark.parametrize("seed", range(80))
def test_every_plane_assembly(seed: int) -> None:
    check(list(PLANE.values())[seed % len(PLANE)], seed, tuple(MILLIMETRES_TO))


@pytest.mark.exhaustive
@pytest.mark.parametrize("seed", range(16))
def test_every_solid_assembly(seed: int) -> None:
    check(list(SOLID.values())[seed % len(SOLID)], seed, tuple(MILLIMETRES_TO))


@pytest.mark.parametrize("seed", [10, 78])
def test_facets_with_a_common_edge_in_micrometres(seed: int) -> None:
    """Balls whose curved edges have the chords of edges of the other side: rounding decided which of both bounds what is
    cut, .2 to .4 % of the pressure."""
    check(list(SOLID.values())[seed % len(SOLID)], seed, ("um",))


@pytest.mark.parametrize(("kinds", "seed", "units"), [(PLANE, 126, "m"), (PLANE, 147, "m"), (SOLID, 28, "m")])
def test_glued_and_pressed_bodies_in_metres(kinds: Mapping[str, Any], seed: int, units: str) -> None:
    """Solved in millimetres, and said to have no unique solution in metres: gaps by pressures were scaled to nothing beside
    gaps by motions."""
    check(list(kinds.values())[seed % len(kinds)], seed, (units,))


@pytest.mark.long
@pytest.mark.parametrize("seed", [151, 249])
def test_smooth_contact_that_opens(seed: int) -> None:
    """Rollers that the constraint function leaves loose: the last steps failed, since open contact takes no notice of where
    they are, and rounding would have moved them."""
    model = list(PLANE.values())[seed % len(PLANE)](np.random.default_rng(seed))
    smooth = [replace(contact, law="constraint-function") for contact in model.contacts]
    assert abut.solve(replace(model, contacts=smooth)).converged


def bolted() -> abut.Model:
    """Two plates between a slab and a stiff washer, which two bolts draw down: equations shorten the distance from the
    washer to the slab. Contact and bolts alone hold washer and plates; then a force lifts the upper plate at its end."""
    layers = {"slab": (-2.0, 0.0), "lower": (0.0, 1.0), "upper": (1.0, 2.0), "washer": (2.0, 3.0)}
    parts = {
        name: make.rectangle(x=[0, 8], y=list(y), cells=[8 + 3 * i, 2], cell="quad8")
        for i, (name, y) in enumerate(layers.items())
    }
    mesh = make.join(parts)
    places = {f"{name}{x}": (x, y) for x in (2, 6) for name, y in (("head", 3.0), ("foot", -1.0))}
    nodes = {label: np.array([np.abs(mesh.points - at).max(axis=1).argmin()]) for label, at in places.items()}
    for name in layers:
        nodes[f"{name} left"] = np.intersect1d(mesh.nodes_of(f"{name}.left"), mesh.nodes_of(f"{name}.bottom"))
    steel = abut.LinearElastic(210e3, 0.3)
    return abut.Model(
        replace(mesh, node_sets=nodes),
        [abut.Solid(name, steel) for name in layers],
        [abut.Support("slab.bottom", x=0, y=0), *(abut.Support(f"{name} left", x=0) for name in list(layers)[1:])],
        [abut.Force("upper.right", (0.0, 40.0))],
        [abut.Contact(contactor=f"{b}.bottom", target=f"{a}.top") for a, b in pairwise(layers)],
        "strain",
        equations=[
            abut.Equation((abut.Term(f"head{x}", "y", 1.0), abut.Term(f"foot{x}", "y", -1.0)), -0.004) for x in (2, 6)
        ],
    )


@pytest.mark.parametrize("name", MILLIMETRES_TO)
def test_bolted_joint_in_any_units(name: str) -> None:
    units = MILLIMETRES_TO[name]
    model = bolted()
    equations = [replace(e, value=e.value * units.length) for e in model.equations]
    other = solved(replace(in_units(model, units), equations=equations))
    here = solved(model)
    assert here is not None
    assert other is not None
    expected = pressures(here[0])
    off = pressures(other[0]) * units.length**2 / units.force - expected
    assert np.abs(off).max() <= UNITS_SAME * np.abs(expected).max()
    assert min(contact.max_pressure for contact in here[0].contacts) > 1.0
