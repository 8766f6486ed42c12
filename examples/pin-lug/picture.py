"""Draw the picture of the README from a finished run: python picture.py OUT.png (needs pyvista)."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pyvista as pv

RESULTS = Path(__file__).with_name("results")


def main(out: Path) -> None:
    """The lug with its deformation, the hole coloured by the contact pressure, the pin as a ghost."""
    fields = pv.read(sorted(RESULTS.glob("fields_*.vtu"))[-1])
    contact = pv.read(sorted(RESULTS.glob("contact_*.vtu"))[-1])
    hole = contact.extract_cells(contact["side"] == 0).extract_surface(
        nonlinear_subdivision=3, algorithm="dataset_surface"
    )
    hole.points[:, :2] *= 0.98  # just in front of the lug's own surface
    plot = pv.Plotter(off_screen=True, window_size=(1400, 860))
    for number, (colour, opacity) in enumerate((("#cfd4da", 1.0), ("#5f7fa6", 0.06))):
        body = fields.extract_cells(fields["body"] == number).extract_surface(
            nonlinear_subdivision=3, algorithm="dataset_surface"
        )
        plot.add_mesh(body, color=colour, opacity=opacity)
        plot.add_mesh(body.extract_feature_edges(35), color="#444444", line_width=2)
    bar = {"title": "contact pressure [MPa]", "vertical": True, "position_x": 0.86, "position_y": 0.2, "height": 0.6}
    summary = json.loads((RESULTS / "summary.json").read_text(encoding="utf-8"))
    largest = summary["steps"][-1]["contacts"][0]["max_pressure"]  # of nodes that are covered by half at least
    colours = {"cmap": "inferno", "clim": [0.0, largest]}
    plot.add_mesh(hole, lighting=False, scalars="pressure", scalar_bar_args={**bar, "color": "black"}, **colours)
    plot.camera_position = [(-22, -50, 34), (6, 6, 3), (0, 0, 1)]
    plot.camera.view_angle = 32
    plot.background_color = "white"
    plot.enable_anti_aliasing("ssaa")
    plot.screenshot(out)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
