"""NLGEOM in decks: what becomes of it, and two decks whose displacements are those of CalculiX."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.job.load import load_job
from models.decks import BRICKS as TWO_BRICKS
from models.decks import HELD, PAIR, PUSH, load, step, write

DECK = TWO_BRICKS + PAIR + HELD + PUSH
LARGE = DECK.replace("*STEP", "*STEP, NLGEOM")
CCX = shutil.which("ccx")
SAME = 1e-5  # of the largest displacement: CalculiX prints seven digits, and iterates to about that
BRICKS = 4
RUBBER, STEEL = "*HYPERELASTIC, NEO HOOKE\n100., 1.E-3", "*ELASTIC\n1000., 0.3"


def beam(material: str, load: str) -> str:
    """A bar of C3D20, 4 x 1 x 1, held at x = 0, with faces of all elements by name."""
    number: dict[tuple[int, int, int], int] = {}
    elements = []
    corners = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
    edges = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    own = [np.array(c) for c in corners]
    own += [(own[a] + own[b]) // 2 for a, b in edges]
    for i in range(BRICKS):
        nodes = [number.setdefault(tuple(int(v) for v in c + np.array([2 * i, 0, 0])), len(number) + 1) for c in own]
        elements.append(f"{i + 1}, " + ", ".join(map(str, nodes[:10])) + ",\n" + ", ".join(map(str, nodes[10:])))
    nodes = "\n".join(f"{n}, {x / 2}, {y / 2}, {z / 2}" for (x, y, z), n in number.items())
    foot = "\n".join(f"{n}," for (x, _, _), n in number.items() if x == 0)
    return "\n".join(
        ["*NODE, NSET=ALL", nodes, "*ELEMENT, TYPE=C3D20, ELSET=E", *elements, "*NSET, NSET=FOOT", foot,
         "*MATERIAL, NAME=M", material, "*SOLID SECTION, ELSET=E, MATERIAL=M", "*BOUNDARY", "FOOT, 1, 3",
         "*STEP, NLGEOM, INC=200", "*STATIC", "0.25, 1.", "*CONTROLS, PARAMETERS=FIELD", "1.E-8, 1.E-7", load,
         "*NODE PRINT, NSET=ALL", "U", "*END STEP"]
    )  # fmt: skip


def by_calculix(folder: Path) -> np.ndarray:
    """Displacements (n, 3) at the end, by number of the node."""
    subprocess.run([str(CCX), "deck"], cwd=folder, check=True, capture_output=True, timeout=120)
    text = (folder / "deck.dat").read_text().rpartition("displacements")[2].splitlines()[1:]
    table = np.array([[float(v) for v in line.split()] for line in text if line.strip()])
    return np.asarray(table[np.argsort(table[:, 0]), 1:])


@pytest.mark.skipif(CCX is None, reason="CalculiX is not installed")
@pytest.mark.parametrize(
    ("material", "load"),
    [
        pytest.param(STEEL, "*DLOAD\nE, P1, 1.5", id="pressure that follows"),
        pytest.param(RUBBER, "*BOUNDARY\nTIP, 1, 1, 2.\nTIP, 2, 2, 1.", id="neo-Hooke drawn out by half"),
    ],
)
def test_displacements_are_those_of_calculix(material: str, load: str, tmp_path: Path) -> None:
    text = beam(material, load)
    if "TIP" in load:
        tip = [
            line.split(",")[0] for line in text.splitlines() if line.count(",") == 3 and f", {float(BRICKS)}," in line
        ]
        text = text.replace("*MATERIAL", "*NSET, NSET=TIP\n" + "\n".join(f"{n}," for n in tip) + "\n*MATERIAL", 1)
    (tmp_path / "deck.inp").write_text(text)
    solution = abut.solve(load_job(tmp_path / "deck.inp").model)
    assert solution.converged
    expected = by_calculix(tmp_path)
    assert np.abs(expected).max() > 0.5  # half the height of the bar: not small
    assert np.abs(solution.displacement - expected).max() < SAME * np.abs(expected).max()


def test_a_pressure_follows_the_surface(tmp_path: Path) -> None:
    job = load(tmp_path, LARGE)
    assert job.model.finite
    pressures = [own for own in job.model.loads if isinstance(own, abut.Pressure)]
    assert all(own.follows for own in pressures)


@pytest.mark.parametrize(
    ("static", "steps", "times"),
    [
        ("*STATIC\n0.1, 2.", "auto", None),
        ("*STATIC\n0.1, 2., 1.E-5, 0.5", 4, None),
        ("*STATIC", "auto", (1.0,)),
        ("*STATIC\n2., 2.", "auto", (1.0,)),
        ("*STATIC, DIRECT\n0.6, 2.", "auto", (0.3, 0.6, 0.9, 1.0)),
    ],
)
def test_increments_become_load_steps(tmp_path: Path, static: str, steps: object, times: object) -> None:
    solve = load(tmp_path, LARGE.replace("*STATIC", static)).model.solve
    assert (solve.steps, solve.times) == (steps, times if times is None else pytest.approx(times))


def test_ends_of_steps_are_met(tmp_path: Path) -> None:
    """Where the load turns the end is met anyway; where it goes straight on it is among the times."""
    first = LARGE.replace("*STATIC", "*STATIC\n0.1, 1.")
    still = load(tmp_path, first + step(card="*STATIC\n0.1, 1.")).model  # the load stays: it turns at the end of step 1
    assert still.loads[0].amplitude is not None
    assert (still.solve.steps, still.solve.times) == ("auto", None)
    straight = load(tmp_path, first + step("*DLOAD", "2, P2, 20.", card="*STATIC\n0.1, 1.")).model
    assert straight.loads[0].amplitude is None
    assert straight.solve.times == pytest.approx(np.arange(1, 21) / 20.0)  # tenths of both steps


@pytest.mark.parametrize(
    ("card", "material"),
    [
        ("MOONEY-RIVLIN\n3., 1., 0.01", abut.MooneyRivlin(200.0, 2.0, 1e-3, c10=3.0, c01=1.0)),
        ("POLYNOMIAL, N=1\n3., 1., 0.01", abut.MooneyRivlin(200.0, 2.0, 1e-3, c10=3.0, c01=1.0)),
        ("YEOH\n3., -.1, .2, 0.01", abut.Yeoh([100.0, 0.0, 0.0], 2.0, 1e-3, c10=3.0, c20=-0.1, c30=0.2)),
        ("REDUCED POLYNOMIAL, N=2\n3., -.1, 0.01, .02", abut.Yeoh([100.0, 50.0], 2.0, 1e-3, c10=3.0, c20=-0.1)),
        ("OGDEN, N=2\n3., 2., -1., -2., 0.01", abut.Ogden([100.0, 0.0], 2.0, 1e-3, terms=[(3.0, 2.0), (1.0, -2.0)])),
        ("ARRUDA-BOYCE\n3., 2.8, 0.01", abut.ArrudaBoyce(200.0, 2.0, 1e-3, shear=3.0, locking=2.8)),
    ],
)
def test_kinds_of_rubber(tmp_path: Path, card: str, material: object) -> None:
    """K = 2 / D1; Ogden's mu of decks is half of mu alpha in abut's form."""
    text = LARGE.replace("*ELASTIC\n1000., 0.", f"*HYPERELASTIC, {card}")
    assert load(tmp_path, text).model.solids[0].material == material


def test_notes_say_what_is_otherwise(tmp_path: Path) -> None:
    notes = load(tmp_path, LARGE.replace("*STATIC", "*STATIC, DIRECT\n0.5, 1.")).notes
    assert any("DIRECT: an increment that does not converge is halved" in note for note in notes)
    assert not any("automatic increments" in note for note in notes)


@pytest.mark.parametrize(("first", "second"), [("", ", NLGEOM"), (", NLGEOM", ", NLGEOM=NO")])
def test_steps_that_are_not_alike(first: str, second: str, tmp_path: Path) -> None:
    """CalculiX solves the one step with small displacements, the other with large ones."""
    text = DECK.replace("*STEP", f"*STEP{first}") + step(card="*STATIC").replace("*STEP", f"*STEP{second}")
    with pytest.raises(InputError, match=r"write \*STEP, NLGEOM in step \d too.* to solve without it: --ignore NLGEOM"):
        load(tmp_path, text)
    assert load(tmp_path, text, "NLGEOM").model.kinematics == "small"


def test_nlgeom_holds_until_it_is_revoked(tmp_path: Path) -> None:
    """CalculiX 2.20 gives the same digits with and without it in the second step."""
    job = load(tmp_path, LARGE + step(card="*STATIC"))
    assert job.model.kinematics == "finite"
    assert not any("NLGEOM holds" in note for note in job.notes)


def test_rubber(tmp_path: Path) -> None:
    """mu = 2 C10, K = 2 / D1."""
    text = LARGE.replace("*ELASTIC\n1000., 0.", "*HYPERELASTIC, NEO HOOKE\n3., 0.01")
    material = load(tmp_path, text).model.solids[0].material
    assert material == abut.NeoHooke(shear=6.0, bulk=200.0, volumetric="isochoric", density=2.0, expansion=1e-3)
    refused = {
        "needs large strains; write \\*STEP, NLGEOM": text.replace(", NLGEOM", ""),
        "this kind of rubber elasticity is not supported": text.replace("NEO HOOKE", "VAN DER WAALS"),
        "POLYNOMIAL is supported with N=1 only": text.replace("NEO HOOKE", "POLYNOMIAL, N=2"),
        "the kind is missing": text.replace(", NEO HOOKE", ""),
        "D1: expected a number > 0": text.replace("3., 0.01", "3., -1."),
        "C10: expected a number > 0": text.replace("3., 0.01", "-3., 0.01"),
        "has \\*ELASTIC as well": text.replace("*HYPERELASTIC", "*ELASTIC\n1., 0.\n*HYPERELASTIC"),
    }
    for words, own in refused.items():
        with pytest.raises(InputError, match=words):
            load(tmp_path, own)


def test_rubber_of_which_nothing_is_said_in_volume(tmp_path: Path) -> None:
    """Poisson's ratio .475, about: K = 20 mu, as CalculiX's manual has it; a note says so."""
    text = LARGE.replace("*ELASTIC\n1000., 0.", "*HYPERELASTIC, NEO HOOKE\n3., 0.")
    job = load(tmp_path, text)
    assert job.model.solids[0].material.bulk == pytest.approx(20.0 * 6.0, rel=1e-12)
    assert any("D1 = 0 is taken as" in note for note in job.notes)


@pytest.mark.parametrize(
    ("gap", "adjust", "clearance", "left"),
    [
        (0.004, ", ADJUST=0.01", "", 0.0),
        (0.004, ", ADJUST=0.001", "", 0.004),
        (-0.004, ", ADJUST=CLOSE", "", 0.0),
        (0.004, "", "*CLEARANCE, SLAVE=SLAVE, MASTER=MASTER, VALUE=0.002\n", 0.002),
    ],
)
def test_gaps_adjusted(gap: float, adjust: str, clearance: str, left: float, tmp_path: Path) -> None:
    """The upper brick comes down by 0.01: the lower one, 1 high, and it, 1 - gap high, are two springs in a row, which Saint
    Venant and Kirchhoff's law makes softer by 3/2 of their strain of half a hundredth."""
    lines = []
    for line in LARGE.splitlines():
        fields = line.split(",")
        if fields[0] in ("11", "12", "13", "14") and len(fields) == 4:
            fields[3] = str(1.0 + gap)
        lines.append(",".join(fields))
    text = "\n".join(lines).replace("*DLOAD\n2, P2, 10.", "*BOUNDARY\nTOP, 3, 3, -0.01") + "\n"
    text = text.replace("*CONTACT PAIR,", f"*NSET, NSET=CLOSE\n11,12,13,14\n{clearance}*CONTACT PAIR{adjust},")
    solution = abut.solve(load(tmp_path, text).model)
    assert solution.converged
    force = solution.contacts[0].force[2]
    assert force == pytest.approx((0.01 - left) * 1000.0 / (2.0 - gap), rel=0.01)


