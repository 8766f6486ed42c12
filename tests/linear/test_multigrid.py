"""The iterative path: the same answer as the direct one, iterations that do not grow, and what it does where it cannot."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

import abut
from abut.linear import iterative
from abut.linear.fractional import inverse_root
from abut.linear.schur_preconditioner import half_spaces, interfaces, schur_inverse, selection
from abut.mesh.make import box, join, rectangle
from abut.nonlinear.settings import DEFAULT
from abut.problem.constraints import supports
from abut.problem.contact_pairs import pairs

STEEL = abut.LinearElastic(210e3, 0.3)
AGREE = 1e-7  # in pressure: the equations are met to 2e-9, and pressures are worse conditioned than residuals


def blocks(n: int, cell: str = "hex8", tilt: float = 0.01, **contact: object) -> abut.Model:
    """A block pressed on a larger one with other cells; tilted, so that half of it stays open."""
    lower = box((0, 10), (0, 10), (0, 10), (n, n, n), cell)
    m = max(3 * n // 4, 1)
    upper = box((1, 9), (1, 9), (10, 18), (m, m, m), cell)
    slope = np.column_stack([np.zeros((len(upper.points), 2)), tilt * (upper.points[:, 0] - 1)])
    return abut.Model(
        join({"lower": lower, "upper": replace(upper, points=upper.points + slope)}),
        [abut.Solid("lower", STEEL), abut.Solid("upper", STEEL)],
        [abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", x=0, y=0, z=-0.05)],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", **contact)],
    )


def both(model: abut.Model) -> tuple[abut.Solution, abut.Solution]:
    found = [abut.solve(replace(model, solve=abut.SolveOptions(linear=kind))) for kind in ("amg", "direct")]
    assert found[0].converged
    return found[0], found[1]


def assert_same(model: abut.Model, limit: float = AGREE) -> abut.Solution:
    iterative, direct = both(model)
    assert "multigrid" in iterative.solver
    p, q = iterative.contacts[0].pressure, direct.contacts[0].pressure
    assert np.nanmax(np.abs(p - q)) < limit * np.nanmax(np.abs(q))
    found, known = iterative.contacts[0].force, direct.contacts[0].force
    assert np.abs(found - known).max() < AGREE * np.abs(known).max()
    assert all(
        check.passed for check in iterative.certificate if check.name not in ("oscillation", "tension", "resolution")
    )
    return iterative


def linear_iterations(solution: abut.Solution) -> int:
    (note,) = (note for note in solution.notes if "linear iterations" in note)
    return int(note.split()[0])


@pytest.mark.parametrize("tilt", [0.0, 0.01])
@pytest.mark.parametrize("cell", ["hex8", "hex20", "hex27", "tet4", "tet10", "wedge6", "wedge15"])
def test_same_answer_as_the_direct_path(cell: str, tilt: float) -> None:
    """Pressures of tet4 are shown from a second solution, which iterations take to ``further``."""
    model = blocks(8 if cell in ("hex8", "tet4", "wedge6") else 4, cell, tilt)
    assert_same(model, DEFAULT.accuracy.further if cell == "tet4" else AGREE)


@pytest.mark.parametrize("pressure", ["P0", "dual"])
def test_other_pressure_spaces(pressure: str) -> None:
    assert_same(blocks(8, pressure=pressure))


def test_tied_blocks() -> None:
    assert_same(blocks(8, tilt=0.0, kind="tied"))


def test_rings() -> None:
    """A section's shifts and turns are next to no strain, though no rigid motions of the ring: as fast as plane strain."""
    lower, upper = (rectangle((0, 10), z, n, "quad8") for z, n in (((0, 5), (40, 40)), ((5, 10), (30, 30))))
    model = abut.Model(
        join({"lower": lower, "upper": upper}),
        [abut.Solid("lower", STEEL), abut.Solid("upper", STEEL)],
        [abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", y=-0.01)],
        contacts=[abut.Contact(contactor="lower.top", target="upper.bottom")],
        plane="axisymmetric",
    )
    plane = assert_same(replace(model, plane="strain"))
    assert linear_iterations(assert_same(model)) < 1.5 * linear_iterations(plane)


def test_block_that_only_contact_holds() -> None:
    """The stiffness is singular: multigrid does not see the rigid motions, which pressures and gaps determine."""
    model = blocks(8, tilt=0.0)
    loose = replace(
        model,
        supports=[model.supports[0], abut.Support("upper.left", x=0), abut.Support("upper.front", y=0)],
        loads=[abut.Pressure("upper.top", 100.0)],
    )
    assert_same(loose)


def test_several_steps() -> None:
    model = blocks(8)
    stepped = [replace(model, solve=abut.SolveOptions(steps=3, linear=kind)) for kind in ("amg", "direct")]
    iterative, direct = (abut.solve(m) for m in stepped)
    for a, b in zip(iterative.steps, direct.steps):
        assert a.contacts[0].force == pytest.approx(b.contacts[0].force, rel=1e-7, abs=1e-7 * b.contacts[0].force[2])


def test_nearly_incompressible() -> None:
    model = blocks(6)
    rubber = abut.LinearElastic(10.0, 0.49)
    assert_same(replace(model, solids=[abut.Solid("lower", rubber), abut.Solid("upper", rubber)]), 1e-6)


@pytest.mark.parametrize("softer", ["lower", "upper"])
def test_stiffness_that_differs_ten_thousand_times(softer: str) -> None:
    assert_same_or_said(with_soft(blocks(6), softer, 1e-4))


@pytest.mark.long
@pytest.mark.parametrize("flat", [0.02, 50.0])
def test_needles_and_flakes(flat: float) -> None:
    """Cells 50 times as wide as high, or as high as wide."""
    model = blocks(8)
    points = model.mesh.points * [1.0, 1.0, flat]
    moved = replace(model.supports[1], z=-0.005 * flat * 10)
    assert_same_or_said(replace(model, mesh=replace(model.mesh, points=points), supports=[model.supports[0], moved]))


def with_soft(model: abut.Model, body: str, share: float) -> abut.Model:
    other = replace(STEEL, young=share * STEEL.young)
    solids = [replace(solid, material=other) if solid.body == body else solid for solid in model.solids]
    return replace(model, solids=solids)


def assert_same_or_said(model: abut.Model) -> None:
    """Multigrid finds the answer of the direct solver, or leaves it to that and says so."""
    iterative, direct = both(model)
    if "multigrid" not in iterative.solver:
        assert any("going on with the direct solver" in note for note in iterative.notes)
    assert iterative.contacts[0].max_pressure == pytest.approx(direct.contacts[0].max_pressure, rel=AGREE)


def test_units_beyond_single_precision() -> None:
    """Cycles are in single precision, models need not be: the same blocks with a modulus and lengths far outside of it."""
    model = blocks(6)
    points, support = model.mesh.points * 1e-6, replace(model.supports[1], z=model.supports[1].z * 1e-6)
    tiny = replace(model, mesh=replace(model.mesh, points=points), supports=[model.supports[0], support])
    scaled = replace(tiny, solids=[replace(s, material=replace(STEEL, young=1e50)) for s in model.solids])
    found = abut.solve(replace(scaled, solve=abut.SolveOptions(linear="amg")))
    assert "multigrid" in found.solver
    expected = abut.solve(model).contacts[0].max_pressure * 1e50 / STEEL.young
    assert found.contacts[0].max_pressure == pytest.approx(expected, rel=AGREE)


def test_falls_back_on_the_direct_solver(monkeypatch: pytest.MonkeyPatch) -> None:
    """One iteration meets no tolerance here: the direct solver takes over, with its answer and a note that says so."""
    monkeypatch.setattr(iterative, "RESTART", 1)
    monkeypatch.setattr(iterative, "CYCLES", 1)
    fallen, direct = both(blocks(6))
    assert fallen.solver == direct.solver
    (note,) = (note for note in fallen.notes if iterative.FAILED in note)
    assert note == f"step 1: {iterative.FAILED}: going on with the direct solver"
    assert fallen.contacts[0].pressure == pytest.approx(direct.contacts[0].pressure, rel=1e-12, nan_ok=True)


@pytest.mark.long
@pytest.mark.parametrize("cell", ["hex8", "tet10"])
def test_constraint_function(cell: str) -> None:
    """The same answer in as many iterations, give or take two that stop a little short of the limit."""
    taken = []
    for law in ("constraint-function", "complementarity"):
        iterative, direct = both(blocks(5, cell, law=law, pressure="P1"))
        assert "multigrid" in iterative.solver
        assert np.nanmax(np.abs(iterative.contacts[0].pressure - direct.contacts[0].pressure)) < (
            AGREE * direct.contacts[0].max_pressure
        )
        taken.append([len(solution.steps[0].iterations) for solution in (iterative, direct)])
    iterative_more, direct_more = np.subtract(*taken)
    assert direct_more > 3
    assert abs(iterative_more - direct_more) <= 2


def test_constraint_function_on_a_body_that_only_contact_holds() -> None:
    """Beside a tie, whose rows are those of the other law; forces do no work on what is left to slide."""
    mesh = join(
        {
            "lower": box((0, 10), (0, 10), (0, 6), (4, 4, 3)),
            "upper": box((2, 8), (2, 8), (6, 11), (3, 3, 2)),
            "cap": box((2, 8), (2, 8), (11, 13), (4, 4, 1)),
        }
    )
    contacts = [
        abut.Contact(contactor="upper.bottom", target="lower.top", law="constraint-function"),
        abut.Contact(contactor="cap.bottom", target="upper.top", kind="tied"),
    ]
    model = abut.Model(
        mesh,
        [abut.Solid(body, STEEL) for body in mesh.bodies],
        [abut.Support("lower.bottom", x=0, y=0, z=0)],
        [abut.Pressure("cap.top", 3.0), abut.Force("cap.left", (0.0, 0.0, -20.0))],
        contacts,
    )
    iterative, direct = both(model)
    assert "multigrid" in iterative.solver
    for a, b in zip(iterative.contacts, direct.contacts):
        assert np.nanmax(np.abs(a.pressure - b.pressure)) < AGREE * b.max_pressure


@pytest.mark.long
def test_iterations_do_not_grow() -> None:
    """Multigrid and the interface's operator are both optimal: for each active set, from 9 000 to 65 000 displacements, no
    more than a third."""
    found = [both(blocks(n))[0] for n in (12, 24)]
    few, many = (linear_iterations(solution) / len(solution.steps[0].iterations) for solution in found)
    assert many < 1.34 * few


@pytest.mark.parametrize("high", [1e2, 1e6])
def test_inverse_root(high: float) -> None:
    x = np.geomspace(1.0, high, 200)
    shifts, weights = inverse_root(1.0, high, 1e-4)
    assert (weights / (x[:, None] + shifts)).sum(axis=1) == pytest.approx(x**-0.5, rel=1e-4)


def test_interface_operator_is_close_to_the_true_one() -> None:
    """S and B K^-1 B^T have the same eigenvalues within a factor of five, for all contact and for a part of it."""
    from abut.bodies.assemble import stiffness

    model = blocks(6, tilt=0.0)
    held = supports(model)
    (pair,) = pairs(model, held)
    k = (held.free.T @ stiffness(model.deformable) @ held.free).tocsc()
    exact = pair.operator @ sp.linalg.spsolve(k, pair.operator.T.toarray())
    for active in (np.ones(len(pair), dtype=bool), np.arange(len(pair)) % 5 > 1):
        inverse = schur_inverse(interfaces([pair]), selection(active))
        product = np.column_stack([inverse(column) for column in exact[np.ix_(active, active)].T])
        values = np.linalg.eigvals(product).real
        assert values.min() > 0.2
        assert values.max() < 5.0 * max(values.min(), 0.2)


def test_interfaces_at_once_are_those_one_by_one() -> None:
    """Half spaces of several pairs do not see each other; the inverse undoes the operator."""
    model = blocks(4, tilt=0.0)
    (pair,) = pairs(model, supports(model))
    several = [pair, replace(pair, compliance=3.0 * pair.compliance)]
    together, alone = half_spaces(interfaces(several)), half_spaces(interfaces([pair]))
    p = np.random.default_rng(0).standard_normal((2, len(pair)))
    gap = together.forward(p.ravel()).reshape(2, -1)
    assert np.abs(gap[0] - alone.forward(p[0])).max() < 1e-10 * np.abs(gap[0]).max()
    assert np.abs(gap[1] - 3.0 * alone.forward(p[1])).max() < 1e-10 * np.abs(gap[1]).max()
    assert np.abs(together.inverse(gap.ravel()) - p.ravel()).max() < 0.05 * np.abs(p).max()  # roots are to 1 %
