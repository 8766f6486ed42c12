"""Couplings of points within a radius, of half models, and in local directions, against closed forms and whole models."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.mesh.make import box, join, rectangle, ring

YOUNG, LENGTH, HEIGHT, WIDTH = 210e3, 40.0, 4.0, 3.0
BENDING = YOUNG * WIDTH * HEIGHT**3 / 12.0
TWO_BARS = join({name: rectangle((0, 10), (y, y + 1), (5, 2), "quad4") for name, y in (("one", 0.0), ("two", 6.0))})
ENDS = np.flatnonzero(TWO_BARS.points[:, 0] == 10.0)
STEEL = abut.LinearElastic(1000.0, 0.0)


def bars(**coupling) -> abut.Model:
    """Two bars side by side, whose ends are one node set."""
    return abut.Model(
        replace(TWO_BARS, node_sets={"ends": ENDS}),
        [abut.Solid("one", STEEL), abut.Solid("two", STEEL)],
        [abut.Support("one.left", x=0, y=0), abut.Support("two.left", x=0, y=0)],
        [abut.Force("grip", (3.0, 0.0))],
        plane="stress",
        couplings=[abut.Coupling("grip", "ends", **coupling)],
        solve=abut.SolveOptions(steps=1),
    )


@pytest.mark.parametrize("kind", ["kinematic", "distributing"])
def test_points_beyond_the_radius_take_no_part(kind):
    """The bar within the radius is stretched by F L / (E A), the other one, beyond it, is not."""
    weights = (0.25, 0.5, 0.25) * 2 if kind == "distributing" else None  # evenly over the height of either
    model = bars(kind=kind, reference=(10.0, 0.5), radius=1.0, weights=weights)
    step = abut.solve(model).steps[-1]
    stretch = 3.0 * 10.0 / 1000.0
    assert step.rigid["grip"].displacement == pytest.approx([stretch, 0.0], rel=1e-9, abs=1e-12)
    other = model.mesh.nodes_of("two")
    assert np.abs(step.displacement[other]).max() == 0.0
    shared = abut.solve(replace(model, couplings=[replace(model.couplings[0], radius=None)])).steps[-1]
    assert np.abs(shared.displacement[other]).max() > 0.1 * stretch


def test_points_on_the_radius_take_part():
    coupling = abut.Coupling("grip", "ends", reference=(10.0, 0.5), radius=0.5)
    assert coupling.nodes(bars().mesh).tolist() == [n for n in ENDS if TWO_BARS.points[n, 1] <= 1.0]


def beam(part: tuple[str, ...], loads, mirrors=None, kinematics="small") -> abut.Model:
    """A beam, or the half or quarter beyond the planes with the normals ``part``, loaded at the middle of its end."""
    y, z = (((0.0 if c in part else -size / 2), size / 2) for c, size in (("y", HEIGHT), ("z", WIDTH)))
    cells = [8, *(1 if c in part else 2 for c in "yz")]  # so that a half is meshed as the whole
    mesh = join({"beam": box((0, LENGTH), y, z, cells=cells, cell="hex20")})
    sets = {c: np.flatnonzero(mesh.points[:, "xyz".index(c)] == 0.0) for c in part}
    return abut.Model(
        replace(mesh, node_sets=sets),
        [abut.Solid("beam", abut.LinearElastic(YOUNG, 0.0))],
        [abut.Support("beam.left", x=0, y=0, z=0), *(abut.Support(c, **{c: 0}) for c in part)],
        loads,
        couplings=[abut.Coupling("tip", "beam.right", "distributing", (LENGTH, 0.0, 0.0), mirrors=mirrors)],
        kinematics=kinematics,
        solve=abut.SolveOptions(steps=1),
    )


@pytest.mark.parametrize("part", [("y",), ("z",), ("y", "z")])
def test_a_half_is_pulled_as_the_whole(part):
    """A stretch without bending, F L / (E A), by the half's share of the force; without ``mirrors`` the half bends."""
    share = 0.5 ** len(part)
    pull = [abut.Force("tip", (share * 1e4, 0.0, 0.0))]
    step = abut.solve(beam(part, pull, part)).steps[-1]
    stretch = 1e4 * LENGTH / (YOUNG * HEIGHT * WIDTH)
    assert step.rigid["tip"].displacement == pytest.approx([stretch, 0.0, 0.0], rel=1e-8, abs=1e-10)
    assert step.rigid["tip"].rotation == pytest.approx([0.0] * 3, abs=1e-12)
    along = step.displacement[:, 0]
    assert along == pytest.approx(stretch * beam(part, pull).mesh.points[:, 0] / LENGTH, abs=1e-8 * stretch)
    bent = abut.solve(beam(part, pull)).steps[-1].displacement[:, 0]
    assert np.abs(bent - along).max() > 0.05 * stretch


def test_a_half_is_bent_as_the_whole():
    """Curvature M / (E I) of the half with half the moment, in its plane of symmetry."""
    moment = 1e-3 * BENDING / LENGTH
    result = abut.solve(beam(("z",), [abut.Moment("tip", (0, 0, 0.5 * moment))], ("z",))).steps[-1].rigid["tip"]
    assert result.displacement == pytest.approx([0.0, 0.5e-3 * LENGTH, 0.0], rel=1e-7, abs=1e-8)
    assert result.rotation[:2] == pytest.approx([0.0, 0.0], abs=1e-12)


