"""The certificate's overlap: the deepest penetration at a point, exact for known motions; false results are found out."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.analysis.overlap import overlaps
from abut.diagnosis.advice import remedies
from abut.mesh.make import box, join, rectangle
from abut.output.results import summary
from abut.problem.constraints import supports
from abut.problem.contact_pairs import pair
from abut.report import write_report
from abut.solution import Check
from models.overlap import NU, E, ball_on_block, strip

SIZE = 1.0 / 3.0  # of the contactor's facets in `stacked`


def stacked(cells: tuple[str, str], gap: float = 0.0, plane: str = "strain", **contact: object) -> abut.Model:
    """A unit block, 3 cells wide, under a narrower one, 2 cells wide, that covers 0.2 < x < 0.7."""
    solid = cells[0].startswith("hex")
    if solid:
        parts = {
            "lower": box((0, 1), (0, 1), (0, 1), (3, 3, 1), cells[0]),
            "upper": box((0.2, 0.7), (0.1, 0.8), (1 + gap, 2), (2, 2, 1), cells[1]),
        }
    else:
        parts = {
            "lower": rectangle((0, 1), (0, 1), (3, 1), cells[0]),
            "upper": rectangle((0.2, 0.7), (1 + gap, 2), (2, 1), cells[1]),
        }
    mesh = join(parts)
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(E, NU)) for body in mesh.bodies],
        [abut.Support("lower.bottom", x=0, y=0, z=0 if solid else None)],
        contacts=[abut.Contact(contactor="lower.top", target="upper.bottom", **contact)],
        plane=None if solid else plane,
    )


def depth(model: abut.Model, move: np.ndarray, offset: float = 0.0) -> float:
    """The overlap as a length where ``move`` displaces the upper block, (n_points, dim)."""
    own = pair(model, model.contacts[0], supports(model))
    upper = np.zeros(len(model.mesh.points), dtype=bool)
    upper[model.mesh.nodes_of("upper.bottom")] = True
    return SIZE * float(overlaps(own, np.where(upper[:, None], move, 0.0), offset).max())


CELLS = [("quad4", "tri3"), ("quad8", "quad9"), ("tri6", "quad4"), ("hex8", "hex20"), ("hex20", "tet10")]


@pytest.mark.parametrize("cells", CELLS)
@pytest.mark.parametrize("contact", [{}, {"law": "constraint-function"}, {"method": "node-to-segment"}])
def test_a_tilted_block_sinks_in_at_its_edge(cells: tuple[str, str], contact: dict[str, object]) -> None:
    """The upper block comes down by 0.01 in its middle, x = 0.45, and turns: its edge at x = 0.7 is deepest, by 0.01 + 0.25
    times the slope. The weighted gap is not asked; 1e-8 of the motion counts as rounding."""
    model = stacked(cells, **contact)
    x = model.mesh.points
    move = np.zeros_like(x)
    move[:, -1] = -0.01 - 0.02 * (x[:, 0] - 0.45)
    assert depth(model, move) == pytest.approx(0.01 + 0.02 * 0.25, rel=1e-7)
    move[:, -1] = 0.006 - 0.02 * (x[:, 0] - 0.45)  # opens by 0.001 at least
    assert depth(model, move) == 0.0


@pytest.mark.parametrize("plane", ["strain", "axisymmetric"])
def test_gaps_offsets_and_adjust_count(plane: str) -> None:
    """A block that starts 0.003 above and comes down by 0.01; an interference of 0.002 more; the initial gap taken away."""
    model = stacked(("quad8", "quad4"), gap=0.003, plane=plane)
    move = np.zeros_like(model.mesh.points)
    move[:, 1] = -0.01
    assert depth(model, move) == pytest.approx(0.007, rel=1e-6)
    assert depth(model, move, offset=-0.002) == pytest.approx(0.009, rel=1e-6)
    adjusted = replace(model, contacts=[replace(model.contacts[0], adjust=0.004)])
    assert depth(adjusted, move) == pytest.approx(0.01, rel=1e-6)


def test_ties_have_none() -> None:
    model = stacked(("quad4", "quad4"), kind="tied")
    move = np.zeros_like(model.mesh.points)
    move[:, 1] = -0.1
    assert depth(model, move) == 0.0


def check(solution: abut.Solution) -> Check:
    (found,) = (check for check in solution.certificate if check.name == "overlap")
    return found


def approach(solution: abut.Solution) -> float:
    return -float(solution.displacement[solution.model.mesh.nodes_of("punch.top"), 1].mean())


def test_linear_pressure_on_coarse_quadratic_facets_is_found_out(tmp_path: Path) -> None:
    """Every function of P1 also stands on a row that stays open: the mean gap is closed when the middle row has sunk in by
    ten times what the punch really yields, and all other checks pass. P2 has functions on the middle row alone. (What abut
    chooses is 10 to 12 % off on three and on five rows.)"""
    fine = approach(abut.solve(strip(24)))
    sound, false = abut.solve(strip()), abut.solve(strip(pressure="P1"))
    assert approach(sound) == pytest.approx(fine, rel=0.15)
    assert check(sound).passed
    assert approach(false) > 10.0 * fine
    assert check(false).value > 10.0
    written = summary(false)
    assert not written["certificate"]["passed"]
    assert written["remedies"][0].startswith("contact 'punch.bottom-plate.top': pressure = \"auto\"")
    assert summary(sound)["remedies"] == []
    for solution, said in ((false, True), (sound, False)):
        text = write_report(solution, tmp_path / "report.html").read_text(encoding="utf-8")
        assert ("<h2>Contact is narrow for its facets</h2>" in text) is said


def test_the_verdict_does_not_depend_on_load_or_units() -> None:
    """Without initial gaps that close, contact is linear: half the load, or another unit of length, is the same value."""
    value = check(abut.solve(stacked_and_pressed(1.0, 1.0))).value
    assert 1e-3 < value < 0.5
    for load, unit in ((0.01, 1.0), (1.0, 1e3)):
        assert check(abut.solve(stacked_and_pressed(load, unit))).value == pytest.approx(value, rel=1e-4)


def stacked_and_pressed(load: float, unit: float) -> abut.Model:
    model = stacked(("quad8", "quad9"))
    mesh = replace(model.mesh, points=unit * model.mesh.points)
    down = abut.Support("upper.top", x=0, y=-1e-4 * load * unit)
    return replace(model, mesh=mesh, supports=[*model.supports, down])


def test_contact_narrower_than_a_facet() -> None:
    """Carried by a block with facets of 0.22, the contact, 0.08 wide, hides in the mean over them: its pressure is a fifth
    of what a mesh four times as fine finds. Carried by the ball, whose facets are finer where it touches, it is seen."""
    sides = "ball.round", "block.top"
    fine = abut.solve(ball_on_block(*sides, 16)).contacts[0].max_pressure
    sound, false = abut.solve(ball_on_block(*sides, 4)), abut.solve(ball_on_block(*sides[::-1], 4))
    assert sound.contacts[0].max_pressure == pytest.approx(fine, rel=0.4)
    assert check(sound).passed
    assert false.contacts[0].max_pressure < 0.2 * fine
    assert not check(false).passed
    assert "refine" in remedies(false)[0].action


def test_penetration_without_any_pressure_fails() -> None:
    """A facet whose mean gap stays open carries nothing, though its edge has sunk in."""
    model = stacked(("quad4", "quad4"), gap=0.01)
    top = abut.Support("upper.top", x=0, y=lambda at: -0.012 * (at[:, 0] > 0.69))
    bottom = abut.Support("upper.bottom", y=lambda at: -0.012 * (at[:, 0] > 0.69))
    solution = abut.solve(replace(model, supports=[*model.supports, top, bottom]))
    assert solution.contacts[0].max_pressure == 0.0
    assert check(solution).value > 1e6
