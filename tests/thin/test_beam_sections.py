"""Beams of other sections than the rectangle, in Python and in job files, by closed forms of bending and torsion."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.errors import InputError
from abut.job.load import load_job
from models.gmsh_files import write_msh
from models.thin import CLAMPED, LENGTH, E, solved

RADIUS = 3.0
WALL, SIDE, THIN = 0.5, 6.0, 0.2
INSIDE, WITHIN = RADIUS - WALL, SIDE - 2 * THIN
Y = (0.0, 1.0, 0.0)
SECTIONS = {
    "circle": abut.Beam(direction=Y, radius=RADIUS),
    "pipe": abut.Beam(direction=Y, radius=RADIUS, wall=WALL),
    "box": abut.Beam((SIDE, SIDE), direction=Y, wall=THIN),
}
AREA = {"circle": np.pi * RADIUS**2, "pipe": np.pi * (RADIUS**2 - INSIDE**2), "box": SIDE**2 - WITHIN**2}
INERTIA = {
    "circle": np.pi * RADIUS**4 / 4,
    "pipe": np.pi * (RADIUS**4 - INSIDE**4) / 4,
    "box": (SIDE**4 - WITHIN**4) / 12,
}
TORSION = {"circle": 2 * INERTIA["circle"], "pipe": 2 * INERTIA["pipe"], "box": (SIDE - THIN) ** 3 * THIN}  # Bredt
each = pytest.mark.parametrize("section", SECTIONS)


def line(path: Path, count: int = 10) -> Path:
    """A line along x with groups "rib", "root" and "tip"."""
    points = np.outer(np.linspace(0.0, LENGTH, count + 1), [1.0, 0.0, 0.0])
    cells = np.stack([np.arange(count), np.arange(1, count + 1)], axis=1)
    return write_msh(path, points, {"rib": {"line2": cells}, "root": {"point": [[0]]}, "tip": {"point": [[count]]}})


def moved(
    section: str, tmp_path: Path, loads: tuple[abut.MidForce, ...] = (), held: tuple[abut.MidSupport, ...] = ()
) -> abut.Solution:
    supports = [abut.MidSupport("root", **CLAMPED), *held]
    return solved(abut.thicken(line(tmp_path / "a.msh"), {"rib": SECTIONS[section]}, supports, loads), "rib", "full")


def end(solution: abut.Solution) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean displacement of the last section and its turn, by least squares."""
    points = solution.model.mesh.points
    here = points[:, 0] > LENGTH - 1e-9
    x, u = points[here] - points[here].mean(axis=0), solution.displacement[here]
    spin = np.concatenate([np.cross(np.eye(3), each).T for each in x])  # turn x arm
    return u.mean(axis=0), np.linalg.lstsq(spin, (u - u.mean(axis=0)).ravel(), rcond=None)[0]


@each
def test_cantilever(section: str, tmp_path: Path) -> None:
    """P L^3 / 3 E I both ways; shear adds (r / L)^2, the outline of parabolas takes less than 0.1 % of I."""
    shift, _ = end(moved(section, tmp_path, (abut.MidForce("tip", (0.0, 1.0, 2.0)),)))
    assert shift[1:] == pytest.approx(np.array([1.0, 2.0]) * LENGTH**3 / (3 * E * INERTIA[section]), rel=0.01)


@each
def test_twisted(section: str, tmp_path: Path) -> None:
    """M L / G J, and no shift. The box is thin: formula by Bredt, good to the wall over the side, 3 %."""
    shift, turn = end(moved(section, tmp_path, (abut.MidForce("tip", (0.0, 0.0, 0.0), (50.0, 0.0, 0.0)),)))
    assert turn[0] == pytest.approx(50.0 * LENGTH / (E / 2 * TORSION[section]), rel=0.02 if section == "box" else 0.01)
    assert shift == pytest.approx(0.0, abs=1e-6 * turn[0])


@each
def test_end_turned(section: str, tmp_path: Path) -> None:
    """By an angle, without a force: a parabola. The section stays plane and one at both ends."""
    shift, turn = end(moved(section, tmp_path, held=(abut.MidSupport("tip", ry=0.01),)))
    assert turn[1] == pytest.approx(0.01, rel=1e-6)
    assert shift[2] == pytest.approx(-0.01 * LENGTH / 2, rel=1e-6)


@each
def test_stretched(section: str, tmp_path: Path) -> None:
    """P L / E A; the force comes in at points of the last section, which adds up to a third of the diameter."""
    shift, _ = end(moved(section, tmp_path, (abut.MidForce("tip", (100.0, 0.0, 0.0)),)))
    assert shift[0] == pytest.approx(100.0 * LENGTH / (E * AREA[section]), rel=0.02)


@pytest.mark.parametrize("section", ["pipe", "box"])
def test_faces(section: str, tmp_path: Path) -> None:
    """The volumes that both faces enclose, by the divergence theorem: half the integral of y n_y + z n_z, whose sign on the
    inner one is negative as its normal points into the hollow."""
    mesh = abut.thicken(line(tmp_path / "a.msh"), {"rib": SECTIONS[section]}).mesh
    outside, inside = (_enclosed(mesh, f"rib.{name}") for name in ("side", "inside"))
    area = {"pipe": (np.pi * RADIUS**2, np.pi * INSIDE**2), "box": (SIDE**2, WITHIN**2)}[section]
    assert (outside, inside) == pytest.approx((area[0] * LENGTH, -area[1] * LENGTH), rel=2e-3)  # parabolas: 8e-4


def _enclosed(mesh: abut.Mesh, name: str) -> float:
    from abut.bodies.loads import stress_load

    force = stress_load(mesh.surface(name), np.eye(3)).reshape(-1, 3)  # the integral of N n
    return float((force[:, 1:] * mesh.points[:, 1:]).sum()) / 2.0


JOB = """
schema = 1
mesh = { file = "a.msh", beams.rib = { direction = [0, 1, 0], SECTION } }
materials.steel = { kind = "linear-elastic", young = 210e3, poisson = 0.0 }
solids = [{ body = "rib", material = "steel" }]
supports = [{ on = "root", x = 0, y = 0, z = 0, rx = 0, ry = 0, rz = 0 }]
loads = [{ kind = "nodal-force", on = "tip", value = [0, 0, 1] }]
"""


@pytest.mark.parametrize(
    ("section", "keys"),
    [("circle", "radius = 3"), ("pipe", "radius = 3, wall = 0.5"), ("box", "widths = [6, 6], wall = 0.2")],
)
def test_in_a_job(section: str, keys: str, tmp_path: Path) -> None:
    line(tmp_path / "a.msh")
    (tmp_path / "job.toml").write_text(JOB.replace("SECTION", keys))
    model = load_job(tmp_path / "job.toml").model
    made = abut.thicken(tmp_path / "a.msh", {"rib": SECTIONS[section]})
    assert model.mesh.points == pytest.approx(made.mesh.points)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({}, "give either widths, of a rectangle, or radius, of a circle"),
        ({"widths": (1.0, 2.0), "radius": 1.0}, "give either widths, of a rectangle, or radius, of a circle"),
        ({"radius": 0.0}, "radius: expected a number > 0"),
        ({"radius": 1.0, "wall": 1.0}, "wall: expected less than 1, half the section"),
        ({"widths": (1.0, 2.0), "wall": 0.0}, "wall: expected a number > 0"),
    ],
)
def test_refused(given: dict[str, float], words: str) -> None:
    with pytest.raises(InputError, match=words):
        abut.Beam(**given)  # type: ignore[arg-type]
