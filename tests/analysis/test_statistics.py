"""Numbers of a contact: pressure over the loaded area, centre of pressure, moments, nodal forces; each against theory."""

from __future__ import annotations

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.analysis.statistics import pressure_statistics, quantile, resultant
from abut.benchmarks.hertz import HALF_WIDTH, LINE_FORCE, LINE_PEAK
from abut.cli import main
from abut.job import load_job
from abut.mesh import make
from abut.output.contact_rows import contact_summary
from abut.report.contact_words import lines
from abut.report.scene import scene
from abut.solution.grids import CONTACTOR, TARGET, contact_grid
from models.patch import CELL_OF, model, two_blocks

ROOT = Path(__file__).parents[2]
STEEL = abut.LinearElastic(1000.0, 0.3)
EXACT = 1e-12
SPACES = ("auto", "P0", "P1", "P1-discontinuous", "P2", "dual", "dual-P1")  # P2-discontinuous swings and opens


def assert_balanced(step: abut.Step) -> None:
    """Nodal forces of both sides add up to the resultant and to nothing, moments too, and bodies share the target's."""
    for contact in step.contacts:
        size = np.linalg.norm(contact.contactor_forces, axis=1).sum()
        assert size > 0.0
        assert np.abs(contact.contactor_forces.sum(axis=0) - contact.force).max() <= EXACT * size
        assert np.abs(contact.target_forces.sum(axis=0) + contact.force).max() <= EXACT * size
        assert np.abs(sum(contact.body_forces.values()) + contact.force).max() <= EXACT * size
        for side, sign, forces in ((CONTACTOR, 1.0, contact.contactor_forces), (TARGET, -1.0, contact.target_forces)):
            grid = contact_grid(step, contact, (side,))
            surface = contact.contactor if side == CONTACTOR else contact.target
            node, first = np.unique(grid.point_data["node"], return_index=True)
            assert (node == surface.node_ids).all()
            dim = surface.dim
            assert (grid.point_data["contact_force"][first, :dim] == forces).all()
            total = grid.point_data["contact_force"][first].sum(axis=0)[:dim]
            assert np.abs(total - sign * contact.force).max() <= EXACT * size


@pytest.mark.parametrize("facet", ["line2", "line3", "quad4", "quad8", "tri3", "tri6", "quad9"])
def test_uniform_pressure(facet: str) -> None:
    """Mean, percentile and largest are the pressure, the centre is that of the unit interface, and the moment is its arm
    times the force: all of the resultant is known, the blocks' sizes and positions being so."""
    if facet.startswith("line"):
        cell = {"line2": "quad4", "line3": "quad8"}[facet]
        built = model(two_blocks(cell, cell, ((5, 3), (4, 3))))
        turn, centre = np.eye(2), np.array([0.5, 1.0])
    else:
        built = model(two_blocks(CELL_OF[facet], CELL_OF[facet], ((3, 3, 2), (2, 2, 2))), rotate=False)
        turn, centre = np.eye(3), np.array([0.5, 0.5, 1.0])
    step = abut.solve(built).steps[-1]
    contact, p = step.contacts[0], built.loads[0].value
    s = contact.statistics
    assert [s.largest, s.mean, s.percentile_95, contact.max_pressure] == pytest.approx([p] * 4, rel=1e-9)
    assert s.area == pytest.approx(1.0, rel=1e-9)
    assert np.isnan(s.partly_covered)
    force = turn @ np.eye(built.mesh.dim)[-1] * -p
    assert contact.resultant.force == pytest.approx(force, abs=1e-9 * p)
    assert contact.resultant.centre == pytest.approx(centre, abs=1e-9)
    moment = np.cross(centre, force) if len(centre) == 3 else [centre[0] * force[1] - centre[1] * force[0]]
    assert contact.resultant.moment == pytest.approx(np.atleast_1d(moment), abs=1e-9 * p)
    assert_balanced(step)


