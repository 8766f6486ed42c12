"""Probes: what a step says at points, along lines and on sets is what theory says there, and it stands in every file."""

from __future__ import annotations

import csv
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import abut
import patch
from abut.cells import CELLS
from abut.check import check
from abut.cli import main
from abut.io.restart import description
from abut.job import load_job
from abut.job.convert import write_job
from abut.mesh import make
from abut.mesh.exterior import outside_of_body
from abut.mesh.make import block
from abut.mesh.mesh import Mesh
from abut.mesh.quadrature import gauss_rule
from abut.probing import boxes, find_place, read
from abut.probing.cells import locate
from abut.probing.feet import feet
from abut.probing.inverse import nearest
from abut.probing.table import columns, peaks
from abut.report import write_report
from abut.solids.elements import reference_nodes
from abut.state import Step
from test_report import Page

PLANE = ("tri3", "tri6", "quad4", "quad8", "quad9")
SOLID = ("tet4", "tet10", "hex8", "hex20", "hex27", "wedge6", "wedge15")
QUADRATIC = tuple(cell for cell in (*PLANE, *SOLID) if CELLS[cell].degree == 2)
STEEL = abut.LinearElastic(1000.0, 0.3)
JOB = Path(__file__).parents[1] / "examples" / "two-blocks" / "job.toml"
TEXT = JOB.read_text()


def distorted(cell: str, curved: bool = False) -> Mesh:
    """A unit square or cube of cells in general position; curved: all nodes moved, so that edges and sides bend."""
    dim = CELLS[cell].dim
    n = (3,) * dim
    move = patch._perturb(0.2, np.zeros(dim), np.ones(dim), 5, n)
    mesh = make.join({"a": block.grid([np.linspace(0.0, 1.0, k + 1) for k in n], cell, move)})
    if not curved:
        return mesh
    x = mesh.points
    bent = x + 0.06 * np.sin(2.0 * x[:, ::-1] + np.arange(1, dim + 1)) + 0.05 * x[:, ::-1] ** 2
    return replace(mesh, points=bent)


def in_cells(mesh: Mesh, count: int, seed: int = 0) -> np.ndarray:
    """Points anywhere in the cells, on faces, edges and corners too: from random and extreme reference coordinates."""
    rng = np.random.default_rng(seed)
    found = []
    for b in mesh.blocks:
        corners = reference_nodes(b.kind)
        for nodes in b.nodes[rng.integers(len(b.nodes), size=count)]:
            share = rng.dirichlet(np.full(len(corners), 0.3))
            places = np.vstack([share @ corners, corners[rng.integers(len(corners))]])
            shapes, _ = abut._core.shape_functions(CELLS[b.kind].code, np.ascontiguousarray(places))
            found.append(shapes @ mesh.points[nodes])
    return np.concatenate(found)


def free(mesh: Mesh, *probes: abut.Probe) -> abut.Model:
    return abut.Model(
        mesh, [abut.Solid("a", STEEL)], plane="strain" if mesh.dim == 2 else None, probes=probes,
    )  # fmt: skip


def step_of(model: abut.Model, displacement: np.ndarray, stress: np.ndarray) -> Step:
    """A step with given fields, as if solved."""
    zero = np.zeros(model.dim)
    return Step(1, 1.0, True, (), displacement, stress, zero, {}, zero, ())


@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize("cell", [*PLANE, *SOLID])
def test_linear_fields_are_met_anywhere(cell: str, curved: bool) -> None:
    """Shape functions hold linear functions of position on curved cells too: at any point, on faces, edges and corners,
    displacement and stress come back to rounding (1e-12), and von Mises is that of the stress."""
    mesh = distorted(cell, curved and cell in QUADRATIC)
    dim = mesh.dim
    rng = np.random.default_rng(1)
    slope, rate = rng.normal(size=(dim, dim)), rng.normal(size=(dim, 6))
    points = in_cells(mesh, 20)
    model = free(mesh, *(abut.Probe(f"p{i}", at=tuple(x)) for i, x in enumerate(points)))
    step = step_of(model, mesh.points @ slope, 1.0 + mesh.points @ rate)
    around = boxes(mesh)
    for probe, x in zip(model.probes, points):
        result = read(find_place(model, probe, around), step)
        assert result.values["displacement"][0] == pytest.approx(x @ slope, abs=1e-12)
        assert result.values["stress"][0] == pytest.approx(1.0 + x @ rate, abs=1e-12)
        xx, yy, zz, xy, yz, zx = 1.0 + x @ rate
        mises = np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * (xy**2 + yz**2 + zx**2))
        assert result.values["von_mises"][0] == pytest.approx(mises, rel=1e-11)
        assert set(result.values) == {"displacement", "stress", "von_mises"}


