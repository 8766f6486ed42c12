"""The report where abut was built without its libraries: pictures and plots in the page, and how to get the others."""

from __future__ import annotations

import base64
import importlib
import json
import re
import struct
import zlib
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.mesh import make
from abut.report import svg
from abut.report.raster import Canvas, ramp, view
from models.friction import pushed
from models.page import Page
from models.patch import model, two_blocks

RED, BLUE = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


@pytest.fixture
def not_built(monkeypatch: pytest.MonkeyPatch) -> None:
    page = importlib.import_module("abut.report.page")  # which the function of that name hides
    static = page._static

    def missing(name: str) -> str:
        if name.startswith("libraries"):
            raise FileNotFoundError(name)
        return static(name)

    monkeypatch.setattr(page, "_static", missing)


def pixels(png: bytes) -> np.ndarray:
    """A picture (height, width, 4) read back."""
    width, height = struct.unpack(">II", png[16:24])
    data = b"".join(
        png[m.end() : m.end() + struct.unpack(">I", png[m.start() - 4 : m.start()])[0]]
        for m in re.finditer(b"IDAT", png)
    )
    lines = np.frombuffer(zlib.decompress(data), np.uint8).reshape(height, 1 + 4 * width)
    assert not lines[:, 0].any()
    return lines[:, 1:].reshape(height, width, 4)


@pytest.mark.parametrize(("dim", "cell"), [(2, "quad4"), (3, "hex8")])
def test_the_page_has_pictures_and_plots_and_says_how_to_get_the_others(
    dim: int, cell: str, not_built: None, tmp_path: Path
) -> None:
    solution = abut.solve(model(two_blocks(cell, cell, ((2,) * dim, (3,) * dim))))
    path = abut.write_report(solution, tmp_path / "report.html")
    page, text = Page(path), path.read_text(encoding="utf-8")
    assert page.addresses == []
    assert page.tags.count("script") == 3  # what counts errors, the data, and the arrays, of which there are none
    assert "build abut again where npm's registry or a mirror of it can be reached" in page.text
    images = [base64.b64decode(m) for m in re.findall(r"data:image/png;base64,([^\"]+)", text)]
    assert len(images) == dim - 1  # in 3D also the contactor
    for image in images:
        assert (pixels(image)[..., 3] > 0).mean() > 0.1
    headings = re.findall(r"<div class=\"plot\"><h3>(.*?)</h3><svg", text)
    assert "Residuals" in headings
    assert "Active set" in headings
    lines = json.loads(page.data)["lines"]
    assert sum("pressure along" in heading for heading in headings) == len(lines) > 0
    assert "<section><h2>Force over displacement</h2>" not in text  # a single step


def test_histories_and_friction_are_plotted(not_built: None, tmp_path: Path) -> None:
    text = abut.write_report(abut.solve(pushed()), tmp_path / "report.html").read_text(encoding="utf-8")
    headings = re.findall(r"<div class=\"plot\"><h3>(.*?)</h3><svg", text)
    for words in ("Contact force", "Contact area", "Largest pressure", "friction force by area", "work of friction"):
        assert any(words in heading for heading in headings), words


def test_a_square_covers_its_pixels_and_the_nearer_hides_the_farther() -> None:
    """A unit square in a view of 100 by 100 pixels, 88 to a length: its area, its colours, one before another."""
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    seen = view(square, np.array([0.0, 0.0, 1.0]), 100, 100, up=np.array([0.0, 1.0, 0.0]))
    triangles = square[[[0, 1, 2], [0, 2, 3]]]
    canvas = Canvas(seen)
    canvas.triangles(triangles, np.broadcast_to(RED, (2, 3, 3)))
    half = triangles * [0.5, 1.0, 1.0]
    canvas.triangles(half + np.array([0.0, 0.0, 0.1]), np.broadcast_to(BLUE, (2, 3, 3)))
    canvas.triangles(triangles - np.array([0.0, 0.0, 0.1]), np.ones((2, 3, 3)))  # hidden
    image = pixels(canvas.png())
    covered = image[..., 3] > 0
    assert covered.sum() == pytest.approx(88**2, rel=0.03)  # the border's pixels are covered whole
    assert covered[10:90, 10:90].all()
    assert (image[20:80, 10:48, :3] == [0, 0, 255]).all()
    assert (image[20:80, 52:90, :3] == [255, 0, 0]).all()


