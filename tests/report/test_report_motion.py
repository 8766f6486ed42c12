"""What the report shows of motions: force over displacement, the steps played, large displacements."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.mesh import make
from abut.report import write_report
from abut.report.motion import paths
from models.page import BROWSER, Page, in_browser

YOUNG = 1000.0


def stretched(far: float = 1.0, kinematics: str = "finite", steps: int = 4) -> abut.Model:
    """A bar, 2 long and 1 high, drawn out and let go again; in plane stress without lateral contraction."""
    return abut.Model(
        make.join({"bar": make.rectangle([0, 2], [0, 1], cells=[2, 1])}),
        plane="stress",
        solids=[abut.Solid("bar", abut.LinearElastic(YOUNG, 0.0))],
        supports=[
            abut.Support("bar.left", x=0, y=0),
            abut.Support("bar.right", x=far, amplitude=abut.Amplitude([(0, 0), (0.5, 1), (1, 0.5)])),
        ],
        kinematics=kinematics,
        solve=abut.SolveOptions(times=[(i + 1) / steps for i in range(steps)]),
    )


def swung(cell: str) -> abut.Model:
    """A lever turned by a right angle about its end, with a block that a pressure holds on it."""
    flat = cell.startswith("quad")
    sides = ("block.bottom", "lever.top") if flat else ("block.front", "lever.back")
    box = make.rectangle if flat else make.box
    lever = box([0, 4], [0, 1], *([] if flat else [[0, 1]]), cells=[4, 1] if flat else [4, 1, 1], cell=cell)
    block = box([2, 3], [1, 2], *([] if flat else [[0, 1]]), cells=[1, 1] if flat else [1, 1, 1], cell=cell)
    return abut.Model(
        make.join({"lever": lever, "block": block}),
        plane="strain" if flat else None,
        solids=[abut.Solid("block", abut.LinearElastic(YOUNG, 0.3))],
        rigid=[abut.Rigid("lever", reference=(0.0,) * (2 if flat else 3), x=0, y=0, rz=np.pi / 2)
               if flat else abut.Rigid("lever", reference=(0.0,) * 3, x=0, y=0, z=0, rx=0, ry=0, rz=np.pi / 2)],
        contacts=[abut.Contact(contactor=sides[0], target=sides[1], kind="tied")],
        kinematics="finite",
        solve=abut.SolveOptions(steps=4),
    )  # fmt: skip


def test_forces_are_those_of_the_supports() -> None:
    """Drawn out and half of it back: two ways over the same displacement, the force of theory (D3) on both."""
    (path,) = paths(abut.solve(stretched()))
    assert path.title == "bar.right: force along x over displacement"
    assert list(path.series) == ["time 0 to 0.5", "time 0.5 to 1"]
    assert path.x == pytest.approx([0.0, 0.5, 0.5, 0.75, 1.0, 1.0])
    for values, count in zip(path.series.values(), (3, 3), strict=True):
        own = ~np.isnan(values)
        assert own.sum() == count
        stretch = 1.0 + path.x[own] / 2.0
        assert values[own] == pytest.approx(0.5 * YOUNG * (stretch**2 - 1.0) * stretch, rel=1e-7, abs=1e-6)


def test_rigid_bodies_have_paths_too() -> None:
    (path,) = paths(abut.solve(swung("quad4")))
    assert path.title == "lever: moment about z over rotation"
    assert path.x[-1] == pytest.approx(np.pi / 2)


def test_nothing_to_show_is_no_plot(tmp_path: Path) -> None:
    assert paths(abut.solve(stretched(kinematics="small", steps=1))) == []
    page = Page(write_report(abut.solve(stretched(far=-0.1, kinematics="small")), tmp_path / "report.html"))
    own = json.loads(page.data)["paths"]
    assert [len(path["series"]) for path in own] == [2]
    assert min(own[0]["x"]) == -0.1


PLAY = """<script>(() => {
  const data = document.documentElement.dataset, s = abut.view.state, play = document.getElementById("play");
  const seen = new Set();
  data.first = s.step;
  data.scale = s.scale;
  play.click();
  const watch = setInterval(() => seen.add(s.step), 50);
  setTimeout(() => {
    clearInterval(watch);
    data.seen = seen.size;
    play.click();
    data.paused = s.step;
    setTimeout(() => { data.later = s.step; }, 1500);
  }, 3500);
  const [low, high] = abut.view.box;
  data.low = low[0];
  data.high = high[1];
  const part = abut.view.bodies[1], normal = part.geometry.attributes.normal.array;
  if (!abut.view.flat) {
    const place = part.geometry.attributes.position.array;
    let worst = 0;
    for (let t = 0; t < part.map.length; t += 3) {
      const x = [0, 1, 2].map((k) => [0, 1, 2].map((c) => place[3 * (t + k) + c]));
      for (const k of [1, 2]) {
        const along = [0, 1, 2].reduce((sum, c) => sum + (x[k][c] - x[0][c]) * normal[3 * t + c], 0);
        worst = Math.max(worst, Math.abs(along));
      }
    }
    data.skew = worst;
  }
})();</script>"""


@pytest.mark.long
@pytest.mark.skipif(BROWSER is None, reason="needs Chromium, and the libraries of the report")
@pytest.mark.parametrize("cell", ["quad4", "hex8"])
def test_a_browser_plays_the_steps(cell: str, tmp_path: Path) -> None:
    """Every step comes up until the button is pressed again; at first the deformation is true, all of it is in the picture,
    and normals stand on the surfaces where they are."""
    solution = abut.solve(swung(cell))
    assert solution.converged
    path = write_report(solution, tmp_path / "report.html")
    text = path.read_text(encoding="utf-8")
    path.write_text(text.replace("</body>", PLAY + "</body>"), encoding="utf-8")
    root = in_browser(path)
    assert (root.get("ready"), root["errors"]) == ("true", "0"), root
    count = len(solution.steps)
    assert (root["first"], root["scale"]) == (str(count - 1), "1")
    assert int(root["seen"]) == count
    assert root["later"] == root["paused"]
    turn = np.arange(1, count + 1) * np.pi / 2 / count
    assert float(root["low"]) == pytest.approx(-2.0, abs=0.05)  # the block, turned over
    assert float(root["high"]) == pytest.approx((4.0 * np.sin(turn) + np.cos(turn)).max(), abs=0.05)  # the lever's end
    if cell == "hex8":
        assert float(root["skew"]) < 1e-5
