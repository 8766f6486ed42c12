"""fields.frd: what CalculiX GraphiX reads, with the numbers of the VTU files."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.cells import CELLS
from abut.io.frd import TYPES, Dataset, Increment, write_frd
from abut.io.vtu import read_vtu
from abut.job import load_job
from abut.mesh import make
from abut.output.results import write_held
from models.frd import read

DIGITS = 5.1e-6  # half a unit in the sixth digit of what is at least 1
CUBE = [[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
PRISM = [[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (0, 1))]
CORNERS = {"hex": CUBE, "wed": PRISM, "tet": [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]],
           "tri": [[0, 0], [1, 0], [0, 1]], "qua": [[0, 0], [1, 0], [1, 1], [0, 1]]}  # fmt: skip
AROUND = {"hex": 4, "wed": 3}  # corners of the bottom


def unit_cell(kind: str) -> np.ndarray:
    """Its nodes: corners, then the middles of edges as VTK orders them, of hex27 and quad9 also those of faces."""
    corners = np.array(CORNERS[kind[:3]], dtype=float)
    n = len(corners)
    if CELLS[kind].degree == 1:
        return corners
    around = AROUND.get(kind[:3], 3 if kind[:3] in ("tri", "tet") else 4)
    edges = [(i, (i + 1) % around) for i in range(around)]
    if kind[:3] == "tet":
        edges += [(i, 3) for i in range(3)]
    elif kind[:3] in AROUND:
        edges += [(around + i, around + j) for i, j in edges] + [(i, around + i) for i in range(around)]
    middles = [(corners[i] + corners[j]) / 2 for i, j in edges]
    rest = CELLS[kind].nodes - n - len(middles)
    return np.vstack([corners, middles, np.full((rest, corners.shape[1]), 0.5)])


@pytest.mark.parametrize("kind", [kind for kind, cell in CELLS.items() if cell.dim > 1])
def test_order_of_nodes(kind: str, tmp_path: Path) -> None:
    """The manual's element types: corners, edges of the bottom, those between bottom and top, then those of the top."""
    points = unit_cell(kind)
    write_frd(tmp_path / "a.frd", points, [(kind, np.arange(len(points))[None])], np.zeros(1, int), ["a"], [])
    file = read(tmp_path / "a.frd")
    code, group, nodes = file.cells[1]
    assert (code, group, file.whole, file.names) == (TYPES[kind][0], 1, True, {1: "a"})
    at = np.array([file.nodes[node] for node in nodes])
    n = len(CORNERS[kind[:3]])
    assert len(at) == {1: 8, 2: 6, 3: 4, 4: 20, 5: 15, 6: 10, 7: 3, 8: 6, 9: 4, 10: 8}[code] == len(file.nodes)
    assert (at[:n, : points.shape[1]] == CORNERS[kind[:3]]).all()
    if code in (4, 5):
        m = AROUND[kind[:3]]
        assert (at[n + m : n + 2 * m] == (at[:m] + at[m : 2 * m]) / 2).all()
        assert (at[n + 2 * m :, 2] == 1.0).all()
        assert (at[n : n + m, 2] == 0.0).all()


@pytest.mark.parametrize("value", [1e-120, -1e-120, 3e150, -3e150, np.pi])
def test_columns_hold(value: float, tmp_path: Path) -> None:
    """Of exponents with three digits, too, which would shift the columns after them."""
    data = Dataset("X", tuple("ABCDEFGH"), np.arange(3), np.full((3, 8), value))
    points = unit_cell("tri3")
    write_frd(
        tmp_path / "a.frd",
        points,
        [("tri3", np.arange(3)[None])],
        np.zeros(1, int),
        ["a"],
        [Increment(1, 1.0, (data,))],
    )
    wanted = 0.0 if abs(value) < 1e-99 else np.clip(value, -9.99999e99, 9.99999e99)
    components, values = read(tmp_path / "a.frd").datasets[1, "X"]
    assert components == list("ABCDEFGH")
    assert np.array(list(values.values())) == pytest.approx(np.full((3, 8), wanted), rel=DIGITS)


