"""Pictures of docs/gallery.md: python docs/make/gallery.py (a minute; needs pyvista and matplotlib)."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
import pyvista as pv

import abut
from abut.benchmarks.measures import contact_points
from abut.job import load_job
from page import DOCS, plots

EXAMPLES = DOCS.parent / "examples"
HALF_WIDTH, PEAK = 6.2146, 3585.36  # Hertz, as in examples/hertz-line


def fields(solution: abut.Solution) -> tuple[pv.UnstructuredGrid, pv.UnstructuredGrid]:
    """The displacement field and the first contact's surfaces, as ParaView would read them."""
    with tempfile.TemporaryDirectory() as folder:
        results = abut.write(solution, Path(folder))
        return pv.read(sorted(results.glob("fields_*.vtu"))[-1]), pv.read(sorted(results.glob("contact_*.vtu"))[-1])


def solid_picture(
    solution: abut.Solution, name: str, title: str, view: list[tuple[float, ...]], angle: float, whole: int
) -> None:
    """Body ``whole`` with its cells, the outline of the other, and the contactor's pressure where it is in contact."""
    body, contact = fields(solution)
    plot = pv.Plotter(off_screen=True, window_size=(1100, 720))
    for number in (0, 1):
        own = body.extract_cells(body["body"] == number)
        skin = own.extract_surface(nonlinear_subdivision=0, algorithm="dataset_surface")
        if number == whole:
            plot.add_mesh(skin, color="#dfe3e8", show_edges=True, edge_color="#8a95a1", ambient=0.25)
        else:
            plot.add_mesh(skin.extract_feature_edges(35), color="#5f7fa6", line_width=2)
    side = contact.extract_cells(contact["side"] == 0)
    side = side.extract_surface(nonlinear_subdivision=3, algorithm="dataset_surface")
    side = side.threshold(0.01 * solution.contacts[0].max_pressure, scalars="pressure", all_scalars=True)
    look = np.subtract(view[0], view[1])
    side.points += 0.01 * side.length * look / np.linalg.norm(look)  # just in front of the body's own surface
    bar = {"title": title, "vertical": True, "position_x": 0.86, "position_y": 0.2, "height": 0.6, "color": "black"}
    limits = (0.0, solution.contacts[0].max_pressure)
    plot.add_mesh(side, scalars="pressure", cmap="inferno", clim=limits, lighting=False, scalar_bar_args=bar)
    plot.camera_position = view
    plot.camera.view_angle = angle
    plot.background_color = "white"
    plot.enable_anti_aliasing("ssaa")
    plot.screenshot(DOCS / "pictures" / name)


def line_picture() -> None:
    """Pressure along the block against Hertz, for both job files."""
    plt = plots()
    figure, axes = plt.subplots(figsize=(7.0, 3.6), constrained_layout=True)
    x = np.linspace(-HALF_WIDTH, HALF_WIDTH, 400)
    axes.plot(x, PEAK * np.sqrt(1.0 - (x / HALF_WIDTH) ** 2), color="0.75", lw=5, label="Hertz")
    for cell, mark in (("quad8", "o-"), ("quad4", "x")):
        at, pressure = contact_points(abut.solve(load_job(EXAMPLES / "hertz-line" / f"{cell}.toml").model).contacts[0])
        near = np.abs(at[:, 0]) < 8.5
        order = np.argsort(at[near, 0], kind="stable")
        axes.plot(at[near, 0][order], pressure[near][order], mark, ms=4, lw=1, label=f"abut, {cell}")
    axes.set_xlabel("position along the block [mm]")
    axes.set_ylabel("contact pressure [MPa]")
    axes.legend(frameon=False)
    figure.savefig(DOCS / "pictures" / "hertz-line.png", dpi=150)


def main() -> None:
    blocks = abut.solve(load_job(EXAMPLES / "two-blocks" / "job.toml").model)
    solid_picture(blocks, "two-blocks.png", "pressure [MPa]", [(22, -26, -4), (5, 5, 7.4), (0, 0, 1)], 27, whole=1)
    line_picture()
    ball = abut.solve(load_job(EXAMPLES / "hertz-sphere" / "job.toml").model)
    solid_picture(
        ball, "hertz-sphere.png", "pressure", [(-1.5, -2.6, -3.6), (0.75, 0.55, 0.25), (0, 0, 1)], 28, whole=0
    )


if __name__ == "__main__":
    main()
