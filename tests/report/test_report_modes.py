"""Modes in the picture: the shapes of theory, that swing as a cosine and, with an imaginary part, round an ellipse."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.mesh import make
from abut.report import write_report
from abut.report.arrays import size
from abut.report.mode_shapes import title
from abut.report.scene import scene
from models.page import BROWSER, Page, in_browser

LENGTH, HEIGHT = 200.0, 5.0
ROOT = 1.87510407  # of cos x cosh x = -1


def cantilever(dim: int) -> abut.Solution:
    """Its three lowest modes in 2D, in 3D of one as broad as high the two bending modes and those of the next pair."""
    flat = [[0, LENGTH], [0, HEIGHT]]
    body = (
        make.rectangle(*flat, cells=[20, 1], cell="quad8")
        if dim == 2
        else make.box(*flat, [0, 2 * HEIGHT], cells=[10, 1, 1], cell="hex20")
    )
    return abut.solve(
        abut.Model(
            make.join({"beam": body}),
            plane="stress" if dim == 2 else None,
            solids=[abut.Solid("beam", abut.LinearElastic(210e3, 0.0, density=7.85e-9))],
            supports=[abut.Support("beam.left", **dict.fromkeys("xyz"[:dim], 0.0))],
            modes=[abut.Frequencies(3)],
        )
    )


def bent(x: np.ndarray) -> np.ndarray:
    """The first mode of a clamped beam over its largest value, at the end (Euler and Bernoulli)."""

    def shape(at: np.ndarray) -> np.ndarray:
        share = (np.cosh(ROOT) + np.cos(ROOT)) / (np.sinh(ROOT) + np.sin(ROOT))
        return np.cosh(at) - np.cos(at) - share * (np.sinh(at) - np.sin(at))

    return shape(ROOT * x / LENGTH) / shape(np.array(ROOT))


@pytest.mark.parametrize("dim", [2, 3])
def test_the_picture_has_the_modes_of_theory(dim: int) -> None:
    """A beam of slenderness 1 : 40 differs from Euler's and Bernoulli's by shear and rotary inertia, some (5 / 200)^2."""
    solution = cantilever(dim)
    data = scene(solution).data
    assert [mode["name"] for mode in data["modes"]] == [title(solution.modes[0], i) for i in range(3)]
    assert data["modes"][0]["name"] == f"mode 1: {solution.modes[0].values[0]:.6g} per time"
    x = data["bodies"][0]["points"].reshape(-1, 3)
    u = data["modes"][0]["bodies"][0]["real"].reshape(-1, 3)
    assert np.abs(np.abs(u[:, 1]) - bent(x[:, 0].astype(float))).max() < 2e-3
    assert np.linalg.norm(u, axis=1).max() == pytest.approx(1.0, rel=1e-6)
    assert data["ranges"]["mode shape"] == [[0.0, 1.0]]


def test_modes_that_do_not_fit_are_counted() -> None:
    """The first ones stay, the arrays are as small as asked, and the report says how many are left out."""
    solution = cantilever(2)
    result = solution.modes[0]
    many = replace(result, values=np.repeat(result.values, 20), shapes=np.repeat(result.shapes, 20, axis=0))
    whole, some = (scene(replace(solution, modes=(many,)), budget) for budget in (16_000_000, 40_000))
    assert len(whole.data["modes"]) == 60
    assert not whole.reduced
    assert 1 <= len(some.data["modes"]) < 60
    assert size(some.data) <= 40_000
    assert f"the picture shows the first {len(some.data['modes'])} of 60 modes" in some.reduced


def test_what_has_no_modes_offers_none(tmp_path: Path) -> None:
    solution = replace(cantilever(2), modes=())
    page = Page(write_report(solution, tmp_path / "report.html"))
    assert page.scene["modes"] == []
    assert "mode shape" not in page.scene["ranges"]


SWING = """<script>(() => {
  const data = document.documentElement.dataset, v = abut.view, s = v.state, select = document.getElementById("modes");
  const part = v.bodies[0], place = part.geometry.attributes.position.array, normal = part.geometry.attributes.normal.array;
  const rest = place.slice(), upright = normal.slice();
  const far = () => {
    let most = 0;
    for (let i = 0; i < place.length; i += 3) {
      most = Math.max(most, Math.hypot(place[i] - rest[i], place[i + 1] - rest[i + 1], place[i + 2] - rest[i + 2]));
    }
    return most / v.size;
  };
  const choose = (i) => { select.value = i; select.onchange(); };
  choose(0);
  const at = (phase) => { s.phase = phase; v.apply(); return far(); };
  data.swings = [0, 1 / 12, 0.25, 0.5, 0.75].map(at).join(" ");
  s.phase = 0;
  v.apply();
  let skew = 0;
  for (let t = 0; t < part.map.length && !v.flat; t += 3) {
    const side = (k) => [0, 1, 2].map((c) => place[3 * (t + k) + c] - place[3 * t + c]), [a, b] = [side(1), side(2)];
    const across = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    const along = [0, 1, 2].reduce((sum, c) => sum + across[c] * normal[3 * t + c], 0);
    skew = Math.max(skew, 1 - along / Math.hypot(...across));
  }
  data.skew = skew;
  data.field = s.field;
  choose(-1);
  data.back = far() + normal.reduce((most, n, i) => Math.max(most, Math.abs(n - upright[i])), 0);
  data.fieldafter = s.field;
  choose(1);
  const seen = new Set(), play = document.getElementById("play-mode");
  play.click();
  const watch = setInterval(() => seen.add(s.phase), 10);
  setTimeout(() => {
    clearInterval(watch);
    play.click();
    data.phases = seen.size;
    data.paused = s.phase;
    setTimeout(() => { data.later = s.phase; }, 500);
  }, 4000);
})();</script>"""


def shown(solution: abut.Solution, folder: Path) -> dict[str, str]:
    path = write_report(solution, folder / "report.html")
    path.write_text(path.read_text(encoding="utf-8").replace("</body>", SWING + "</body>"), encoding="utf-8")
    root = in_browser(path)
    assert (root.get("ready"), root["errors"]) == ("true", "0"), root
    return root


@pytest.mark.long
@pytest.mark.skipif(BROWSER is None, reason="needs Chromium, and the libraries of the report")
@pytest.mark.parametrize("dim", [2, 3])
def test_a_browser_plays_a_mode(dim: int, tmp_path: Path) -> None:
    """By a tenth of the model's size, as the cosine of the phase; normals turn with the surface; without a mode all is as it
    was; all 48 phases come up until the button is pressed again."""
    root = shown(cantilever(dim), tmp_path)
    swings = 0.1 * np.abs(np.cos(2.0 * np.pi * np.array([0.0, 1 / 12, 0.25, 0.5, 0.75])))
    np.testing.assert_allclose([float(v) for v in root["swings"].split()], swings, atol=1e-6)
    assert float(root["skew"]) < 1e-3  # averaged over neighbours, that are nearly in line
    assert (root["field"], root["fieldafter"]) == ("mode shape", "von Mises")
    assert float(root["back"]) < 1e-6
    assert int(root["phases"]) == 48
    assert root["later"] == root["paused"]


@pytest.mark.long
@pytest.mark.skipif(BROWSER is None, reason="needs Chromium, and the libraries of the report")
def test_a_browser_plays_a_complex_mode(tmp_path: Path) -> None:
    """With the same shape along x as imaginary part as it has along y each point goes round a circle."""
    solution = cantilever(2)
    result = solution.modes[0]
    shapes = np.zeros_like(result.shapes)
    shapes[..., 1] = result.shapes[..., 1]
    turned = replace(result, shapes=shapes, imaginary=shapes[..., ::-1].copy())
    root = shown(replace(solution, modes=(turned,)), tmp_path)
    np.testing.assert_allclose([float(v) for v in root["swings"].split()], 0.1 / np.sqrt(2.0), rtol=1e-5)
