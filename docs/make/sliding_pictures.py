"""Pictures of sliding in docs/gallery.md: a strip, an O-ring, a snap joint, a clamp, two gears (needs matplotlib)."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.collections import PolyCollection

import abut
from abut.benchmarks import BENCHMARKS
from abut.job import load_job
from page import DOCS, plots

COLOURS = ("#c9d6e6", "#dfe3e8", "#eee6d8")
CORNERS = {"tri": 3, "quad": 4}


def draw(axes, solution: abut.Solution, step: abut.solution.Step, scale: float) -> None:
    """Bodies as they are in a step, and the pressure on the contactor as arrows, length per pressure ``scale``."""
    mesh = solution.model.mesh
    points = mesh.points + step.displacement
    for colour, body in zip(COLOURS, mesh.bodies):
        for kind, nodes, _ in mesh.cells_of(body):
            corners = points[nodes[:, : CORNERS[kind[:-1]]]]
            axes.add_collection(PolyCollection(corners, facecolors=colour, edgecolors="#8a95a1", linewidths=0.25))
    contact = step.contacts[0]
    surface = contact.contactor
    for nodes, pressure in zip(surface.nodes, contact.pressure):
        x = points[nodes[:2]]
        along = x[1] - x[0]
        normal = np.array([along[1], -along[0]]) / np.linalg.norm(along)
        for place, value in zip(x, pressure[:2]):
            if value > 0.02 * contact.max_pressure:
                end = place - scale * value * normal
                axes.plot(*np.transpose([place, end]), color="#b3261e", lw=0.8, solid_capstyle="butt")
    axes.set_aspect("equal")
    axes.autoscale_view()
    axes.axis("off")


def series(
    name: str, solution: abut.Solution, times: Sequence[float], scale: float, limits: Sequence[float], rows: int = 1
) -> None:
    """The steps next to some times, side by side."""
    figure, frames = plots().subplots(
        rows, len(times) // rows, figsize=(9.0, 1.4 + 1.3 * rows), constrained_layout=True, squeeze=False
    )
    for axes, time in zip(frames.ravel(), times):
        step = min(solution.steps, key=lambda candidate: abs(candidate.factor - time))
        draw(axes, solution, step, scale)
        axes.set_xlim(limits[0], limits[1])
        axes.set_ylim(limits[2], limits[3])
    figure.savefig(DOCS / "pictures" / name, dpi=150)


def snap_curve(solution: abut.Solution) -> None:
    """Force that pushes the hook over its way."""
    figure, axes = plots().subplots(figsize=(6.0, 2.8), constrained_layout=True)
    travel = solution.model.supports[1].x
    way = [0.0, *(travel * step.factor for step in solution.steps)]
    axes.plot(way, [0.0, *(-step.contacts[0].force[0] for step in solution.steps)], ".-", ms=4, lw=1)
    axes.axhline(0.0, color="0.7", lw=0.8)
    axes.set_xlabel("way of the hook [mm]")
    axes.set_ylabel("force [N/mm]")
    figure.savefig(DOCS / "pictures" / "snap-joint-force.png", dpi=150)


def clamp_curve(solution: abut.Solution) -> None:
    """Friction of the pad and what it can be at most, over the time; lines where steps end."""
    figure, axes = plots().subplots(figsize=(6.0, 2.8), constrained_layout=True)
    ends = {"tighten": 1.0, "pull": 2.0, "let go": 3.0}
    times = [0.0, *(step.factor * max(ends.values()) for step in solution.steps)]
    own = [step.contacts[0] for step in solution.steps]
    axes.plot(times, [0.0, *(contact.force[0] for contact in own)], ".-", label="friction")
    axes.plot(times, [0.0, *(contact.friction.force_limit for contact in own)], "--", color="0.5", label="its limit")
    for name, end in ends.items():
        axes.axvline(end, color="0.85", lw=0.8)
        axes.text(end - 0.5, 3.75, name, ha="center", color="0.4")
    axes.set_ylim(0.0, 4.1)
    axes.set_xlabel("time")
    axes.set_ylabel("force [N/mm]")
    axes.legend(frameon=False, loc="center right")
    figure.savefig(DOCS / "pictures" / "clamped-strip-force.png", dpi=150)


def example(name: str) -> abut.Solution:
    return abut.solve(load_job(DOCS.parent / "examples" / name / "job.toml").model)


def main() -> None:
    series("accordion.png", example("accordion"), (0.1, 0.5, 1.0), 0.02, (-1.4, 2.0, -2.0, 2.0))
    series("o-ring.png", example("o-ring"), (0.05, 0.5, 1.0), 0.12, (-3.6, 3.6, -1.1, 4.6))
    snap = example("snap-joint")
    peak = max(snap.steps, key=lambda step: -step.contacts[0].force[0]).factor
    series("snap-joint.png", snap, (peak, 0.45, 0.7, 1.0), 0.01, (0.0, 13.5, -2.5, 3.0), rows=2)
    snap_curve(snap)
    clamp_curve(example("clamped-strip"))
    gears = abut.solve(BENCHMARKS["gears"].model(0))
    series("gears.png", gears, (0.1, 0.55, 1.0), 0.1, (22.0, 68.0, -24.0, 24.0))


if __name__ == "__main__":
    main()