def bent(scale: float = 1.0, load: float = 1.0, **contact: object) -> abut.Solution:
    """A column on a column of the same width under p(x) = 3 - 2 x on [0, 1], closed throughout, free to bend: whatever the
    method, the contact force and its line of action are given by the upper column's balance."""
    parts = {
        "lower": make.rectangle([0, scale], [0, scale], cells=[6, 6], cell="quad8"),
        "upper": make.rectangle([0, scale], [scale, 2 * scale], cells=[6, 6], cell="quad8"),
    }

    def down(x: np.ndarray) -> np.ndarray:
        return np.column_stack([0.0 * x[:, 0], -load * (3.0 - 2.0 * x[:, 0] / scale)])

    return abut.solve(
        abut.Model(
            make.join(parts),
            [abut.Solid(body, abut.LinearElastic(1000.0 * load, 0.0)) for body in parts],
            [abut.Support("lower.bottom", y=0)],
            [abut.Traction("upper.top", down)],
            [abut.Contact(contactor="upper.bottom", target="lower.top", name="columns", **contact)],
            plane="strain",
        )
    )


NODES = {"method": "node-to-segment"}
WAYS = [*({"pressure": p} for p in SPACES), NODES, {"kind": "tied"}, {"kind": "tied", "pressure": "P0"}]


@pytest.mark.parametrize("contact", WAYS, ids=lambda way: "-".join(way.values()))
def test_linear_pressure(contact: dict[str, str]) -> None:
    """Force 2 and centre int x p / 2 = 5/12 to rounding in every space and method; mean 2; the percentile 2.9 within what
    the pressure changes over half a facet (a whole one where it is constant on facets)."""
    step = bent(**contact).steps[-1]
    (own,) = step.contacts
    assert own.resultant.force == pytest.approx([0.0, 2.0], abs=1e-9)
    assert own.resultant.centre == pytest.approx([5.0 / 12.0, 1.0], abs=1e-9)
    assert own.resultant.moment == pytest.approx([5.0 / 6.0], abs=1e-9)
    assert own.statistics.mean == pytest.approx(2.0, rel=1e-9)
    assert own.statistics.area == pytest.approx(1.0, rel=1e-9)
    facet = 2.0 / 6.0
    assert own.statistics.percentile_95 == pytest.approx(
        2.9, abs=facet if contact.get("pressure") == "P0" else facet / 2
    )
    assert own.statistics.percentile_95 <= own.max_pressure
    assert own.statistics.place == pytest.approx([0.0, 1.0], abs=1e-12)
    assert_balanced(step)


def test_other_units() -> None:
    """Lengths in other units and other forces: every number in proportion, to rounding."""
    (one,), (two,) = bent().contacts, bent(scale=1e3, load=1e-9).contacts
    for name, unit in (("largest", 1e-9), ("mean", 1e-9), ("percentile_95", 1e-9), ("area", 1e3), ("place", 1e3)):
        assert getattr(two.statistics, name) == pytest.approx(unit * getattr(one.statistics, name), rel=1e-9), name
    for name, unit in (("force", 1e-6), ("moment", 1e-3), ("centre", 1e3)):
        first = getattr(one.resultant, name)
        size = np.abs(first).max()
        assert getattr(two.resultant, name) / unit == pytest.approx(first, rel=1e-9, abs=1e-9 * size), name


@pytest.mark.parametrize("cell", ["quad4", "quad8"])
def test_hertz_line(cell: str) -> None:
    """The mean of an elliptic pressure is pi/4 of the largest; the width of contact is known to half a facet of a tenth of
    the half width, 2.5 % of the area. The force is given, its line of action is the axis of symmetry. Pressures act between
    both sides' normals, at a share s = 70 / (70 + 210) of x / R from the block's, (R2): their sum is 1 + (s a / R)^2 / 8 of
    it."""
    (own,) = abut.solve(load_job(ROOT / "examples" / "hertz-line" / f"{cell}.toml").model).contacts
    lean = 0.25 * HALF_WIDTH / 50.0
    assert own.statistics.mean == pytest.approx(np.pi / 4.0 * LINE_PEAK, rel=0.03)
    assert own.statistics.area == pytest.approx(own.area, rel=1e-9)
    assert own.statistics.mean * own.statistics.area == pytest.approx(LINE_FORCE * (1.0 + lean**2 / 8.0), rel=1e-6)
    assert own.statistics.percentile_95 == pytest.approx(np.sqrt(1.0 - 0.05**2) * LINE_PEAK, rel=0.01)
    assert own.resultant.centre == pytest.approx([0.0, 0.0], abs=1e-9 * HALF_WIDTH)
    assert own.statistics.place == pytest.approx([0.0, 0.0], abs=0.1 * HALF_WIDTH)


