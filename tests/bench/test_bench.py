"""The benchmark harness: cases, input written for other codes, limits of a run, tables. Needs none of the other codes."""

from __future__ import annotations

import itertools
import json
import os
import re
import sys
from pathlib import Path

import numpy as np
import pytest

from abut.cells import CELLS

BENCH = Path(__file__).parents[2] / "bench" / "contact"
sys.path.insert(0, str(BENCH))

import calculix  # noqa: E402
import cases  # noqa: E402
import codes  # noqa: E402
import kratos  # noqa: E402
import process  # noqa: E402
import report  # noqa: E402
import run  # noqa: E402

# Faces and edges of CalculiX's elements, from 1, as its manual numbers them.
HEX_FACES = ((1, 2, 3, 4), (5, 8, 7, 6), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 8, 4), (4, 8, 5, 1))
TET_FACES = ((1, 2, 3), (1, 4, 2), (2, 4, 3), (3, 4, 1))
BOTTOM, TOP, UP = ((1, 2), (2, 3), (3, 4), (4, 1)), ((5, 6), (6, 7), (7, 8), (8, 5)), ((1, 5), (2, 6), (3, 7), (4, 8))
EDGES = {"hex8": (), "hex20": BOTTOM + TOP + UP, "tet10": ((1, 2), (2, 3), (3, 1), (1, 4), (2, 4), (3, 4))}
KRATOS_EDGES = {**EDGES, "hex20": BOTTOM + UP + TOP}
NAMES = [f"{geometry}-{cell}" for geometry in cases.GEOMETRIES for cell in cases.CELLS]
QUICK = [name for name in NAMES if name not in [f"{ball}-tet10" for ball in cases.BALLS]]  # whose smallest is large
ZERO = 1e-9 * cases.SIDE


def small(name: str):
    """The case with few cells."""
    geometry, cell = name.split("-")
    return cases.GEOMETRIES[geometry](2 if geometry in cases.BALLS else 4, cell)


def middles(points: dict[int, np.ndarray], nodes: list[int], corners: int, edges) -> bool:
    """Whether nodes after the corners lie in the middle of the edges, as far as the edges are straight."""
    ends = np.array([[points[nodes[a - 1]], points[nodes[b - 1]]] for a, b in edges]).reshape(-1, 2, 3)
    own = np.array([points[n] for n in nodes[corners:]]).reshape(-1, 3)
    length = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    return bool((np.linalg.norm(own - ends.mean(axis=1), axis=1) <= 0.2 * length).all())


def area_vector(points: np.ndarray) -> np.ndarray:
    """Area times normal of a face given by its corners in order."""
    return sum(0.5 * np.cross(points[i] - points[0], points[i + 1] - points[0]) for i in range(1, len(points) - 1))


def blocks(text: str) -> dict[str, list[list[str]]]:
    """A deck as {card: rows}; rows that end with a comma go on."""
    result: dict[str, list[list[str]]] = {}
    rows: list[list[str]] = []
    for line in text.splitlines():
        if line.startswith("*"):
            rows = result.setdefault(line, [])
        else:
            words = [word.strip() for word in line.split(",") if word.strip()]
            if rows and rows[-1][-1] == "...":
                rows[-1][-1:] = words
            else:
                rows.append(words)
            if line.endswith(","):
                rows[-1].append("...")
    return result


