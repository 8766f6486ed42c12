"""Pictures of docs/job.md: a joint that fluid enters, a body that goes and comes back, loads in local axes, stress from
before (needs matplotlib)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from matplotlib.collections import PolyCollection

import abut
from abut.benchmarks import BENCHMARKS
from abut.benchmarks.penetration import BASE, HEAD, LIGAMENT, WEIGHT
from abut.benchmarks.removals import LENGTH, STRETCH, YOUNG
from abut.benchmarks.residual_stress import LENGTH as LONG
from abut.benchmarks.residual_stress import STRESS
from abut.materials.invariants import von_mises
from abut.mesh.make import join, ring
from page import DOCS, plots

RED, BLUE, GREY = "#b3261e", "#1f5fa8", "#8a95a1"


def penetration() -> None:
    """Pressure under the block of ``abut verify uplift`` and the fluid's, over the base, beside the hand formula."""
    solution = abut.solve(BENCHMARKS["uplift"].model(0))
    step = solution.steps[-1]
    contact = step.contacts[0]
    x = solution.model.mesh.points[contact.contactor.nodes[:, :2], 0]
    figure, axes = plots().subplots(figsize=(6.6, 2.8), constrained_layout=True)
    tip = BASE - LIGAMENT
    wet = step.penetrations["joint"].area
    axes.fill_between([0.0, wet], [HEAD, HEAD], color=BLUE, alpha=0.25, lw=0.0, label="fluid in the joint")
    order = np.argsort(x.ravel(), kind="stable")
    axes.plot(x.ravel()[order], contact.pressure[:, :2].ravel()[order], color=RED, lw=1.4, label="contact pressure")
    top = HEAD + 2.0 * (WEIGHT - HEAD * BASE) / LIGAMENT
    axes.plot([0.0, tip, BASE], [HEAD, HEAD, top], color="black", lw=0.9, ls="--", label="gravity method")
    axes.set_xlabel("distance from the heel")
    axes.set_ylabel("pressure")
    axes.set_xlim(0.0, BASE)
    axes.set_ylim(0.0, None)
    axes.legend(frameon=False, loc="upper left")
    figure.savefig(DOCS / "pictures" / "penetration.png", dpi=150)


def removal() -> None:
    """Force on the bar of ``abut verify half-returns`` over the time, beside that of two springs."""
    model = BENCHMARKS["half-returns"].model(0)
    model = replace(model, solve=replace(model.solve, times=tuple(np.linspace(0.0, 1.0, 41)[1:])))
    solution = abut.solve(model)
    time = [0.0, *(step.factor for step in solution.steps)]
    force = [0.0, *(float(step.reactions["bar.top"][2]) for step in solution.steps)]
    half = YOUNG * STRETCH / LENGTH / 2.0
    figure, axes = plots().subplots(figsize=(6.6, 2.8), constrained_layout=True)
    axes.axvspan(0.25, 0.75, color=GREY, alpha=0.2, lw=0.0)
    axes.text(0.5, 0.3 * half, "one half is away", ha="center", color="#4a535d")
    axes.plot(time, force, color=RED, lw=1.4, marker="o", ms=2.5, label="force on the bar")
    exact = [0.0, 2.0 * half, half, 3.0 * half]
    axes.plot([0.0, 0.25, 0.75, 1.0], exact, color="black", lw=0.9, ls="--", label="two springs")
    axes.set_xlabel("time")
    axes.set_ylabel("force")
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(0.0, None)
    axes.legend(frameon=False, loc="upper left")
    figure.savefig(DOCS / "pictures" / "removal.png", dpi=150)