@pytest.mark.parametrize("cell", QUADRATIC)
def test_reference_coordinates_come_back(cell: str) -> None:
    """Round trip through strongly curved cells, up to those whose map is about to fold over."""
    rng = np.random.default_rng(2)
    nodes = reference_nodes(cell)
    kind = CELLS[cell]
    for _ in range(20):
        x = nodes + np.where(np.arange(len(nodes))[:, None] < kind.corners, 0.05, 0.12) * rng.uniform(
            -1, 1, nodes.shape
        )
        _, slopes = abut._core.shape_functions(kind.code, np.vstack([nodes, gauss_rule(cell, 6)[0]]))
        volume = np.linalg.det(np.einsum("qna,nd->qad", slopes, x))
        if volume.min() < 0.05 * volume.max():
            continue
        xi = rng.dirichlet(np.full(len(nodes), 0.4), 30) @ nodes
        shapes, _ = abut._core.shape_functions(kind.code, np.ascontiguousarray(xi))
        found, miss = nearest(cell, np.broadcast_to(x, (30, *x.shape)), shapes @ x)
        assert np.abs(found - xi).max() < 1e-11
        assert np.abs(miss).max() < 1e-13


@pytest.mark.parametrize("cell", ["tri3", "quad8", "tet10", "hex20", "wedge6"])
def test_points_outside_are_found_to_be(cell: str) -> None:
    """Beside faces, edges and corners by 1 % of the model; a thousandth of a cell's size counts as on the surface."""
    mesh = distorted(cell)
    around = boxes(mesh)
    rng = np.random.default_rng(3)
    inner = rng.uniform(0.0, 1.0, (60, mesh.dim))
    assert len(locate(mesh, around, inner).outside) == 0
    outer = inner.copy()
    axis = rng.integers(mesh.dim, size=60)
    high = rng.integers(2, size=60)
    for size, wrong in ((0.01, 60), (1e-4, 0)):
        outer[np.arange(60), axis] = np.where(high, 1.0 + size, -size)
        inside = locate(mesh, around, outer)
        assert len(inside.outside) == wrong
        if not wrong:
            weights = inside.weights
            assert np.abs(weights.sum(axis=1) - 1.0).max() < 1e-13
            assert np.abs(weights @ mesh.points - outer).max() < 2e-4
    corner = np.full((1, mesh.dim), 1.0 + 1e-13)
    assert len(locate(mesh, around, corner).outside) == 0


def test_many_cells_and_points_agree_with_brute_force() -> None:
    """The cell found is one whose box holds the point, for points in any order and some of them equal."""
    mesh = make.join({"a": make.box(cells=[6, 5, 4], cell="hex8")})
    rng = np.random.default_rng(4)
    points = rng.uniform(0.0, 1.0, (300, 3))
    points[100:120] = points[7]
    weights = locate(mesh, boxes(mesh), points).weights
    assert np.abs(weights @ mesh.points - points).max() < 1e-13
    for row, x in enumerate(points):
        used = mesh.points[weights[row].indices]
        assert (used.min(axis=0) <= x + 1e-12).all()
        assert (used.max(axis=0) >= x - 1e-12).all()
        assert (np.ptp(used, axis=0) < np.array([1 / 6, 1 / 5, 1 / 4]) + 1e-12).all()


