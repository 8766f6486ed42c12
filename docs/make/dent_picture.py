"""Picture of the dented plate in docs/gallery.md: python docs/make/dent_picture.py (half a minute; needs matplotlib)."""

from __future__ import annotations

import numpy as np

import abut
from abut.job import load_job
from abut.materials.plastic import EQUIVALENT
from page import DOCS, plots, save

LARGER, NEAR = 5.0, 1.5  # displacements as drawn, and how much of the plate
SIDES = (("pressed", 0.6, -1.0), ("taken off", 1.0, 1.0))


def main() -> None:
    plt = plots()
    solution = abut.solve(load_job(DOCS.parent / "examples" / "dented-plate" / "job.toml").model)
    mesh = solution.model.mesh
    cells = mesh.blocks[0].nodes
    assert set(mesh.bodies["plate"]) == set(range(len(cells)))
    figure, axes = plt.subplots(figsize=(7.0, 3.4), constrained_layout=True)
    for text, time, side in SIDES:
        step = next(step for step in solution.steps if abs(step.factor - time) < 1e-9)
        at = mesh.points + LARGER * step.displacement
        corners = at[cells] * (side, 1.0)
        strain = np.asarray(step.remembered[EQUIVALENT]).reshape(-1)[cells].mean(axis=1)
        shown = (np.abs(corners[..., 0]).max(axis=1) < NEAR) & (corners[..., 1].min(axis=1) > -NEAR)
        drawn = plt.matplotlib.collections.PolyCollection(
            corners[shown], array=100.0 * strain[shown], cmap="inferno_r", edgecolors="0.6", linewidths=0.2
        )
        drawn.set_clim(0.0, 8.0)
        axes.add_collection(drawn)
        axes.text(side * 0.95 * NEAR, 0.2, text, ha="left" if side < 0.0 else "right")
    axes.set(xlim=(-NEAR, NEAR), ylim=(-1.2, 0.35), aspect="equal", xlabel="radius [mm]", ylabel="height [mm]")
    figure.colorbar(drawn, ax=axes, label="equivalent plastic strain [%]", shrink=0.8)
    save(figure, "dented-plate.png")


if __name__ == "__main__":
    main()
