"""Natural frequencies of bars, beams and assemblies against closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

import abut
from abut.bodies.mass import mass
from abut.errors import InputError
from abut.mesh import make

YOUNG, DENSITY = 210e3, 7.85e-9  # N, mm, s: tonnes per mm^3 give cycles per second
STEEL = abut.LinearElastic(YOUNG, 0.3, density=DENSITY)
STIFF = abut.LinearElastic(YOUNG, 0.0, density=DENSITY)
LENGTH, HEIGHT = 200.0, 5.0
BENDING = np.sqrt(YOUNG / DENSITY * HEIGHT**2 / 12.0) / LENGTH**2 / (2.0 * np.pi)
CLAMPED = np.array([1.87510407, 4.69409113]) ** 2  # of cos x cosh x = -1
FREE = np.array([4.73004074, 7.85320462]) ** 2  # of cos x cosh x = 1
SPEED = np.sqrt(YOUNG / DENSITY)


def beam(clamped: bool, plane: str = "stress") -> abut.Model:
    mesh = make.join({"beam": make.rectangle([0, LENGTH], [0, HEIGHT], cells=[40, 2])})
    return abut.Model(
        mesh,
        plane=plane,
        solids=[abut.Solid("beam", STEEL)],
        supports=[abut.Support("beam.left", x=0, y=0)] if clamped else [],
        modes=[abut.Frequencies(5)],
    )


def stacked(kind: str, kinematics: str, plates: float = HEIGHT) -> abut.Model:
    lower = make.rectangle([0, LENGTH], [0, plates], cells=[40, 2])
    upper = make.rectangle([0, LENGTH], [plates, 2 * plates], cells=[58, 2])
    return abut.Model(
        make.join({"lower": lower, "upper": upper}),
        plane="stress",
        kinematics=kinematics,
        solids=[abut.Solid("lower", STIFF), abut.Solid("upper", STIFF)],
        supports=[abut.Support("lower.left", x=0, y=0), abut.Support("upper.left", x=0, y=0)],
        contacts=[abut.Contact("upper.bottom", "lower.top", kind=kind)],
        modes=[abut.Frequencies(2)],
    )


def bars(push: float) -> abut.Model:
    """Two bars end to end along x, held at their far ends, the right one pushed to the left."""
    left, right = (make.rectangle([x, x + 100.0], [0, 10], cells=[20, n]) for x, n in ((0.0, 2), (100.0, 3)))
    sides = [abut.Support(f"{body}.{side}", y=0) for body in ("left", "right") for side in ("top", "bottom")]
    return abut.Model(
        make.join({"left": left, "right": right}),
        plane="stress",
        solids=[abut.Solid("left", STIFF), abut.Solid("right", STIFF)],
        supports=[abut.Support("left.left", x=0), abut.Support("right.right", x=-push), *sides],
        contacts=[abut.Contact("right.left", "left.right")],
        modes=[abut.Frequencies(3, stiffening=False)],
    )


def found(model: abut.Model) -> abut.Solution:
    solution = abut.solve(model)
    assert all(check.passed for check in solution.certificate)
    assert solution.modes[0].missing == 0
    return solution


def test_a_cantilever_vibrates_as_beams_do():
    """Shear and rotary inertia lower the second one by .3 %."""
    values = found(beam(True)).modes[0].values
    np.testing.assert_allclose(values[:2], CLAMPED * BENDING, rtol=4e-3)


def test_a_free_beam_has_three_motions_without_frequency():
    result = found(beam(False)).modes[0]
    assert (result.values[:3] == 0.0).all()
    np.testing.assert_allclose(result.values[3:5], FREE * BENDING, rtol=8e-3)
    np.testing.assert_allclose(result.effective.sum(axis=0), result.mass, rtol=1e-6)  # rigid motions are all there is
    np.testing.assert_allclose(result.mass[:2], DENSITY * LENGTH * HEIGHT)
    about_origin = DENSITY * LENGTH * HEIGHT * (LENGTH**2 + HEIGHT**2) / 3.0
    np.testing.assert_allclose(result.mass[2], about_origin)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_plates_that_slide_are_half_as_stiff_as_bonded_ones(kinematics: str):
    """Each bends by itself, 104.4396 Hz, or both as one of twice the height, 208.8791 Hz, which shear lowers by .15 %."""
    sliding, bonded = (found(stacked(kind, kinematics)).modes[0].values for kind in ("contact", "tied"))
    np.testing.assert_allclose(sliding[0], CLAMPED[0] * BENDING, rtol=5e-4)
    np.testing.assert_allclose(bonded[0], 2.0 * CLAMPED[0] * BENDING, rtol=2e-3)


@pytest.mark.parametrize("kind", ["contact", "tied"])
def test_pinned_plates_slide_or_bend_as_one(kind: str):
    """Half a sine wave: of each plate by itself, pinned at its own middle, 293.166 Hz, or of both as one of twice the
    height, pinned at the interface, 586.333 Hz; Timoshenko's shear and rotary inertia lower them by .09 % and .35 %."""
    model = stacked(kind, "small")
    points = model.mesh.points
    height, pins = (HEIGHT, [HEIGHT / 2, 3 * HEIGHT / 2]) if kind == "contact" else (2 * HEIGHT, [HEIGHT])
    pinned = np.isclose(points[:, 1, None], pins).any(axis=1)
    sets = {
        name: np.flatnonzero(pinned & np.isclose(points[:, 0], x)) for name, x in (("here", 0.0), ("there", LENGTH))
    }
    model = replace(
        model,
        mesh=replace(model.mesh, node_sets=sets),
        supports=[abut.Support("here", x=0, y=0), abut.Support("there", y=0)],
    )
    thick = (np.pi * height / LENGTH) ** 2 / 12.0 * (1.0 + 2.0 / (5.0 / 6.0))  # E / (k G) with nu = 0
    expected = np.pi**2 * BENDING * height / HEIGHT / np.sqrt(1.0 + thick)
    np.testing.assert_allclose(found(model).modes[0].values[0], expected, rtol=2e-4)