def pushed(cell: str, cells: list[int]) -> abut.Model:
    """A metal block that yields, on a wider one, pushed down and aside with friction in two steps."""
    flat = {"lower": make.box([0, 4], [0, 4], [0, 2], cells=[4, 4, 2], cell=cell)}
    steel = abut.LinearElastic(1000.0, 0.3)
    return abut.Model(
        make.join({**flat, "upper": make.box([1, 3], [1, 3], [2, 3], cells=cells, cell=cell)}),
        solids=[abut.Solid("lower", steel), abut.Solid("upper", abut.Plastic(1000.0, 0.3, 5.0))],
        supports=[abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", x=0.002, y=0, z=-0.02)],
        contacts=[abut.Contact("lower.top", "upper.bottom", name="touch", friction=0.3)],
        solve=abut.SolveOptions(steps=2),
    )


@pytest.mark.parametrize(
    ("cell", "cells"), [("hex8", [3, 3, 1]), pytest.param("hex27", [2, 2, 1], marks=pytest.mark.long)]
)
def test_numbers_of_the_vtu_files(cell: str, cells: list[int], tmp_path: Path) -> None:
    """Displacements, stresses, plastic strains, pressures on both sides, openings, tractions and slips of every step."""
    from models.steps import arrays

    solution = abut.solve(pushed(cell, cells))
    abut.write(solution, tmp_path, output=abut.Output(formats=["vtu", "frd"]))
    file = read(tmp_path / "fields.frd")
    assert file.whole
    assert sorted(file.names.values()) == ["lower", "upper"]
    assert len(file.cells) == solution.model.mesh.n_cells
    for step in solution.steps:
        assert file.times[step.number] == pytest.approx(step.factor, rel=DIGITS)
        fields = dict(arrays(tmp_path / f"fields_{step.number:04d}.vtu"))
        for name, key, scale in (
            ("DISP", "displacement", 1), ("STRESS", "stress", 1), ("PE", "equivalent_plastic_strain", 1),
            ("PSTRAIN", "plastic_strain", [1, 1, 1, 0.5, 0.5, 0.5]),
        ):  # fmt: skip
            _, values = file.datasets[step.number, name]
            assert set(values) == set(file.nodes)
            wanted = (fields[key].reshape(len(fields[key]), -1) * scale)[np.array(list(values)) - 1]
            assert np.array(list(values.values())) == pytest.approx(wanted, rel=2 * DIGITS, abs=1e-99), name
        assert max(v[0] for v in file.datasets[step.number, "PE"][1].values()) > 1e-4
        contact = dict(arrays(tmp_path / f"contact_touch_{step.number:04d}.vtu"))
        for name, column, key in (("CONTACT", 0, "gap"), ("CONTACT", 1, "pressure"), ("CPRESS", 0, "pressure"),
                                  ("CSHEAR", 0, "traction"), ("CSLIP", 0, "total_slip")):  # fmt: skip
            _, values = file.datasets[step.number, name]
            assert values
            for node, row in values.items():
                there = (contact["node"] == node - 1) & np.isfinite(contact["gap"] if name != "CPRESS" else 0.0)
                wanted = contact[key][there].reshape(there.sum(), -1)[:, 0].mean()
                assert row[column] == pytest.approx(wanted, rel=1e-4, abs=1e-9), (name, node)
        assert set(file.datasets[step.number, "CONTACT"][1]) < set(file.datasets[step.number, "CPRESS"][1])


def test_asked_for_or_not(tmp_path: Path) -> None:
    """It is there where it is asked for, alone too, with the steps and fields that are; the next run takes it away."""
    model = abut.Model(
        make.join({"bar": make.rectangle([0, 2], [0, 1], cells=[2, 1], cell="quad9")}),
        plane="stress",
        solids=[abut.Solid("bar", abut.LinearElastic(1000.0, 0.0))],
        supports=[abut.Support("bar.left", x=0), abut.Support("bar.bottom", y=0), abut.Support("bar.right", x=0.02)],
        solve=abut.SolveOptions(steps=5),
    )
    solution = abut.solve(model)
    abut.write(solution, tmp_path, output=abut.Output(steps=2, fields=["displacement"], formats=["frd"]))
    assert not [*tmp_path.glob("*.vtu"), *tmp_path.glob("*.pvd")]
    file = read(tmp_path / "fields.frd")
    assert {name for _, name in file.datasets} == {"DISP"}
    assert list(file.times) == [2, 4, 5]
    for number, time in file.times.items():
        for node, (x, *others) in file.datasets[number, "DISP"][1].items():
            assert x == pytest.approx(0.01 * file.nodes[node][0] * time, rel=DIGITS, abs=1e-15)  # uniform strain
            assert others == pytest.approx([0.0, 0.0], abs=1e-12)
    abut.write(solution, tmp_path)
    assert not (tmp_path / "fields.frd").exists()
    assert (tmp_path / "fields.pvd").exists()
    with pytest.raises(abut.InputError, match=r"output\.formats: .*'frd'"):
        abut.Output(formats=["fdr"])


JOB = """schema = 1
[mesh.bodies.bar]
kind = "box"
x = [0, 2]
y = [0, 1]
z = [0, 1]
cells = [2, 1, 1]
cell = "hex20"
[materials.steel]
kind = "linear-elastic"
young = 1000.0
poisson = 0.0
[[solids]]
body = "bar"
material = "steel"
[[supports]]
on = "bar.left"
x = 0
y = 0
z = 0
[[loads]]
kind = "traction"
on = "bar.right"
value = [10, 0, 0]
[output]
formats = ["vtu", "frd"]
"""


def test_in_a_job_file(tmp_path: Path) -> None:
    path = tmp_path / "bar.toml"
    path.write_text(JOB)
    job = load_job(path)
    assert job.output.frd
    assert job.output.bodies
    write_held(abut.solve(job.model), tmp_path, None, None, abut.output.fields.write_fields, job.output)
    file = read(tmp_path / "fields.frd")
    stress = np.array(list(file.datasets[1, "STRESS"][1].values()))
    assert stress == pytest.approx(np.tile([10.0, 0, 0, 0, 0, 0], (len(stress), 1)), abs=1e-9)
    assert len(read_vtu(tmp_path / "fields_0001.vtu").points) == len(file.nodes)


@pytest.mark.skipif(shutil.which("cgx") is None, reason="needs CalculiX GraphiX (cgx)")
def test_in_calculix_graphix(tmp_path: Path) -> None:
    """It finds as many nodes, cells and datasets, and the largest displacement."""
    path = tmp_path / "bar.toml"
    path.write_text(JOB)
    job = load_job(path)
    abut.write(abut.solve(job.model), tmp_path, output=job.output)
    (tmp_path / "a.fbd").write_text("read fields.frd\nprnt info\nds 1 e 1\nquit\n")
    said = subprocess.run(["cgx", "-bg", "a.fbd"], cwd=tmp_path, capture_output=True, text=True, timeout=60).stdout
    file = read(tmp_path / "fields.frd")
    assert f" n:{len(file.nodes)} e:{len(file.cells)} " in said
    assert " ds:2 " in said
    assert "max:2.000000e-02 at node:" in said
