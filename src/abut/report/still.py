"""The report without scripts, where three.js and uPlot were not to be had when abut was built: pictures and plots in the
places of those that a browser draws."""

from __future__ import annotations

import base64
import re
from collections.abc import Sequence
from html import escape
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut.report.mode_shapes import SHAPE
from abut.report.raster import Canvas, lights, ramp, view
from abut.report.svg import Series, plot
from abut.types import Json

SIZE = (1200, 640)  # of a picture, pixels
SWING = 0.1  # largest displacement of a mode over the size of the model
MODES = 6  # pictures of them
PRESSED = 0.01  # share of the largest pressure above which a part counts as pressed
PLAIN = (0.8, 0.83, 0.85)
INK = (0.25, 0.28, 0.32)
CORNER = np.array([0.6, -1.0, 0.55])  # towards the eye
COLOURS = ("accent", "second", "third", "good", "bad", "soft")
MAPS = {
    "pressure": ("1b0c41", "4a0c6b", "781c6d", "a52c60", "cf4446", "ed6925", "fb9b06", "f7d13d", "fcffa4"),
    "von Mises": ("30123b", "4145ab", "4675ed", "39a2fc", "1bcfd4", "24eca6", "61fc6c", "a4fc3b", "d1e834", "f3c63a",
                  "fe9b2d", "f36315", "d93806", "b11901", "7a0402"),
    SHAPE: ("440154", "482878", "3e4989", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b", "fde725"),
}  # fmt: skip
HOW = (
    "This report was written without three.js and uPlot, which draw the interactive picture: they could not be fetched when "
    "abut was built. To have it, build abut again where npm's registry or a mirror of it can be reached "
    "(npm_config_registry=&lt;address of the mirror&gt; pip install .), and run the job again."
)
Vector = NDArray[np.float64]


def still_page(page: str, data: Json) -> str:
    """The page of a report, with pictures and plots of ``data``, which its scripts would read, in their places."""
    pictures = f'<section class="still">{"".join(_pictures(data["scene"]))}<p class=note>{HOW}</p></section>'
    page = re.sub(r'<section id="viewer">.*?</section>', lambda _: pictures, page, count=1, flags=re.DOTALL)
    for name, plots in _plots(data).items():
        page = page.replace(f'id="{name}"></div>', f'id="{name}">{"".join(plots)}</div>', 1)
    if not data["lines"]:
        page = re.sub(r"<section><h2>Along the contact</h2>.*?</section>", "", page, count=1, flags=re.DOTALL)
    if not data["paths"]:
        page = re.sub(r"<section><h2>Force over displacement</h2>.*?</section>", "", page, count=1, flags=re.DOTALL)
    return page


def _pictures(scene: Json) -> list[str]:
    """At the step of the largest stress: the bodies with their von Mises stress; in 3D the pressed parts of the contactors
    with their pressure, from outside."""
    step = max(scene["steps"], key=_largest_stress)
    parts = [(b["points"], b["triangles"], own) for b, own in zip(scene["bodies"], step["bodies"])]
    sides = list(zip(scene["contacts"], step["contacts"])) if scene["dim"] == 3 else []
    parts += [(side["points"], side["cells"], own) for side, own in sides]
    corners = [_corners(*part, "von Mises") for part in parts]
    lines = [_lines(b, own) for b, own in zip(scene["bodies"], step["bodies"])]
    values = np.concatenate([value.ravel() for _, value in corners])
    limits = (0.0, float(np.nanmax(values))) if np.isfinite(values).any() else (0.0, 1.0)
    towards = CORNER if scene["dim"] == 3 else np.array([0.0, 0.0, 1.0])
    when = f"step {step['number']}, time {step['time']:.4g}; true scale"
    shown = [_figure(corners, lines, towards, "von Mises", limits, f"von Mises stress of the bodies, {when}")]
    for side, own in sides:
        if side["role"] == "contactor":
            normal = _vectors(side["normals"]).mean(axis=0)
            towards = normal if np.linalg.norm(normal) > 0.1 else CORNER
            pressed = [_corners(side["points"], side["cells"], own, "pressure")]
            top = float(scene["ranges"]["pressure"][0][1]) or 1.0
            what = f"pressure on the contactor {side['surface']} of {side['contact']}, seen from outside, {when}"
            shown.append(_figure(pressed, [_lines(side, own)], towards, "pressure", (0.0, top), what, PRESSED * top))
    return [*shown, *(_mode(scene, mode) for mode in scene["modes"][:MODES])]


def _mode(scene: Json, mode: Json) -> str:
    """The bodies and contact surfaces at one end of a mode's swing about the last step, and how far each point moves."""
    last, flat = scene["steps"][-1], scene["dim"] == 2
    items = [(b, b["triangles"], *own) for b, *own in zip(scene["bodies"], last["bodies"], mode["bodies"])]
    sides = [] if flat else list(zip(scene["contacts"], last["contacts"], mode["contacts"]))
    items += [(side, side["cells"], *own) for side, *own in sides]
    points = np.concatenate([_vectors(item["points"]) for item, *_ in items])
    far = SWING * float(np.linalg.norm(np.ptp(points, axis=0)))
    swung = [_swung(state, own, far) for _, _, state, own in items]
    corners = [_corners(item["points"], cells, own, SHAPE) for (item, cells, _, _), own in zip(items, swung)]
    lines = [_lines(item, own) for (item, *_), own in zip(items, swung) if "features" in item]
    towards = np.array([0.0, 0.0, 1.0]) if flat else CORNER
    return _figure(corners, lines, towards, SHAPE, (0.0, 1.0), f"{mode['name']}; amplitude over the largest")


def _swung(state: Json, own: Json, far: float) -> Json:
    """Displacement and amplitude of a part."""
    real, imaginary = (_vectors(own[name]) if name in own else np.zeros(1) for name in ("real", "imaginary"))
    size = np.sqrt((real**2).sum(axis=-1) + (imaginary**2).sum(axis=-1))
    return {"displacement": (_vectors(state["displacement"]) + far * real).ravel(), SHAPE: size}


def _largest_stress(step: Json) -> float:
    values = [own["von Mises"] for own in (*step["bodies"], *step["contacts"]) if "von Mises" in own]
    return max((float(np.nanmax(v)) for v in values if np.isfinite(v).any()), default=0.0)


def _figure(
    parts: Sequence[tuple[Vector, Vector]], lines: Sequence[Vector], towards: Vector, field: str,
    limits: tuple[float, float], caption: str, least: float = -np.inf,
) -> str:  # fmt: skip
    """parts: corners (m, 3, 3) of triangles and their values (m, 3); lines (k, 2, 3); least: the picture shows the triangles
    with larger values, and what lies around them, all if there are none."""
    points = np.concatenate([corners for corners, _ in parts])
    flat = not np.ptp(points[..., 2])
    above = np.concatenate([values for _, values in parts]).max(axis=1) > least
    shown = points[above] if above.any() else points
    seen = view(shown.reshape(-1, 3), towards, *SIZE, up=np.array([0.0, 1.0, 0.0]) if flat else None)
    canvas = Canvas(seen)
    for corners, values in parts:
        share = (values - limits[0]) / max(limits[1] - limits[0], 1e-300)
        colours = np.where(np.isfinite(values)[..., None], ramp(MAPS[field], np.nan_to_num(share)), PLAIN)
        bright = np.ones(len(corners)) if flat else lights(corners, seen)
        canvas.triangles(corners, colours * bright[:, None, None])
    for ends in lines:
        canvas.lines(ends, INK)
    image = base64.b64encode(canvas.png()).decode("ascii")
    scale = f'<i class="scale" style="background:linear-gradient(90deg,{",".join("#" + s for s in MAPS[field])})"></i>'
    return (
        f'<figure><img alt="{escape(caption)}" src="data:image/png;base64,{image}"><figcaption>{escape(caption)}: '
        f"{limits[0]:.4g}{scale}{limits[1]:.5g}</figcaption></figure>"
    )


def _corners(points: NDArray[Any], triangles: NDArray[Any], own: Json, field: str) -> tuple[Vector, Vector]:
    """Where the corners of triangles are now, (m, 3, 3), and the values there, (m, 3)."""
    at = triangles.reshape(-1, 3).astype(np.int64)
    return (_vectors(points) + _vectors(own["displacement"]))[at], (
        own[field].astype(float) if field in own else np.full(len(points), np.nan)
    )[at]


def _lines(item: Json, own: Json) -> Vector:
    """Borders and creases of a body, all edges of a contact surface, where they are now: (k, 2, 3)."""
    edges = item["edges"].reshape(-1, 2).astype(np.int64)[: item.get("features")]
    return np.asarray((_vectors(item["points"]) + _vectors(own["displacement"]))[edges])


def _vectors(array: NDArray[Any]) -> Vector:
    return array.reshape(-1, 3).astype(float)


def _plots(data: Json) -> dict[str, list[str]]:
    """By the place in the page: what ``plots.js`` draws there."""
    return {
        "lines": [_along(line) for line in data["lines"]],
        "beside": [_chart(chart) for chart in data["beside"]],
        "probes": [_chart(chart) for chart in data["probes"]],
        "paths": [_chart(chart) for chart in data["paths"]],
        "history": _history(data["history"]),
        "convergence": _convergence(data["convergence"]),
    }


def _along(line: Json) -> str:
    series = [Series("pressure", line["pressure"])]
    for key, label, colour, dash in (
        ("traction", "tangential traction", "good", ""),
        ("limit", "its limit", "good", "3 4"),
        ("theory", "theory", "second", "6 5"),
    ):
        if line[key]:
            series.append(Series(label, line[key], colour, dash))
    if any(v is not None for v in line["gap"]):
        series.append(Series("gap", line["gap"], "third", right=True))
    return plot(
        f"{line['contact']}: pressure {line['label']}", f"distance from {line['zero']}", line["distance"], series
    )


def _chart(chart: Json) -> str:
    """A chart; its lines go on where single values are missing."""
    series = [
        Series(s["label"], s["values"], COLOURS[i % len(COLOURS)], "" if i < len(COLOURS) else "6 5",
               right=s["label"] == "gap" and len(chart["series"]) > 1)
        for i, s in enumerate(chart["series"])
    ]  # fmt: skip
    return plot(chart["title"], chart["label"], chart["x"], series)


def _history(history: Json) -> list[str]:
    times, label, contacts = history["time"], history["label"], history["contacts"]
    if len(times) < 2 or not contacts:
        return []
    shown = [
        plot(
            title, label, times, [Series(c["name"], c[key], COLOURS[i % len(COLOURS)]) for i, c in enumerate(contacts)]
        )
        for key, title in (("force", "Contact force"), ("area", "Contact area"), ("pressure", "Largest pressure"))
    ]
    for c in contacts:
        if not c["friction"]:
            continue
        own = c["friction"]
        some = any(v is not None for v in own["limit"])
        limit = [Series("at most", own["limit"], "second", "6 5")] if some else []
        areas = [Series("sticking", own["sticking"]), Series("slipping", own["slipping"], "second")]
        shown += [
            plot(
                f"{c['name']}: friction force by area", label, times, [Series("friction force", own["force"]), *limit]
            ),
            plot(f"{c['name']}: work of friction", label, times, [Series("work in all", own["work"])]),
            plot(f"{c['name']}: area", label, times, areas),
        ]
    return shown


def _convergence(run: Json) -> list[str]:
    count = [float(i + 1) for i in range(len(run["step"]))]
    steps = run["step"]
    marks = [i + 0.5 for i in range(1, len(steps)) if steps[i] != steps[i - 1]]
    residuals = [
        Series("equilibrium, over the reference force", _positive(run["residual"])),
        Series("contact law, over the reference pressure", _positive(run["contact"]), "second"),
    ]
    sets = [Series("in contact", run["active"]), Series("changed", run["changed"], "second")]
    if run["slipping"]:
        sets.append(Series("slipping", run["slipping"], "third"))
    return [
        plot("Residuals", "iteration", count, residuals, log=True, marks=marks),
        plot("Active set", "iteration", count, sets, marks=marks),
    ]


def _positive(values: Sequence[float | None]) -> list[float | None]:
    return [None if v is None else max(v, 1e-17) for v in values]