@pytest.mark.parametrize("lower", [*PLANE, *SOLID])
def test_uniform_pressure_is_uniform_along_a_line(lower: str) -> None:
    """The contact patch test read by probes: along the interface and beyond its ends, on the whole contactor, on the target,
    at corners; stress and displacement where the bodies are, all to 1e-9 of theory."""
    dim = CELLS[lower].dim
    upper = "quad9" if dim == 2 else "hex20"
    model = patch.model(patch.two_blocks(lower, upper, ((3,) * dim, (4,) * dim)), rotate=False)
    middle = [0.37] * (dim - 2)
    line = ([0.0, *middle, 1.0], [1.0, *middle, 1.0])
    longer = ([-0.25, *middle, 1.0], [1.25, *middle, 1.0])
    model = replace(
        model,
        probes=(
            abut.Probe("along", line=line, points=7, body="lower"),
            abut.Probe("beyond", line=longer, points=7, of=["pressure", "gap"]),
            abut.Probe("set", on="lower.top"),
            abut.Probe("target", on="upper.bottom"),
            abut.Probe("upper side", line=line, points=5, body="upper"),
            abut.Probe("corner", at=[0.0] * (dim - 1) + [1.0], body="lower"),
            abut.Probe("inside", at=[0.41] * (dim - 1) + [1.37]),
            abut.Probe("above", line=([0.2, *middle, 1.4], [0.8, *middle, 1.4]), points=4, of=["pressure"]),
        ),
    )
    solution = abut.solve(model)
    own = {result.name: result for result in solution.probes}
    load = model.loads[0].value
    strain = load / 1.0
    side, along = (
        (patch.POISSON * (1 + patch.POISSON) * strain, -(1 - patch.POISSON**2) * strain)
        if dim == 2
        else (patch.POISSON * strain, -strain)
    )
    for name in ("along", "set", "target", "upper side", "corner", "above"):
        assert own[name].values["pressure"] == pytest.approx(load, rel=1e-9), name
    for name in ("along", "set", "corner"):
        assert np.abs(own[name].values["gap"]).max() < 1e-9 * strain, name
    for name in ("target", "upper side", "inside"):
        assert "gap" not in own[name].values
    beyond = own["beyond"].values["pressure"]
    assert np.isnan(beyond).tolist() == [True] + [False] * 5 + [True]
    assert beyond[1:-1] == pytest.approx(load, rel=1e-9)
    assert set(own["beyond"].values) == {"pressure", "gap"}
    assert set(own["inside"].values) == {"displacement", "stress", "von_mises"}
    for name in ("along", "upper side", "inside", "set"):
        result = own[name]
        x = result.points
        stress = np.zeros((len(x), 6))
        stress[:, dim - 1] = -load
        stress[:, 2] -= patch.POISSON * load if dim == 2 else 0.0
        exact = np.column_stack([side * x[:, :-1], along * x[:, -1:]])
        assert np.abs(result.values["displacement"] - exact).max() < 1e-9 * strain, name
        assert np.abs(result.values["stress"] - stress).max() < 1e-8 * load, name
    assert own["along"].distance == pytest.approx(np.linspace(0.0, 1.0, 7), abs=1e-15)
    assert (own["set"].nodes == model.mesh.nodes_of("lower.top")).all()
    assert any("projected" in note and "'above'" in note for note in solution.notes)


def two_blocks(*probes: abut.Probe, **options: Any) -> abut.Model:
    """A small block on a larger one in the plane, the upper one pressed down by 0.01."""
    lower = make.rectangle([0, 2], [0, 1], cells=[4, 2], cell="quad8")
    upper = make.rectangle([0.5, 1.5], [1, 2], cells=[3, 2], cell="quad8")
    given = {
        "plane": "strain",
        "solids": [abut.Solid("lower", STEEL), abut.Solid("upper", STEEL)],
        "supports": [abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0, y=-0.01)],
        "contacts": [abut.Contact("upper.bottom", "lower.top", name="blocks")],
        **options,
    }
    return abut.Model(make.join({"lower": lower, "upper": upper}), probes=probes, **given)


def test_jumps_are_read_as_means() -> None:
    """P0: constant on each facet; where two meet, their mean; a node's value on a set likewise. Of facets without a gap only
    the other counts."""
    model = two_blocks(
        abut.Probe("line", line=([0.5, 1], [1.5, 1]), points=7, of=["pressure", "gap"]),
        abut.Probe("set", on="upper.bottom"),
        contacts=[abut.Contact("upper.bottom", "lower.top", pressure="P0")],
    )
    solution = abut.solve(model)
    contact = solution.contacts[0]
    x = contact.contactor.points[contact.contactor.nodes[:, :2]][..., 0].mean(axis=1)
    a, b, c = contact.pressure[np.argsort(x), 0]
    line, own = solution.probes
    assert line.values["pressure"] == pytest.approx([a, a, (a + b) / 2, b, (b + c) / 2, c, c], rel=1e-12)
    at = dict(zip(own.points[:, 0].round(6), own.values["pressure"]))
    assert at[round(0.5 + 1 / 3, 6)] == pytest.approx((a + b) / 2, rel=1e-12)
    gap = contact.gap.copy()
    gap[np.argsort(x)[0]] = np.nan
    step = replace(solution.steps[-1], contacts=(replace(contact, gap=gap),))
    read_again = read(find_place(model, model.probes[0]), step).values["gap"]
    assert np.isnan(read_again).tolist() == [True, True] + [False] * 5


