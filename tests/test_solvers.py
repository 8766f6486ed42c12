"""The condensed solution path against its slow twin, the sparse saddle point system factorised in every iteration."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.mesh.make import box, join
from abut.solvers import condensed, direct


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
        contacts=[abut.Contact("upper.bottom", "lower.top", law=law, kind=kind)],
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
    assert any("eliminated" in note for note in dense.notes)
    monkeypatch.setattr(condensed, "LARGEST", 0)
    sparse = abut.solve(model)
    assert not any("eliminated" in note for note in sparse.notes)
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
    monkeypatch.setattr(direct, "_pardiso", lambda: None)
    solution = abut.solve(model)
    assert "SuperLU" in solution.solver
    assert np.abs(solution.displacement - expected).max() < 1e-9 * np.abs(expected).max()


@pytest.mark.parametrize("law", ["complementarity", "constraint-function"])
def test_direct_solver_that_does_not_fit_says_so(law: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Before anything is factorised: what it needs, what there is, what to choose instead."""
    monkeypatch.setattr(direct, "available_memory", lambda: 1e4)
    with pytest.raises(abut.InputError, match=r'the direct solver needs about .* GB .* choose linear = "amg"'):
        abut.solve(pressed_block(law))