@pytest.mark.parametrize("name", [name for name in QUICK if not name.startswith("neohooke")])  # a law it has not
def test_calculix_deck(name: str) -> None:
    """Counts, edge nodes, supports, and both contact surfaces: where they are, how large, facing outward."""
    case, kind = small(name), name.split("-")[1]
    cards = blocks("\n".join(calculix.deck(case, "mortar")))
    points = {int(n): np.array(x, dtype=float) for n, *x in cards["*NODE, NSET=NALL"]}
    assert len(points) == len(case.mesh.points)
    cells = {
        int(n): [int(v) for v in nodes]
        for card, rows in cards.items()
        if card.startswith("*ELEMENT")
        for n, *nodes in rows
    }
    assert sorted(cells) == list(range(1, case.mesh.n_cells + 1))
    corners = 4 if kind == "tet10" else 8
    assert all(len(nodes) == corners + len(EDGES[kind]) for nodes in cells.values())
    assert all(middles(points, nodes, corners, EDGES[kind]) for nodes in cells.values())
    faces = TET_FACES if kind == "tet10" else HEX_FACES
    contact = case.contacts[0]
    for card, surface in (("SLAVE", contact.contactor), ("MASTER", contact.target)):
        rows = cards[f"*SURFACE, NAME={card}, TYPE=ELEMENT"]
        found = [[cells[int(e)][n - 1] for n in faces[int(s[1:]) - 1]] for e, s in rows]
        assert len(found) == len(set(map(tuple, found))) == len(case.mesh.surfaces[surface])
        assert set(itertools.chain(*found)) <= set((case.mesh.nodes_of(surface) + 1).tolist())
        assert all(set(nodes) <= set(cells[int(e)][:corners]) for (e, _), nodes in zip(rows, found))
    if not name.startswith(cases.BALLS):
        lower = case.mesh.nodes_of("lower.top")
        assert np.abs(case.mesh.points[lower, 2] - cases.SIDE).max() < ZERO
        total = [np.linalg.norm(area_vector(np.array([points[m] for m in nodes]))) for nodes in found]
        assert sum(total) == pytest.approx(cases.SIDE**2)  # of the upper block, turned or not
    check_supports(case, cards)


def check_supports(case, cards: dict[str, list[list[str]]]) -> None:
    """Every component that a support gives is prescribed, once, and nothing else."""
    given = {(int(n) - 1, int(axis) - 1): float(value) for n, axis, _, value in cards["*BOUNDARY"]}
    assert len(given) == len(cards["*BOUNDARY"])
    for support in case.supports:
        for axis, value in enumerate((support.x, support.y, support.z)):
            if value is not None:
                assert all(given.pop((int(n), axis), value) == value for n in case.mesh.nodes_of(support.on))
    assert not given
    foot = {int(n) for row in cards["*NSET, NSET=FOOT"] for n in row}
    assert foot == set((case.mesh.nodes_of(case.supports[0].on) + 1).tolist())


@pytest.mark.parametrize("name", QUICK)
def test_kratos_model(name: str) -> None:
    """Counts, edge nodes in Kratos' order, faces that turn outward, parts."""
    case, kind = small(name), name.split("-")[1]
    text = "\n".join(kratos.mdpa(case))
    assert len(re.findall(r"^\s*Begin", text, re.MULTILINE)) == len(re.findall(r"^\s*End", text, re.MULTILINE))

    def rows(block: str) -> list[list[str]]:
        found = re.findall(rf"^Begin {block}[^\n]*\n(.*?)^End", text, re.MULTILINE | re.DOTALL)
        return [line.split() for part in found for line in part.splitlines()]

    points = {int(n): np.array(x, dtype=float) for n, *x in rows("Nodes")}
    assert len(points) == len(case.mesh.points)
    cells = {int(n): [int(v) for v in nodes] for n, _, *nodes in rows("Elements")}
    assert sorted(cells) == list(range(1, case.mesh.n_cells + 1))
    corners = 4 if kind == "tet10" else 8
    assert all(middles(points, nodes, corners, KRATOS_EDGES[kind]) for nodes in cells.values())
    contact = case.contacts[0]
    count = len(case.mesh.surfaces[contact.contactor])
    conditions = {int(n): [int(v) for v in nodes] for n, _, *nodes in rows("Conditions")}
    assert len(conditions) == count + len(case.mesh.surfaces[contact.target])
    surfaces = [set((case.mesh.nodes_of(s) + 1).tolist()) for s in (contact.contactor, contact.target)]
    owner = {
        frozenset(nodes[i] for i in face if i < corners): np.mean([points[m] for m in nodes[:corners]], axis=0)
        for nodes in cells.values()
        for _, face in CELLS[kind].facets
    }
    for n, nodes in conditions.items():
        assert set(nodes) <= surfaces[0 if n <= count else 1]
        face = nodes[: 3 if kind == "tet10" else 4]
        place = np.array([points[m] for m in face])
        assert np.dot(place.mean(axis=0) - owner[frozenset(face)], area_vector(place)) > 0.0
    parts = re.findall(r"^Begin SubModelPart (\S+)", text, re.MULTILINE)
    every = {"slave", "master", *(f"body_{b}" for b in case.mesh.bodies)}
    assert set(parts) == every | {f"support_{i}" for i in range(len(case.supports))}