def test_bars_that_preload_joins_vibrate_as_one():
    """Half a wave over both bars, then a whole one, 12 930.5 and 25 861.0; apart, each one as a quarter of a wave, which is
    the first of these again, then three quarters."""
    waves = np.array([1.0, 2.0, 3.0]) * SPEED / (2.0 * 200.0)
    np.testing.assert_allclose(found(bars(0.01)).modes[0].values, waves, rtol=1e-5)
    apart = abut.solve(bars(-0.01)).modes[0].values
    np.testing.assert_allclose(apart, np.array([1.0, 1.0, 3.0]) * SPEED / (4.0 * 100.0), rtol=1e-5)


def test_friction_that_sticks_bonds_and_slipping_frees():
    """Blocks pressed together and sheared: what sticks is as if tied but for the functions of its multipliers, what slips
    moves freely along."""

    def sheared(friction: float | None) -> float:
        lower, upper = (make.rectangle([0, 10], [y, y + 5], cells=[4, 2]) for y in (0.0, 5.0))
        kind = "tied" if friction is None else "contact"
        contact = abut.Contact("upper.bottom", "lower.top", kind=kind, friction=friction or 0.0)
        model = abut.Model(
            make.join({"lower": lower, "upper": upper}),
            plane="stress",
            solids=[abut.Solid("lower", STIFF), abut.Solid("upper", STIFF)],
            supports=[abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=1e-3, y=-0.01)],
            contacts=[contact],
            modes=[abut.Frequencies(1, stiffening=False)],
        )
        return float(abut.solve(model).modes[0].values[0])

    sticking, slipping, tied, smooth = sheared(5.0), sheared(1e-4), sheared(None), sheared(0.0)
    np.testing.assert_allclose(sticking, tied, rtol=1e-3)
    np.testing.assert_allclose(slipping, smooth, rtol=1e-7)
    assert smooth < 0.9 * tied