@pytest.mark.parametrize("cell", ["quad4", "quad8"])
def test_axisymmetric(cell: str) -> None:
    """A cylinder under uniform pressure: the force of the whole turn, centre on the axis, no moment."""
    parts = {
        "lower": make.rectangle(y=(0, 1), cells=(3, 3), cell=cell),
        "upper": make.rectangle(y=(1, 2), cells=(4, 3), cell=cell),
    }
    step = abut.solve(
        abut.Model(
            make.join(parts),
            [abut.Solid(body, STEEL) for body in parts],
            [abut.Support("lower.bottom", y=0)],
            [abut.Pressure("upper.top", 2.0)],
            [abut.Contact(contactor="upper.bottom", target="lower.top")],
            plane="axisymmetric",
        )
    ).steps[-1]
    (own,) = step.contacts
    s = own.statistics
    assert [s.largest, s.mean, s.percentile_95, s.area] == pytest.approx([2.0, 2.0, 2.0, np.pi], rel=1e-9)
    assert own.resultant.force[1] == pytest.approx(2.0 * np.pi, rel=1e-9)
    assert own.resultant.centre == pytest.approx([0.0, 1.0], abs=1e-9)
    assert (own.resultant.moment == 0.0).all()
    assert_balanced(step)


@pytest.mark.parametrize("joined", [False, True])
def test_a_target_of_two_bodies(joined: bool) -> None:
    """Uniform pressure on a surface of which a quarter belongs to one body: that gets a quarter of the force, whether the
    bodies have points of their own or share those between them."""
    upper = make.rectangle([0, 1], [1, 2], cells=[4, 3], cell="quad8")
    if joined:
        mesh = make.join({"left": make.rectangle([0, 1], [0, 1], cells=[8, 2], cell="quad8"), "upper": upper})
        own = mesh.bodies["left"]
        middle = np.array([mesh.points[n].mean(axis=0)[0] for _, nodes, _ in mesh.cells_of("left") for n in nodes])
        bodies = {**mesh.bodies, "left": own[middle < 0.25], "right": own[middle > 0.25]}
        mesh = replace(mesh, bodies=bodies)
        target, held = "left.top", ["left.bottom"]
    else:
        left = make.rectangle([0, 0.25], [0, 1], cells=[2, 2], cell="quad8")
        right = make.rectangle([0.25, 1], [0, 1], cells=[5, 2], cell="quad8")
        mesh = make.join({"left": left, "right": right, "upper": upper})
        both = np.concatenate([mesh.surfaces["left.top"], mesh.surfaces["right.top"]])
        mesh = replace(mesh, surfaces={**mesh.surfaces, "tops": both})
        target, held = "tops", ["left.bottom", "right.bottom"]
    soft = abut.LinearElastic(1000.0, 0.0)
    solution = abut.solve(
        abut.Model(
            mesh,
            [abut.Solid(body, soft) for body in mesh.bodies],
            [abut.Support(side, x=0, y=0) for side in held],
            [abut.Pressure("upper.top", 4.0)],
            [abut.Contact(contactor="upper.bottom", target=target)],
            plane="strain",
        )
    )
    (own,) = solution.contacts
    assert list(own.body_forces) == ["left", "right"]
    assert own.body_forces["left"] == pytest.approx([0.0, -1.0], abs=1e-9)
    assert own.body_forces["right"] == pytest.approx([0.0, -3.0], abs=1e-9)
    assert any("left (0, -1), right (0, -3)" in line for line in lines(own))
    assert_balanced(solution.steps[-1])