def test_hertz_beneath_a_cylinder() -> None:
    """Stress below the middle of a line contact: sigma_y = -p0 / (1 + (z/a)^2)^(1/2), largest shear 0.30 p0 at 0.79 a; the
    pressure along the top is the ellipse; the cylinder is no half-space, hence 3 % of p0."""
    path = JOB.parents[1] / "hertz-line" / "quad8.toml"
    peak, half = 3585.36, 6.2146
    model = replace(
        load_job(path).model,
        probes=(
            abut.Probe("axis", line=([0, 0], [0, -2 * half]), points=21, body="block", of=["stress"]),
            abut.Probe("top", line=([-0.8 * half, 0], [0.8 * half, 0]), points=41, of=["pressure", "gap"]),
            abut.Probe("round", line=([-0.8 * half, 0], [0.8 * half, 0]), points=41, of=["pressure"], body="cylinder"),
        ),
    )
    axis, top, carried = abut.solve(model).probes
    z = axis.distance / half
    xx, yy = axis.values["stress"][:, 0], axis.values["stress"][:, 1]
    assert np.abs(yy[1:] + peak / np.sqrt(1 + z[1:] ** 2)).max() < 0.03 * peak
    shear = 0.5 * (xx - yy)
    assert shear.max() == pytest.approx(0.30 * peak, rel=0.06)  # nodal averages of cells a fifth of a wide
    assert z[np.argmax(shear)] == pytest.approx(0.79, abs=0.11)
    s = (top.distance - 0.8 * half) / half
    for values in (top.values["pressure"], carried.values["pressure"]):
        assert np.abs(values - peak * np.sqrt(1 - s**2)).max() < 0.05 * peak


def test_feet_on_a_kinked_and_bent_surface() -> None:
    """Above the edge of a convex kink the foot is the edge, not beside; beyond the rim there is none; on a circle the foot
    of a point outside is on its own radius."""
    mesh = make.join({"a": make.box(cells=[2, 2, 2])})
    rows = np.concatenate([mesh.surfaces["a.top"], mesh.surfaces["a.right"]])
    surface = mesh.facets(rows)
    points = np.array(
        [[1.1, 0.3, 1.1], [1.1, 0.5, 1.2], [0.3, 0.3, 1.5], [-0.1, 0.3, 1.0], [0.5, 1.2, 1.0], [1.1, 0.0, 1.1]]
    )
    own = feet(surface, points)
    assert own.beside.tolist() == [False, False, False, True, True, False]
    assert own.distance[:4] == pytest.approx([0.02**0.5, 0.05**0.5, 0.5, 0.1], rel=1e-12)
    used = surface.points[np.maximum(surface.nodes[own.facet], 0)]
    x = np.einsum("kn,knd->kd", own.weights, used)
    assert np.abs(x[own.point == 0] - [1.0, 0.3, 1.0]).max() < 1e-12
    disc = make.join({"d": make.disc(radius=1.0, cells=6, cell="quad8")})
    surface = disc.facets(outside_of_body(disc, "d"))
    angle = np.linspace(0.1, 6.0, 17)
    own = feet(surface, 1.4 * np.column_stack([np.cos(angle), np.sin(angle)]))
    assert not own.beside.any()
    assert own.distance == pytest.approx(0.4, abs=2e-3)  # a circle by parabolas


def test_which_body_is_read() -> None:
    """On the interface of two bodies the first in the mesh is read, with a note, or the one asked for."""
    at = [1.0, 1.0]
    solution = abut.solve(
        two_blocks(abut.Probe("a", at=at), abut.Probe("b", at=at, body="upper"), abut.Probe("c", at=at, body="lower"))
    )
    a, b, c = solution.probes
    mesh = solution.model.mesh
    lower = mesh.nodes_of("lower")
    (node,) = lower[np.linalg.norm(mesh.points[lower] - at, axis=1) < 1e-9]
    assert a.values["displacement"][0] == pytest.approx(solution.displacement[node], abs=1e-15)
    assert (a.values["stress"] == c.values["stress"]).all()
    assert np.abs(a.values["stress"] - b.values["stress"]).max() > 1e-6
    (note,) = (text for text in solution.notes if "probe" in text)
    assert note == "probe 'a': it lies in 'lower' and 'upper'; read in 'lower' (body = \"upper\" for the other)"


