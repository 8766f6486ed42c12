"""Coefficients of friction that depend on place, pressure and time, and the pressures that carry friction."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.contact.friction_bound import FrictionBound, PressureCurve
from abut.contact.laws import Coulomb, LawState
from abut.errors import InputError
from abut.mesh import make
from abut.verify import inf_sup, interface_patch, law_tangents
from models.friction import FRICTION, PRESSURE, errors, pushed, sheared
from models.patch import two_blocks

EXACT = 1e-10
SLIDE = 1e-3
FLAT, SOLID = ((5, 3), (7, 3)), ((2, 3, 2), (3, 2, 2))
FALLING = ((0.0, 0.4), (2.0 * PRESSURE, 0.2))  # at the pressure of the patch: 0.3, as FRICTION
BEYOND = ((0.0, 0.8), (0.5 * PRESSURE, FRICTION))
BELOW = ((3.0 * PRESSURE, FRICTION), (4.0 * PRESSURE, 0.0))


@pytest.mark.parametrize("table", [FALLING, BEYOND, BELOW], ids=["between", "beyond", "below"])
@pytest.mark.parametrize("cells", [("quad8", "tri3", FLAT), ("hex8", "tet10", SOLID)], ids=["2D", "3D"])
def test_coefficient_over_pressure(table: tuple, cells: tuple) -> None:
    """A patch that slips: traction is the coefficient at its pressure times this pressure, but for rounding."""
    *far, solution = errors(sheared(two_blocks(*cells), FRICTION, SLIDE, friction=table), FRICTION, SLIDE)
    assert max(far) < EXACT
    assert solution.contacts[0].friction.coefficient == pytest.approx(FRICTION, rel=1e-10)
    assert all(check.passed for check in solution.certificate)


@pytest.mark.parametrize("slides", [False, True], ids=["sticks", "slips"])
@pytest.mark.parametrize(
    ("pressure", "cells"),
    [
        ("P0", ("quad4", "tri3", FLAT)),
        ("P0", ("hex8", "tet4", SOLID)),
        ("P1-discontinuous", ("quad8", "quad4", FLAT)),
        ("P1-discontinuous", ("hex27", "tet10", SOLID)),
        ("P2-discontinuous", ("quad9", "tri6", FLAT)),
    ],
)
def test_pressures_of_facets(pressure: str, cells: tuple, slides: bool) -> None:
    """The patch test with functions that belong to a facet alone."""
    size, slide = (FRICTION, SLIDE) if slides else (0.2, None)
    *far, solution = errors(sheared(two_blocks(*cells), size, slide, pressure=pressure), size, slide)
    assert max(far) < EXACT
    covered = solution.contacts[0].contactor.nodes >= 0
    assert (solution.contacts[0].friction.status[covered] == (2 if slides else 1)).all()
    assert all(check.passed for check in solution.certificate)


def two_on_a_plate(**contact: object) -> abut.Model:
    """Two blocks on a plate, each under unit pressure over a width of one, both pushed far to the right."""
    parts = {"plate": make.rectangle([0, 5], [0, 1], cells=[15, 3])}
    parts |= {f"b{i}": make.rectangle([1 + 2 * i, 2 + 2 * i], [1, 1.5], cells=[4 + i, 2]) for i in range(2)}
    return abut.Model(
        make.join(parts),
        [abut.Solid(name, abut.LinearElastic(1e3, 0.3)) for name in parts],
        [abut.Support("plate.bottom", x=0, y=0), *(abut.Support(f"b{i}.top", x=0.2) for i in range(2))],
        [abut.Pressure(f"b{i}.top", 1.0, amplitude=abut.Amplitude([(0, 1)])) for i in range(2)],
        [abut.Contact(contactor=["b0.bottom", "b1.bottom"], target="plate.top", **contact)],
        plane="strain",
    )


@pytest.mark.long
def test_coefficient_over_position() -> None:
    """0.1 under the left block and 0.3 under the right one: each drags with its own."""
    model = two_on_a_plate(friction=lambda x: np.where(x[:, 0] < 2.5, 0.1, 0.3))
    solution = abut.solve(model)
    assert solution.converged
    contact = solution.contacts[0]
    at = contact.contactor.node_ids
    for i, coefficient in enumerate((0.1, 0.3)):
        own = np.isin(at, model.mesh.nodes_of(f"b{i}"))
        assert contact.contactor_forces[own].sum(axis=0) == pytest.approx([-coefficient, 1.0], rel=1e-9)
    assert contact.friction.coefficient == 0.3
    assert all(check.passed for check in solution.certificate)


def test_where_the_coefficient_is_zero_nothing_drags() -> None:
    model = two_on_a_plate(friction=lambda x: np.where(x[:, 0] < 2.5, 0.0, 0.3))
    contact = abut.solve(model).contacts[0]
    own = np.isin(contact.contactor.node_ids, model.mesh.nodes_of("b0"))
    assert contact.contactor_forces[own][:, 0] == pytest.approx(0.0, abs=1e-12)


def test_coefficient_over_time() -> None:
    """What slides all the way drags with the coefficient of each moment, down to none."""
    factors = abut.Amplitude([(0.2, 1.0), (0.6, 0.5), (0.8, 0.5), (1.0, 0.0)])
    model = pushed(far=0.05)
    model = replace(
        model,
        supports=[model.supports[0], abut.Support("upper.top", x=0.05, amplitude=abut.Amplitude([(0.2, 0), (1, 1)]))],
        contacts=[replace(model.contacts[0], friction_amplitude=factors)],
    )
    solution = abut.solve(model)
    assert solution.converged
    for step in solution.steps[2:]:
        force = step.contacts[0].force
        assert force[0] == pytest.approx(-FRICTION * factors(step.factor) * force[1], abs=1e-9 * force[1])
        assert step.contacts[0].friction.coefficient == pytest.approx(FRICTION * factors(step.factor))
    assert all(check.passed for check in solution.certificate)


def test_every_form_in_one_model() -> None:
    """Six blocks on a plate, each under unit pressure and pushed far: every contact has friction of its own."""
    forms: dict[str, dict] = {
        "number": {"friction": 0.2},
        "table": {"friction": [[0.0, 0.3], [0.01, 0.15]]},
        "place": {"friction": lambda x: np.full(len(x), 0.1)},
        "fading": {"friction": 0.4, "friction_amplitude": abut.Amplitude([(0, 1), (1, 0.25)])},
        "smooth": {"friction": 0.3, "law": "constraint-function"},
        "none": {},
    }
    parts = {"plate": make.rectangle([0, 12], [0, 1], cells=[36, 3])}
    parts |= {n: make.rectangle([0.5 + 2 * i, 1.5 + 2 * i], [1, 1.5], cells=[4, 2]) for i, n in enumerate(forms)}
    model = abut.Model(
        make.join(parts),
        [abut.Solid(name, abut.LinearElastic(1e3, 0.3)) for name in parts],
        [abut.Support("plate.bottom", x=0, y=0), *(abut.Support(f"{name}.top", x=0.2) for name in forms)],
        [abut.Pressure(f"{name}.top", 1.0, amplitude=abut.Amplitude([(0, 1)])) for name in forms],
        [abut.Contact(contactor=f"{name}.bottom", target="plate.top", name=name, **own) for name, own in forms.items()],
        plane="strain",
    )
    solution = abut.solve(model)
    assert solution.converged
    along = {contact.name: -contact.force[0] for contact in solution.contacts}
    expected = {"number": 0.2, "table": 0.15, "place": 0.1, "fading": 0.1, "smooth": 0.3, "none": 0.0}
    assert along == pytest.approx(expected, abs=1e-6)  # the smooth one is off by epsilon
    assert all(check.passed for check in solution.certificate)


@pytest.mark.parametrize("law", ["complementarity", "constraint-function"])
def test_axisymmetric(law: str) -> None:
    """A rod pressed on a softer disc, which would widen under it: friction over radius and over pressure, in the section."""
    parts = {"disc": make.rectangle([0, 3], [0, 1], [18, 6]), "rod": make.rectangle([0, 1], [1, 3], [7, 10])}
    model = abut.Model(
        make.join(parts),
        [abut.Solid("disc", abut.LinearElastic(1e3, 0.4)), abut.Solid("rod", abut.LinearElastic(1e5, 0.3))],
        [abut.Support("disc.bottom", y=0)],
        [abut.Pressure("rod.top", 10.0)],
        [abut.Contact(contactor="disc.top", target="rod.bottom", law=law)],
        plane="axisymmetric",
    )
    smooth = abut.solve(model)
    for friction in (lambda x: 0.1 + 0.1 * x[:, 0], ((0.0, 0.2), (20.0, 0.1)), "rough"):
        solution = abut.solve(replace(model, contacts=[replace(model.contacts[0], friction=friction)]))
        assert solution.converged
        assert all(check.passed for check in solution.certificate)
        contact = solution.contacts[0]
        assert contact.force[1] == pytest.approx(smooth.contacts[0].force[1], rel=1e-9)
        # The disc would widen under the rod: friction holds it back.
        assert contact.force[0] * smooth.displacement[model.mesh.nodes_of("disc.top")][:, 0].max() < 0.0


@pytest.mark.parametrize("components", [2, 3])
def test_law_of_a_table_against_differences(components: int) -> None:
    """Slipping points, away from the points of the table; central differences are good to 1e-9 of the largest entry."""
    curve = PressureCurve(np.array([1.0, 4.0, 9.0]), np.array([0.5, 0.4, 0.1]))
    rng, n = np.random.default_rng(1), 40
    law = Coulomb(3.0, FrictionBound(rng.uniform(0.5, 1.0, n), curve))
    traction = np.column_stack([rng.choice([0.5, 2.0, 6.0, 12.0], n), rng.uniform(6.0, 9.0, (n, components - 1))])
    jump = 0.05 * rng.standard_normal((n, components))
    state = LawState(np.ones(n, bool), slipping=np.ones(n, bool))
    assert law_tangents(law, jump, traction, state) < 1e-8


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"friction": [[0, 0.1], [0, 0.2]]}, "friction: pressures must increase, but 0 follows 0"),
        ({"friction": [[-1, 0.1]]}, "pressures >= 0"),
        ({"friction": [[1, -0.1]]}, "a coefficient >= 0, got -0.1 at pressure 1"),
        ({"friction": [1, 2, 3]}, "pairs of pressure and coefficient"),
        ({"friction": []}, "at least one pair"),
        ({"friction": True}, "friction: expected a finite number"),
        ({"friction": {"mu": 0.1}}, "pairs of pressure and coefficient"),
        ({"friction": float("inf")}, "friction: expected a finite number"),
        ({"friction": 0.1, "friction_amplitude": 2.0}, "friction_amplitude: expected an Amplitude"),
        ({"friction": 0.1, "friction_amplitude": abut.Amplitude([(0, -1)])}, "factors >= 0"),
        ({"friction": "rough", "friction_amplitude": abut.Amplitude([(0, 1)])}, "no coefficient that it could"),
        ({"friction_amplitude": abut.Amplitude([(0, 1)])}, "no coefficient that it could"),
    ],
)
def test_refused(options: dict, words: str) -> None:
    with pytest.raises(InputError, match=words):
        abut.Contact(contactor="a", target="b", **options)


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (lambda x: x[:, 0] - 2.0, r"the function returns -1 at \[1.0, 1.0\], not >= 0"),
        (lambda x: x, "must return shape"),
        (lambda x: np.full(len(x), np.nan), "returns nan"),
    ],
)
def test_functions_refused(function: object, words: str) -> None:
    with pytest.raises(InputError, match=words):
        abut.solve(two_on_a_plate(friction=function))


@pytest.mark.parametrize("options", [{"law": "constraint-function"}, {"friction_amplitude": abut.Amplitude([(0, 1)])}])
def test_tests_of_the_interface_leave_friction_out(options: dict) -> None:
    model = two_on_a_plate(friction=0.1, **options)
    assert inf_sup(model).levels[0].trace > 0.1
    assert all(part.passed for part in interface_patch(model))
