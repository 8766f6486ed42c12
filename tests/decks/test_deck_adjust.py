"""ADJUST of *CONTACT PAIR: slave nodes are moved on to the master before anything else, without strain. CalculiX 2.20 writes
such coordinates into its results, and solves a deck with ADJUST and one with the moved nodes to the same digits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from models.decks import BRICKS, HELD, PAIR, load, step

CONTACT = BRICKS + PAIR + HELD
DOWN = step("*BOUNDARY", "TOP, 3, 3, -0.01")
SLAVE = (11, 12, 13, 14)  # bottom of the upper brick, on the lower one's top at z = 1


def raised(text: str, heights: dict[int, float]) -> str:
    """A deck with the z of some nodes changed."""
    lines = []
    for line in text.splitlines():
        fields = line.split(",")
        if len(fields) == 4 and fields[0].strip().isdigit() and int(fields[0]) in heights:
            fields[3] = str(heights[int(fields[0])])
        lines.append(",".join(fields))
    return "\n".join(lines) + "\n"


def adjusting(text: str, adjust: str) -> str:
    return text.replace("INTERACTION=I,", f"INTERACTION=I{adjust},")


def z(model: abut.Model) -> list[float]:
    """Of the slave's nodes: nodes 1 to 8 and 11 to 18 are the mesh's points in this order."""
    return model.mesh.points[[n - 3 for n in SLAVE], 2].tolist()


@pytest.mark.parametrize(
    ("adjust", "expected"),
    [
        ("", [0.996, 1.003, 1.02, 1.0]),
        (", ADJUST=0.0", [1.0, 1.003, 1.02, 1.0]),  # an overlap of 0.004 is taken away, however small the zone
        (", ADJUST=0.01", [1.0, 1.0, 1.02, 1.0]),
        (", ADJUST=0.1", [1.0, 1.0, 1.0, 1.0]),
        (", ADJUST=SOME", [0.996, 1.003, 1.0, 1.0]),  # a set: its nodes, and no others, however near they are
    ],
)
def test_nodes_in_the_zone_are_moved_on_to_the_master(adjust: str, expected: list[float], tmp_path: Path) -> None:
    text = raised(CONTACT, {11: 0.996, 12: 1.003, 13: 1.02})
    text = text.replace("*CONTACT PAIR", "*NSET, NSET=SOME\n13,14\n*CONTACT PAIR")
    job = load(tmp_path, adjusting(text, adjust) + DOWN)
    assert z(job.model) == pytest.approx(expected, abs=1e-12)
    assert job.model.contacts[0].adjust == 0.0  # nothing is left between flat faces
    moved = sum(a != b for a, b in zip(expected, [0.996, 1.003, 1.02, 1.0]))
    assert any(f"ADJUST: {moved} nodes of 'SLAVE' were moved on to 'MASTER'" in note for note in job.notes) == (
        moved > 0
    )


@pytest.mark.parametrize("held", ["", "11, 3, 3\n12, 3, 3\n13, 3, 3\n14, 3, 3"])
def test_the_same_as_with_the_nodes_written_where_they_go(held: str, tmp_path: Path) -> None:
    """A facet of which two corners are in the zone, also where its nodes are held along the normal (then the lower brick's
    top meets a wedge that does not move): by the definition of ADJUST."""
    end = step("*BOUNDARY", *(["BOTTOM, 3, 3, 0.01", held] if held else ["TOP, 3, 3, -0.04"]))
    free = CONTACT.replace("BOTTOM, 1, 3", "BOTTOM, 1, 2") if held else CONTACT
    before = raised(free, {12: 1.004, 13: 1.03, 14: 1.03})
    after = raised(free, {12: 1.0, 13: 1.03, 14: 1.03})
    found = []
    for text, adjust in ((before, ", ADJUST=0.005"), (after, "")):
        solution = abut.solve(load(tmp_path, adjusting(text, adjust) + end).model)
        found.append((solution.contacts[0].force[2], solution.displacement))
    assert abs(found[0][0]) > 1e-3
    assert found[0][0] == pytest.approx(found[1][0], rel=1e-9)
    np.testing.assert_allclose(found[0][1], found[1][1], atol=1e-12)


def test_what_lies_under_the_far_side_stays(tmp_path: Path) -> None:
    """The other jaw of a clamp, under the lower brick, looks the same way as that one's top: it is not drawn through it."""
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    jaw = [
        f"{21 + 4 * k + i}, {x},{y},{level}"
        for k, level in enumerate((-1.0, -0.01))
        for i, (x, y) in enumerate(corners)
    ]
    brick = "\n".join(["*NODE, NSET=JAW", *jaw, "*ELEMENT, TYPE=C3D8, ELSET=HIGH", "3, 21,22,23,24,25,26,27,28"])
    text = CONTACT.replace("*ELSET, ELSET=EALL", f"{brick}\n*ELSET, ELSET=EALL")
    text = text.replace("*SURFACE, NAME=SLAVE\n", "*SURFACE, NAME=SLAVE\n3, S2\n") + "*BOUNDARY\nJAW, 1, 3\n"
    job = load(tmp_path, adjusting(text, ", ADJUST=0.001") + DOWN)
    assert sorted(set(job.model.mesh.points[:, 2].tolist())) == [-1.0, -0.01, 0.0, 1.0, 2.0]


def test_round_surfaces_keep_no_gap_between_nodes_moved(tmp_path: Path) -> None:
    """A tube of 24 quadrilaterals in one of 16, .01 apart: chords of 16 lie between cos(pi/16) and 1 from the axis, those
    of 24 whose ends are on them at least cos(pi/24) times as far: what is left between counts as none."""
    lines, elements, number = ["*NODE"], [], 0
    rings = {}
    for name, radii, count in (("IN", (0.5, 0.99), 24), ("OUT", (1.0, 1.5), 16)):
        for k, radius in enumerate(radii):
            for i in range(count):
                number += 1
                rings[name, k, i] = number
                angle = 2.0 * np.pi * i / count
                lines.append(f"{number}, {radius * np.cos(angle):.17g}, {radius * np.sin(angle):.17g}")
    first = 0
    for name, count in (("IN", 24), ("OUT", 16)):
        elements.append(f"*ELEMENT, TYPE=CPE4, ELSET={name}")
        for i in range(count):
            first += 1
            j = (i + 1) % count
            nodes = rings[name, 0, i], rings[name, 1, i], rings[name, 1, j], rings[name, 0, j]
            elements.append(", ".join(map(str, (first, *nodes))))
    rest = """*SURFACE, NAME=SLAVE
IN, S2
*SURFACE, NAME=MASTER
OUT, S4
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET=IN, MATERIAL=M
*SOLID SECTION, ELSET=OUT, MATERIAL=M
*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD
*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE
SLAVE, MASTER
*BOUNDARY
25, 1, 2
41, 1, 2
49, 1, 2
"""
    text = "\n".join([*lines, *elements]) + "\n" + adjusting(rest, ", ADJUST=0.02")
    job = load(tmp_path, text + step("*DLOAD", "IN, P4, 1."))
    on_chords = np.linalg.norm(job.model.mesh.points[24:48], axis=1)
    assert on_chords.max() <= 1.0 + 1e-12
    assert on_chords.min() >= np.cos(np.pi / 16) - 1e-12
    assert 0.0 < job.model.contacts[0].adjust < 1.0 - np.cos(np.pi / 16) * np.cos(np.pi / 24)
