"""Beams of decks, expanded: those of the textbook, and CalculiX's displacements."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.errors import InputError
from models.decks import load, solve, step, write

CCX = shutil.which("ccx")
LENGTH, WIDE, HIGH, E = 10.0, 0.4, 0.25, 1e7  # WIDE along the first direction, y; HIGH along the second, z
SECTION = f"RECT\n{WIDE}, {HIGH}\n0., 1., 0.\n"


def beam(code: str, count: int = 8, section: str = SECTION, nu: float = 0.0, more: str = "", turn: float = 0.0) -> str:
    """Along x from the origin, node 1, to its free end, the last node; turned about z."""
    middles = code.startswith("B32")
    nodes = count * (2 if middles else 1) + 1
    along = np.array([np.cos(turn), np.sin(turn), 0.0])
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{i + 1}, {', '.join(f'{x:.15g}' for x in LENGTH * i / (nodes - 1) * along)}" for i in range(nodes)]
    lines.append(f"*ELEMENT, TYPE={code}, ELSET=EALL")
    reach = 2 if middles else 1
    lines += [f"{k + 1}, {', '.join(str(reach * k + 1 + i) for i in range(reach + 1))}" for k in range(count)]
    lines += [f"*NSET, NSET=END\n{nodes}", f"*BOUNDARY\n1, 1, 6\n*MATERIAL, NAME=M\n*ELASTIC\n{E}, {nu}\n*DENSITY\n1."]
    return "\n".join(lines) + f"\n*BEAM SECTION, ELSET=EALL, MATERIAL=M, SECTION={section}{more}"


def end(solution: abut.Solution) -> NDArray[np.float64]:
    """Mean displacement of the corners of the free end."""
    x = solution.model.mesh.points[:, 0]
    at = np.flatnonzero(x > LENGTH - 1e-9)
    corners = np.abs(solution.model.mesh.points[at, 1:]).min(axis=1) > 1e-9
    return np.asarray(solution.displacement[at[corners]].mean(axis=0))


@pytest.mark.parametrize("code", ["B31", "B31R", "B32", "B32R"])
def test_cantilever(code: str, tmp_path: Path) -> None:
    """P L^3 / 3 E I along both directions of the section, and L / E A along the beam; shear adds (h / L)^2 and less, forces
    at corners of the last section stretch it by a tenth of its width more."""
    solution = solve(tmp_path, beam(code) + step("*CLOAD", "END, 1, 1.", "END, 2, 1.", "END, 3, 1."))
    flat, upright = HIGH * WIDE**3 / 12, WIDE * HIGH**3 / 12
    wanted = [LENGTH / (E * WIDE * HIGH), LENGTH**3 / (3 * E * flat), LENGTH**3 / (3 * E * upright)]
    assert end(solution)[1:] == pytest.approx(wanted[1:], rel=0.01)
    assert end(solution)[0] == pytest.approx(wanted[0], rel=0.02)


def test_in_the_plane(tmp_path: Path) -> None:
    """B21, clamped in the plane alone: nothing holds it across or against spinning but that its nodes stay there."""
    text = beam("B21").replace("1, 1, 6", "1, 1, 2\n1, 6, 6")
    moved = end(solve(tmp_path, text + step("*CLOAD", "END, 2, 1.", "END, 6, 5.")))
    bent = LENGTH**3 / 3 + 5.0 * LENGTH**2 / 2
    assert moved[1] == pytest.approx(bent / (E * HIGH * WIDE**3 / 12), rel=0.01)
    assert moved[2] == pytest.approx(0.0, abs=1e-6 * moved[1])


@pytest.mark.parametrize(
    "given", [("*BOUNDARY", "END, 5, 5, 0.01"), ("*CLOAD", f"END, 5, {0.01 * E * WIDE * HIGH**3 / 12 / LENGTH}")]
)
def test_end_turned(given: tuple[str, str], tmp_path: Path) -> None:
    """By an angle, or the moment E I angle / L: a parabola, to -angle L / 2."""
    solution = solve(tmp_path, beam("B32R") + step(*given))
    assert end(solution)[2] == pytest.approx(-0.01 * LENGTH / 2, rel=2e-3)


@pytest.mark.parametrize("word", ["rectangular", "Rect", "RECTANGLE"])
def test_section_in_any_spelling(word: str, tmp_path: Path) -> None:
    """CalculiX reads the first four letters of the section, in any case."""
    text = beam("B32", section=SECTION.replace("RECT", word))
    assert np.ptp(load(tmp_path, text + step("*CLOAD", "END, 3, 1.")).model.mesh.points, axis=0) == pytest.approx(
        [LENGTH, WIDE, HIGH]
    )


def test_offset_and_gravity(tmp_path: Path) -> None:
    """The section lies beside its nodes; gravity acts on its volume."""
    text = beam("B32", section=SECTION.replace("RECT", "RECT, OFFSET1=0.5"))
    solution = solve(tmp_path, text + step("*DLOAD", "EALL, GRAV, 3., 0., 0., -1."))
    y = solution.model.mesh.points[:, 1]
    assert (y.min(), y.max()) == pytest.approx((-WIDE, 0.0), abs=1e-12)
    x = solution.model.mesh.points[:, 0]
    weight, upright = 3.0 * WIDE * HIGH, WIDE * HIGH**3 / 12
    assert solution.displacement[x > LENGTH - 1e-9, 2].mean() == pytest.approx(
        -weight * LENGTH**4 / (8 * E * upright), rel=0.01
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (
            beam("B32", section="BOX\n.4, .3, .1, .1, .1, .2\n0.,1.,0.\n"),
            "wall: expected a number > 0 and < 0.15, half the section, got 0.2",
        ),
        (
            beam("B32", section="PIPE\n.4, .4\n0.,1.,0.\n"),
            "wall: expected a number > 0 and < 0.4",
        ),
        (
            beam("B32", section="PIPE\n.4, .1\n0.,1.,0.\n") + "*SURFACE, NAME=S\nEALL, S1\n",
            "faces of hollow beams have no numbers; name the element without a face",
        ),
        (beam("B32", section="HEX\n.1\n0.,1.,0.\n"), "SECTION=HEX: RECT, CIRC, PIPE and BOX alone"),
        (beam("B32", section="RECT\n.1, 0.\n0.,1.,0.\n"), "width: expected a number > 0, got 0"),
        (beam("B32", section="RECT\n.1, .1\n1.,0.,0.\n"), "beam 1 has no length, or lies along the first direction"),
        (beam("B32").partition("*BEAM")[0], r"element 1 without \*BEAM SECTION"),
    ],
)
def test_refused(text: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        load(tmp_path, text + step("*CLOAD", "END, 3, 1."))


def test_circle(tmp_path: Path) -> None:
    """One number is the diameter, which a note says, as in Abaqus it is the radius."""
    text = beam("B32R", section="circ\n.4\n0., 1., 0.\n") + step("*CLOAD", "END, 3, 1.")
    job = load(tmp_path, text)
    assert np.linalg.norm(job.model.mesh.points[:, 1:], axis=1) == pytest.approx(0.2)
    assert "SECTION=CIRC of EALL: 0.4 is the diameter, as in CalculiX" in "".join(job.notes)
    assert "B32R of round section: expanded to C3D20, " in "".join(job.notes)
    inertia = np.pi * 0.2**4 / 4
    assert end(solve(tmp_path, text))[2] == pytest.approx(LENGTH**3 / (3 * E * inertia), rel=0.03)  # I is 2.3 % less


@pytest.mark.parametrize("card", ["BEAM SECTION", "BEAM GENERAL SECTION"])
@pytest.mark.parametrize(
    ("section", "area", "inertia"),
    [
        ("PIPE\n.2, .05\n", np.pi * (0.2**2 - 0.15**2), np.pi * (0.2**4 - 0.15**4) / 4),
        ("box\n.4, .25, .05, .05, .05, .05\n", 0.4 * 0.25 - 0.3 * 0.15, (0.4 * 0.25**3 - 0.3 * 0.15**3) / 12),
    ],
)
def test_hollow(section: str, area: float, inertia: float, card: str, tmp_path: Path) -> None:
    """Its weight, on every solid of an element: q L^4 / 8 E I; shear adds a few (h / L)^2."""
    text = beam("B32R", section=section + "0., 1., 0.\n").replace("BEAM SECTION", card)
    solution = solve(tmp_path, text + step("*DLOAD", "EALL, GRAV, 3., 0., 0., -1."))
    x = solution.model.mesh.points[:, 0]
    assert solution.displacement[x > LENGTH - 1e-9, 2].mean() == pytest.approx(
        -3.0 * area * LENGTH**4 / (8 * E * inertia), rel=0.01
    )


WALLS = (0.03, 0.02, 0.06, 0.04)  # at the sides 1, 2, -1, -2 of a box
UNEVEN = "BOX\n.4, .25, .03, .02, .06, .04\n0., 1., 0.\n"


def test_box_with_different_walls(tmp_path: Path) -> None:
    """Pulled at the middle of its outline, beside its centroid: F e L^2 / 2 E I both ways, by the principal axes."""
    right, above, left, below = WALLS
    parts = [  # area, place of its middle along 1 and 2, widths
        (0.4 * 0.25, 0.0, 0.0, 0.4, 0.25),
        (-(0.4 - right - left) * (0.25 - above - below), (left - right) / 2, (below - above) / 2, 0.4 - right - left,
         0.25 - above - below),
    ]  # fmt: skip
    area = sum(a for a, *_ in parts)
    middle = np.array([sum(a * p[k] for a, *p in parts) for k in (0, 1)]) / area
    inertia = sum(
        a * np.array([[p**2 + v**2 / 12, p * q], [p * q, q**2 + w**2 / 12]]) for a, p, q, v, w in parts
    ) - area * np.outer(middle, middle)  # fmt: skip
    text = beam("B32R", section=UNEVEN) + step("*CLOAD", "END, 1, 1.")
    bent = np.linalg.solve(inertia, middle) * LENGTH**2 / (2 * E)
    assert end(solve(tmp_path, text))[1:] == pytest.approx(bent, rel=0.01)


@pytest.mark.skipif(CCX is None, reason="CalculiX is not installed")
@pytest.mark.parametrize("section", [SECTION, SECTION.replace("RECT", "CIRC"), UNEVEN])
@pytest.mark.parametrize("code", ["B32", "B32R"])
def test_as_calculix(code: str, section: str, tmp_path: Path) -> None:
    """Clamped, a force aslant and a moment at its end; a rectangle, an ellipse and a box. CalculiX has other points in a
    B32R that is round, 0.7 % in bending; for a box points in a full section, no walls, 0.35 %, and no B32 of it."""
    if code == "B32" and section == UNEVEN:
        pytest.skip("CalculiX has boxes of B32R alone")
    text = beam(code, nu=0.3, section=section) + step(
        "*CLOAD", "END, 2, 1.", "END, 3, 2.", "END, 5, 3.", "*NODE PRINT, NSET=END", "U"
    )
    path = write(tmp_path, text)
    solution = solve(tmp_path, text)
    subprocess.run(["ccx", "-i", path.stem], cwd=tmp_path, check=True, capture_output=True)
    row = next(r for line in path.with_suffix(".dat").read_text().splitlines() if (r := line.split()) and r[0] == "17")
    wanted = np.array(row[1:4], dtype=float)
    assert end(solution) == pytest.approx(
        wanted, abs=(0.01 if section != SECTION and code == "B32R" else 0.002) * np.abs(wanted).max()
    )


@pytest.mark.parametrize("kind", ["S8", "S4"])
def test_a_beam_on_the_edge_of_a_shell(kind: str, tmp_path: Path) -> None:
    """A strip of shell, and a beam from the middle of its end on, joined by a rigid knot: pulled, L / E A of each, and bent
    upright, P L^3 / 3 E I of both with the beam's end turned by the strip's; a knot holds a section, which stiffens the
    strip by less than its width over its length."""
    length, wide, thick = 10.0, 0.4, 0.25
    nodes = [(x, y) for x in (0.0, 5.0, 10.0) for y in (-wide / 2, 0.0, wide / 2)]
    text = "*NODE\n" + "".join(f"{i + 1}, {x}, {y}, 0.\n" for i, (x, y) in enumerate(nodes))
    if kind == "S8":
        more = [(2.5, -wide / 2), (2.5, 0.0), (2.5, wide / 2), (7.5, -wide / 2), (7.5, 0.0), (7.5, wide / 2)]
        more += [(x, y) for x in (0.0, 5.0, 10.0) for y in (-wide / 4, wide / 4)]
        text += "".join(f"{i + 10}, {x}, {y}, 0.\n" for i, (x, y) in enumerate(more))
        cells = ["1,4,5,2,10,18,11,16", "2,5,6,3,11,19,12,17", "4,7,8,5,13,20,14,18", "5,8,9,6,14,21,15,19"]
    else:
        cells = ["1,4,5,2", "2,5,6,3", "4,7,8,5", "5,8,9,6"]
    text += "*NODE, NSET=END\n40, 20., 0., 0.\n*NODE\n41, 15., 0., 0.\n"
    text += f"*ELEMENT, TYPE={kind}, ELSET=S\n" + "".join(f"{k + 1}, {c}\n" for k, c in enumerate(cells))
    text += "*ELEMENT, TYPE=B32, ELSET=B\n9, 8, 41, 40\n"
    text += f"*NSET, NSET=FOOT\n1, 2, 3{', 16, 17' if kind == 'S8' else ''}\n*BOUNDARY\nFOOT, 1, 6\n"
    text += f"*MATERIAL, NAME=M\n*ELASTIC\n{E}, 0.\n*SHELL SECTION, ELSET=S, MATERIAL=M\n{thick}\n"
    text += f"*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT\n{wide}, {thick}\n0., 1., 0.\n"
    solution = solve(tmp_path, text + step("*CLOAD", "END, 1, 1.", "END, 3, 1."))
    at = solution.model.mesh.points[:, 0] > 20.0 - 1e-9
    found = solution.displacement[at].mean(axis=0)
    inertia = wide * thick**3 / 12.0
    assert found[0] == pytest.approx(2.0 * length / (E * wide * thick), rel=wide / length)
    assert found[2] == pytest.approx((2.0 * length) ** 3 / (3.0 * E * inertia), rel=wide / length)
