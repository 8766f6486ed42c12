"""Linear buckling against closed forms."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.mesh import make

YOUNG = 210e3
STEEL = abut.LinearElastic(YOUNG, 0.0)


def column(load: float, kinematics: str = "small") -> abut.Model:
    return abut.Model(
        make.join({"column": make.rectangle([0, 200], [0, 4], cells=[40, 2])}),
        plane="stress",
        kinematics=kinematics,
        solids=[abut.Solid("column", STEEL)],
        supports=[abut.Support("column.left", x=0, y=0)],
        loads=[abut.Traction("column.right", (load, 0))],
        modes=[abut.Buckling(2)],
    )


def test_a_clamped_column_buckles_at_eulers_loads():
    """pi^2 E I / (4 L^2) times 1, 9; shear lowers the second one by .3 %."""
    solution = abut.solve(column(-2.0))
    assert all(check.passed for check in solution.certificate)
    euler = np.pi**2 * YOUNG * (4.0**2 / 12.0) / (4.0 * 200.0**2)
    np.testing.assert_allclose(2.0 * solution.modes[0].values, euler * np.array([1.0, 9.0]), rtol=4e-3)
    assert solution.modes[0].missing == 0


def test_a_stack_in_contact_buckles_as_two_columns():
    """Without friction each of two leaves carries half and buckles by itself; tied, four times as much."""

    def factor(kind: str) -> float:
        lower = make.rectangle([0, 200], [0, 4], cells=[40, 2])
        upper = make.rectangle([0, 200], [4, 8], cells=[58, 2])
        model = abut.Model(
            make.join({"lower": lower, "upper": upper}),
            plane="stress",
            solids=[abut.Solid("lower", STEEL), abut.Solid("upper", STEEL)],
            supports=[abut.Support("lower.left", x=0, y=0), abut.Support("upper.left", x=0, y=0)],
            loads=[abut.Traction("lower.right", (-1.0, 0)), abut.Traction("upper.right", (-1.0, 0))],
            contacts=[abut.Contact("upper.bottom", "lower.top", kind=kind)],
            modes=[abut.Buckling(1)],
        )
        return float(abut.solve(model).modes[0].values[0])

    euler = np.pi**2 * YOUNG * (4.0**2 / 12.0) / (4.0 * 200.0**2)
    np.testing.assert_allclose([factor("contact"), factor("tied")], [euler, 4.0 * euler], rtol=4e-3)


def test_a_ring_buckles_under_pressure():
    """A quarter with symmetry holds the oval mode: 4 E I / R^3 where the pressure keeps its direction (Boresi 1955)."""
    radius, wall = 50.0, 1.0
    model = abut.Model(
        make.join({"ring": make.ring([radius - wall / 2, radius + wall / 2], cells=[1, 24])}),
        plane="stress",
        solids=[abut.Solid("ring", STEEL)],
        supports=[abut.Support("ring.start", y=0), abut.Support("ring.end", x=0)],
        loads=[abut.Pressure("ring.outer", 0.5), abut.Pressure("ring.inner", -0.5)],  # as if on the middle
        modes=[abut.Buckling(1)],
    )
    value = abut.solve(model).modes[0].values[0]
    np.testing.assert_allclose(value, 4.0 * YOUNG * (wall**3 / 12.0) / radius**3, rtol=5e-3)


def test_what_cannot_buckle_is_told():
    with pytest.raises(InputError, match="buckling: there is no stress"):
        abut.solve(column(0.0))
    with pytest.raises(InputError, match="check the loads' signs"):
        abut.solve(column(2.0))
    with pytest.raises(InputError, match="small displacements"):
        abut.solve(column(-1.0, "finite"))