def test_tension_raises_the_pitch_of_a_string():
    """A pinned beam under tension: f^2 = f0^2 (1 + N / N_euler), and at the buckling load's opposite it is zero. Ends turn
    about their middle, so that both are simply supported."""
    mesh = make.join({"beam": make.rectangle([0, LENGTH], [0, HEIGHT], cells=[40, 2])})
    euler = np.pi**2 * YOUNG * HEIGHT**2 / 12.0 / LENGTH**2  # stress
    middles = {
        name: np.flatnonzero((mesh.points == [x, HEIGHT / 2]).all(axis=1)) for name, x in (("a", 0), ("b", LENGTH))
    }
    mesh = replace(mesh, node_sets=middles)

    def first(stress: float) -> float:
        model = abut.Model(
            mesh,
            plane="stress",
            solids=[abut.Solid("beam", STIFF)],
            supports=[abut.Support("a", x=0, y=0), abut.Support("b", y=0)],
            loads=[abut.Traction("beam.right", (stress, 0)), abut.Traction("beam.left", (-stress, 0))],
            modes=[abut.Frequencies(1)],
        )
        return float(abut.solve(model).modes[0].values[0])

    at_rest = first(0.0)
    np.testing.assert_allclose(at_rest, np.pi**2 * BENDING, rtol=2e-3)
    np.testing.assert_allclose([first(s * euler) / at_rest for s in (3.0, -0.5)], np.sqrt([4.0, 0.5]), rtol=2e-3)


CELLS = ["tet4", "tet10", "hex8", "hex20", "hex27", "wedge6", "wedge15"]


@pytest.mark.parametrize("cell", CELLS)
def test_mass_of_a_block_is_that_of_a_block(cell: str):
    """Total, first and second moments, which displacements of second order have exactly, those of first order the first."""
    block = make.box([0, 2], [0, 3], [0, 1], cells=[2, 2, 2], cell=cell)
    matrix = mass(make.join({"block": block}), {"block": 2.5})
    points = make.join({"block": block}).points
    one, x = (np.zeros_like(points) for _ in range(2))
    one[:, 1], x[:, 1] = 1.0, points[:, 0]
    one, x = one.ravel(), x.ravel()
    np.testing.assert_allclose(
        [one @ matrix @ one, one @ matrix @ x, x @ matrix @ x], 2.5 * 6.0 * np.array([1, 1, 4 / 3])
    )


def test_what_has_no_mass_is_told():
    model = abut.Model(
        make.join({"beam": make.rectangle([0, 1], [0, 1], cells=[1, 1])}),
        plane="stress",
        solids=[abut.Solid("beam", abut.LinearElastic(1.0, 0.3))],
        supports=[abut.Support("beam.left", x=0, y=0)],
        modes=[abut.Frequencies()],
    )
    with pytest.raises(InputError, match="density"):
        abut.solve(model)
    for count in (0, True, 2.5):
        with pytest.raises(InputError, match="whole number"):
            abut.Frequencies(count=count)


def row(*wanted: abut.Frequencies) -> abut.Model:
    """Two slender beams in a row along x, clamped at their far ends and pressed on each other by P = 1.2 E I / L^2."""
    length, height = 100.0, 5.0
    left, right = (make.rectangle([x, x + length], [0, height], cells=[20, 2], cell="quad8") for x in (0.0, length))
    push = 1.2 * height**2 / 12.0 / length**2 * 2.0 * length
    return abut.Model(
        make.join({"left": left, "right": right}),
        plane="stress",
        kinematics="finite",
        solids=[abut.Solid("left", STIFF), abut.Solid("right", STIFF)],
        supports=[abut.Support("left.left", x=0, y=0), abut.Support("right.right", x=-push, y=0)],
        contacts=[abut.Contact("right.left", "left.right", "joint")],
        modes=list(wanted),
    )