def test_a_converted_deck_keeps_what_nlgeom_means(tmp_path: Path) -> None:
    from abut.cli import main

    deck = write(tmp_path, LARGE.replace("*ELASTIC\n1000., 0.", "*HYPERELASTIC, NEO HOOKE\n3., 0.01"))
    assert main(["convert", str(deck), str(tmp_path / "job.toml"), "--quiet"]) == 0
    again, first = load_job(tmp_path / "job.toml").model, load_job(deck).model
    assert (again.kinematics, again.solve) == (first.kinematics, first.solve)
    assert again.solids[0].material == first.solids[0].material


def test_level_faces(tmp_path: Path) -> None:
    """Equations hold all nodes of both surfaces level, so that of their four pressures only the sum is known: small loads
    give what small displacements do."""
    level = "".join(
        f"*EQUATION\n2\n{n}, 3, 1., {first}, 3, -1.\n" for first in (5, 11) for n in range(first + 1, first + 4)
    )
    text = LARGE.replace("*STEP", level + "*STEP")
    large, small = (abut.solve(load(tmp_path, text, *ignored).model) for ignored in ((), ("NLGEOM",)))
    assert large.converged
    assert large.contacts[0].force == pytest.approx(small.contacts[0].force, rel=1e-2)
    assert np.abs(large.displacement - small.displacement).max() < 0.05 * np.abs(small.displacement).max()


def test_a_step_that_cannot_begin_says_why(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: object) -> None:
        raise abut.errors.SingularModelError("the direct solver failed (for the test)")

    monkeypatch.setattr("abut.nonlinear.semismooth.advance", fails)
    with pytest.raises(
        abut.errors.ConvergenceError, match="step 1 cannot be begun, however short: the direct solver failed"
    ):
        abut.solve(load(tmp_path, LARGE).model)


@pytest.mark.parametrize(("deck", "says"), [(LARGE, "a drag of its own"), (DECK, "no effect without NLGEOM")])
def test_stabilize(tmp_path: Path, deck: str, says: str) -> None:
    """Is left out, with a note: solutions are those of the deck without it."""
    told = deck.replace("*STATIC", "*STATIC, STABILIZE=2.E-4, ALLSDTOL=0.05")
    job = load(tmp_path, told)
    assert job.model.solve == load(tmp_path, deck).model.solve
    assert any(says in note for note in job.notes)