def test_files_of_several_steps(tmp_path: Path) -> None:
    """Every value at every step in probe_NAME.csv; the same in few numbers in summary.json and history.csv."""
    probes = (
        abut.Probe("mid point", at=[1.0, 0.5]),
        abut.Probe("top", line=([0.0, 1.0], [2.0, 1.0]), points=9, contact="blocks", body="lower"),
        abut.Probe("edge", line=([0.3, 1.0], [1.7, 1.0]), points=9, of=["pressure"]),
        abut.Probe("held", on="lower.bottom", of=["displacement"]),
    )
    solution = abut.solve(two_blocks(*probes, solve=abut.SolveOptions(steps=3)))
    abut.write(solution, tmp_path)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert [[p["name"] for p in step["probes"]] for step in summary["steps"]] == [[p.name for p in probes]] * 3
    assert [p["file"] for p in summary["steps"][0]["probes"]] == [
        "probe_mid_point.csv", "probe_top.csv", "probe_edge.csv", "probe_held.csv",
    ]  # fmt: skip
    for number, (step, said) in enumerate(zip(solution.steps, summary["steps"])):
        for result, few in zip(step.probes, said["probes"]):
            rows = table(tmp_path / few["file"])
            own = [row for row in rows if row["step"] == str(number + 1)]
            assert len(own) == len(result.points) == few["points"]
            for name, values in columns(result).items():
                listed = [float(row[name]) if row[name] else np.nan for row in own]
                assert listed == pytest.approx(values.tolist(), nan_ok=True, rel=1e-15, abs=0), name
                assert few[name] == peaks(result)[name]
            assert [float(row["x"]) for row in own] == pytest.approx(result.points[:, 0])
    edge = table(tmp_path / "probe_edge.csv")
    assert [row["pressure"] == "" for row in edge[:9]] == [True, True] + [False] * 5 + [True, True]
    assert [row["distance"] for row in edge[:2]] == ["0.0", "0.175"]
    assert "node" in table(tmp_path / "probe_held.csv")[0]
    history = table(tmp_path / "history.csv")
    assert [row["probe"] for row in history if row["step"] == "2"] == ["", *(p.name for p in probes)]
    of_point = [row for row in history if row["probe"] == "mid point"]
    assert [float(row["displacement_y"]) for row in of_point] == pytest.approx(
        [step.probes[0].values["displacement"][0, 1] for step in solution.steps], rel=1e-15
    )
    assert of_point[0]["pressure"] == of_point[0]["max_pressure"] == ""
    assert float(history[0]["max_pressure"]) == solution.steps[0].contacts[0].max_pressure


def test_every_step_has_its_own_values() -> None:
    """Where contact does not change, everything is proportional to the time."""
    model = two_blocks(abut.Probe("spot", at=[1.0, 0.5]), solve=abut.SolveOptions(times=(0.25, 1.0)))
    quarter, whole = (step.probes[0].values for step in abut.solve(model).steps)
    for name in ("displacement", "stress", "von_mises"):
        assert 4.0 * quarter[name] == pytest.approx(whole[name], rel=1e-9, abs=1e-9)


def test_peaks_keep_their_sign() -> None:
    """Of several points the value farthest from zero; what is missing does not count, and where all is there is none."""
    nothing = np.full(3, np.nan)
    values = {
        "displacement": np.array([[1.0, 0.0], [-3.0, 0.5], [2.0, 0.25]]),
        "pressure": np.array([np.nan, 2.0, 1.0]),
        "gap": nothing,
    }
    result = abut.state.ProbeResult("p", np.zeros((3, 2)), None, None, values)
    assert peaks(result) == {"displacement_x": -3.0, "displacement_y": 0.5, "pressure": 2.0, "gap": None}


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_without_probes_files_are_as_before(tmp_path: Path) -> None:
    abut.write(abut.solve(two_blocks()), tmp_path)
    head = (tmp_path / "history.csv").read_text().splitlines()[0]
    assert head == "step,factor,converged,contact,force_x,force_y,max_pressure,area,max_penetration,active"
    assert "<h2>Probes</h2>" not in (tmp_path / "report.html").read_text()
    assert not list(tmp_path.glob("probe_*"))


def test_the_report_shows_them(tmp_path: Path) -> None:
    """A table with units, lines over their length, points over time; broken where there is no value."""
    probes = (
        abut.Probe("<b>spot</b>", at=[1.0, 0.5]),
        abut.Probe("edge", line=([0.3, 1.0], [1.7, 1.0]), points=9, of=["pressure", "gap"]),
        abut.Probe("held", on="lower.bottom", of=["displacement"]),
    )
    solution = abut.solve(two_blocks(*probes, solve=abut.SolveOptions(steps=2)))
    page = Page(write_report(solution, tmp_path / "report.html"))
    for words in ("Probes", "<b>spot</b>", "at (1, 0.5)", "9 points from (0.3, 1) to (1.7, 1)", "displacement [length]",
                  "stress xx yy zz xy yz zx [force/length²]", "von Mises [force/length²]", "pressure [force/length²]",
                  "gap [length]", "nodes of lower.bottom", f"{peaks(solution.probes[1])['pressure']:.6g}"):  # fmt: skip
        assert words in page.text, words
    charts = {chart["title"]: chart for chart in json.loads(page.data)["probes"]}
    assert list(charts) == [
        "<b>spot</b>: displacement [length]",
        "<b>spot</b>: stress [force/length²]",
        "edge: pressure [force/length²] in the last step",
        "held: displacement [length], value farthest from zero",
    ]
    stress = charts["<b>spot</b>: stress [force/length²]"]
    assert [s["label"] for s in stress["series"]] == ["stress xx", "stress yy", "stress zz", "stress xy", "von Mises"]
    assert stress["x"] == [0.5, 1.0]
    edge = charts["edge: pressure [force/length²] in the last step"]
    assert edge["x"] == pytest.approx(np.linspace(0.0, 1.4, 9), rel=1e-6, abs=1e-12)
    assert [s["label"] for s in edge["series"]] == ["pressure"]  # the gap is rounding all along, and left out
    assert edge["series"][0]["values"][:2] == [None, None]
    assert edge["series"][0]["values"][2:7] == pytest.approx(solution.probes[1].values["pressure"][2:7], rel=1e-6)
    one = abut.solve(two_blocks(probes[0]))
    page = Page(write_report(one, tmp_path / "one.html"))
    assert json.loads(page.data)["probes"] == []
    assert f"{one.probes[0].values['von_mises'][0]:.6g}" in page.text