def cantilever(load: float, turns: bool, stays: bool) -> float:
    """First square, over that without load, of a cantilever under P = load E I / L^2 along it at its end (roots of its
    determinant): turns: as the end does (Beck); stays: acting on the line that the end was on, with a moment P u."""

    def determinant(square: float, k: float) -> float:
        root = np.sqrt(k * k / 4.0 + square)
        a, b = np.sqrt(root - k / 2.0), np.sqrt(root + k / 2.0)
        u = np.array([np.cosh(a) - np.cos(b), np.sinh(a) - a / b * np.sin(b)])
        slope = np.array([a * np.sinh(a) + b * np.sin(b), a * np.cosh(a) - a * np.cos(b)])
        moment = np.array([a**2 * np.cosh(a) + b**2 * np.cos(b), a**2 * np.sinh(a) + a * b * np.sin(b)])
        force = np.array([a**3 * np.sinh(a) - b**3 * np.sin(b), a**3 * np.cosh(a) + a * b**2 * np.cos(b)])
        moment, force = moment + k * u * stays, force + k * slope * (not turns)
        return float(moment[0] * force[1] - moment[1] * force[0])

    first = [brentq(determinant, 3.0, 25.0, args=(k,)) for k in (1e-9, load)]
    return first[1] / first[0]


def test_bars_in_a_row_slide_on_each_other_and_vibrate_apart():
    """Pressed: they slide on each other, and what presses them turns with their faces and stays where these overlap. Open:
    stresses alone soften them. At the start: nothing does. Shear and the change of length count 1 %."""
    apart, start = abut.Frequencies(2, open=["joint"]), abut.Frequencies(2, time=0.0)
    solution = abut.solve(row(abut.Frequencies(1), apart, start))
    assert all(check.passed for check in solution.certificate)
    pressed, opened, unloaded = (result.eigenvalues for result in solution.modes)
    np.testing.assert_allclose(opened / unloaded, cantilever(1.2, False, False), rtol=0.01)
    np.testing.assert_allclose(pressed / unloaded[:1], cantilever(1.2, True, True), rtol=0.01)
    alone = (CLAMPED[0] * np.sqrt(YOUNG / DENSITY * 5.0**2 / 12.0) / 100.0**2) ** 2
    np.testing.assert_allclose(unloaded, alone, rtol=0.01)


def test_what_is_open_is_a_contact():
    with pytest.raises(InputError, match="did you mean 'joint'"):
        abut.solve(row(abut.Frequencies(1, open=["joit"])))


def headed(density: float) -> abut.Model:
    """A light bar along x with a rigid head of 20 by 10 tied to it."""
    light = abut.LinearElastic(YOUNG, 0.0, density=1e-14)
    mesh = make.join(
        {"bar": make.rectangle([0, 100], [0, 10], cells=[10, 1]), "head": make.rectangle([100, 120], [0, 10])}
    )
    return abut.Model(
        mesh,
        plane="stress",
        solids=[abut.Solid("bar", light)],
        rigid=[abut.Rigid("head", y=0.0, rz=0.0, density=density)],
        supports=[abut.Support("bar.left", x=0, y=0)],
        contacts=[abut.Contact("bar.right", "head.left", kind="tied")],
        modes=[abut.Frequencies(1)],
    )


def test_a_rigid_head_swings_on_a_light_bar():
    """omega^2 = (E A / L) / m."""
    result = found(headed(1e-6)).modes[0]
    np.testing.assert_allclose(result.eigenvalues, [YOUNG * 10.0 / 100.0 / (1e-6 * 200.0)], rtol=1e-5)


def test_a_rigid_body_without_mass_is_told():
    assert any("rigid body 'head' has no mass" in note for note in found(headed(0.0)).notes)
    assert not any("no mass" in note for note in found(headed(1e-6)).notes)
    with pytest.raises(InputError, match="density"):
        abut.Rigid("head", density=-1.0)