def over_a_hole(cell: str = "quad4") -> abut.Solution:
    """A contactor with facets of 1/4 over a narrower target, which covers a fifth of the facet beyond x = 1/2."""
    lower = make.rectangle([0, 0.55], [0, 1], cells=[11, 10], cell=cell)
    upper = make.rectangle([0, 1], [1, 2], cells=[4, 4], cell=cell)
    return abut.solve(
        abut.Model(
            make.join({"lower": lower, "upper": upper}),
            [abut.Solid("lower", STEEL), abut.Solid("upper", STEEL)],
            [abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0, y=-0.01)],
            contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", pressure="P1")],
            plane="strain",
        )
    )


@pytest.mark.long
def test_a_node_over_nothing_sets_no_scale(tmp_path: Path) -> None:
    """Beside the target's edge a node has 2 % of its support covered, where the pressure of an edge is: it is larger than
    elsewhere, and named apart; headline, place and colours are those of the other nodes."""
    solution = over_a_hole()
    (own,) = solution.contacts
    s = own.statistics
    assert s.partly_covered > own.max_pressure > 0.0
    assert np.nanmax(own.pressure) == s.partly_covered
    assert own.max_pressure == s.largest == np.nanmax(own.pressure[own.share >= 0.5])
    assert s.place[0] <= 0.5
    assert max(s.percentile_95, s.mean) <= s.largest
    assert scene(solution).data["ranges"]["pressure"] == [[0.0, own.max_pressure]]
    summary = contact_summary(own)
    assert summary["max_pressure_partly_covered"] == s.partly_covered
    assert any(f"{s.partly_covered:.6g}" in line for line in lines(own))
    pytest.importorskip("pyvista")
    plotter = solution.plot(path=tmp_path / "picture.png")
    assert plotter.mapper.scalar_range == pytest.approx((0.0, own.max_pressure))


def test_what_is_hardly_covered_counts_nowhere() -> None:
    """Of a quadratic facet also the middle node counts only where both its corners do."""
    mesh = make.join({"body": make.rectangle([0, 2], [0, 1], cells=[2, 1], cell="quad8")})
    surface = mesh.surface("body.top")
    x = surface.points[np.maximum(surface.nodes, 0), 0]
    pressure = np.where(surface.nodes >= 0, np.choose(np.round(x).astype(int), [3.0, 3.0, 30.0]), np.nan)
    pressure[np.isclose(x, 1.5) & (surface.nodes >= 0)] = 16.5
    share = np.where(surface.nodes >= 0, np.interp(x, [0.0, 1.0, 2.0], [1.0, 1.0, 0.4]), np.nan)
    area = np.zeros_like(share)
    area[:, :2] = 0.5
    load = area * np.nan_to_num(pressure)
    result = pressure_statistics(surface, pressure, load, area, share)
    assert (result.largest, result.mean, result.percentile_95, result.area) == (3.0, 3.0, 3.0, 1.5)
    assert result.partly_covered == 30.0


def test_what_is_hardly_covered_counts_where_nothing_else_presses() -> None:
    """Under an edge of the target a node less than half covered may carry all of the force."""
    mesh = make.join({"body": make.rectangle([0, 3], [0, 1], cells=[3, 1], cell="quad4")})
    surface = mesh.surface("body.top")
    x = surface.points[np.maximum(surface.nodes, 0), 0]
    there = surface.nodes >= 0
    pressure = np.where(there, np.where(x > 2.5, 30.0, 0.0), np.nan)
    share = np.where(there, np.where(x > 2.5, 0.4, 1.0), np.nan)
    area = np.where(there & (x > 2.5), 0.2, 0.0)
    result = pressure_statistics(surface, pressure, area * 30.0, area, share)
    assert (result.largest, result.mean, result.area) == (30.0, pytest.approx(30.0), pytest.approx(0.2))
    assert result.place.tolist() == [3.0, 1.0]
    assert np.isnan(result.partly_covered)


