"""What supports at nodes of shells and beams hold, in job files' terms and in decks: statics, and plates of the textbook."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.output.forces import table
from models.decks import load, solve, step
from models.gmsh_files import write_msh
from models.thin import CLAMPED, INERTIA, LENGTH, STEEL, THICK, WIDTH, E, solved, strip

Wrench = tuple[list[float], list[float]]


def rows(solution: abut.Solution) -> dict[str, Wrench]:
    """Force and moment of each support in the last step's rows of forces.csv."""
    last = [row for row in csv.DictReader(table(solution).splitlines()) if row["kind"] == "support"]
    last = [row for row in last if int(row["step"]) == solution.steps[-1].number]
    axes = "xyz"
    return {
        row["name"]: ([float(row[f"force_{a}"]) for a in axes], [float(row[f"moment_{a}"]) for a in axes])
        for row in last
    }


def layered(path: Path, layers: Sequence[float], offset: float, held: list[abut.MidSupport]) -> abut.Solution:
    """A strip of layers of one material under a pressure that lifts it."""
    thick = abut.thicken(path, {"strip": abut.Shell(THICK, offset, tuple(layers))}, held)
    solids = [abut.Solid(body, STEEL, integration="reduced") for body in thick.mesh.shells]
    load = [abut.Pressure("strip.sneg", 1e-4)]
    return abut.solve(abut.Model(thick.mesh, solids, thick.supports, load, equations=thick.equations))


@pytest.mark.parametrize("kind", ["quad4", "tri3"])
@pytest.mark.parametrize("offset", [0.0, 0.5])
def test_clamped_strip(kind: str, offset: float, tmp_path: Path) -> None:
    """Force and moment of a clamp balance a pressure and a force at a corner, about the middle of the edge."""
    load = [abut.MidForce("corner", (0.0, 0.0, 0.3))]
    path = strip(tmp_path / "a.msh", kind=kind)
    thick = abut.thicken(path, {"strip": abut.Shell(THICK, offset)}, [abut.MidSupport("left", **CLAMPED)], load)
    solution = solved(thick, "strip", loads=[abut.Pressure("strip.sneg", 1e-4)])
    force, moment = rows(solution)["left"]
    total = 1e-4 * LENGTH * WIDTH
    assert force == pytest.approx([0.0, 0.0, -(total + 0.3)], abs=1e-7)
    bent = total * LENGTH / 2 + 0.3 * LENGTH
    assert moment == pytest.approx([0.3 * WIDTH / 2, bent, 0.0], abs=1e-6 * bent)


@pytest.mark.parametrize("layers", [(), (1.0, 1.0), (1.0, 3.0), (1.0, 2.0, 4.0)], ids=str)
@pytest.mark.parametrize("offset", [0.0, 0.5])
def test_layers_on_ends_that_are_free_to_turn(layers: Sequence[float], offset: float, tmp_path: Path) -> None:
    """However a strip is cut into layers, 5 q L^4 / 384 E I; each end has half of the load, and no moment across."""
    held = [abut.MidSupport("left", x=0, y=0, z=0), abut.MidSupport("right", z=0)]
    solution = layered(strip(tmp_path / "a.msh", 20), layers, offset, held)
    middle = np.abs(solution.model.mesh.points[:, 0] - LENGTH / 2) < 1e-9
    sag = 5e-4 * WIDTH * LENGTH**4 / (384 * E * INERTIA)
    assert solution.displacement[middle][:, 2].mean() == pytest.approx(sag, rel=0.002)
    half = 1e-4 * LENGTH * WIDTH / 2
    for name in ("left", "right"):
        force, moment = rows(solution)[name]
        assert force == pytest.approx([0.0, 0.0, -half], abs=1e-6 * half)
        assert moment == pytest.approx([0.0, 0.0, 0.0], abs=1e-6 * half * LENGTH)


