"""Friction of a body in contact with itself, in the plane and in space."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.contact.sides import Names
from abut.job import load_job
from abut.solution import Solution
from abut.solution.state import State
from models.certificate import faceted
from models.clamps import DEPTH, NAMED, WHOLE, balanced, clamp, tube, wrung
from models.sliding import finite, tangent_errors_at

TENTHS = abut.SolveOptions(times=tuple(np.linspace(0.1, 1.0, 10)))


@cache
def closed(make: Callable[..., abut.Model], cell: str, sides: tuple[Names, Names]) -> Solution:
    """In the same load steps: friction follows them."""
    solution = abut.solve(replace(make(cell, sides=sides, friction=0.3), solve=TENTHS))
    assert solution.converged
    return solution


def same(one: Solution, other: Solution, tolerance: float) -> None:
    a, b = one.contacts[0], other.contacts[0]
    assert a.friction is not None
    assert b.friction is not None
    assert np.abs(one.displacement - other.displacement).max() < tolerance
    assert np.abs(a.force - b.force).max() < tolerance * np.abs(b.force).max()
    assert np.abs(a.friction.force - b.friction.force).max() < tolerance * np.abs(b.force).max()
    assert a.friction.work == pytest.approx(b.friction.work, rel=tolerance, abs=tolerance)


@pytest.mark.long
@pytest.mark.parametrize("cell", ["quad4", "hex8", pytest.param("hex20", marks=pytest.mark.exhaustive)])
def test_a_clamp_closes_as_between_two_surfaces(cell: str) -> None:
    """The body named twice is its two arms as contactor and target, to rounding; hex20: to the rule of integration, which is
    that of the most curved facet, elsewhere on the whole body."""
    whole, named = (closed(clamp, cell, sides) for sides in (WHOLE, NAMED))
    balanced(whole)
    same(whole, named, 1e-3 if cell == "hex20" else 1e-9)


@pytest.mark.long
def test_a_flattened_tube_touches_itself_inside() -> None:
    """As its two halves. Facets match, so that rounding decides which segments there are: 1e-6 is left by the rule of
    integration."""
    whole, named = (closed(tube, "hex8", sides) for sides in (WHOLE, NAMED))
    balanced(whole)
    same(whole, named, 1e-5)


@pytest.mark.long
def test_extruded_by_one_cell() -> None:
    """Between two planes hex8 is quad4 in plane strain: to the square of the turn of normals within a facet, by which a
    traction that is laid on the surface at each point (3D) is shorter than one that turns with it (2D), and to the other
    integration points of theory (G19), 1e-5. Without bulges, which at the ends of the depth are found from more facets."""

    def flat_facets(cell: str, **given: object) -> abut.Model:
        return faceted(clamp(cell, **given))  # type: ignore[arg-type]

    flat, deep = (closed(flat_facets, cell, WHOLE).contacts[0] for cell in ("quad4", "hex8"))
    assert np.abs(deep.force[:2] / DEPTH - flat.force).max() < 2e-5 * np.abs(flat.force).max()
    assert deep.max_pressure == pytest.approx(flat.max_pressure, rel=2e-5)
    assert deep.friction is not None
    assert flat.friction is not None
    assert np.abs(deep.friction.force[:2] / DEPTH - flat.friction.force).max() < 2e-5 * np.abs(flat.force).max()


@pytest.mark.long
@pytest.mark.parametrize("cell", ["hex8", pytest.param("tet10", marks=pytest.mark.exhaustive)])
def test_jaws_pushed_across_and_turned(cell: str) -> None:
    """Nothing of it is plane. The jaws slip all over: each function carries the coefficient times its pressure against its
    slip, forces and moments of both sides add up to none, and the certificate's lines hold. hex8
    to rounding; tet10 to the rule of integration, which is that of the most curved facet, elsewhere on the whole body."""
    states: list[State] = []
    model = wrung(cell, friction=0.3)
    whole = abut.solve(model, on_step=lambda _, saved: states.append(saved.state))
    named = abut.solve(wrung(cell, NAMED, friction=0.3))
    assert whole.converged
    assert named.converged
    balanced(whole)
    same(whole, named, 1e-3 if cell == "tet10" else 1e-9)
    wanted = {"friction cone", "friction direction", "force balance", "moment balance", "energy balance"}
    checks = {check.name: check.passed for check in whole.certificate}
    assert all(passed for name, passed in checks.items() if name in wanted)
    result = whole.contacts[0]
    pair, state = finite(model).again(states[-1], states[-1]).pairs[0], states[-1]
    slips = state.slipping[pair.normal]
    traction, pressure = pair.tangential_traction(state.multipliers), state.multipliers[pair.normal]
    assert slips.sum() == result.active > 2
    assert np.allclose(np.linalg.norm(traction[slips], axis=1), 0.3 * pressure[slips], rtol=1e-8)
    assert result.friction is not None
    assert result.friction.force[2] > 0.2 * -result.force[1]  # the contactor, below, is dragged across
    assert result.friction.work > 0.0


def test_tangent_is_the_derivative() -> None:
    """Of balance, gaps and slips where the jaws touch, with random multipliers: as between two bodies. In the bend a facet
    looks at others beyond the place where its normals meet."""
    model = wrung("hex8", friction=0.3)
    states: list[State] = []
    abut.solve(replace(model, solve=abut.SolveOptions(times=(0.5, 0.75))), on_step=lambda _, s: states.append(s.state))
    problem, (before, about), rng = finite(model), states[-2:], np.random.default_rng(3)
    unknowns = about.unknowns + 1e-3 * rng.standard_normal(problem.n_free)
    at = replace(before, time=0.7, unknowns=unknowns, multipliers=rng.uniform(0.0, 5.0, len(before.multipliers)))
    assert max(tangent_errors_at(problem, before, at, rng.standard_normal(problem.n_free), 1e-6)) < 1e-7


def test_every_pair_of_bodies_found(tmp_path: Path) -> None:
    """auto = true with friction in 3D: bodies that might touch themselves and do not are no burden on the pair that does."""
    job = """
    schema = 1
    model.kinematics = "finite"
    mesh.bodies.plate = {kind = "box", x = [0, 2], y = [0, 1], z = [0, 0.5], cells = [4, 2, 1], cell = "hex8"}
    mesh.bodies.block = {kind = "box", x = [0.5, 1.2], y = [0.2, 0.8], z = [0.5, 1], cells = [2, 2, 1], cell = "hex8"}
    materials.rubber = {kind = "neo-hooke", young = 10, poisson = 0.4}
    solids = [{body = "plate", material = "rubber"}, {body = "block", material = "rubber"}]
    supports = [{on = "plate.bottom", x = 0, y = 0, z = 0}, {on = "block.top", x = 0.2, y = 0.1, z = -0.05}]
    solve.steps = 2
    """
    solutions = []
    for name, sides in (("auto", "auto = true"), ("named", 'contactor = "block.bottom", target = "plate.top"')):
        (tmp_path / name).mkdir()
        path = tmp_path / name / "job.toml"
        path.write_text(job + f"contacts = [{{{sides}, friction = 0.3}}]")
        solutions.append(abut.solve(load_job(path).model))
    found, named = solutions
    assert len(found.contacts) == 3
    assert found.converged
    touching = [contact for contact in found.contacts if contact.active]
    assert len(touching) == 1
    force, expected = np.abs(touching[0].force), np.abs(named.contacts[0].force)  # block or plate is the contactor
    assert np.abs(force - expected).max() < 1e-6 * expected.max()