def test_a_half_is_moved_by_half_the_force():
    """A prescribed motion of the reference: half of the force and of the moment that the whole needs, none across."""
    moves = {"y": 0.01, "rz": 0.0}

    def moved(model):
        return abut.solve(replace(model, couplings=[replace(model.couplings[0], **moves)])).steps[-1].rigid["tip"]

    half, whole = moved(beam(("z",), [], ("z",))), moved(beam((), []))
    assert half.force == pytest.approx(0.5 * whole.force, rel=1e-7, abs=1e-7)
    assert half.moment == pytest.approx(0.5 * whole.moment, rel=1e-7, abs=1e-6)
    assert half.displacement == pytest.approx([whole.displacement[0], 0.01, 0.0], abs=1e-10)


def test_what_is_not_symmetric_is_refused():
    for load in (abut.Force("tip", (0, 0, 1.0)), abut.Moment("tip", (1.0, 0, 0))):
        with pytest.raises(InputError, match=r"coupling 'tip': .* is not symmetric about the planes of mirrors, z"):
            abut.solve(beam(("z",), [load], ("z",)))
    with pytest.raises(InputError, match=r"lie on both sides of the plane through the reference with the normal z"):
        beam((), [], ("z",))
    with pytest.raises(InputError, match=r"couplings\[0\]\.mirrors: halves need small turns"):
        beam(("z",), [], ("z",), "finite")


ANGLE = 0.5
ALONG = np.array([np.cos(ANGLE), np.sin(ANGLE)])


def test_points_that_follow_along_an_oblique_direction():
    """An oblique bar pulled at its end, which stays free to contract: F L / (E A) along it, -nu times the strain across."""
    nu, force = 0.3, 20.0
    mesh = join({"bar": rectangle((0, 10), (0, 2), (5, 2), "quad4")})
    turn = np.array([ALONG, [-ALONG[1], ALONG[0]]])
    mesh = replace(mesh, points=mesh.points @ turn, node_sets={"corner": np.array([0])})
    axes = abut.Axes(x=tuple(ALONG))
    model = abut.Model(
        mesh,
        [abut.Solid("bar", abut.LinearElastic(1000.0, nu))],
        [abut.Support("bar.left", x=0, axes=axes), abut.Support("corner", y=0, axes=axes)],
        [abut.Force("grip", tuple(force * ALONG))],
        plane="stress",
        couplings=[
            abut.Coupling("grip", "bar.right", reference=tuple(10.0 * turn[0] + turn[1]), follow=("x",), axes=axes)
        ],
        solve=abut.SolveOptions(steps=1),
    )
    step = abut.solve(model).steps[-1]
    strain = force / (1000.0 * 2.0)
    place = mesh.points @ turn.T
    exact = np.column_stack([strain * place[:, 0], -nu * strain * place[:, 1]]) @ turn
    assert np.abs(step.displacement - exact).max() < 1e-9 * np.abs(exact).max()
    held = replace(model, couplings=[replace(model.couplings[0], follow=None, axes=None)])
    assert np.abs(abut.solve(held).steps[-1].displacement - exact).max() > 0.01 * np.abs(exact).max()


def test_points_that_follow_around():
    """The rim of a ring, held around only, widens under pressure in the bore as Lame's: 2 p a^2 b / (E (b^2 - a^2))."""
    inner, outer, pressure = 1.0, 2.0, 10.0
    model = abut.Model(
        join({"ring": ring((inner, outer), cells=(4, 8))}),
        [abut.Solid("ring", STEEL)],
        [abut.Support("ring.start", y=0), abut.Support("ring.end", x=0)],
        [abut.Pressure("ring.inner", pressure)],
        plane="stress",
        couplings=[
            abut.Coupling(
                "rim", "ring.outer", reference=(0.0, 0.0), follow=("y",), axes=abut.Axes("cylindrical"), x=0, y=0, rz=0
            )
        ],
        solve=abut.SolveOptions(steps=1),
    )
    step = abut.solve(model).steps[-1]
    rim = model.mesh.nodes_of("ring.outer")
    widened = 2.0 * pressure * inner**2 * outer / (1000.0 * (outer**2 - inner**2))
    exact = widened * model.mesh.points[rim] / outer
    assert np.abs(step.displacement[rim] - exact).max() < 1e-3 * widened  # quadratic cells, eight over a quarter


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"radius": 1.0}, "radius is the distance from the reference; give reference"),
        ({"radius": 0.0, "reference": (10.0, 0.5)}, "radius: expected a number > 0"),
        (
            {"radius": 0.1, "reference": (12.0, 0.0)},
            r"couplings\[0\]\.radius: no point of 'ends' .*the nearest at 2; give",
        ),
        ({"axes": abut.Axes()}, "axes are those of follow; give follow"),
        ({"axes": abut.Axes(x=(1, 0, 0)), "follow": ("x",)}, r"couplings\[0\]: axes: x: expected 2 numbers, got 3"),
        ({"mirrors": ("y",), "reference": (10.0, 0.0)}, 'mirrors goes with kind = "distributing"'),
        ({"mirrors": ("y",), "kind": "distributing"}, "the reference lies on the planes of symmetry; give reference"),
        ({"mirrors": ("q",), "kind": "distributing", "reference": (10.0, 0.0)}, "mirrors: expected one of x, y, z"),
        (
            {"mirrors": ("y",), "kind": "distributing", "reference": (10.0, 0.0), "rz": 0.0},
            "rz is 0 by the symmetry of mirrors; leave it out",
        ),
        (
            {"mirrors": ("z",), "kind": "distributing", "reference": (10.0, 0.0)},
            r"couplings\[0\]\.mirrors: the model is 2D; leave z out",
        ),
    ],
)
def test_what_is_refused(given, message):
    with pytest.raises(InputError, match=message):
        bars(**given)