def test_theory_may_speak_of_probes() -> None:
    from abut.report.origin import comparison, quantities

    solution = abut.solve(two_blocks(abut.Probe("spot", at=[1.0, 0.5])))
    value = solution.probes[0].values["stress"][0, 1]
    assert quantities(solution.steps[-1])["probe.spot.stress_yy"] == value
    (row,) = comparison(solution, {"probe.spot.stress_yy": {"value": 1.01 * value, "tolerance": 0.02, "source": "x"}})
    assert row["passed"]
    assert row["deviation"] == pytest.approx(-0.01 / 1.01 if value > 0 else 0.01 / 1.01, rel=1e-9)


BAD_RECORDS: dict[str, tuple[dict[str, Any], str]] = {
    "no place": ({}, "give one of at (a point), line, on (a node set or surface); got none of them"),
    "two places": ({"at": [0, 0], "on": "lower.top"}, "got at and on"),
    "one number": ({"at": [1.0]}, "expected 2 or 3 numbers, got 1"),
    "no numbers": ({"at": []}, "expected 2 or 3 numbers, got 0"),
    "a number": ({"at": 3.0}, "expected 2 or 3 numbers, got 3.0"),
    "nan": ({"at": [0.0, float("nan")]}, "expected a finite number"),
    "text": ({"at": ["a", 0]}, "expected a number, got 'a'"),
    "one end": ({"line": [[0, 0]]}, "expected two points, its start and its end, got 1"),
    "no length": ({"line": [[0, 1], [0, 1]]}, "starts where it ends, at (0, 1)"),
    "one point": (
        {"line": [[0, 0], [1, 0]], "points": 1},
        "expected a whole number from 2 (both ends) to 10000, got 1",
    ),
    "half a point": ({"line": [[0, 0], [1, 0]], "points": 2.5}, "expected a whole number from 2"),
    "too many": ({"line": [[0, 0], [1, 0]], "points": 10**9}, "to 10000, got 1000000000"),
    "points of a point": ({"at": [0, 0], "points": 5}, "points is for lines"),
    "unknown quantity": ({"at": [0, 0], "of": ["presure"]}, "did you mean 'pressure'?"),
    "no quantity": ({"at": [0, 0], "of": []}, "the list is empty; leave it out for all"),
    "one word": ({"at": [0, 0], "of": "pressure"}, "expected a list of names, got 'pressure'"),
    "contact for nothing": ({"at": [0, 0], "of": ["stress"], "contact": "blocks"}, "contact is for pressure and gap"),
    "body of a set": ({"on": "lower.top", "body": "lower"}, "body is for points and lines"),
    "no name": ({"name": " ", "at": [0, 0]}, "expected a text that is not empty"),
}


@pytest.mark.parametrize("case", BAD_RECORDS)
def test_records_check_themselves(case: str) -> None:
    given, message = BAD_RECORDS[case]
    with pytest.raises(abut.InputError) as error:
        abut.Probe(**{"name": "p", **given})
    assert message in str(error.value)
    assert case == "no name" or "probe 'p'" in str(error.value)


