"""Friction by the constraint function: it tends to Coulomb's law, in 2D and 3D, beside other contacts."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.mesh import make
from models.friction import FRICTION, errors, pushed, sheared
from models.patch import two_blocks

SLIDE = 1e-3
SMOOTH = {"law": "constraint-function"}


def with_law(model: abut.Model, **options: object) -> abut.Model:
    return replace(model, contacts=[replace(contact, **SMOOTH, **options) for contact in model.contacts])


@pytest.mark.long
def test_tends_to_coulomb() -> None:
    """Pushed to and fro, stick and slip side by side: the distance falls with the square root of ``epsilon``."""
    exact, far = abut.solve(pushed()), []
    for epsilon in (1e-6, 1e-8, 1e-10, 1e-12):
        solution = abut.solve(with_law(pushed(), epsilon=epsilon))
        assert solution.converged
        assert all(check.passed for check in solution.certificate)
        far.append(np.abs(solution.displacement - exact.displacement).max() / np.abs(exact.displacement).max())
    assert far[0] < 2e-3
    assert all(after < 0.35 * before for before, after in pairwise(far))
    assert far[-1] < 1e-5
    status = [solution.contacts[0].friction.status for solution in (exact, solution)]
    assert np.array_equal(*status)


@pytest.mark.parametrize("slides", [False, True], ids=["sticks", "slips"])
def test_patch_in_3d(slides: bool) -> None:
    """Along the direction of slip. The functions are off by epsilon (1e-6) over the distance to the corner."""
    size, slide = (FRICTION, SLIDE) if slides else (0.2, None)
    model = sheared(two_blocks("hex8", "tet10", ((2, 3, 2), (3, 2, 2))), size, slide, **SMOOTH)
    *far, solution = errors(model, size, slide)
    assert 1e-12 < max(far) < 1e-4
    assert all(check.passed for check in solution.certificate)


@pytest.mark.long
def test_tends_to_coulomb_in_3d() -> None:
    """Pushed askew by its top, until a third of it slips, each point in a direction of its own."""
    parts = {
        "lower": make.box([0, 4], [0, 3], [0, 1], [8, 6, 2], "hex8"),
        "upper": make.box([1, 3], [0.5, 2.5], [1, 2], [5, 5, 3], "hex8"),
    }
    model = abut.Model(
        make.join(parts),
        [abut.Solid(name, abut.LinearElastic(1e4, 0.3)) for name in parts],
        [
            abut.Support("lower.bottom", x=0, y=0, z=0),
            abut.Support("upper.top", x=0.012, y=0.006, amplitude=abut.Amplitude([(0.3, 0), (1, 1)])),
        ],
        [abut.Pressure("upper.top", 100.0, amplitude=abut.Amplitude([(0, 0), (0.3, 1)]))],
        [abut.Contact(contactor="upper.bottom", target="lower.top", friction=FRICTION)],
        solve=abut.SolveOptions(times=[0.3, 0.65, 1.0]),
    )
    exact, far = abut.solve(model), []
    assert exact.contacts[0].friction.slipping_area > 1.0
    assert exact.contacts[0].friction.sticking_area > 1.0
    for epsilon in (1e-8, 1e-12):
        solution = abut.solve(with_law(model, epsilon=epsilon))
        assert solution.converged
        assert all(check.passed for check in solution.certificate)
        far.append(np.abs(solution.displacement - exact.displacement).max() / np.abs(exact.displacement).max())
    assert far[1] < 0.1 * far[0] < 1e-4


def test_laws_side_by_side() -> None:
    """The constraint function with friction and without, Coulomb's law, a tie: all slides in the end."""
    parts = {name: make.rectangle([0, 1], [i, i + 1], cells=[3 + i, 3]) for i, name in enumerate("abcde")}
    contacts = [
        abut.Contact(contactor="a.top", target="b.bottom", **SMOOTH),
        abut.Contact(contactor="b.top", target="c.bottom", kind="tied"),
        abut.Contact(contactor="c.top", target="d.bottom", friction=0.1),
        abut.Contact(contactor="d.top", target="e.bottom", friction=0.3, **SMOOTH),
    ]
    model = abut.Model(
        make.join(parts),
        [abut.Solid(name, abut.LinearElastic(1e3, 0.3)) for name in parts],
        [abut.Support("a.bottom", x=0, y=0), abut.Support("e.top", x=0.1), abut.Support("b.left", x=0)],
        [abut.Pressure("e.top", 1.0)],
        contacts,
        plane="strain",
    )
    solution = abut.solve(model)
    assert solution.converged
    along = [contact.force[0] for contact in solution.contacts]
    assert along[0] == pytest.approx(0.0, abs=1e-9)
    assert np.abs(along[2:]) == pytest.approx(0.1, rel=1e-6)  # the weaker one slips, the other carries as much
    assert solution.contacts[2].friction.sticking_area == 0.0
    assert solution.contacts[3].friction.sticking_area > 0.5


def test_rough_and_over_time() -> None:
    rough = abut.solve(with_law(pushed(far=0.01), friction="rough"))
    assert rough.converged
    assert rough.contacts[0].friction.slipping_area == 0.0
    factors = abut.Amplitude([(0.2, 1.0), (1.0, 0.0)])
    fading = abut.solve(with_law(pushed(far=0.05), friction_amplitude=factors))
    assert fading.converged
    assert fading.contacts[0].force[0] == pytest.approx(0.0, abs=1e-9 * fading.contacts[0].force[1])


def test_multigrid_is_refused() -> None:
    model = with_law(pushed())
    with pytest.raises(InputError, match="friction by Coulomb's law alone"):
        abut.solve(replace(model, solve=abut.SolveOptions(linear="amg")))


class Own:
    def evaluate(self, jump: np.ndarray, traction: np.ndarray, state: object) -> object:
        raise NotImplementedError


def test_a_law_of_ones_own_has_no_friction() -> None:
    with pytest.raises(InputError, match="friction: a law of your own looks at the gap and the pressure alone"):
        abut.Contact(contactor="a", target="b", law=Own(), friction=0.1)