def test_supports_that_share_nodes(tmp_path: Path) -> None:
    """A shell of layers held across by its name, and clamped at one end: the clamp has all of the load, the other what a
    hindered Poisson's ratio of 0 needs, nothing."""
    held = [abut.MidSupport("left", x=0, z=0, ry=0), abut.MidSupport("strip", y=0, rx=0)]
    found = rows(layered(strip(tmp_path / "a.msh"), (1.0, 3.0), 0.0, held))
    total = 1e-4 * LENGTH * WIDTH
    assert list(found) == ["left", "strip"]
    for force, _ in found.values():
        assert force == pytest.approx([0.0, 0.0, -total], abs=1e-6 * total)
    assert found["left"][1] == pytest.approx([0.0, total * LENGTH / 2, 0.0], abs=1e-6 * total * LENGTH)


def line(path: Path, count: int = 10) -> Path:
    points = np.outer(np.linspace(0.0, LENGTH, count + 1), [1.0, 0.0, 0.0])
    cells = np.stack([np.arange(count), np.arange(1, count + 1)], axis=1)
    return write_msh(path, points, {"rib": {"line2": cells}, "root": {"point": [[0]]}, "tip": {"point": [[count]]}})


@pytest.mark.parametrize("turns", [True, False])
def test_beam(turns: bool, tmp_path: Path) -> None:
    """Clamped at its root; or on two supports, the root free to turn but about the beam, which then lift it alike."""
    held = [abut.MidSupport("root", **CLAMPED)]
    if not turns:
        held = [abut.MidSupport("root", x=0, y=0, z=0), abut.MidSupport("tip", y=0, z=0, rx=0)]
    thick = abut.thicken(line(tmp_path / "a.msh"), {"rib": abut.Beam((2.0, 5.0), (0.0, 1.0, 0.0))}, held)
    solution = solved(thick, "rib", "full", loads=[abut.Traction("rib.side", (0.0, 0.0, 0.01))])
    found, total = rows(solution), 0.01 * 2 * (2.0 + 5.0) * LENGTH
    if turns:
        assert found["root"][0] == pytest.approx([0.0, 0.0, -total], abs=1e-6 * total)
        assert found["root"][1] == pytest.approx([0.0, total * LENGTH / 2, 0.0], abs=1e-6 * total * LENGTH)
        return
    for name in ("root", "tip"):
        assert found[name][0] == pytest.approx([0.0, 0.0, -total / 2], abs=1e-6 * total)
        assert found[name][1] == pytest.approx([0.0, 0.0, 0.0], abs=1e-6 * total * LENGTH)


def deck_of(code: str, held: str) -> str:
    """A strip of two by ten shells or a line of beams, 10 long and 1 wide, LEFT and RIGHT its ends."""
    lines = ["*NODE, NSET=ALL"]
    if code.startswith("B"):
        lines += [f"{i + 1}, {i * 1.0}, 0., 0." for i in range(11)] + [f"*ELEMENT, TYPE={code}, ELSET=EALL"]
        lines += [f"{i}, {i}, {i + 1}" for i in range(1, 11)] + ["*NSET, NSET=LEFT\n1\n*NSET, NSET=RIGHT\n11"]
        section = "*BEAM SECTION, ELSET=EALL, MATERIAL=M, SECTION=RECT\n1., .1\n0., 1., 0.\n"
    else:
        lines += [f"{3 * i + j + 1}, {i * 1.0}, {j * 0.5}, 0." for i in range(11) for j in range(3)]
        lines += [f"*ELEMENT, TYPE={code}, ELSET=EALL"]
        first = [3 * i + j + 1 for i in range(10) for j in range(2)]
        lines += [f"{k}, {n}, {n + 3}, {n + 4}, {n + 1}" for k, n in enumerate(first, start=1)]
        lines += ["*NSET, NSET=LEFT\n1, 2, 3\n*NSET, NSET=RIGHT\n31, 32, 33"]
        section = "*SHELL SECTION, ELSET=EALL, MATERIAL=M\n.1\n"
    return "\n".join(lines) + f"\n*BOUNDARY\n{held}\n*MATERIAL, NAME=M\n*ELASTIC\n1.E5, .3\n{section}"


@pytest.mark.parametrize("code", ["S4", "B31"])
def test_cantilever_in_a_deck(code: str, tmp_path: Path) -> None:
    solution = solve(tmp_path, deck_of(code, "LEFT, 1, 6") + step("*CLOAD", "RIGHT, 3, .1", "RIGHT, 2, .2"))
    count = 3 if code == "S4" else 1
    ((force, moment),) = rows(solution).values()
    assert force == pytest.approx([0.0, -0.2 * count, -0.1 * count], abs=1e-6)
    assert moment == pytest.approx([0.0, 1.0 * count, -2.0 * count], abs=1e-5)


