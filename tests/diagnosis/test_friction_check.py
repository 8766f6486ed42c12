"""Checks of friction before a run: what it alone holds, when solutions are unique, axisymmetric models."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.diagnosis import check
from abut.diagnosis.friction import friction
from abut.diagnosis.uniqueness import Uniqueness, uniqueness
from abut.mesh import make
from abut.problem.backend import serial
from abut.problem.constraints import supports
from abut.problem.contact_pairs import pairs
from models.friction import FRICTION, on_a_slope, pushed, sheared
from models.patch import two_blocks


def findings(model: abut.Model) -> list[tuple[str, str]]:
    held = supports(model)
    return [(finding.severity, finding.line) for finding in friction(model, held, pairs(model, held))]


def with_friction(model: abut.Model, friction: object, **options: object) -> abut.Model:
    return replace(model, contacts=[replace(own, friction=friction, **options) for own in model.contacts])


def needed(text: str) -> float:
    found = re.search(r"a coefficient of ([\d.]+) at least", text)
    assert found is not None
    return float(found.group(1))


@pytest.mark.parametrize("given", [FRICTION, 2.0, ((0.0, 0.2), (1.0, 0.4)), "rough"], ids=str)
def test_what_friction_alone_holds(given: object) -> None:
    """A block on a slope: the tangent of its angle, to the thousandth of the bisection and the digits shown."""
    ((severity, text),) = findings(with_friction(on_a_slope(0.2), given))
    assert severity == "info"
    assert "body 'upper' is free to translate along x but for friction, which alone holds it" in text
    assert needed(text) == pytest.approx(np.tan(0.2), rel=5e-3)
    assert ("rough" in text) == (given == "rough")


def test_close_to_sliding() -> None:
    ((severity, text),) = findings(on_a_slope(0.98 * np.arctan(FRICTION)))
    assert severity == "advice"
    assert "close to sliding" in text


def test_the_step_that_takes_most() -> None:
    """The coefficient falls from the first to the second of three steps, and rises again."""
    model = with_friction(
        on_a_slope(0.1), FRICTION, friction_amplitude=abut.Amplitude([(1 / 3, 1), (2 / 3, 0.5), (1, 1)])
    )
    ((_, text),) = findings(replace(model, solve=abut.SolveOptions(steps=3)))
    assert "in step 2" in text
    assert "given is 0.15" in text
    assert needed(text) == pytest.approx(np.tan(0.1), rel=5e-3)


@pytest.mark.parametrize("last", [0.05, 0.0])
def test_friction_that_fades(last: float) -> None:
    """Below the tangent in the last step, or none there at all: it slides then, and both check and run say when."""
    model = with_friction(on_a_slope(0.1), FRICTION, friction_amplitude=abut.Amplitude([(0.5, 1), (1, last)]))
    model = replace(model, solve=abut.SolveOptions(steps=2))
    words = "body 'upper' is free to translate along x: the loads pull it off its contact in step 2"
    assert any(finding.severity == "error" and words in finding.line for finding in check(model).findings)
    with pytest.raises(abut.SingularModelError, match=words):
        abut.solve(model)


def test_in_3d() -> None:
    """A shear of 0.2 of the pressure; the pyramid of sixteen edges lies round the cone: 2 % less at the most."""
    ((_, text),) = findings(sheared(two_blocks("hex8", "tet4", ((2, 3, 2), (3, 2, 2))), 0.2))
    assert 0.98 * 0.2 < needed(text) < 1.001 * 0.2


@pytest.mark.parametrize("model", [pushed(), pushed(friction=0.0), on_a_slope(0.4)], ids=["held", "none", "slides"])
def test_nothing_to_say(model: abut.Model) -> None:
    assert not [text for _, text in findings(model) if "but for friction" in text]


def corner(dim: int, friction: float = 0.3) -> abut.Model:
    """A cell of which one node is free, on a plate that is fixed."""
    ranges = [[0.0, 1.0]] * (dim - 1)
    kind = "quad4" if dim == 2 else "hex8"
    cell = make.rectangle if dim == 2 else make.box
    parts = {"plate": cell(*ranges, [-1, 0], [1] * dim, kind), "cell": cell(*ranges, [0, 1.5], [1] * dim, kind)}
    whole = dict.fromkeys("xyz"[:dim], 0)
    held = ["plate.bottom", "plate.top", "cell.top", "cell.right", *(["cell.back"] if dim == 3 else [])]
    return abut.Model(
        make.join(parts),
        [abut.Solid(name, abut.LinearElastic(1.0, 0.3)) for name in parts],
        [abut.Support(on, **whole) for on in held],
        contacts=[abut.Contact(contactor="cell.bottom", target="plate.top", friction=friction)],
        plane="strain" if dim == 2 else None,
    )


def found(model: abut.Model) -> tuple[Uniqueness, np.ndarray]:
    held = supports(model)
    result = uniqueness(model, held, pairs(model, held))
    assert result is not None
    return result, serial(model).reduce(held).toarray()


def test_bounds_of_a_single_node() -> None:
    """Klarbring 1990: one solution if and only if the coefficient is below k_tt / |k_nt|; and theory (R17)."""
    result, stiffness = found(corner(2))
    assert stiffness.shape == (2, 2)
    tangential, both, normal = stiffness[0, 0], stiffness[0, 1], stiffness[1, 1]
    assert result.critical == pytest.approx(tangential / abs(both), rel=1e-3)  # gaps are held by a stiff spring
    assert result.certain == pytest.approx(2.0 * np.sqrt(tangential / normal - (both / normal) ** 2), rel=1e-9)
    assert result.certain <= result.critical


def test_bounds_of_a_single_node_in_3d() -> None:
    """Along the worst direction, of which eight in half a turn are tried: cos(pi / 16)."""
    result, stiffness = found(corner(3))
    assert stiffness.shape == (3, 3)
    yields = np.linalg.inv(stiffness)
    exact = yields[2, 2] / np.linalg.norm(yields[2, :2])
    assert exact * (1.0 - 1e-3) < result.critical < exact / np.cos(np.pi / 16) * (1.0 + 1e-3)
    assert 0.0 < result.certain <= exact


def test_a_coefficient_that_is_too_large() -> None:
    critical = found(corner(2))[0].critical
    for factor, severity in ((1.1, "warning"), (0.9, "info")):
        ((own, text),) = findings(corner(2, factor * critical))
        assert own == severity
        assert f"from {critical:.3g} on" in text
    assert any("several solutions" in finding.line for finding in check(corner(2, 1.1 * critical)).findings)


def test_bounds_are_for_what_they_know() -> None:
    """Not beside contacts without friction, nor for bodies that friction alone holds, rough surfaces and tables."""
    model = pushed()
    other = abut.Contact(contactor="upper.right", target="lower.top", name="other")
    table = ((0.0, 0.3), (1.0, 0.2))
    for own in (
        on_a_slope(0.2),
        with_friction(model, "rough"),
        with_friction(model, table),
        replace(model, contacts=[]),
    ):
        held = supports(own)
        assert uniqueness(own, held, pairs(own, held)) is None
    built = pairs(model, supports(model))
    slippery = replace(built[0], contact=other, slip=None)
    assert uniqueness(model, supports(model), [*built, slippery]) is None


def test_axisymmetric() -> None:
    parts = {"a": make.rectangle([1, 2], [0, 1], [2, 2]), "b": make.rectangle([1, 2], [1, 2], [3, 2])}
    model = abut.Model(
        make.join(parts),
        [abut.Solid(name, abut.LinearElastic(1.0, 0.3)) for name in parts],
        [abut.Support("a.bottom", x=0, y=0), abut.Support("b.top", x=0, y=-0.01)],
        contacts=[abut.Contact(contactor="b.bottom", target="a.top", friction=0.1)],
        plane="axisymmetric",
    )
    ((severity, text),) = findings(model)
    assert severity == "info"
    assert "friction acts in the plane of the section" in text
