"""Static condensation against its slow twin, the sparse saddle point system factorised in every iteration."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.linear import dense, direct, static_condensation
from abut.mesh.make import box, join


def pressed_block(law: str, kind: str = "contact", free: bool = False) -> abut.Model:
    """A small block pressed askew onto a larger one, so that part of it lifts off."""
    lower = box(x=(-1, 2), y=(-1, 2), z=(-1, 0), cells=(5, 4, 3), cell="hex20")
    upper = box(x=(0, 1), y=(0, 1), z=(0, 1), cells=(3, 3, 2), cell="hex20")
    x = upper.points.copy()
    x[:, 2] += 0.2 * ((x[:, 0] - 0.5) ** 2 + (x[:, 1] - 0.5) ** 2)  # a bowl, so that contact is partial
    mesh = join({"lower": lower, "upper": replace(upper, points=x)})
    top = abut.Force("upper.top", (0, 0, -20.0)) if free else abut.Traction("upper.top", (1.0, 0.0, -20.0))
    held = [
        abut.Support("lower.bottom", x=0, y=0, z=0),
        abut.Support("upper.left", x=0),
        abut.Support("upper.front", y=0),
    ]
    if not free:
        held.append(abut.Support("upper.top", x=0, y=0))
    steel = abut.LinearElastic(1000.0, 0.3)
    return abut.Model(
        mesh,
        solids=[abut.Solid("lower", steel), abut.Solid("upper", steel)],
        supports=held,
        loads=[top],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", law=law, kind=kind)],
        solve=abut.SolveOptions(steps=2),
    )


@pytest.mark.skipif(direct.solver_name() != "PARDISO", reason="only PARDISO condenses")
@pytest.mark.parametrize("free", [False, True])
@pytest.mark.parametrize(
    ("law", "kind"), [("complementarity", "contact"), ("constraint-function", "contact"), ("complementarity", "tied")]
)
def test_condensed_equals_sparse(law: str, kind: str, free: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    model = pressed_block(law, kind, free)
    dense = abut.solve(model)
    assert any("condensed" in note for note in dense.notes)
    monkeypatch.setattr(static_condensation, "LARGEST", 0)
    sparse = abut.solve(model)
    assert not any("condensed" in note for note in sparse.notes)
    assert len(dense.steps) == len(sparse.steps) == 2
    for a, b in zip(dense.steps, sparse.steps):
        size = np.abs(b.displacement).max()
        # Both solve the same equations: they differ by rounding times the condition of the stiffness, 1e6 here.
        assert np.abs(a.displacement - b.displacement).max() < 1e-9 * size
        assert a.contacts[0].force == pytest.approx(b.contacts[0].force, rel=1e-9, abs=1e-9 * 20)
        assert a.contacts[0].active == b.contacts[0].active
        assert np.nanmax(np.abs(a.contacts[0].pressure - b.contacts[0].pressure)) < 1e-8 * b.contacts[0].max_pressure
    if kind == "contact":
        assert 0 < dense.contacts[0].active < dense.contacts[0].multipliers


def test_without_pardiso(monkeypatch: pytest.MonkeyPatch) -> None:
    """SuperLU takes over, and the log says so."""
    model = pressed_block("complementarity")
    expected = abut.solve(model).displacement
    monkeypatch.setattr(direct, "pardiso", lambda: None)
    solution = abut.solve(model)
    assert "SuperLU" in solution.solver
    assert np.abs(solution.displacement - expected).max() < 1e-9 * np.abs(expected).max()


@pytest.mark.parametrize("law", ["complementarity", "constraint-function"])
def test_direct_solver_that_does_not_fit_says_so(law: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Before anything is factorised: what it needs, what there is, what to choose instead."""
    monkeypatch.setattr(direct, "available_memory", lambda: 1e4)
    with pytest.raises(abut.InputError, match=r'the direct solver needs about .* GB .* choose linear = "amg"'):
        abut.solve(pressed_block(law))


def bordered(units: float, seed: int = 0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A system as contact makes them, gaps by pressures and by motions, with a well known solution; ``units``: of the
    pressures over those of the motions. matrix (9, 9), solution (9,), sizes of the unknowns (9,)."""
    rng = np.random.default_rng(seed)
    root, motions = rng.normal(size=(6, 6)), rng.normal(size=(6, 3))
    matrix = np.block([[-(root @ root.T + np.eye(6)), motions], [motions.T, np.zeros((3, 3))]])
    sizes = np.concatenate([np.full(6, units), np.ones(3)])
    return matrix / sizes[:, None] / sizes, rng.uniform(1.0, 2.0, 9) * sizes, sizes


@pytest.mark.parametrize("units", [1e-9, 1.0, 1e6, 1e12])
def test_units_do_not_matter_to_dense_systems(units: float) -> None:
    """One pass over columns and rows left the two kinds of unknowns so far apart that a joint in metres was taken for
    singular: now the accuracy is that of the system in good units."""
    matrix, solution, sizes = bordered(units)
    found = dense.solve_dense(matrix, matrix @ solution, False)
    assert np.abs((found - solution) / sizes).max() < 1e-12


def test_small_right_hand_sides_are_no_sign_of_a_singular_matrix() -> None:
    """What a cancellation of large terms leaves is met as well as it can be: to rounding of the terms."""
    rng = np.random.default_rng(1)
    matrix = np.vander(np.linspace(0.1, 1.0, 9))  # condition 1e8
    large = rng.uniform(1.0, 2.0, 9)
    small = matrix @ large - np.linalg.norm(matrix) * 1e-16
    assert np.abs(dense.solve_dense(matrix, small, False) - large).max() < 1e-6


def test_dense_systems_are_refined() -> None:
    """Wilkinson's matrix, well conditioned, whose pivots grow to 2^29: elimination alone leaves 1e-9, one refinement
    rounding."""
    n = 30
    matrix = np.eye(n) - np.tri(n, k=-1)
    matrix[:, -1] = 1.0
    solution = np.random.default_rng(2).uniform(1.0, 2.0, n)
    assert np.abs(dense.solve_dense(matrix, matrix @ solution, False) - solution).max() < 1e-13


def test_singular_dense_systems() -> None:
    """The smallest solution where there is one, an error where there is none."""
    matrix, solution, _ = bordered(1.0)
    matrix[:6, 8] = matrix[8, :6] = 0.0  # a motion that nothing resists
    matrix[:6, 7] = matrix[7, :6] = matrix[:6, 6]  # and one that does what another does
    rhs = matrix @ solution
    found = dense.solve_dense(matrix, rhs, False)
    assert np.abs(matrix @ found - rhs).max() < 1e-10
    with pytest.raises(abut.SingularModelError, match="no unique solution"):
        dense.solve_dense(matrix, rhs + np.eye(9)[7], False)


def test_motions_that_rows_let_go() -> None:
    """Rows that see only the first of three motions, in two units."""
    rows = np.outer([1e-3, 2e-3, 1e-9], [3.0, 4.0, 0.0])
    loose, held = dense.let_go(rows, np.array([1e-3, 2e-3, 1e-9]))
    assert np.abs(held[:, 0]) == pytest.approx([0.6, 0.8, 0.0])
    assert np.abs(rows @ loose).max() < 1e-15
    assert loose.T @ loose == pytest.approx(np.eye(2))