LINE = ([0.0, 0.5], [2.0, 0.5])
BAD_MODELS: dict[str, tuple[Sequence[dict[str, Any]], str]] = {
    "three numbers in 2D": ([{"at": [0, 0, 0]}], "probes[0].at: expected 2 numbers for a point, got 3"),
    "a line in 3D": ([{"line": [[0, 0], [0, 0, 1]]}], "probes[0].line: expected 2 numbers for a point, got 3"),
    "unknown set": ([{"on": "lower.topp"}], "probes[0].on: no surface or node set named 'lower.topp'; did you mean"),
    "a body is no set": ([{"on": "lower"}], "probes[0].on: no surface or node set named 'lower'"),
    "unknown body": ([{"at": [1, 0.5], "body": "lover"}], "probes[0].body: no body named 'lover'; did you mean 'lower'?"),
    "unknown contact": ([{"at": [1, 1], "contact": "block"}], "no contact named 'block'; did you mean 'blocks'?"),
    "twice": ([{"at": [1, 0.5]}, {"at": [1, 0.6]}], "probes[1].name: 'p' is used twice"),
    "one file": ([{"name": "a b", "at": [1, 0.5]}, {"name": "a_b", "at": [1, 0.6]}], "would have the same name"),
}  # fmt: skip
BAD_PLACES: dict[str, tuple[dict[str, Any], str]] = {
    "outside": ({"at": [1.0, 2.25]}, "(1, 2.25) lies outside every body, 0.25 from the nearest, 'upper'; move it"),
    "outside its body": ({"at": [1.0, 1.5], "body": "lower"}, "lies outside body 'lower', 0.5 from it"),
    "line outside": ({"line": [[0, 1.5], [2, 1.5]], "points": 9}, "4 of its 9 points, the first at (0, 1.5), lie outside"),
    "set off the contact": ({"on": "lower.bottom", "of": ["pressure"]}, "no node of 'lower.bottom' is on a surface of"),
    "beside": ({"at": [1.8, 1.0], "of": ["pressure"], "body": "upper"}, "no point of it lies over surface 'upper.bottom'"),
    "gap of the target": ({"on": "lower.top", "of": ["gap"]}, "is known on its contactor 'upper.bottom'"),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD_MODELS)
def test_models_check_probes(case: str) -> None:
    given, message = BAD_MODELS[case]
    with pytest.raises(abut.InputError) as error:
        two_blocks(*(abut.Probe(**{"name": "p", **one}) for one in given))
    assert message in str(error.value)


@pytest.mark.parametrize("case", BAD_PLACES)
def test_places_are_checked_before_solving(case: str) -> None:
    """By solve before anything else, and by check as an error that stands for exit status 2."""
    given, message = BAD_PLACES[case]
    model = two_blocks(abut.Probe("p", **given))
    told: list[object] = []
    with pytest.raises(abut.InputError) as error:
        abut.solve(model, told.append)
    assert message in str(error.value)
    assert str(error.value).startswith("probe 'p': ")
    assert told == []
    report = check(model)
    assert any(f.severity == "error" and f.where == "probes[0]" and "'p'" in f.line for f in report.findings)
    assert report.status == 2


def test_no_contact_no_pressure() -> None:
    with pytest.raises(abut.InputError, match=r"probes\[0\].of: the model has no contacts, and so no pressure"):
        free(distorted("quad4"), abut.Probe("p", at=[0.5, 0.5], of=["pressure"]))


def test_ambiguous_contacts_are_not_guessed() -> None:
    """A line through a pile crosses two contacts and asks for neither; where it does ask, it must choose."""
    parts = {name: make.rectangle([0, 1], [i, i + 1], cells=[2, 2]) for i, name in enumerate("abc")}
    contacts = [abut.Contact("b.bottom", "a.top", name="low"), abut.Contact("c.bottom", "b.top", name="high")]
    given: dict[str, Any] = {
        "plane": "strain",
        "solids": [abut.Solid(name, STEEL) for name in parts],
        "supports": [
            abut.Support("a.bottom", x=0, y=0),
            abut.Support("c.top", x=0, y=-0.01),
            abut.Support("b.left", x=0),
        ],
        "contacts": contacts,
    }
    through = abut.Probe("p", line=([0.5, 0], [0.5, 3]), points=31)
    mesh = make.join(parts)
    assert find_place(abut.Model(mesh, probes=[through], **given), through).of == (
        "displacement",
        "stress",
        "von-mises",
    )
    for probe, names in (
        (replace(through, of=("pressure",)), "touches"),
        (abut.Probe("p", at=[0.5, 1.5], of=["gap"]), ""),
    ):
        with pytest.raises(abut.InputError, match="of contacts 'low' and 'high'; choose with contact"):
            find_place(abut.Model(mesh, probes=[probe], **given), probe)
        chosen = replace(probe, contact="high")
        place = find_place(abut.Model(mesh, probes=[chosen], **given), chosen)
        assert place.surface is not None
        assert place.surface.contact == 1, names


PROBES = """
[[probes]]
name = "edge"
line = [[1, 5, 10], [9, 5, 10]]
points = 7
of = ["pressure", "gap"]

[[probes]]
name = "spot"
at = [5, 5, 5]

[[probes]]
name = "held"
on = "lower.bottom"
of = ["displacement", "von-mises"]
"""
BAD_JOBS = {
    "two numbers in 3D": ("at = [5, 5, 5]", "at = [5, 5]", "probes[1].at: expected 3 numbers for a point, got 2"),
    "nan": ("at = [5, 5, 5]", "at = [5, 5, nan]", "probes[1].at[2]: expected a finite number"),
    "empty": ("at = [5, 5, 5]", "at = []", "probe 'spot': at: expected 2 or 3 numbers, got 0"),
    "unknown key": ("points = 7", "pionts = 7", "probes[0].pionts: unknown key; did you mean 'points'?"),
    "unknown set": ('"lower.bottom"\nof', '"lower.botom"\nof', "did you mean 'lower.bottom'?"),
    "one point": ("points = 7", "points = 1", "expected a whole number from 2 (both ends)"),
    "unknown quantity": ('"von-mises"', '"mises"', "probes[2].of[1]: expected 'displacement', 'stress', 'von-mises'"),
    "outside": ("at = [5, 5, 5]", "at = [5, 5, 80]", "probe 'spot': (5, 5, 80) lies outside every body"),
    "no name": ('name = "spot"\n', "", "probes[1].name: missing"),
}