def test_laws_of_calculix() -> None:
    """Bodies that yield and rubber: the yield stress at plastic strains 0 and 1, C10 = G / 2 and D1 = 2 / K, the same points
    of integration, and large displacements where abut has them; Kratos has not that one of rubber."""
    metal = blocks("\n".join(calculix.deck(small("plastic-hex20"), "penalty")))
    assert metal["*PLASTIC"] == [["300.0", "0."], ["2300.0", "1."]]
    assert "*ELEMENT, TYPE=C3D20R, ELSET=BLOCK" in metal
    assert "*STEP" in metal
    assert metal["*STATIC, DIRECT"] == [["0.2", "1."]]
    case = small("rubber-hex8")
    rubber = blocks("\n".join(calculix.deck(case, "penalty")))
    shear, bulk = 3.0 / (2 * 1.48), 3.0 / (3 * 0.04)
    assert [float(x) for x in rubber["*HYPERELASTIC, NEO HOOKE"][0]] == pytest.approx([shear / 2, 2 / bulk])
    assert {"*STEP, NLGEOM", "*ELEMENT, TYPE=C3D8, ELSET=BALL"} <= set(rubber)
    assert rubber["*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR"] == [
        [repr(calculix.PENALTY * case.solids[0].material.modulus)]
    ]
    with pytest.raises(ValueError, match="NeoHooke is not compared"):
        kratos.materials(case)


def test_laws_of_kratos() -> None:
    """Metal that yields, loaded in as many steps as by abut; neo-Hooke's law with (ln J)^2, of large strains."""
    metal = small("plastic-hex8")
    block, ball = (own["Material"] for own in kratos.materials(metal)["properties"])
    assert block["constitutive_law"] == {"name": "SmallStrainJ2Plasticity3DLaw"}
    assert (block["Variables"]["YIELD_STRESS"], block["Variables"]["ISOTROPIC_HARDENING_MODULUS"]) == (300.0, 2000.0)
    assert ball["constitutive_law"] == {"name": "LinearElastic3DLaw"}
    written = kratos.parameters(metal)
    step, end = written["solver_settings"]["time_stepping"]["time_step"], written["problem_data"]["end_time"]
    assert int(np.ceil(end / step)) == metal.solve.steps
    (pressed,) = [
        own["Parameters"]["value"][2]
        for own in written["processes"]["constraints_process_list"]
        if own["Parameters"]["constrained"] == [True, True, True] and own["Parameters"]["value"][2] != "0.0 * t"
    ]
    assert pressed == f"{-cases.INDENT!r} * t"
    rubber = small("neohooke-hex8")
    law = kratos.materials(rubber)["properties"][0]["Material"]
    assert law["constitutive_law"] == {"name": "HyperElastic3DLaw"}
    assert law["Variables"] == {"YOUNG_MODULUS": 3.0, "POISSON_RATIO": 0.48}
    assert "TotalLagrangianElement3D8N" in "\n".join(kratos.mdpa(rubber))
    assert cases.with_options(rubber, linear="auto", tied=False, dual=True).contacts[0].pressure == "dual"


def test_friction_of_every_code() -> None:
    """The coefficient reaches CalculiX and Kratos, and nothing of it where there is none; a tie has none."""
    rough, smooth = small("friction-hex8"), small("tilted-hex8")
    assert rough.mesh.points.tolist() == smooth.mesh.points.tolist()
    cards = blocks("\n".join(calculix.deck(rough, "mortar")))
    assert cards["*FRICTION"] == [["0.3", repr(5.0 * cases.STEEL.young)]]
    assert "*FRICTION" not in blocks("\n".join(calculix.deck(smooth, "mortar")))
    (own,) = kratos.parameters(rough)["processes"]["contact_process_list"]
    assert own["Parameters"]["contact_type"] == "Frictional"
    assert own["Parameters"]["friction_coefficients"] == {"0": 0.3}
    assert kratos.parameters(rough)["solver_settings"]["contact_settings"]["mortar_type"] == "ALMContactFrictional"
    (other,) = kratos.parameters(smooth)["processes"]["contact_process_list"]
    assert (other["Parameters"]["contact_type"], "friction_coefficients" in other["Parameters"]) == (
        "Frictionless",
        False,
    )
    assert cases.with_options(rough, linear="auto", tied=True).contacts[0].kind == "tied"
    assert cases.with_options(rough, linear="auto", tied=False).contacts[0].friction == 0.3


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name in QUICK if name not in [f"{ball}-hex20" for ball in cases.BALLS]])
def test_sizes(name: str) -> None:
    """The mesh comes near the number wanted (whole cells), and grows with it; the smallest is the one of two cells."""
    geometry, cell = name.split("-")
    least = cases.dofs(cases.GEOMETRIES[geometry](2, cell))
    wanted = (3 * least, 6 * least) if geometry in cases.BALLS else (6 * least, 12 * least)
    sizes = [cases.dofs(cases.model(name, w)) for w in wanted]
    assert sizes == sorted(set(sizes))
    assert all(2 / 3 < size / w < 3 / 2 for size, w in zip(sizes, wanted))
    assert cases.dofs(cases.model(name, 10)) == least


