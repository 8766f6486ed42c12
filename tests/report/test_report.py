"""The report: one file that stands alone, whose arrays are the solution's, and which a browser draws without complaint."""

from __future__ import annotations

import json
import re
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.cli import main
from abut.mesh import make
from abut.report import Origin, read_origin, write_report
from abut.report.arrays import size
from abut.report.friction import arrow_nodes, at_arrows
from abut.report.lines import pressure_lines
from abut.report.origin import comparison
from abut.report.scene import scene, thin
from abut.report.surface_triangles import patch, skin
from models.friction import FRICTION, pushed
from models.page import BROWSER, Page, in_browser
from models.twisted import twisted

STEEL = abut.LinearElastic(1000.0, 0.3)
HOSTILE = '</script><b onclick="x">&amp;'


def solution_of(cell: str, steps: int = 1, name: str = "blocks", plane: str = "strain") -> abut.Solution:
    """A small block on a larger one."""
    if cell.startswith(("tri", "quad")):
        lower = make.rectangle([0, 2], [0, 1], cells=[4, 2], cell=cell)
        upper = make.rectangle([0, 1], [1, 2], cells=[3, 2], cell=cell)
        hold, push = {"y": 0} if plane == "axisymmetric" else {"x": 0, "y": 0}, {"y": -0.01}
        hold, push = ({"x": 0, **hold}, {"x": 0, **push})
    else:
        lower = make.box([0, 2], [0, 2], [0, 1], cells=[3, 3, 2], cell=cell)
        upper = make.box([0.5, 1.5], [0.5, 1.5], [1, 2], cells=[3, 3, 2], cell=cell)
        hold, push = {"x": 0, "y": 0, "z": 0}, {"x": 0, "y": 0, "z": -0.01}
    return abut.solve(
        abut.Model(
            make.join({"lower": lower, "upper": upper}),
            plane=None if lower.dim == 3 else plane,
            solids=[abut.Solid("lower", STEEL), abut.Solid("upper", STEEL)],
            supports=[abut.Support("lower.bottom", **hold), abut.Support("upper.top", **push)],
            contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", name=name)],
            solve=abut.SolveOptions(steps=steps),
        )
    )


def unpack(array: np.ndarray) -> np.ndarray:
    return array.ravel()


@pytest.mark.parametrize("cell", ["tet4", "tet10", "hex8", "hex20", "hex27", "wedge6", "wedge15"])
def test_skins_are_closed(cell: str) -> None:
    """Skin and contact facets of a body together bound it: by the divergence theorem their triangles enclose its volume,
    and none of the area is missing (flat bodies: exactly)."""
    solution = solution_of(cell)
    mesh, data = solution.model.mesh, scene(solution).data
    for number, body in enumerate(data["bodies"]):
        parts = [(body["points"], body["triangles"])]
        parts += [(side["points"], side["cells"]) for side in data["contacts"] if side["body"] == number]
        area = volume = 0.0
        for points, triangles in parts:
            x = unpack(points).reshape(-1, 3).astype(float)[unpack(triangles).reshape(-1, 3)]
            normal = 0.5 * np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
            area += np.linalg.norm(normal, axis=1).sum()
            volume += np.einsum("ij,ij->", normal, x.mean(axis=1)) / 3.0
        size = np.ptp(mesh.points[mesh.nodes_of(body["name"])], axis=0)
        a, b, c = size
        assert volume == pytest.approx(a * b * c, rel=1e-6)  # 32-bit coordinates
        assert area == pytest.approx(2.0 * (a * b + b * c + c * a), rel=1e-6)
        edges = unpack(body["edges"]).reshape(-1, 2)[: body["features"]]
        x = unpack(body["points"]).reshape(-1, 3)[edges]
        along = np.abs(x[:, 1] - x[:, 0])
        assert (np.sort(along, axis=1)[:, :2] < 1e-6).all()  # creases of a box run along the axes
        rim = 2.0 * (a + b)  # where the contact facets are left out, their border counts; it is no more than one face's
        assert 4.0 * (a + b + c) - 1e-5 <= along.sum() <= 4.0 * (a + b + c) + rim + 1e-5