def load_axes() -> None:
    """A hub held in its bore: tractions on its rim, around and outwards in cylindrical axes, and what they do."""
    mesh = join({"hub": ring((1.0, 2.0), (0.0, 270.0), cells=(4, 36), cell="quad4")})
    figure, frames = plots().subplots(1, 2, figsize=(7.6, 3.8), constrained_layout=True)
    around = abut.Axes("cylindrical")
    for axes, value, title in zip(frames, ((0.0, 5.0), (5.0, 0.0)), ("value = [0, 5]", "value = [5, 0]")):
        model = abut.Model(
            mesh,
            [abut.Solid("hub", abut.LinearElastic(1000.0, 0.3))],
            [abut.Support("hub.inner", x=0, y=0)],
            [abut.Traction("hub.outer", value, axes=around)],
            plane="strain",
        )
        step = abut.solve(model).steps[-1]
        points = mesh.points + 15.0 * step.displacement
        cells = next(nodes for _, nodes, _ in mesh.cells_of("hub"))
        axes.add_collection(PolyCollection(mesh.points[cells], facecolors="none", edgecolors="#d5dae0", linewidths=0.4))
        shown = PolyCollection(points[cells], edgecolors=GREY, linewidths=0.3, cmap="viridis")
        shown.set_array(von_mises(step.stress)[cells].mean(axis=1))
        axes.add_collection(shown)
        rim = mesh.nodes_of("hub.outer")[::2]
        at, arrows = points[rim], 0.07 * np.einsum("nkd,k->nd", around.frames(mesh.points[rim]), value)
        axes.quiver(*at.T, *arrows.T, color=RED, angles="xy", scale_units="xy", scale=1.0, width=0.005)
        figure.colorbar(shown, ax=axes, shrink=0.7, label="von Mises stress")
        axes.set_title(title, fontsize=9)
        axes.set_aspect("equal")
        axes.set_xlim(-2.6, 2.6)
        axes.set_ylim(-2.6, 2.6)
        axes.axis("off")
    figure.savefig(DOCS / "pictures" / "load-axes.png", dpi=150)


def initial_stress() -> None:
    """The strip of ``abut verify spring-back``: how it bends, and stress over its height, given and left, beside beams."""
    solution = abut.solve(BENCHMARKS["spring-back"].model(0))
    mesh, step = solution.model.mesh, solution.steps[-1]
    figure, (shape, axes) = plots().subplots(1, 2, figsize=(7.6, 2.8), constrained_layout=True, width_ratios=[1.6, 1.0])
    cells = next(nodes for _, nodes, _ in mesh.cells_of("strip"))[:, :4]
    moved = mesh.points + 60.0 * step.displacement
    shape.add_collection(PolyCollection(mesh.points[cells], facecolors="none", edgecolors="#d5dae0", linewidths=0.4))
    shown = PolyCollection(moved[cells], edgecolors=GREY, linewidths=0.3, cmap="viridis")
    shown.set_array(step.stress[cells, 0].mean(axis=1))
    shape.add_collection(shown)
    shape.autoscale()
    shape.set_aspect("equal")
    shape.axis("off")
    figure.colorbar(shown, ax=shape, shrink=0.7, label="stress along the strip")
    column = np.flatnonzero(np.abs(mesh.points[:, 0] - 0.5 * LONG) < 1e-9)
    column = column[np.argsort(mesh.points[column, 1])]
    y = np.linspace(-0.5, 0.5, 101)
    axes.plot(STRESS * (2.0 * y) ** 3, y, color=GREY, lw=1.2, label="initial stress")
    axes.plot(STRESS * ((2.0 * y) ** 3 - 1.2 * y), y, color="black", lw=0.9, ls="--", label="beam")
    axes.plot(
        step.stress[column, 0], mesh.points[column, 1], color=RED, lw=0.0, marker="o", ms=3.0, label="what is left"
    )
    axes.set_xlabel("stress along the strip")
    axes.set_ylabel("height")
    axes.legend(frameon=False, fontsize=8, loc="lower right")
    figure.savefig(DOCS / "pictures" / "initial-stress.png", dpi=150)


if __name__ == "__main__":
    penetration()
    removal()
    load_axes()
    initial_stress()