def environment() -> dict[str, str]:
    """Lets a child import this very abut."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}


@pytest.mark.long
def test_abut_child(tmp_path: Path) -> None:
    """A run in a process of its own gives a converged result with a force of about E strain area."""
    command = [sys.executable, str(BENCH / "abut_child.py"), "flat-hex8", "200"]
    child = process.run(command, tmp_path, process.available_cores()[:1], 60.0, 4e9, environment())
    assert child.status == "ok", child.output
    result = child.json()
    assert result is not None
    assert result["status"] == "ok"
    force = cases.STEEL.young * cases.DEPTH / (2 * cases.SIDE) * cases.SIDE**2
    assert force < result["force"] < 1.1 * force  # held sideways at both ends
    assert result["iterations"] >= 1
    assert {"assembly", "interface", "solve"} <= set(result["stages"])
    assert 10.0 < child.peak_mb < 4000.0


@pytest.mark.parametrize(
    ("code", "status"),
    [
        ("import time; time.sleep(20)", "time limit"),
        ("raise KeyError(3)", "failed: KeyError: 3"),
        ("import os; os.abort()", "failed: SIGABRT"),
        ("print(1)", "ok"),
    ],
)
def test_process(tmp_path: Path, code: str, status: str) -> None:
    """A child that hangs, raises or dies is said to."""
    assert process.run([sys.executable, "-c", code], tmp_path, process.available_cores(), 0.5, 4e9).status == status


def test_memory_limit(tmp_path: Path) -> None:
    code = "x = bytearray(200_000_000); import time; time.sleep(20)"
    child = process.run([sys.executable, "-c", code], tmp_path, process.available_cores(), 10.0, 100e6)
    assert child.status == ("memory limit" if sys.platform == "linux" else "time limit")


def test_calculix_results(tmp_path: Path) -> None:
    """Force and iterations are read from CalculiX's files; a run that stops before the end is not taken for one."""
    own = codes.code("calculix-mortar", "auto", "no such program", sys.executable)
    assert own.version == ""
    head = " SUMMARY\n  STEP   INC  ATT   ITER\n    (#)    (%)\n"
    (tmp_path / "deck.cvg").write_text(
        head + "     1     1     1     1        0  0.0000E+00\n     1     1     1     2        0  0.0000E+00\n"
    )
    text = "\n total force (fx,fy,fz) for set FOOT and time  {}\n\n  1.0E-15  4.0E-14  -2.5E+04\n"
    (tmp_path / "deck.dat").write_text(text.format("0.1000000E+01"))
    ended = process.Run("ok", "...\nJob finished\n", 1.0, 1.0, 1.0)
    assert own.read(ended, tmp_path) == {"status": "ok", "iterations": 2, "force": 2.5e4}
    (tmp_path / "deck.dat").write_text(text.format("0.2500000E+00"))
    assert own.read(ended, tmp_path)["status"] == "not converged"
    stopped = process.Run("ok", " *ERROR in spooles: matrix found to be singular\n", 1.0, 1.0, 1.0)
    assert own.read(stopped, tmp_path)["status"] == "failed: ERROR in spooles: matrix found to be singular"


def rows() -> list[report.Row]:
    """Runs that took dofs^1.5, with one that is missing, and one with another answer."""
    result: list[report.Row] = []
    for dofs in (10_000, 40_000):
        for code, factor, force in (("abut", 2.0, 100.0), ("abut-tied", 1.0, 300.0), ("kratos", 8.0, 100.5)):
            seconds = factor * (dofs / 10_000) ** 1.5
            row: report.Row = {"case": "flat-hex8", "dofs": dofs, "cores": 1, "code": code, "status": "ok"}
            result.append({**row, "seconds": seconds, "force": force, "iterations": 3, "peak_mb": 99.6, "runs": 3})
    result[-1]["force"] = 110.0
    row = {"case": "flat-hex8", "dofs": 40_000, "cores": 1, "code": "calculix-mortar", "status": "not installed"}
    return [*result, row]