def test_colours_are_interpolated() -> None:
    assert ramp(("000000", "ff0000", "ffffff"), np.array([-1.0, 0.25, 0.5, 2.0])) == pytest.approx(
        np.array([[0, 0, 0], [0.5, 0, 0], [1, 0, 0], [1, 1, 1]])
    )


def test_a_plot_puts_values_where_its_marks_are() -> None:
    """y = 100 x: a point at the mark of each axis; a missing value breaks the line."""
    text = svg.plot("a < b", "x", [0.0, 1.0, 2.0, 3.0], [svg.Series("y", [0.0, 100.0, None, 300.0])])
    assert "a &lt; b" in text
    (path,) = re.findall(r'<path d="(M[^"]*)" fill="none" stroke-width="2"', text)
    places = [tuple(map(float, p.split())) for p in re.findall(r"[ML]([\d.]+ [\d.]+)", path)]
    assert path.count("M") == 2
    labels = {
        t: (float(x), float(y)) for x, y, t in re.findall(r'<text x="([\d.]+)" y="([\d.]+)"[^>]*>([\d.e-]+)<', text)
    }
    assert places[0][1] - places[1][1] == pytest.approx((places[0][1] - places[2][1]) / 3.0, abs=0.2)
    assert labels["100"][1] - 4.0 == pytest.approx(places[1][1], abs=0.2)
    assert labels["1"][0] == pytest.approx(places[1][0], abs=0.2)


def test_powers_of_ten_are_marked_at_most_eight_times() -> None:
    text = svg.plot("r", "i", [1.0, 2.0], [svg.Series("y", [1.0, 1e-16])], log=True)
    marks = re.findall(r">(1e-?\d+)<", text)
    assert 4 <= len(marks) <= 8


def test_modes_are_pictures(not_built: None, tmp_path: Path) -> None:
    """A bar between guides stretches as sin(pi x / 2 L): at one end of its first mode it reaches a tenth of the model's size
    beyond its own end, and the picture says which mode that is."""
    mesh = make.join({"bar": make.rectangle([0.0, 10.0], [0.0, 1.0], cells=[8, 1], cell="quad8")})
    solution = abut.solve(
        abut.Model(
            mesh,
            plane="stress",
            solids=[abut.Solid("bar", abut.LinearElastic(1.0, 0.0, density=1.0))],
            supports=[abut.Support("bar.left", x=0), abut.Support("bar.bottom", y=0), abut.Support("bar.top", y=0)],
            modes=[abut.Frequencies(2)],
        )
    )
    text = abut.write_report(solution, tmp_path / "report.html").read_text(encoding="utf-8")
    pictures = re.findall(r'<figure><img alt="(mode [^"]*)" src="data:image/png;base64,([^"]*)"', text)
    values = solution.modes[0].values
    assert [caption for caption, _ in pictures] == [
        f"mode {i + 1}: {value:.6g} per time; amplitude over the largest" for i, value in enumerate(values)
    ]
    drawn = pixels(base64.b64decode(pictures[0][1]))[..., 3] > 0
    across, along = (np.ptp(np.flatnonzero(drawn.any(axis=axis))) + 1 for axis in (1, 0))
    longer = 10.0 + (1 if along > 10.0 * across else -1) * 0.1 * np.hypot(10.0, 1.0)
    assert along / across == pytest.approx(longer, rel=0.03)  # pixels
