"""Bearing loads and fluids: resultants, moments and largest pressures in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.bodies.bearing import bearing_direction
from abut.errors import InputError
from abut.job.convert import job_table
from abut.mesh import make
from abut.problem.loads import applied_load

RADIUS, WIDTH, FORCE = 5.0, 3.0, 100.0
STEEL = abut.LinearElastic(210e3, 0.3)
NOWHERE = np.empty((0, 2))  # planes of symmetry


def bore(
    angles: tuple[float, float], force: tuple[float, float], cell: str = "quad8", around: int = 24, **more: object
) -> abut.Model:
    """A sector of a ring, loaded at its inner side."""
    mesh = make.join({"lug": make.ring([RADIUS, 10.0], angles, cells=[2, around], cell=cell)})
    return abut.Model(
        mesh,
        [abut.Solid("lug", STEEL)],
        [abut.Support("lug.outer", x=0, y=0)],
        [abut.Force("lug.inner", force, bearing=True)],
        plane="stress",
        **more,
    )


@pytest.mark.parametrize("cell", ["quad4", "quad8", "tri6"])
@pytest.mark.parametrize("turn", [0.0, 30.0])
def test_half_a_bore(cell: str, turn: float) -> None:
    """F on the half that it presses on, no moment about the axis, and the pressure 2 F / (pi r) in the middle."""
    towards = np.array([np.cos(np.deg2rad(turn)), np.sin(np.deg2rad(turn))])
    model = bore((turn - 170, turn + 170), tuple(FORCE * towards), cell)
    forces = applied_load(model)[:, 0].reshape(-1, 2)
    x = model.mesh.points
    assert forces.sum(axis=0) == pytest.approx(FORCE * towards, rel=1e-12, abs=1e-10)
    assert (
        np.abs(x[:, 0] * forces[:, 1] - x[:, 1] * forces[:, 0]).sum() < 0.06 * FORCE * RADIUS
    )  # chords: not quite radial
    assert (x[:, 0] * forces[:, 1] - x[:, 1] * forces[:, 0]).sum() == pytest.approx(0.0, abs=1e-9 * FORCE * RADIUS)
    behind = (x @ towards < -2.0) & (np.hypot(*x.T) < RADIUS + 1e-9)
    assert behind.any()
    assert not forces[behind].any()
    largest = np.linalg.norm(bearing_direction(model.mesh.surface("lug.inner"), FORCE * towards, NOWHERE, ""))
    chords = 340.0 / 24.0
    wide = (np.deg2rad(chords) / 2.0) ** 2 if cell == "quad4" else 1e-3  # area and directions of chords
    assert largest == pytest.approx(2.0 * FORCE / (np.pi * RADIUS), rel=wide)


@pytest.mark.parametrize("cell", ["quad4", "quad8", "tri3"])
def test_a_half_model(cell: str) -> None:
    """Cut along the line of action, with half of the force: loaded as that half of the whole, both sides being alike."""
    whole, force = bore((-170.0, 170.0), (FORCE, 0.0), cell), (0.5 * FORCE, 0.0)
    half = bore((0.0, 170.0), force, cell, around=12)
    with pytest.raises(InputError, match=r"no pressure on 'lug[.]inner' adds up"):
        applied_load(half)  # held nowhere along the cut: a sector of its own
    half = replace(half, supports=[*half.supports, abut.Support("lug.start", y=0)])
    loads, x = (applied_load(model)[:, 0].reshape(-1, 2) for model in (whole, half)), half.mesh.points
    of_whole, of_half = loads
    at = [int(np.argmin(np.linalg.norm(whole.mesh.points - point, axis=1))) for point in x]
    assert whole.mesh.points[at] == pytest.approx(x, abs=1e-9)
    cut = np.abs(x[:, 1]) < 1e-9
    assert of_half[~cut] == pytest.approx(of_whole[at][~cut], rel=1e-9, abs=1e-9 * FORCE)
    assert of_half[cut, 0] == pytest.approx(0.5 * of_whole[at][cut, 0], rel=1e-9, abs=1e-9 * FORCE)
    cap = replace(half, loads=[abut.Force("lug.inner", (0.0, FORCE), bearing=True)])  # off the plane: no half
    assert applied_load(cap)[:, 0].reshape(-1, 2).sum(axis=0) == pytest.approx([0.0, FORCE], abs=1e-9 * FORCE)


def test_a_sector() -> None:
    """Of 60 degrees about the line of action, all of which is pressed: a = M^-1 F with M = r int n n dS over the angle."""
    towards = FORCE * np.array([np.cos(np.deg2rad(32.0)), np.sin(np.deg2rad(32.0))])
    model = bore((0.0, 60.0), (float(towards[0]), float(towards[1])))
    end = np.deg2rad(60.0)
    twice, square = np.sin(2.0 * end) / 2.0, np.sin(end) ** 2
    wanted = np.linalg.solve(RADIUS / 2.0 * np.array([[end + twice, square], [square, end - twice]]), towards)
    assert min(wanted[0], wanted @ [np.cos(end), np.sin(end)]) > 0.0
    assert bearing_direction(model.mesh.surface("lug.inner"), towards, NOWHERE, "") == pytest.approx(wanted, rel=1e-4)
    assert applied_load(model)[:, 0].reshape(-1, 2).sum(axis=0) == pytest.approx(towards, rel=1e-12)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_solved(kinematics: str) -> None:
    """Supports hold it, and the stress across the bore's middle is the pressure there, with the opposite sign."""
    model = bore((-90.0, 90.0), (FORCE, 0.0), kinematics=kinematics)
    step = abut.solve(model).steps[-1]
    assert step.load == pytest.approx([FORCE, 0.0], rel=1e-9, abs=1e-7)
    assert step.reaction == pytest.approx([-FORCE, 0.0], rel=1e-8, abs=1e-6)
    middle = np.argmin(np.linalg.norm(model.mesh.points - [RADIUS, 0.0], axis=1))
    assert step.stress[middle, 0] == pytest.approx(
        -2.0 * FORCE / (np.pi * RADIUS), rel=0.01
    )  # recovered from second order