@pytest.mark.parametrize(("held", "told"), [("LEFT, 1, 6", True), ("LEFT, 1, 3", False), ("LEFT, XSYMM", False)])
def test_decks_say_that_clamps_keep_the_thickness(held: str, told: bool, tmp_path: Path) -> None:
    notes = load(tmp_path, deck_of("S4", held) + step("*CLOAD", "RIGHT, 3, .1")).notes
    assert any("keep their thickness" in note for note in notes) == told


def test_what_pulls_at_a_held_node_is_its_supports(tmp_path: Path) -> None:
    """RIGHT lifted by its middle node, the others following by equations: the force is that of the end as a whole, and
    what these pass on at the others is none of a support's."""
    text = (
        deck_of("S4", "LEFT, 1, 6\n32, 3, 3, .01")
        + "*EQUATION\n2\n31, 3, 1., 32, 3, -1.\n*EQUATION\n2\n33, 3, 1., 32, 3, -1.\n"
    )
    solution = solve(tmp_path, text + step())
    lifted, clamp = sorted((force[2] for force, _ in rows(solution).values()), reverse=True)
    assert lifted == pytest.approx(3.0 * 1e5 * 0.1**3 / 12 * 0.01 / 10.0**3, rel=0.05)  # P = 3 E I w / L^3
    assert clamp == pytest.approx(-lifted, rel=1e-6)


@pytest.mark.parametrize(("thick", "exact"), [(0.01, 0.01384), (0.1, 0.01600)])
def test_clamped_plate(thick: float, exact: float, tmp_path: Path) -> None:
    """w E t^3 / q a^4 at the centre, Poisson's ratio .3: 12 (1 - .09) .0012653 of a thin plate (Timoshenko), and what
    Mindlin's theory adds (Liew et al. 1993: .0015046 at 1:10), of which one quadratic cell over the thickness, whose shear
    is even, has 5/6. Where the clamp held the thickness, too, it was 4 % too stiff here, in proportion to the cells."""
    count = 12
    x = np.linspace(0.0, 1.0, count + 1)
    points = np.array([(a, b, 0.0) for a in x for b in x])
    i, j = (n.ravel() for n in np.meshgrid(np.arange(count), np.arange(count), indexing="ij"))
    first = i * (count + 1) + j
    cells = np.stack([first, first + count + 1, first + count + 2, first + 1], axis=1)
    edges = np.concatenate([cells[:, [k, (k + 1) % 4]] for k in range(4)])
    rim = edges[(np.abs(points[edges].mean(axis=1)[:, :2] - 0.5).max(axis=1) > 0.5 - 1e-9)]
    path = write_msh(tmp_path / "a.msh", points, {"plate": {"quad4": cells}, "rim": {"line2": rim}})
    made = abut.thicken(path, {"plate": abut.Shell(thick)}, [abut.MidSupport("rim", **CLAMPED)])
    solid = abut.Solid("plate", abut.LinearElastic(1000.0, 0.3), integration="reduced")
    load = abut.Pressure("plate.sneg", 1e-3 * thick**3)
    solution = abut.solve(abut.Model(made.mesh, [solid], made.supports, [load], equations=made.equations))
    centre = np.abs(made.mesh.points[:, :2] - 0.5).max(axis=1) < 1e-9
    assert solution.displacement[centre][:, 2].mean() * 1e6 == pytest.approx(exact, rel=0.012)
    force, _ = rows(solution)["rim"]
    assert force[2] == pytest.approx(-1e-3 * thick**3, rel=1e-6)


def test_supports_of_equations_exist(tmp_path: Path) -> None:
    thick = abut.thicken(strip(tmp_path / "a.msh"), {"strip": abut.Shell(THICK)})
    held = abut.Equation((abut.Term(0, "x", 1.0),), supports=("lft",))
    with pytest.raises(InputError, match=r"equations\[0\].supports: no surface, node set or body named 'lft'.*'left'"):
        abut.Model(thick.mesh, [abut.Solid("strip", STEEL)], equations=[held])