def test_table() -> None:
    head, *lines = report.table(rows())
    assert all(len(line) == len(head) for line in lines)
    assert lines[2] == [
        "flat-hex8",
        "10 000",
        "1",
        "kratos",
        "3",
        "8",
        "100",
        "3",
        "100.5",
        "+0.50%",
        "4.00",
        "8.00",
        "",
    ]
    assert lines[4][9:] == ["-", "0.50", "1.00", ""]  # a tied body's force is not compared
    assert lines[5][9:] == ["+10.00%", "4.00", "8.00", "different answer"]
    assert lines[6][4:] == [*["-"] * 8, "not installed"]
    assert len({len(line) for line in report.markdown([head, *lines]).splitlines()[1:2]}) == 1
    assert report.plain([["a", "b"], ["long", "c"]]) == "a     b\nlong  c"


def test_overview() -> None:
    """Times over abut's; at least the limit's share of those stopped there."""
    stopped: report.Row = {"case": "flat-hex8", "dofs": 10_000, "cores": 1, "code": "calculix-mortar", "wall": 60.0}
    head, *lines = report.overview([*rows(), {**stopped, "status": "time limit of 60 s"}])
    assert head == ["case", "dofs", "cores", "abut s", "MB", "abut-tied", "kratos", "calculix-mortar"]
    assert lines == [
        ["flat-hex8", "10 000", "1", "2", "100", "0.50", "4.00", "> 30"],
        ["flat-hex8", "40 000", "1", "16", "100", "0.50", "4.00*", "-"],
    ]


def test_rows_in_order() -> None:
    """By case, size, cores and code, the latest of each."""
    again: report.Row = {**rows()[1], "seconds": 5.0}
    found = report.ordered([*reversed(rows()), again], NAMES, list(codes.CODES))
    assert [(row["dofs"], row["code"]) for row in found[:3]] == [
        (10_000, "abut"), (10_000, "abut-tied"), (10_000, "kratos")
    ]  # fmt: skip
    assert len(found) == len(rows())
    assert found[1]["seconds"] == 5.0


def test_exponents() -> None:
    found = report.exponents(rows())
    assert [(code, cores) for _, code, cores, _ in found] == [("abut", 1), ("abut-tied", 1), ("kratos", 1)]
    assert [value for *_, value in found] == pytest.approx([1.5] * 3)
    assert report.exponent_table(rows())[:2] == [["case", "code", "1 core"], ["flat-hex8", "abut", "1.50"]]


def test_page(tmp_path: Path) -> None:
    """The table goes between the markers, however often; the page of the documentation has them."""
    page = tmp_path / "page.md"
    page.write_text(f"before\n{report.BEGIN}\nold\n{report.END}\nafter\n")
    for _ in range(2):
        report.put_into(page, report.page(rows(), "2 cores", {"abut": "1", "Kratos": "missing"}))
    text = page.read_text()
    assert text.startswith("before\n")
    assert text.endswith("after\n")
    assert "old" not in text
    assert text.count("2 cores. abut 1, Kratos missing.") == 1
    every = report.all_runs(rows(), "2 cores", {"abut": "1"})
    assert all(part in every for part in ("# Every run", "## flat-hex8", "| 40 000 | 1 | kratos | 3 | 64 |"))
    documented = (BENCH.parents[1] / "docs" / "performance.md").read_text(encoding="utf-8")
    assert documented.count(report.BEGIN) == documented.count(report.END) == 1
    page.write_text("no markers")
    with pytest.raises(ValueError, match="begin table"):
        report.put_into(page, "text")


def test_case_names() -> None:
    """The names that the command line takes are those of the cases."""
    assert run.NAMES == NAMES


def test_kratos_parameters_are_json() -> None:
    case = small("hertz-hex8")
    supports = json.loads(json.dumps(kratos.parameters(case)))["processes"]["constraints_process_list"]
    assert [s["Parameters"]["constrained"].count(True) for s in supports] == [3, 1, 1, 1, 1, 3]
