"""The picture's numbers: ranges of true nodal values, steps of the largest ones, mirror images, the inside of bodies."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.materials.invariants import max_shear, principal, von_mises
from abut.mesh import make
from abut.model.mirror_planes import mirrors
from abut.report import write_report
from abut.report.inside import tetrahedra
from abut.report.quantities import extremes, largest_by_body, peak_steps
from abut.report.scene import kept, scene
from models.page import BROWSER, Page, in_browser

STEEL = abut.LinearElastic(1000.0, 0.3)


def cubes(cell: str = "hex20", steps: int = 1, **more: object) -> abut.Model:
    """A quarter of a small block on a larger one."""
    lower = make.box([0, 2], [0, 2], [0, 1], cells=[2, 2, 2], cell=cell)
    upper = make.box([0, 1], [0, 1], [1, 2], cells=[3, 3, 2], cell=cell)
    held = [abut.Support(f"{b}.{s}", **{a: 0}) for b in ("lower", "upper") for s, a in (("left", "x"), ("front", "y"))]
    push = abut.Support("upper.top", z=-0.01, amplitude=more.pop("amplitude", None))  # type: ignore[arg-type]
    return abut.Model(
        make.join({"lower": lower, "upper": upper}),
        solids=[abut.Solid("lower", STEEL), abut.Solid("upper", STEEL)],
        supports=[abut.Support("lower.bottom", x=0, y=0, z=0), push, *held],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top")],
        solve=abut.SolveOptions(steps=steps),
    )


def test_principal_stresses() -> None:
    """Those of NumPy's eigenvalues; of equal and tiny ones, too."""
    stress = np.random.default_rng(1).normal(size=(200, 6)) * np.logspace(-200, 50, 200)[:, None]
    stress[:3] = [[0, 0, 0, 0, 0, 0], [2, 2, 2, 0, 0, 0], [3, 1, 1, 0, 0, 0]]
    matrix = stress[:, [[0, 3, 5], [3, 1, 4], [5, 4, 2]]]
    size = np.abs(stress).max(axis=1, keepdims=True) + 1e-300
    assert principal(stress) / size == pytest.approx(np.linalg.eigvalsh(matrix)[:, ::-1] / size, abs=3e-8)
    ends = np.linalg.eigvalsh(matrix)[:, [0, 2]]
    assert max_shear(stress) / size[:, 0] == pytest.approx(0.5 * (ends[:, 1] - ends[:, 0]) / size[:, 0], abs=3e-8)


def test_no_negative_von_mises() -> None:
    """Parabolas through positive values at nodes fall below zero between them; of the stress there it cannot: with the
    stress of bending, whose von Mises is |x - 1/2|, it is that to rounding at every point of the subdivided facets."""
    solution = abut.solve(cubes())
    x = solution.model.mesh.points[:, 0]
    stress = np.zeros((len(x), 6))
    stress[:, 2] = x - 0.45
    step = replace(solution.steps[-1], stress=stress)
    data = scene(replace(solution, steps=(step,))).data
    side, values = data["contacts"][0], data["steps"][0]["contacts"][0]
    place = side["points"].reshape(-1, 3)[:, 0]
    assert values["von Mises"].min() >= 0.0
    assert values["von Mises"] == pytest.approx(np.abs(place - 0.45), abs=1e-5)
    assert values["smallest principal stress"] == pytest.approx(np.minimum(place - 0.45, 0.0), abs=1e-5)


def test_ranges_are_those_of_the_nodes() -> None:
    """Of every quantity, over all steps, of all bodies and of each; the estimated error of stresses among them."""
    solution = abut.solve(cubes(steps=2))
    ranges, mesh = scene(solution).data["ranges"], solution.model.mesh
    stress = np.array([von_mises(step.stress) for step in solution.steps])
    assert ranges["von Mises"][0] == [stress.min(), stress.max()]
    for number, body in enumerate(mesh.bodies, start=1):
        own = stress[:, mesh.nodes_of(body)]
        assert ranges["von Mises"][number] == [own.min(), own.max()]
    sizes = [np.linalg.norm(step.displacement, axis=1) for step in solution.steps]
    assert ranges["displacement"][0] == [np.min(sizes), np.max(sizes)]
    assert ranges["pressure"][0] == [0.0, max(step.contacts[0].max_pressure for step in solution.steps)]
    assert ranges["stress error"][0][1] == max(step.stress_error.cells.max() for step in solution.steps)
    head, rows = largest_by_body(solution, extremes(solution))
    assert head[1] == "largest von Mises stress"
    assert rows[0][1].startswith(f"{ranges['von Mises'][1][1]:.6g} at (")
    assert rows[0][1].endswith("step 2")


def test_the_step_of_the_largest_values_stays() -> None:
    """Pressed and let go again: however small the file must be, the picture has the step in the middle, and its range."""
    solution = abut.solve(cubes("hex8", 8, amplitude=abut.Amplitude([(0, 0), (0.375, 1), (1, 0.1)])))
    found = peak_steps(solution, extremes(solution))
    assert found == [2, 7]
    for budget in (1, 100_000):
        picture = scene(solution, budget=budget)
        numbers = [step["number"] for step in picture.data["steps"]]
        assert {3, 8} <= set(numbers)
        assert len(numbers) < 8
        top = max(step.contacts[0].max_pressure for step in solution.steps)
        assert picture.data["ranges"]["pressure"][0][1] == top == solution.steps[2].contacts[0].max_pressure