@pytest.mark.parametrize("case", BAD_JOBS)
def test_bad_jobs(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old, new, message = BAD_JOBS[case]
    text = TEXT + PROBES
    assert old in text
    job = tmp_path / "job.toml"
    job.write_text(text.replace(old, new))
    for command in ("run", "check"):
        assert main([command, str(job)]) == 2
        printed = capsys.readouterr()
        assert message.partition("; did")[0] in printed.out + printed.err
        assert "Traceback" not in printed.err
    assert [p.name for p in tmp_path.iterdir()] == ["job.toml"]


def test_probes_survive_writing_a_job(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """What is written says the same, and running it reads the same."""
    job = tmp_path / "job.toml"
    job.write_text(TEXT + PROBES)
    write_job(tmp_path / "copy.toml", load_job(job))
    first, second = load_job(job).model, load_job(tmp_path / "copy.toml").model
    assert first.probes == second.probes
    assert first.probes[0] == abut.Probe("edge", line=((1, 5, 10), (9, 5, 10)), points=7, of=("pressure", "gap"))
    capsys.readouterr()
    assert main(["run", str(job)]) == 0
    out = capsys.readouterr().out
    assert "probe 'edge': 7 points, farthest from zero: pressure " in out
    assert "probe 'spot': displacement_x " in out
    summary = json.loads((tmp_path / "results" / "summary.json").read_text())
    assert [p["name"] for p in summary["steps"][0]["probes"]] == ["edge", "spot", "held"]
    assert len(table(tmp_path / "results" / "probe_held.csv")) == summary["steps"][0]["probes"][2]["points"]


def test_a_restart_has_the_probes_of_all_steps(tmp_path: Path) -> None:
    """Steps done before are read anew, also by probes that came later: they do not change what is solved."""
    from abut.errors import Stopped
    from abut.io.stream import Stream

    job = tmp_path / "job.toml"
    text = TEXT + "\n[solve]\nsteps = 3\n"
    job.write_text(text + PROBES)
    whole = abut.solve(load_job(job).model)
    job.write_text(text)
    loaded = load_job(job)

    def stop(item: object) -> None:
        if getattr(item, "step", 0) == 3:
            raise Stopped("now")

    with pytest.raises(Stopped), Stream(loaded.directory, description(loaded.model)) as stream:
        abut.analysis.solve(loaded.model, stop, stream.step)
    job.write_text(text + PROBES)
    assert main(["run", str(job), "--restart", "--quiet"]) == 0
    rows = table(tmp_path / "results" / "probe_spot.csv")
    assert [row["step"] for row in rows] == ["1", "2", "3"]
    exact = [step.probes[1].values["displacement"][0, 2] for step in whole.steps]
    assert [float(row["displacement_z"]) for row in rows] == pytest.approx(exact, rel=1e-9)


def test_results_come_step_by_step(tmp_path: Path) -> None:
    """After the first of two steps its rows are on disk."""
    from abut.io.stream import Stream

    model = two_blocks(abut.Probe("spot", at=[1.0, 0.5]), solve=abut.SolveOptions(steps=2))
    seen = []
    with Stream(tmp_path, description(model)) as stream:

        def keep(solution: abut.Solution, saved: Any) -> None:
            stream.step(solution, saved)
            seen.append(len(table(tmp_path / "probe_spot.csv")))

        abut.analysis.solve(model, None, keep)
    assert seen == [1, 2]


def test_units_do_not_matter() -> None:
    """In metres, millimetres and nanometres the same points are inside, and outside."""
    for unit in (1e-9, 1.0, 1e3):
        mesh = distorted("hex20", curved=True)
        mesh = replace(mesh, points=unit * mesh.points)
        around = boxes(mesh)
        points = in_cells(mesh, 10)
        inside = locate(mesh, around, points)
        assert len(inside.outside) == 0
        assert np.abs(inside.weights @ mesh.points - points).max() < 1e-13 * unit
        assert len(locate(mesh, around, points + 10.0 * unit).outside) == len(points)