@pytest.mark.parametrize("kind", ["contact", "tied"])
def test_nothing_pressed(kind: str, tmp_path: Path) -> None:
    """Apart, or tied and pulled: no mean, no place, in files null or nan; the tie still has a centre of its forces."""
    gap = 0.1 if kind == "contact" else 0.0
    lower = make.rectangle([0, 1], [0, 1], cells=[3, 2])
    upper = make.rectangle([0, 1], [1 + gap, 2 + gap], cells=[2, 2])
    soft = abut.LinearElastic(1000.0, 0.0)
    solution = abut.solve(
        abut.Model(
            make.join({"lower": lower, "upper": upper}),
            [abut.Solid("lower", soft), abut.Solid("upper", soft)],
            [abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0, y=0.01)],
            contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", kind=kind)],
            plane="strain",
        )
    )
    abut.write(solution, tmp_path)
    (entry,) = json.loads((tmp_path / "summary.json").read_text())["steps"][0]["contacts"]
    with (tmp_path / "history.csv").open() as file:
        (row,) = csv.DictReader(file)
    for name in ("mean_pressure", "pressure_percentile_95", "max_pressure_at", "max_pressure_partly_covered"):
        assert entry[name] is None, name
    assert entry["loaded_area"] == 0.0
    assert row["mean_pressure"] == "nan"
    if kind == "tied":
        assert entry["centre_of_pressure"] == pytest.approx([0.5, 1.0], abs=1e-9)
    else:
        assert entry["centre_of_pressure"] is None
        assert entry["moment"] == [0.0]
        assert lines(solution.contacts[0]) == []


def test_wrench_in_space() -> None:
    """Two forces that do not lie in one plane: on the central axis moment and force are parallel, wherever the origin is."""
    x = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    f = np.array([[0.0, 0.1, 1.0], [0.3, 0.0, 2.0], [0.0, -0.2, 1.5]])
    for shift in (np.zeros(3), np.array([5.0, -7.0, 11.0])):
        result = resultant(x + shift, f)
        left = result.moment - np.cross(result.centre, result.force)
        assert np.abs(np.cross(left, result.force)).max() < 1e-12
        assert result.centre - shift == pytest.approx(resultant(x, f).centre, abs=1e-12)
    plane = resultant(x, f * [0.0, 0.0, 1.0])
    assert plane.centre == pytest.approx([4.0 / 4.5, 1.5 / 4.5, 0.0], abs=1e-12)
    assert np.isnan(resultant(x[:2], np.array([[0.0, 0.0, 1.0], [0.0, 0.0, 1e-14 - 1.0]])).centre).all()


def test_centre_on_a_curve() -> None:
    """Along the line of action it is as high as the mean of the nodes, by their forces; nodes without any do not count."""
    x = np.array([[-1.0, 1.0], [1.0, 1.0], [0.0, 0.0], [0.0, 9.0]])
    f = np.array([[0.5, 1.0], [-0.5, 1.0], [0.0, 2.0], [0.0, 0.0]])
    assert resultant(x, f).centre == pytest.approx([0.0, 0.5], abs=1e-12)
    assert np.isnan(resultant(x, f, nothing=True).centre).all()


def test_centre_in_the_plane() -> None:
    """Oblique forces that do not meet in one point: about the centre they have no moment, wherever the origin is, and it
    is the foot of the nodes' mean, weighted by their forces along the resultant."""
    x = np.array([[0.0, 0.0], [2.0, 0.0], [0.0, 1.0]])
    f = np.array([[0.0, 1.0], [0.6, 2.0], [-0.2, 1.5]])
    for shift in (np.zeros(2), np.array([5.0, -7.0])):
        result = resultant(x + shift, f)
        arms = x + shift - result.centre
        assert abs(float((arms[:, 0] * f[:, 1] - arms[:, 1] * f[:, 0]).sum())) < 1e-12
        along = result.force / np.linalg.norm(result.force)
        mean = shift + (f @ along) @ x / (f @ along).sum()
        assert (result.centre - mean) @ along == pytest.approx(0.0, abs=1e-12)
        assert np.linalg.norm(result.centre - mean) > 0.01


