"""*SHELL SECTION, COMPOSITE in decks, against classical laminate theory, Timoshenko's bimetal strip and CalculiX."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.job.load import load_job

LENGTH, PLY = 100.0, 0.1
E1, E2, NU, G, G23 = 140e3, 10e3, 0.3, 5e3, 3.4e3  # carbon and epoxy, N and mm
CARBON = f"*MATERIAL, NAME=CF\n*ELASTIC, TYPE=ENGINEERING CONSTANTS\n{E1}, {E2}, {E2}, {NU}, {NU}, .45, {G}, {G}\n{G23}"


def name(angle: float) -> str:
    return f"O{angle:g}".replace("-", "M")


def plies(angles: Sequence[float]) -> tuple[str, str]:
    """Materials with orientations, and the section, of layers from the negative side."""
    axes = []
    for angle in sorted(set(angles)):
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        axes.append(f"*ORIENTATION, NAME={name(angle)}\n{c:.12f}, {s:.12f}, 0., {-s:.12f}, {c:.12f}, 0.")
    layers = [f"{PLY}, , CF, {name(angle)}" for angle in angles]
    return "\n".join([CARBON, *axes]), "\n".join(["*SHELL SECTION, ELSET=EALL, COMPOSITE", *layers])


def plate(cells: tuple[int, int], width: float, made: tuple[str, str], held: str, load: str) -> str:
    """Of S8R in the plane z = 0, with a load at the edge x = LENGTH as {edge}, 1/6, 2/3 and 1/6 of it at its nodes."""
    nx, ny = cells
    places = [(i, j) for i in range(2 * nx + 1) for j in range(2 * ny + 1) if not (i % 2 and j % 2)]
    number = {place: k for k, place in enumerate(places, start=1)}
    nodes = [f"{k}, {LENGTH * i / (2 * nx):.9g}, {width * j / (2 * ny):.9g}, 0." for (i, j), k in number.items()]
    around = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1)]
    rows = [[number[2 * i + a, 2 * j + b] for a, b in around] for i in range(nx) for j in range(ny)]
    edge = [f"{number[2 * nx, j]}, {{}}".format(f"5, {width * w}") for j, w in enumerate((1 / 6, 2 / 3, 1 / 6))]
    materials, section = made
    return "\n".join(
        [
            "*NODE, NSET=NALL", *nodes, "*ELEMENT, TYPE=S8R, ELSET=EALL",
            *(f"{k}, " + ", ".join(map(str, row)) for k, row in enumerate(rows, start=1)), "*NSET, NSET=ROOT",
            ",\n".join(str(k) for (i, _), k in number.items() if not i), materials, section, "*BOUNDARY", "ROOT, 1, 6", held,
            "*STEP\n*STATIC", load.replace("{edge}", "\n".join(edge)), "*NODE PRINT, NSET=NALL\nU\n*END STEP", "",
        ]
    )  # fmt: skip


def solution(folder: Path, text: str) -> abut.Solution:
    path = folder / "deck.inp"
    path.write_text(text, encoding="utf-8")
    return abut.solve(load_job(path).model)


def bending_stiffness(angles: Sequence[float]) -> float:
    """D11 of classical laminate theory: sum of Q11 (z1^3 - z0^3) / 3, by rotation of each layer's plane stress stiffness."""
    whole = E1 / (1.0 - NU**2 * E2 / E1)
    z = PLY * (np.arange(len(angles) + 1) - len(angles) / 2.0)
    c, s = np.cos(np.radians(angles)), np.sin(np.radians(angles))
    q = whole * (c**4 + E2 / E1 * s**4) + 2.0 * (NU * whole * E2 / E1 + 2.0 * G) * c**2 * s**2
    return float((q * (z[1:] ** 3 - z[:-1] ** 3)).sum() / 3.0)


@pytest.mark.parametrize(
    ("angles", "tolerance"), [((0, 90, 0), 5e-4), ((90, 0, 90), 2e-3), ((45, -45, -45, 45), 8e-3)], ids=str
)
def test_cylindrical_bending(angles: tuple[float, ...], tolerance: float, tmp_path: Path) -> None:
    """w = M L^2 / (2 D11) where nothing moves or turns across: of a soft outer layer 1/1000 less by the clamp, of angles a
    little more, as free edges relax the twisting moment over some half thickness each, h / W = 0.04 together."""
    text = plate((10, 1), 10.0, plies(angles), "NALL, 2, 2\nNALL, 4, 4", "*CLOAD\n{edge}")
    deflection = np.abs(solution(tmp_path, text).displacement[:, 2]).max()
    assert deflection == pytest.approx(LENGTH**2 / (2.0 * bending_stiffness(angles)), rel=tolerance)


def bimetal(layers: str = "1., , A\n.5, , B") -> str:
    metals = [
        f"*MATERIAL, NAME={name}\n*ELASTIC\n{young}, 0.\n*EXPANSION\n{alpha}"
        for name, young, alpha in (("A", 210e3, 1.2e-5), ("B", 70e3, 2.4e-5))
    ]
    section = f"*SHELL SECTION, ELSET=EALL, COMPOSITE\n{layers}"
    cold = "*INITIAL CONDITIONS, TYPE=TEMPERATURE\nNALL, 0."
    return plate((10, 1), 5.0, ("\n".join([*metals, cold]), section), "NALL, 2, 2", "*TEMPERATURE\nNALL, 100.")