def test_in_three_dimensions_and_files() -> None:
    """A flat face takes what presses on it, evenly; what draws at it, or goes along it, is refused."""
    mesh = make.join({"block": make.box([0, 2], [0, 2], [0, WIDTH], cells=[2, 2, 2], cell="hex20")})

    def pressed(force: tuple[float, ...], on: str = "block.top") -> abut.Model:
        return abut.Model(
            mesh, [abut.Solid("block", STEEL)], [abut.Support("block.bottom", x=0, y=0, z=0)],
            [abut.Force(on, force, bearing=True)],
        )  # fmt: skip

    even = applied_load(abut.Model(mesh, [abut.Solid("block", STEEL)], [], [abut.Pressure("block.top", 2.5)]))
    assert applied_load(pressed((0.0, 0.0, -10.0))) == pytest.approx(even, abs=1e-12)
    assert job_table(pressed((0.0, 0.0, -10.0)), "m.vtu")["loads"][0]["bearing"] is True
    for force in ((0.0, 0.0, 10.0), (1.0, 0.0, -10.0)):
        with pytest.raises(InputError, match=r"bearing force on 'block.top': no pressure on 'block.top' adds up"):
            applied_load(pressed(force))
    with pytest.raises(InputError, match="bearing: expected true or false"):
        abut.Force("block.top", (0, 0, 1), bearing=1)  # type: ignore[arg-type]


def test_water_on_a_wall() -> None:
    """Half full: rho g h^2 / 2 a width, whose moment about the foot is rho g h^3 / 6."""
    weight, level = 2.0, 3.0
    wall = make.join({"wall": make.rectangle([0, 1], [0, 6], cells=[1, 6], cell="quad8")})
    load = abut.Pressure("wall.left", f"max(0, {weight} * ({level} - y))")
    model = abut.Model(
        wall, [abut.Solid("wall", STEEL)], [abut.Support("wall.bottom", x=0, y=0)], [load], plane="strain"
    )
    forces = applied_load(model)[:, 0].reshape(-1, 2)
    assert forces.sum(axis=0) == pytest.approx([weight * level**2 / 2.0, 0.0], rel=1e-12, abs=1e-12)
    assert (wall.points[:, 1] * forces[:, 0]).sum() == pytest.approx(weight * level**3 / 6.0, rel=1e-12)
