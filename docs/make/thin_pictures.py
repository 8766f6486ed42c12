"""Pictures of docs/gallery.md of shells: python docs/make/thin_pictures.py (some minutes; needs pyvista)."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path

import pyvista as pv

import abut
from abut.job import load_job
from page import DOCS

View = list[tuple[float, ...]]
EXAMPLES: dict[str, tuple[float, View, float]] = {  # how much displacements are enlarged; the view and its angle
    "leaf-spring": (4.0, [(330, -330, 110), (100, 10, -24), (0, 0, 1)], 19),
    "pipe-clip": (1.0, [(-18, 34, 62), (3, 6, 5), (0, 1, 0)], 22),
    "stiffened-panel": (20.0, [(330, -300, 190), (128, -10, 0), (0, 0, 1)], 26),
    "belt": (1.0, [(70, 110, 240), (0, 12, 10), (0, 1, 0)], 28),
}


def picture(results: Path, name: str, steps: Sequence[int] = (-1,)) -> None:
    """Deformed bodies with their cells and von Mises stress at some steps, one below the other."""
    larger, view, angle = EXAMPLES[name]
    files = sorted(results.glob("fields_*.vtu"))
    plot = pv.Plotter(off_screen=True, window_size=(1100, 620 * len(steps)), shape=(len(steps), 1))
    most = max(float(pv.read(files[step])["von_mises"].max()) for step in steps)
    for row, step in enumerate(steps):
        plot.subplot(row, 0)
        body = pv.read(files[step])
        body.points += larger * body["displacement"]
        skin = body.extract_surface(nonlinear_subdivision=2, algorithm="dataset_surface")
        bar = {"title": "von Mises stress [MPa]", "vertical": True, "position_x": 0.87, "position_y": 0.2, "height": 0.6,
               "color": "black"}  # fmt: skip
        plot.add_mesh(skin, scalars="von_mises", cmap="viridis", clim=(0.0, most), scalar_bar_args=bar, ambient=0.3)
        edges = body.extract_surface(nonlinear_subdivision=0, algorithm="dataset_surface").extract_all_edges()
        plot.add_mesh(edges, color="#30343a", line_width=1, opacity=0.35)
        plot.camera_position = view
        plot.camera.view_angle = angle
        plot.background_color = "white"
    plot.enable_anti_aliasing("ssaa")
    plot.screenshot(DOCS / "pictures" / f"{name}.png")


def main() -> None:
    for name in EXAMPLES:
        solution = abut.solve(load_job(DOCS.parent / "examples" / name / "job.toml").model)
        with tempfile.TemporaryDirectory() as folder:
            picture(abut.write(solution, Path(folder)), name)


if __name__ == "__main__":
    main()