def test_bimetal_strip(tmp_path: Path) -> None:
    """Timoshenko (1925), m and n the ratios of thickness and modulus; the clamp squeezes what swells through the thickness,
    a thickness of the length, 1.5 %, at most. The side that expands more is the outer one."""
    z = solution(tmp_path, bimetal()).displacement[:, 2]
    m, n = 2.0, 3.0
    curvature = (
        6.0 * 1.2e-5 * 100.0 * (1.0 + m) ** 2 / (1.5 * (3.0 * (1.0 + m) ** 2 + (1.0 + m * n) * (m**2 + 1.0 / (m * n))))
    )
    assert z.min() == pytest.approx(-curvature * LENGTH**2 / 2.0, rel=5e-3)


def test_layers_of_one_material_are_one(tmp_path: Path) -> None:
    """Stretched evenly, where a finer mesh changes nothing; by gravity on all layers."""
    plain = "*MATERIAL, NAME=A\n*ELASTIC\n1000., 0.\n*DENSITY\n2."
    pull = "*DLOAD\nEALL, GRAV, 3., 1., 0., 0."
    one, three = (
        solution(tmp_path, plate((4, 1), 10.0, (plain, f"*SHELL SECTION, ELSET=EALL, {section}"), "NALL, 2, 2", pull))
        for section in ("MATERIAL=A\n.6", "COMPOSITE\n.1, , A\n.2, , A\n.3, , A")
    )
    far = [np.abs(found.displacement[:, 0]).max() for found in (one, three)]
    np.testing.assert_allclose(far, 2.0 * 3.0 * LENGTH**2 / 2.0 / 1000.0, rtol=1e-6)
    assert set(three.model.mesh.bodies) == {"EALL-layer1", "EALL-layer2", "EALL-layer3"}


def test_faces_are_those_of_the_outer_layers(tmp_path: Path) -> None:
    """A pressure from the negative side (P) bends as one from the positive side (SPOS) does, the other way."""
    text = plate((4, 1), 10.0, plies((0, 90, 0)), "ROOT, 1, 6", "*DLOAD\nEALL, P, .001")
    below = solution(tmp_path, text)
    surface = "*SURFACE, NAME=OVER\nEALL, SPOS\n*STEP"
    text = text.replace("*DLOAD\nEALL, P, .001", "*DSLOAD\nOVER, P, .001").replace("*STEP", surface)
    above = solution(tmp_path, text)
    mesh = above.model.mesh
    (loaded,) = [np.unique(mesh.surfaces[load.on][:, 0]) for load in above.model.loads]
    np.testing.assert_array_equal(loaded, mesh.bodies["EALL-layer3"])
    np.testing.assert_allclose(above.displacement[:, 2].min(), -below.displacement[:, 2].max(), rtol=1e-3)


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX is not installed")
@pytest.mark.parametrize("angles", [(0, 90, 0), (90, 0, 90), (45, -45, -45, 45), (30, -30, 30)], ids=str)
def test_plates_under_pressure_beside_calculix(angles: tuple[float, ...], tmp_path: Path) -> None:
    """A clamped plate at every node, of 16 x 4 elements: within 1 % of the largest displacement, as CalculiX has one solid
    for all layers, which is stiffer at the clamp."""
    text = plate((16, 4), 50.0, plies(angles), "ROOT, 1, 6", "*DLOAD\nEALL, P, .001")
    found = solution(tmp_path, text)
    subprocess.run(["ccx", "deck"], cwd=tmp_path, check=True, capture_output=True, timeout=60)
    rows = re.findall(r"^ +(\d+) +(\S+) +(\S+) +(\S+) *$", (tmp_path / "deck.dat").read_text(), re.MULTILINE)
    theirs = np.array([[float(x) for x in row[1:]] for row in rows])
    nodes = re.findall(r"^(\d+), (\S+), (\S+), 0\.$", text, re.MULTILINE)
    points, half = found.model.mesh.points, PLY * len(angles) / 2.0
    ours = []
    for (_, x, y), row in zip(nodes, rows):
        assert _ == row[0]
        sides = [[float(x), float(y), z] for z in (-half, half)]
        ours.append(np.mean([found.displacement[((points - at) ** 2).sum(axis=1).argmin()] for at in sides], axis=0))
    assert np.linalg.norm(np.array(ours) - theirs, axis=1).max() <= 0.01 * np.linalg.norm(theirs, axis=1).max()


@pytest.mark.parametrize(
    ("layers", "words"),
    [
        ("1., , A\n-.5, , B", "thickness of the layer: expected a number > 0"),
        ("1., , A\n.5", "has no material"),
        ("1., , C", "no material named 'C'"),
        ("1., , A, 45.", "an angle is not supported"),
    ],
)
def test_refused(layers: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        solution(tmp_path, bimetal(layers))