@pytest.mark.parametrize("cell", ["tri3", "tri6", "quad4", "quad8", "quad9"])
def test_plane_bodies_are_flat(cell: str) -> None:
    """In 2D the triangles cover each body once, and its creases are its border."""
    data = scene(solution_of(cell)).data
    for body, (area, border) in zip(data["bodies"], ((2.0, 6.0), (1.0, 4.0))):
        x = unpack(body["points"]).reshape(-1, 3).astype(float)
        t = x[unpack(body["triangles"]).reshape(-1, 3)]
        assert 0.5 * np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])[:, 2].sum() == pytest.approx(area, rel=1e-6)
        sides = np.sort(unpack(body["triangles"]).reshape(-1, 3)[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        sides, count = np.unique(sides, axis=0, return_counts=True)
        assert count.max() == 2  # neighbours meet edge to edge, and none lies on another
        assert np.linalg.norm(np.diff(x[sides[count == 1]], axis=1), axis=2).sum() == pytest.approx(border, rel=1e-6)
        e = x[unpack(body["edges"]).reshape(-1, 2)[: body["features"]]]
        assert np.linalg.norm(e[:, 1] - e[:, 0], axis=1).sum() == pytest.approx(border, rel=1e-6)


@pytest.mark.parametrize("cell", ["hex20", "quad8"])
def test_page_stands_alone(cell: str, tmp_path: Path) -> None:
    """Nothing is fetched from elsewhere, every section is there, and the numbers are the solution's."""
    solution = solution_of(cell, steps=3)
    path = write_report(solution, tmp_path / "report.html", Origin("A job", "schema = 1"))
    page = Page(path)
    assert page.addresses == []
    assert "url(" not in re.sub(r"url\(#", "", path.read_text(encoding="utf-8"))
    for words in ("A job", "Certificate", "Convergence", "schema = 1", "model balance", "upper.bottom", "young 1000"):
        assert words in page.text
    assert f"all {len(solution.certificate)} checks pass" in page.text
    data = json.loads(page.data)
    assert len(data["scene"]["steps"]) == 3
    assert data["history"]["contacts"][0]["force"] == pytest.approx(
        [float(np.linalg.norm(step.contacts[0].force)) for step in solution.steps], rel=1e-6
    )
    assert len(data["convergence"]["residual"]) == sum(len(step.iterations) for step in solution.steps)
    contactor = data["scene"]["steps"][-1]["contacts"][0]
    assert np.nanmax(page.unpack(contactor["pressure"])) >= 0.999 * solution.contacts[0].max_pressure
    dim = solution.model.dim
    moved = np.linalg.norm(page.unpack(contactor["displacement"]).reshape(-1, 3), axis=1)
    own = np.linalg.norm(solution.displacement[solution.contacts[0].contactor.node_ids], axis=1)
    assert moved.max() == pytest.approx(own.max(), rel=0.05)  # parabolas may rise above their nodes
    assert data["scene"]["dim"] == dim


def test_names_cannot_break_the_page(tmp_path: Path) -> None:
    """Names and job text come from anybody's file: they are shown, never obeyed."""
    solution = solution_of("quad4", name=HOSTILE)
    page = Page(write_report(solution, tmp_path / "report.html", Origin(HOSTILE, HOSTILE)))
    assert HOSTILE in page.text
    assert json.loads(page.data)["history"]["contacts"][0]["name"] == HOSTILE
    plain = Page(write_report(solution_of("quad4"), tmp_path / "plain.html", Origin("plain", "text")))
    assert page.tags == plain.tags


def test_a_failed_check_leads_the_page(tmp_path: Path) -> None:
    from dataclasses import replace

    solution = solution_of("quad4")
    contact = solution.contacts[0]
    bad = replace(contact, checks=(replace(contact.checks[0], value=1.0, limit=0.1),))
    step = replace(solution.steps[-1], contacts=(bad,))
    page = Page(write_report(replace(solution, steps=(step,)), tmp_path / "report.html"))
    count = len(replace(solution, steps=(step,)).certificate)
    assert f"1 of {count} checks fail: blocks: {contact.checks[0].name}" in page.text
    page = Page(write_report(replace(solution, steps=(replace(step, converged=False),)), tmp_path / "report.html"))
    assert "Not converged at step 1" in page.text


def test_trouble_comes_before_the_certificate(tmp_path: Path) -> None:
    """Where a run failed with facets and nodes, what to try, and what of a deck was left out."""
    from dataclasses import replace

    from abut.diagnosis.advice import remedies

    solution = solution_of("quad4")
    step = replace(solution.steps[-1], converged=False, cycling={"blocks": np.array([1, 2])})
    model = solution.model
    short = replace(model, solve=replace(model.solve, max_iterations=1))  # more iterations are a remedy
    failed = replace(solution, model=short, steps=(step,), ignored=("*FRICTION (deck.inp:12)",))
    page = Page(write_report(failed, tmp_path / "report.html"))
    assert page.text.index("Not converged") < page.text.index("Certificate")
    assert "the contact status of 2 facets keeps changing: [1, 2]" in page.text
    surface = solution.contacts[0].contactor
    assert ", ".join(map(str, np.unique(surface.nodes[[1, 2], :2]))) in page.text
    assert len(remedies(failed)) == 1
    assert all(str(remedy) in page.text for remedy in remedies(failed))
    assert "*FRICTION (deck.inp:12)" in page.text
    sound = Page(write_report(solution, tmp_path / "sound.html"))
    assert "What to try" not in sound.text
    assert "Left out" not in sound.text


def test_rigid_bodies_show_what_moves_them(tmp_path: Path) -> None:
    tool = make.rectangle([0, 1], [1, 2], cells=[3, 2])
    block = make.rectangle([0, 2], [0, 1], cells=[4, 2])
    model = abut.Model(
        make.join({"block": block, "tool": tool}),
        plane="strain",
        solids=[abut.Solid("block", STEEL)],
        rigid=[abut.Rigid("tool", x=0.0, y=-0.01, rz=0.0)],
        supports=[abut.Support("block.bottom", x=0, y=0)],
        contacts=[abut.Contact(contactor="block.top", target="tool.bottom")],
    )
    solution = abut.solve(model)
    page = Page(write_report(solution, tmp_path / "report.html"))
    force = solution.steps[-1].rigid["tool"].force
    assert force[1] == pytest.approx(solution.contacts[0].force[1], rel=1e-9)
    assert f"{force[1]:.6g}" in page.text


def test_without_contact_there_is_a_report_too(tmp_path: Path) -> None:
    mesh = make.join({"a": make.box([0, 1], [0, 1], [0, 1], cells=[2, 2, 2])})
    model = abut.Model(
        mesh,
        solids=[abut.Solid("a", STEEL)],
        supports=[abut.Support("a.bottom", x=0, y=0, z=0), abut.Support("a.top", z=-0.1)],
    )
    page = Page(write_report(abut.solve(model), tmp_path / "report.html"))
    assert page.scene["contacts"] == []
    assert json.loads(page.data)["lines"] == []


@pytest.mark.parametrize("cell", ["hex20", "quad4"])
def test_a_budget_is_kept_and_said(cell: str) -> None:
    """Too much for the file: steps go first (never the last), then points; what remains are values of the solution."""
    solution = solution_of(cell, steps=6)
    whole = scene(solution)
    total = size(whole.data)
    assert whole.reduced == ()
    fewer = scene(solution, budget=total // 3)
    assert [step["number"] for step in fewer.data["steps"]][-1] == 6
    assert len(fewer.data["steps"]) < 6
    assert any("of 6 steps" in text for text in fewer.reduced)
    assert size(fewer.data) < 1.4 * total / 3 + 5000


def test_thinned_skins_keep_their_shape() -> None:
    """A skin thinned to a tenth lies on the points it had, and bounds about the same box."""
    mesh = make.join({"a": make.box([0, 1], [0, 1], [0, 1], cells=[20, 20, 20])})
    own = skin(mesh, "a", np.empty((0, 2), np.int64))
    few = thin(mesh, own, len(own.nodes) // 10)
    assert len(few.nodes) <= len(own.nodes) // 10
    assert set(few.nodes) <= set(own.nodes)
    x = mesh.points[few.nodes][few.triangles]
    normal = 0.5 * np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0])
    assert np.linalg.norm(normal, axis=1).sum() == pytest.approx(6.0, rel=0.35)


def test_line_of_a_known_pressure() -> None:
    """A pressure that is a parabola over a flat surface comes back along the line: exact to P2, about its largest value, in
    the direction in which it is longest."""
    from dataclasses import replace

    solution = solution_of("hex20")
    contact = solution.contacts[0]
    x = contact.contactor.points[np.maximum(contact.contactor.nodes, 0)]
    along, across = x[..., 0] - 1.0, x[..., 1] - 1.0
    known = np.where(contact.contactor.nodes >= 0, 1.0 - along**2 - 3.0 * across**2, np.nan)
    line = pressure_lines(replace(contact, pressure=known))[0]
    assert line.label == "along x"
    assert line.distance.min() == pytest.approx(-0.5, abs=0.01)
    assert line.distance.max() == pytest.approx(0.5, abs=0.01)
    offset = line.points[:, 1].mean() - 1.0
    assert np.ptp(line.points[:, 1]) < 1e-12
    wanted = 1.0 - (line.points[:, 0] - 1.0) ** 2 - 3.0 * offset**2
    assert line.pressure == pytest.approx(wanted, abs=0.25 * (1.0 / 3.0 / 4.0) ** 2 * 4)  # chords of the parabola
    assert line.distance_from(np.array([1.0, 1.0, 1.0])) == pytest.approx(line.points[:, 0] - 1.0, abs=1e-9)


def test_line_in_2d_is_the_contactor() -> None:
    solution = solution_of("quad8")
    (line,) = pressure_lines(solution.contacts[0])
    assert np.ptp(line.distance) == pytest.approx(1.0, rel=1e-12)
    assert line.points[:, 1] == pytest.approx(1.0)
    force = np.sum(0.5 * (line.pressure[1:] + line.pressure[:-1]) * np.diff(line.distance))
    # Values at nodes, three facets, the last of which ends at a sharp corner: only averages add up to the force exactly.
    assert force == pytest.approx(abs(solution.contacts[0].force[1]), rel=0.03)


def test_patches_show_quadratic_pressures() -> None:
    """A quadratic function on quadratic facets is met at every point of the division."""
    solution = solution_of("hex27")
    surface = solution.contacts[0].contactor
    own = patch(surface)
    f = lambda x: 1.0 + x[..., 0] * x[..., 1] - 2.0 * x[..., 0] ** 2  # noqa: E731
    assert own.of_points(f(surface.points)) == pytest.approx(f(own.points), abs=1e-12)
    assert own.normals == pytest.approx(np.broadcast_to([0.0, 0.0, -1.0], (len(own), 3)), abs=1e-12)


def test_theory_beside_the_job(tmp_path: Path) -> None:
    """expected.json is read by the job's name; one that is somebody else's does no harm."""
    solution = solution_of("quad4")
    job = tmp_path / "punch.toml"
    entry = {"contact.area": {"value": 1.0, "tolerance": 1e-9, "source": "geometry"}}
    (tmp_path / "expected.json").write_text(json.dumps({"punch": entry}))
    origin = read_origin(job, "text")
    (row,) = comparison(solution, origin.expected)
    assert row["passed"]
    assert row["deviation"] == pytest.approx(0.0, abs=1e-9)
    assert "Compared with theory" in Page(write_report(solution, tmp_path / "a.html", origin)).text
    wrong = {"contact.area": {"value": 2.0, "tolerance": 0.1, "source": "geometry"}}
    page = Page(write_report(solution, tmp_path / "a.html", Origin("x", "", wrong)))
    assert "different from theory: area" in page.text
    for text in ("[1, 2]", "{", '{"punch": 3}', '{"punch": {"contact.area": "x", "contact.profile": {"peak": []}}}'):
        (tmp_path / "expected.json").write_text(text)
        assert comparison(solution, read_origin(job, "").expected) == []
        write_report(solution, tmp_path / "a.html", read_origin(job, ""))


def test_run_writes_the_report(tmp_path: Path) -> None:
    job = Path(__file__).parents[2] / "examples" / "two-blocks" / "job.toml"
    assert main(["run", str(job), "--output", str(tmp_path), "--quiet"]) == 0
    page = Page(tmp_path / "report.html")
    assert "two-blocks" in page.text
    assert "Two steel blocks with independent meshes" in page.text


def test_friction_is_in_the_page(tmp_path: Path) -> None:
    """Its table, its numbers over the steps, traction and limit along the line, the words of the fields."""
    solution = abut.solve(pushed())
    page = Page(write_report(solution, tmp_path / "report.html"))
    own = solution.contacts[0].friction
    assert "largest share of the limit" in page.text
    for value in (own.sticking_area, own.force_by_area, own.max_total_slip, own.total_work):
        assert f"{value:.6g}" in page.text
    data = json.loads(page.data)
    history = data["history"]["contacts"][0]["friction"]
    each = [step.contacts[0].friction for step in solution.steps]
    assert history["force"] == pytest.approx([f.force_by_area for f in each], rel=1e-6)
    assert history["work"] == pytest.approx([f.total_work for f in each], rel=1e-6)
    assert history["limit"] == pytest.approx([FRICTION * 200.0] * 5, rel=1e-6)
    line = data["lines"][0]
    assert np.max(line["traction"]) == pytest.approx(own.max_traction, rel=1e-6)
    assert line["limit"] == pytest.approx(FRICTION * np.array(line["pressure"]), rel=1e-5, abs=1e-6)
    assert len(data["convergence"]["slipping"]) == len(data["convergence"]["step"])


def test_no_friction_no_words(tmp_path: Path) -> None:
    page = Page(write_report(solution_of("quad4"), tmp_path / "report.html"))
    assert "riction" not in page.text
    data = json.loads(page.data)
    assert data["history"]["contacts"][0]["friction"] is None
    assert "arrows" not in data["scene"]["contacts"][0]
    assert "traction" not in data["scene"]["steps"][0]["contacts"][0]


def test_rough_contacts_have_no_limit(tmp_path: Path) -> None:
    page = Page(write_report(abut.solve(pushed(friction="rough")), tmp_path / "report.html"))
    assert "no limit" in page.text
    assert json.loads(page.data)["history"]["contacts"][0]["friction"]["limit"] == [None] * 5


def test_arrows_are_the_traction() -> None:
    """Arrows stand at the corners of facets and are the reported traction there; status is drawn in the order of zones."""
    solution = abut.solve(twisted(3))
    data, contact = scene(solution).data, solution.contacts[0]
    side, step = data["contacts"][0], data["steps"][-1]["contacts"][0]
    points, arrows = (unpack(a).reshape(-1, 3) for a in (side["arrows"]["points"], step["arrows"]["traction"]))
    nodes = np.unique(contact.contactor.nodes[:, :4])
    assert points == pytest.approx(solution.model.mesh.points[nodes], abs=1e-6)
    assert np.linalg.norm(arrows, axis=1).max() == pytest.approx(
        np.linalg.norm(contact.friction.traction[:, :4], axis=2).max(),
        rel=1e-5,  # five digits are drawn
    )
    normals = unpack(side["arrows"]["normals"]).reshape(-1, 3)
    assert np.abs(np.einsum("ij,ij->i", normals, arrows)).max() < 1e-5 * np.abs(arrows).max()
    round_ = np.cross([0, 0, 1], points)
    assert (np.einsum("ij,ij->i", round_, arrows) < 0.0).all()  # against the turn
    assert set(np.unique(unpack(step["status"]))) == {1.0}  # slips all over: between open and stuck
    assert unpack(step["traction"]).max() == pytest.approx(contact.friction.max_traction, rel=1e-3)


def test_many_arrows_are_thinned(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("abut.report.friction.MOST", 10)
    contact = abut.solve(twisted(3)).contacts[0]
    nodes = arrow_nodes(contact)
    assert len(nodes) == 10
    drawn = at_arrows(contact, nodes, contact.friction.traction)
    for node, arrow in zip(nodes, drawn):
        own = contact.friction.traction[contact.contactor.nodes == node]
        assert arrow == pytest.approx(own.mean(axis=0), rel=1e-9)


TOUCH_EVERYTHING = """<script>(() => {
  document.documentElement.dataset.before = abut.view.count().pixels;
  const change = (e, value) => { e.value = value; for (const k of ["input", "change"]) e.dispatchEvent(new Event(k)); };
  for (const e of document.querySelectorAll("#panel select")) for (const o of [...e.options].reverse()) change(e, o.value);
  for (const e of document.querySelectorAll("#panel input[type=range]")) for (const v of [e.min, e.max]) change(e, v);
  for (const e of document.querySelectorAll("#panel input[type=checkbox]")) { e.click(); e.click(); }
  for (const e of document.querySelectorAll("#bar input")) { change(e, "3"); change(e, ""); }
  for (const e of document.querySelectorAll("#views button")) e.click();
  document.querySelector("#theme").click();
  const found = new Set();
  for (let i = 1; i < 20; i++) for (let j = 1; j < 20; j++) {
    const hit = abut.view.pick(i / 20, j / 20);
    if (hit) { found.add(hit.name); if (!("displacement" in hit.values)) throw Error("nothing known at " + hit.name); }
  }
  document.documentElement.dataset.found = found.size;
  document.documentElement.dataset.arrows = abut.view.arrows.reduce((n, own) => n + own.shown, 0);
})();</script>"""


@pytest.mark.long
@pytest.mark.skipif(BROWSER is None, reason="needs Chromium, and the libraries of the report")
@pytest.mark.parametrize("case", ["hex20", "quad8", "axisymmetric"])
def test_a_browser_draws_it(case: str, tmp_path: Path) -> None:
    """Headless Chromium: no error on the console, plots and a picture that covers a good part of the canvas in colours, also
    after every control has been used."""
    cell = case if case in ("hex20", "quad8") else "quad4"
    solution = solution_of(
        cell, steps=2, name=HOSTILE,
        plane="axisymmetric" if case == "axisymmetric" else "strain",
    )  # fmt: skip
    path = write_report(solution, tmp_path / "report.html", Origin(case, HOSTILE))
    path.write_text(path.read_text(encoding="utf-8").replace("</body>", TOUCH_EVERYTHING + "</body>"), encoding="utf-8")
    root = in_browser(path)
    assert root.get("ready") == "true", root
    assert root["errors"] == "0", root
    assert int(root["plots"]) >= 5  # pressure, residuals, active set, and at least two of the history
    assert int(root["before"]) > 20_000
    assert int(root["found"]) >= 2  # values under the pointer, of both bodies or of a body and a contact
    assert int(root["pixels"]) > 20_000  # the picture is still there after everything has been touched
    assert int(root["colours"]) > 30


STATUS_ONLY = """<script>(() => {
  const s = abut.view.state, data = document.documentElement.dataset;
  Object.assign(s, { field: "status", mesh: false, arrows: false });
  abut.view.apply();
  data.plain = abut.view.count().colours;
  s.arrows = true;
  abut.view.apply();
  data.arrows = abut.view.arrows[0].shown;
  data.more = abut.view.count().colours;
})();</script>"""


@pytest.mark.long
@pytest.mark.skipif(BROWSER is None, reason="needs Chromium, and the libraries of the report")
@pytest.mark.parametrize("dim", [2, 3])
def test_a_browser_draws_friction(dim: int, tmp_path: Path) -> None:
    """Every field, the status and the arrows: an arrow for each node of a facet's corner, which changes the picture; three
    more plots; no error."""
    solution = abut.solve(pushed() if dim == 2 else twisted(3))
    path = write_report(solution, tmp_path / "report.html")
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("</body>", TOUCH_EVERYTHING + STATUS_ONLY + "</body>"), encoding="utf-8")
    root = in_browser(path)
    assert (root.get("ready"), root["errors"]) == ("true", "0"), root
    contactor = solution.contacts[0].contactor
    assert int(root["arrows"]) == len(np.unique(contactor.nodes[:, : 2 if dim == 2 else 4]))
    assert int(root["more"]) > int(root["plain"])
    assert int(root["plots"]) >= 9


@pytest.mark.skipif(BROWSER is None, reason="needs Chromium, and the libraries of the report")
def test_a_browser_would_notice(tmp_path: Path) -> None:
    """The test above can fail: with one array cut short the page says that it has an error."""
    path = write_report(solution_of("quad4"), tmp_path / "report.html")
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace('"triangles":{"type":"u4"', '"triangle":{"type":"u4"'), encoding="utf-8")
    root = in_browser(path)
    assert root["errors"] != "0" or root.get("ready") != "true"