def test_what_unloading_leaves_is_nothing() -> None:
    """Pressed, then moved apart by less than rounding: pressures below a millionth of those before are none."""
    lower, upper = make.rectangle([0, 1], [0, 1], cells=[3, 2]), make.rectangle([0, 1], [1, 2], cells=[2, 2])
    soft = abut.LinearElastic(1000.0, 0.0)
    released = abut.Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, 1e-9)))
    model = abut.Model(
        make.join({"lower": lower, "upper": upper}),
        [abut.Solid("lower", soft), abut.Solid("upper", soft)],
        [
            abut.Support("lower.bottom", x=0, y=0),
            abut.Support("upper.top", x=0, y=-0.01, amplitude=released),
        ],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top")],
        plane="strain",
        solve=abut.SolveOptions(steps=2),
    )
    pressed, left = (step.contacts[0] for step in abut.solve(model).steps)
    assert pressed.statistics.mean == pytest.approx(5.0, rel=1e-9)
    assert 0.0 < left.max_pressure < 1e-8
    assert np.isnan(left.statistics.mean)
    assert np.isnan(left.statistics.place).all()
    assert np.isnan(left.resultant.centre).all()


def test_quantile() -> None:
    """Of a linear field by equal pieces exact inside; equal values count as one, in whatever order; none of nothing."""
    x = np.linspace(0.05, 0.95, 10)
    assert quantile(x, np.full(10, 0.1), 0.8) == pytest.approx(0.8)
    twice = np.repeat(x, 3)[::-1] * (1.0 + 1e-14 * np.arange(30))
    assert quantile(twice, np.full(30, 0.1 / 3), 0.8) == pytest.approx(0.8)
    assert quantile(np.array([1.0, 5.0]), np.array([0.99, 0.01]), 0.95) < 5.0
    assert np.isnan(quantile(np.zeros(0), np.zeros(0), 0.95))


def test_files_and_the_end_of_a_run(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """New keys and columns come after those that were there, and say what Python says."""
    job = tmp_path / "job.toml"
    job.write_text((ROOT / "examples" / "two-blocks" / "job.toml").read_text())
    assert main(["run", str(job)]) == 0
    said = capsys.readouterr().out
    (own,) = abut.solve(load_job(job).model).contacts
    assert all(f"  {line}\n" in said for line in lines(own))
    assert f"mean {own.statistics.mean:.6g}" in said
    tour = (ROOT / "docs" / "tour.md").read_text(encoding="utf-8")
    assert all(f"  {line}\n" in tour for line in lines(own))
    (folder,) = (path.parent for path in tmp_path.rglob("summary.json"))
    (entry,) = json.loads((folder / "summary.json").read_text())["steps"][-1]["contacts"]
    assert entry["mean_pressure"] == pytest.approx(own.statistics.mean, rel=1e-9)
    assert entry["max_pressure_at"] == pytest.approx(own.statistics.place, rel=1e-9)
    assert entry["centre_of_pressure"] == pytest.approx([5.0, 5.0, 10.0], rel=1e-6)
    assert entry["moment"] == pytest.approx(own.resultant.moment, rel=1e-9, abs=1e-6)
    assert entry["target_forces"]["lower"] == pytest.approx(-own.force, rel=1e-9, abs=1e-6)
    with (folder / "history.csv").open() as file:
        reader = csv.DictReader(file)
        rows = list(reader)
    head = ["step", "factor", "converged", "contact", "force_x", "force_y", "force_z"]
    head += ["max_pressure", "area", "max_penetration", "active"]
    assert (reader.fieldnames or [])[: len(head)] == head
    assert float(rows[-1]["centre_z"]) == pytest.approx(10.0)
    assert float(rows[-1]["contact_moment_x"]) == pytest.approx(own.resultant.moment[0], rel=1e-9)
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert "centre of pressure" in page
    assert "(2, 2, 10)" in page
