"""Draw the picture of the gallery from a finished run: python picture.py OUT.png (needs pyvista)."""

from __future__ import annotations

import sys
from pathlib import Path

import pyvista as pv

RESULTS = Path(__file__).with_name("results")
STEP = 3  # partly turned: slips at the end where the shaft is held, sticks at the flange
ZONES = ("#b8bec6", "#2a6fb5", "#e8a33d")  # open, sticks, slips


def main(out: Path) -> None:
    """The hub cut in half with what its bore does on the shaft: zones of stick and slip, and the traction as arrows."""
    fields = pv.read(RESULTS / f"fields_{STEP:04d}.vtu")
    contact = pv.read(RESULTS / f"contact_fit_{STEP:04d}.vtu")
    plot = pv.Plotter(off_screen=True, window_size=(1300, 860))
    for number, colour in enumerate(("#8fa9c9", "#cfd4da")):
        body = fields.extract_cells(fields["body"] == number)
        skin = body.extract_surface(nonlinear_subdivision=3, algorithm="dataset_surface")
        if number == 1:
            plot.add_mesh(body.clip("y", origin=(0, 0, 0), invert=False), color=colour, ambient=0.4)
            plot.add_mesh(skin.clip("y", origin=(0, 0, 0), invert=False).extract_feature_edges(35), color="#444444")
        else:
            plot.add_mesh(skin, color=colour, opacity=0.12)
            plot.add_mesh(skin.extract_feature_edges(35), color="#5f7fa6", line_width=2)
    half = (contact["side"] == 0) & (contact.cell_centers().points[:, 1] > 0.0)
    bore = contact.extract_cells(half)
    bore.points[:, :2] *= 0.997  # just in front of the hub's own surface
    zones = bore.extract_surface(nonlinear_subdivision=0, algorithm="dataset_surface")
    plot.add_mesh(
        zones, scalars="friction_status", cmap=list(ZONES), clim=(-0.5, 2.5), show_scalar_bar=False, lighting=False
    )
    corners = bore.extract_points(bore.cell_connectivity.reshape(-1, 8)[:, :4].ravel(), include_cells=False)
    corners.points[:, :2] *= 0.98
    corners.set_active_vectors("traction")
    largest = float((contact["traction"] ** 2).sum(axis=1).max() ** 0.5)
    plot.add_mesh(corners.glyph(orient="traction", scale="traction", factor=4.0 / largest), color="#12181f")
    legend = [[name, colour] for name, colour in zip(("sticks", "slips"), ZONES[1:])]
    plot.add_legend(legend, bcolor="white", face="rectangle", size=(0.13, 0.1), loc="upper right")
    plot.camera_position = [(20, -88, 62), (0, 0, 24), (0, 0, 1)]
    plot.camera.view_angle = 34
    plot.background_color = "white"
    plot.enable_anti_aliasing("ssaa")
    plot.screenshot(out)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