def test_kept_steps_are_spread() -> None:
    solution = abut.solve(cubes("hex8"))
    steps = tuple(replace(solution.steps[0], number=n) for n in range(1, 101))
    numbers = [step.number for step in kept(steps, [41, 99], 10)]
    assert len(numbers) == 10
    assert {42, 100} <= set(numbers)
    assert np.diff([0, *numbers]).max() <= 25


def test_mirrors_of_a_quarter() -> None:
    """The planes x = 0 and y = 0, with the model behind them; a clamped bottom is none."""
    assert mirrors(cubes()) == [[-1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.0]]
    model = cubes()
    some = replace(model, supports=[s for s in model.supports if s.on != "upper.left"])
    assert mirrors(some) == [[0.0, -1.0, 0.0, 0.0]]  # what nothing holds is no plane of symmetry


@pytest.mark.parametrize("cell", ["tet4", "tet10", "hex8", "hex20", "hex27", "wedge6", "wedge15"])
def test_the_inside_is_the_body(cell: str) -> None:
    mesh = make.join({"a": make.box([0, 2], [0, 1], [0, 3], cells=[2, 3, 2], cell=cell)})
    x = mesh.points[tetrahedra(mesh, "a")]
    volume = np.einsum("ij,ij->i", np.cross(x[:, 1] - x[:, 0], x[:, 2] - x[:, 0]), x[:, 3] - x[:, 0]) / 6.0
    assert volume.min() > 0.0
    assert volume.sum() == pytest.approx(6.0, rel=1e-12)


def test_force_of_a_fit_is_by_area(tmp_path: Path) -> None:
    """Where a shaft is pressed all round the resultant says nothing; the page has what the surfaces carry."""
    solution = abut.solve(cubes())
    contact = solution.contacts[0]
    assert contact.force_by_area == pytest.approx(np.linalg.norm(contact.force), rel=1e-9)  # flat, without friction
    fit = replace(contact, force=1e-12 * contact.force)
    page = Page(
        write_report(replace(solution, steps=(replace(solution.steps[0], contacts=(fit,)),)), tmp_path / "a.html")
    )
    assert "0resultant of contact" in page.text
    assert f"{contact.force_by_area:.6g}contact force by area" in page.text


LOOK = """<script>(() => {
  const data = document.documentElement.dataset, v = abut.view, s = v.state;
  data.unpacked = Array.from(unpack(v.data.bodies[0].points)).reduce((a, b) => a + b, 0);
  Object.assign(s, { field: "von Mises", mesh: false, bodies: ["solid", "solid"] });
  s.section.axis = "y";
  s.section.at = 0.25;
  v.apply();
  let area = 0;
  for (const cap of v.caps) {
    const x = cap.geometry.attributes.position.array;
    for (let i = 0; i < x.length; i += 9) {
      area += 0.5 * Math.abs((x[i + 3] - x[i]) * (x[i + 8] - x[i + 2]) - (x[i + 6] - x[i]) * (x[i + 5] - x[i + 2]));
      data.level = x[i + 1];
    }
  }
  data.area = area;
  s.mirrors = [true, true];
  v.mirror();
  data.copies = v.copies.length;
  data.box = v.box.flat().map((x) => x.toFixed(3)).join(" ");
  const plot = document.querySelector(".plot").abut;
  data.csv = plot.csv().split("\\n")[0].replaceAll('"', "");
  data.png = plot.png().slice(0, 22);
})();</script>"""


@pytest.mark.skipif(BROWSER is None, reason="needs Chromium")
def test_a_browser_cuts_and_mirrors(tmp_path: Path) -> None:
    """The section through both blocks has their area, the whole made of four quarters their size; plots are saved."""
    model = cubes("hex8")
    solution = abut.solve(model)
    path = write_report(solution, tmp_path / "report.html")
    path.write_text(path.read_text(encoding="utf-8").replace("</body>", LOOK + "</body>"), encoding="utf-8")
    root = in_browser(path)
    assert (root.get("ready"), root["errors"]) == ("true", "0"), root
    mesh = model.mesh
    assert float(root["unpacked"]) == pytest.approx(mesh.points[mesh.nodes_of("lower")].sum(), rel=1e-6)
    assert float(root["level"]) == pytest.approx(0.5, abs=1e-6)  # of the box, which is undeformed
    assert float(root["area"]) == pytest.approx(3.0, rel=0.03)  # pressed a hundredth of the height
    assert root["copies"] == "3"
    assert root["box"] == "-2.000 -2.000 0.000 2.000 2.000 2.000"
    assert root["csv"].startswith("distance from the largest pressure,pressure")
    assert root["png"] == "data:image/png;base64,"


def test_narrow_contact_is_called_that(tmp_path: Path) -> None:
    """The advice is for contact that is narrow for its facets, and the heading says so."""
    solution = abut.solve(cubes("hex8"))
    contact = solution.contacts[0]
    checks = tuple(replace(c, value=2.0 * c.limit) if c.name == "overlap" else c for c in contact.checks)
    step = replace(solution.steps[0], contacts=(replace(contact, checks=checks),))
    page = Page(write_report(replace(solution, steps=(step,)), tmp_path / "a.html"))
    assert "Contact is narrow for its facets" in page.text
    assert "Surfaces overlap" not in page.text
