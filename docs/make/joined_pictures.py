"""Pictures of job.md and probes.md: jobs after each other, bolts, what joins and holds bodies, modes (matplotlib)."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection

import abut
from abut.benchmarks import BENCHMARKS, joined, local_axes, started
from abut.benchmarks import response as shaking
from abut.benchmarks.connectors import slider_crank, travel
from abut.benchmarks.holds import LOAD, STIFFNESS, STRETCH
from abut.benchmarks.preloads import sleeve
from abut.io.vtu import write_vtu
from abut.mesh.make import join, rectangle, ring
from page import DOCS, plots

RED, BLUE, GREY = "#b3261e", "#1f5fa8", "#8a95a1"


def saved(figure: Any, name: str) -> None:
    figure.savefig(DOCS / "pictures" / f"{name}.png", dpi=150)


def panel(across: str, along: str, columns: int = 1) -> tuple[Any, Any]:
    figure, axes = plots().subplots(1, columns, figsize=(6.6, 2.8), constrained_layout=True)
    for one, x, y in zip(np.atleast_1d(axes), across.split("|"), along.split("|")):
        one.set_xlabel(x)
        one.set_ylabel(y)
    return figure, axes


def at_times(model: abut.Model, count: int) -> abut.Model:
    return replace(model, solve=replace(model.solve, steps=1, times=tuple(np.linspace(0.0, 1.0, count + 1)[1:])))


def start() -> None:
    """Traction over the stretch of the bar of ``abut verify start-plastic``, the steps of either job in a colour."""
    benchmark = BENCHMARKS["start-plastic"]
    model = at_times(benchmark.model(0), 24)
    solution = abut.solve(model)
    nodes = model.mesh.nodes_of("bar.right")
    time = np.array([0.0, *(step.factor for step in solution.steps)])
    way = np.array([0.0, *(float(step.displacement[nodes, 0].mean()) for step in solution.steps)])
    pull = started.PULL * np.interp(time, [0.0, started.SHARE, 1.0], [0.0, 1.0, 0.0])
    figure, axes = panel("stretch of the bar", "traction")
    first, second = time <= started.SHARE, time >= started.SHARE
    axes.plot(way[first], pull[first], color=BLUE, marker="o", ms=3, label="first job, whose steps are taken over")
    axes.plot(way[second], pull[second], color=RED, marker="o", ms=3, label="second job")
    axes.axvline(
        benchmark.references["let go"].value, color="black", lw=0.9, ls="--", label="plastic strain, (300 - 200) / H"
    )
    axes.set_ylim(0.0, None)
    axes.legend(frameon=False, loc="center right", bbox_to_anchor=(0.85, 0.45))
    saved(figure, "start")


def bolt() -> None:
    """Tension of the bolt of ``abut verify bolt-opened`` over the force that pulls the joint apart."""
    model = at_times(sleeve("small", apart=16000.0), 40)
    solution = abut.solve(model)
    steps = [step for step in solution.steps if step.factor >= 0.5 - 1e-9]
    pulled = [16000.0 * (2.0 * step.factor - 1.0) for step in steps]
    figure, axes = panel("force that pulls the joint apart", "force")
    axes.plot(pulled, [step.preloads["bolt"].tension for step in steps], color=RED, marker="o", ms=3, label="bolt")
    rest = [abs(float(step.contacts[1].force[1])) for step in steps]
    axes.plot(pulled, rest, color=BLUE, marker="o", ms=3, label="sleeve")
    axes.plot([0, 12500, 16000], [10000, 12500, 16000], color="black", lw=0.9, ls="--", label="two springs")
    axes.plot([0, 12500, 16000], [10000, 0, 0], color="black", lw=0.9, ls="--")
    axes.legend(frameon=False, loc="center right")
    saved(figure, "bolt")


def grid(axes: Any, solution: abut.Solution, scale: float) -> Any:
    """The deformed cells of a plane model, coloured by the stress along x."""
    mesh, step = solution.model.mesh, solution.steps[-1]
    points = mesh.points + scale * step.displacement
    cells = next(nodes[:, :4] for _, nodes, _ in mesh.cells_of("beam"))
    axes.add_collection(PolyCollection(mesh.points[cells], facecolors="none", edgecolors="#d5dae0", linewidths=0.4))
    shown = PolyCollection(points[cells], edgecolors=GREY, linewidths=0.3, cmap="viridis")
    shown.set_array(step.stress[cells, 0].mean(axis=1))
    axes.add_collection(shown)
    return shown


def couplings() -> None:
    """A short beam like that of ``abut verify coupled-beam``, Poisson's ratio .45, with either kind of coupling."""
    model = BENCHMARKS["coupled-beam"].model(1)
    mesh = join({"beam": rectangle((0.0, 6.0), (-2.0, 2.0), (12, 8), "quad8")})
    eye = np.array([9.0, 3.0])
    figure, frames = plots().subplots(1, 2, figsize=(7.6, 3.4), constrained_layout=True)
    shown = None
    for axes, kind in zip(frames, ("distributing", "kinematic")):
        one = replace(
            model,
            mesh=mesh,
            solids=[abut.Solid("beam", abut.LinearElastic(joined.YOUNG, 0.45))],
            couplings=[replace(model.couplings[0], kind=kind, reference=tuple(eye))],
            loads=[abut.Force("eye", (-60.0, 0.0))],
        )
        solution = abut.solve(one)
        scale = 1.0
        shown = grid(axes, solution, scale)
        there = eye + scale * solution.steps[-1].rigid["eye"].displacement
        for point in (mesh.points + scale * solution.steps[-1].displacement)[mesh.nodes_of("beam.right")]:
            axes.plot(*zip(point, there), color=RED, lw=0.5)
        axes.plot(*there, "o", color=RED, ms=5)
        axes.annotate("", there - (2.0, 0.0), there, arrowprops={"arrowstyle": "->", "color": RED})
        axes.set_title(f'kind = "{kind}"', fontsize=9)
        axes.set_xlim(-0.5, 9.5)
        axes.set_ylim(-2.5, 5.6)
        axes.set_aspect("equal")
        axes.axis("off")
    figure.colorbar(shown, ax=frames, shrink=0.7, label="stress along x")
    saved(figure, "couplings")


def connectors() -> None:
    """The crank of ``abut verify slider-crank`` over a whole turn: bars in four positions, travel and moment."""
    whole = 2.0 * np.pi
    *others, eye = slider_crank(whole).connectors
    pushed = replace(eye, amplitude=abut.Amplitude(((0.0, 1.0),)))
    times = abut.SolveOptions(times=tuple(np.linspace(0.0, 1.0, 25)[1:]))
    model = replace(slider_crank(whole), connectors=[*others, pushed], solve=times)
    solution = abut.solve(model)
    mesh, plt = model.mesh, plots()
    figure, (left, right) = plt.subplots(1, 2, figsize=(8.4, 2.9), width_ratios=(1.5, 1.0), constrained_layout=True)
    for number, (name, color) in enumerate((("crank", RED), ("rod", GREY))):
        cells = next(nodes[:, :4] for _, nodes, _ in mesh.cells_of(name))
        for step in solution.steps[3:19:5]:
            shape = (mesh.points + step.displacement)[cells]
            left.add_collection(PolyCollection(shape, facecolors=color, edgecolors="none", alpha=0.35 + 0.2 * number))
    for step in solution.steps[3:19:5]:
        end = np.array([13.0 + step.connectors["eye"].motion["travel"], 0.0])
        crank = 3.0 * np.array([np.cos(whole * step.factor), np.sin(whole * step.factor)])
        left.plot(*np.array([np.zeros(2), crank, end]).T, color="black", lw=0.8, marker="o", ms=4)
    left.axhline(0.0, color=GREY, lw=0.6, zorder=0)
    left.set_xlim(-4.2, 14.2)
    left.set_ylim(-4.2, 4.2)
    left.set_aspect("equal")
    left.axis("off")
    angles = np.linspace(0.0, whole, 200)
    steps = [whole * step.factor for step in solution.steps]
    joints = [step.connectors for step in solution.steps]
    right.plot(steps, [j["eye"].motion["travel"] for j in joints], "o", color=RED, ms=3, label="travel of the eye")
    right.plot(steps, [j["axle"].drive / 5.0 for j in joints], "s", color=GREY, ms=3, label="moment / force")
    for curve in travel(angles):
        right.plot(angles, curve, color="black", lw=0.8, ls="--")
    right.set_xlabel("angle of the crank")
    right.legend(frameon=False, fontsize=8)
    saved(figure, "connectors")


def springs() -> None:
    """A beam that is pushed up and down at its tip, where a spring carries downward only: its table, beside beam theory."""
    mesh = join({"arm": rectangle((0.0, 20.0), (0.0, 2.0), (10, 2), "quad8")})
    tip = np.flatnonzero((mesh.points == (20.0, 1.0)).all(axis=1))
    force = abut.Amplitude(((0.0, -1.0), (1.0, 1.0)))
    stiffness = 3.0 * 1000.0 * (8.0 / 12.0) / 20.0**3
    model = abut.Model(
        replace(mesh, node_sets={"tip": tip}),
        [abut.Solid("arm", abut.LinearElastic(1000.0, 0.0))],
        [abut.Support("arm.left", x=0, y=0)],
        [abut.NodalForce("tip", (0.0, 0.5), force)],
        springs=[abut.Spring("bed", "tip", y=((-1.0, -2.0 * stiffness), (0.0, 0.0), (1.0, 0.0)))],
        plane="stress",
        solve=abut.SolveOptions(times=tuple(np.linspace(0.0, 1.0, 21)[1:])),
    )
    solution = abut.solve(model)
    ways = [float(step.displacement[tip[0], 1]) for step in solution.steps]
    pushes = [0.5 * (2.0 * step.factor - 1.0) for step in solution.steps]
    figure, axes = panel("force on the tip", "displacement of the tip")
    axes.plot(
        pushes, ways, color=RED, marker="o", ms=3, label="arm with a spring below its tip, of twice its stiffness"
    )
    line = np.array([-0.5, 0.0, 0.5])
    bent = line / stiffness + line * 20.0 / (500.0 * 2.0 / 1.2)
    soft = 1.0 / (bent[-1] / 0.5)
    axes.plot(
        line,
        [-0.5 / (soft + 2.0 * stiffness), 0.0, 0.5 / soft],
        color="black",
        lw=0.9,
        ls="--",
        label="beam and spring side by side",
    )
    axes.legend(frameon=False, loc="upper left")
    saved(figure, "springs")


def stops() -> None:
    """Way of the bar of ``abut verify stop`` and force of the stop over the force that pulls it."""
    solution = abut.solve(at_times(BENCHMARKS["stop"].model(0), 20))
    top = solution.model.mesh.nodes_of("bar.top")
    pulled = [0.0, *(3.0 * step.factor for step in solution.steps)]
    figure, (left, right) = panel("force on the bar|force on the bar", "displacement of its end|force of the stop", 2)
    left.plot(
        pulled, [0.0, *(float(step.displacement[top, 2].max()) for step in solution.steps)], color=RED, marker="o", ms=3
    )
    left.plot([0.0, 1.0, 3.0], [0.0, joined.GAP, joined.GAP], color="black", lw=0.9, ls="--")
    right.plot(
        pulled, [0.0, *(abs(float(step.contacts[0].force[2])) for step in solution.steps)], color=RED, marker="o", ms=3
    )
    right.plot([0.0, 1.0, 3.0], [0.0, 0.0, 2.0], color="black", lw=0.9, ls="--")
    saved(figure, "stops")


def holds() -> None:
    """Displacement and force of the bar of ``abut verify holds`` over the time, beside a spring's."""
    solution = abut.solve(at_times(BENCHMARKS["holds"].model(0), 40))
    top = solution.model.mesh.nodes_of("bar.top")
    time = [0.0, *(step.factor for step in solution.steps)]
    way = [0.0, *(float(step.displacement[top, 2].mean()) for step in solution.steps)]
    force = [0.0, *(float(step.reactions["bar.top"][2]) for step in solution.steps)]
    figure, frames = panel("time|time", "displacement of the end|force of the holds", 2)
    corners = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]
    held, down = STIFFNESS * STRETCH, -LOAD / STIFFNESS
    exact = ([0.0, STRETCH, STRETCH, down, down, down], [0.0, held, held + LOAD, 0.0, 0.0, -LOAD])
    for axes, values, line in zip(frames, (way, force), exact):
        axes.plot(time, values, color=RED, marker="o", ms=2.5)
        axes.plot(corners, line, color="black", lw=0.9, ls="--")
        for begin, end in ((0.0, 0.4), (0.8, 1.0)):
            axes.axvspan(begin, end, color=GREY, alpha=0.2, lw=0.0)
    saved(figure, "holds")


def modes() -> None:
    """The strut of ``abut verify strut``: three frequencies, unloaded and under half of the force at which it buckles."""
    model = BENCHMARKS["strut"].model(0)
    euler = BENCHMARKS["strut"].references["force"].value
    figure, axes = panel("force over the buckling load", "frequency over that without force")
    shares = np.linspace(0.0, 0.98, 8)
    found = []
    for share in shares:
        one = replace(
            model,
            solids=[abut.Solid("strut", abut.LinearElastic(210e3, 0.0, 7.85e-9))],
            loads=[abut.Force("strut.right", (-share * euler, 0.0))],
            modes=[abut.Frequencies(2)],
        )
        found.append(abut.solve(one).modes[0].values)
    table = np.array(found) / found[0]
    for mode, colour in enumerate((RED, BLUE)):
        axes.plot(shares, table[:, mode], color=colour, marker="o", ms=3, label=f"frequency {mode + 1}")
    fine = np.linspace(0.0, 1.0, 101)
    axes.plot(fine, np.sqrt(1.0 - fine), color="black", lw=0.9, ls="--", label="sqrt(1 - force / buckling load)")
    axes.legend(frameon=False, loc="lower left")
    axes.set_ylim(0.0, None)
    saved(figure, "strut")


def response() -> None:
    """The mass of ``abut verify sudden-load``, beside closed forms."""
    solution = abut.solve(BENCHMARKS["sudden-load"].model(0))
    over_time, steady = solution.responses
    static, zeta = shaking.STATIC, shaking.DAMPING
    figure, every = plots().subplots(1, 3, figsize=(9.6, 2.6), constrained_layout=True)
    moved, r = steady.probes[0].displacement[:, 0, 1], steady.at * 2.0 * np.pi / shaking.OMEGA
    fine = np.linspace(0.0, r.max(), 400)
    exact = 1.0 / (1.0 - fine**2 + 2j * zeta * fine)
    for axes, shown, known in (
        (every[0], np.abs(moved) / static, np.abs(exact)),
        (every[1], np.degrees(np.angle(moved)), np.degrees(np.angle(exact))),
    ):
        axes.plot(fine, known, color="black", lw=0.9, ls="--", label="theory")
        axes.plot(r, shown, color=RED, marker="o", ms=3, ls="", label="abut")
        axes.set_xlabel("frequency over the natural one")
    every[0].set_ylabel("amplitude over the static one")
    every[1].set_ylabel("phase, degrees")
    damped = np.sqrt(1.0 - zeta**2)
    wave = np.cos(damped * shaking.OMEGA * over_time.at) + zeta / damped * np.sin(damped * shaking.OMEGA * over_time.at)
    periods = over_time.at * shaking.OMEGA / (2.0 * np.pi)
    every[2].plot(periods, 1.0 - np.exp(-zeta * shaking.OMEGA * over_time.at) * wave, color="black", lw=0.9, ls="--")
    every[2].plot(
        periods[::4], over_time.probes[0].displacement[::4, 0, 1] / static, color=RED, marker="o", ms=3, ls=""
    )
    every[2].set_xlabel("periods after the load came")
    every[2].set_ylabel("displacement over the static one")
    every[0].legend(frameon=False)
    saved(figure, "response")


def lever() -> None:
    """The bars of ``abut verify lever``, displacements three hundred times as large."""
    solution = abut.solve(BENCHMARKS["lever"].model(0))
    mesh, step = solution.model.mesh, solution.steps[-1]
    points = mesh.points + 300.0 * step.displacement
    figure, axes = plots().subplots(figsize=(6.6, 2.4), constrained_layout=True)
    for name, colour in (("first", RED), ("second", BLUE)):
        cells = next(nodes for _, nodes, _ in mesh.cells_of(name))
        for at, edge, width in ((mesh.points, "#d5dae0", 0.6), (points, colour, 1.0)):
            shown = PolyCollection(at[cells][..., ::-1], facecolors="none", edgecolors=edge, linewidths=width)
            axes.add_collection(shown)
    ends = np.array([points[mesh.nodes_of(f"{name}.top")].mean(axis=0) for name in joined.BARS])
    axes.plot(*np.vstack([ends, 2.0 * ends[1] - ends[0]])[:, ::-1].T, color=GREY, lw=1.5, label="lever")
    axes.annotate(
        "", (ends[0, 1] + 2.0, ends[0, 0]), (ends[0, 1], ends[0, 0]), arrowprops={"arrowstyle": "->", "color": RED}
    )
    axes.set_xlim(-0.5, 26.0)
    axes.set_ylim(-0.5, 7.5)
    axes.axis("off")
    saved(figure, "lever")


def probes() -> None:
    """Stresses through the wall of the ball of ``abut verify ball-probe``, read in spherical axes, beside Lame's."""
    model = BENCHMARKS["ball-probe"].model(0)
    model = replace(model, probes=[replace(model.probes[0], points=21)])
    result = abut.solve(model).probes[0]
    figure, axes = panel("distance from the bore", "stress")
    radius = local_axes.INNER + result.distance
    exact = np.array([local_axes.stresses(one) for one in radius])
    for column, colour, name in ((0, BLUE, "stress_xx, radial"), (1, RED, "stress_yy, around")):
        axes.plot(result.distance, result.values["stress"][:, column], color=colour, marker="o", ms=3, label=name)
        axes.plot(
            result.distance, exact[:, column], color="black", lw=0.9, ls="--", label=None if column == 0 else "Lame"
        )
    axes.legend(frameon=False)
    saved(figure, "probe-axes")


def fields() -> None:
    """Temperatures at the points of one mesh, and where the nodes of another one are."""
    other = join({"b": ring((1.0, 2.0), (0.0, 120.0), cells=(3, 7), cell="tri3")})
    mesh = join({"b": ring((1.0, 2.0), (0.0, 120.0), cells=(5, 16), cell="quad8")})
    warm = 20.0 + 80.0 * np.exp(-3.0 * np.linalg.norm(other.points - (0.9, 0.9), axis=1))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "thermal.vtu"
        write_vtu(path, other.points, [(block.kind, block.nodes) for block in other.blocks], {"T": warm})
        read = abut.result_field(path, "T")(mesh.points)
    figure, frames = plots().subplots(1, 2, figsize=(7.6, 3.0), constrained_layout=True)
    shown = None
    for axes, one, values, corners in ((frames[0], other, warm, 3), (frames[1], mesh, read, 4)):
        cells = np.concatenate([block.nodes[:, :corners] for block in one.blocks])
        shown = PolyCollection(one.points[cells], edgecolors=GREY, linewidths=0.4, cmap="inferno")
        shown.set_array(values[cells].mean(axis=1))
        shown.set_clim(20.0, 90.0)
        axes.add_collection(shown)
        axes.set_aspect("equal")
        axes.set_xlim(-1.1, 2.1)
        axes.set_ylim(-0.1, 2.1)
        axes.axis("off")
    frames[0].set_title("thermal.vtu", fontsize=9)
    frames[1].set_title('value = "hot"', fontsize=9)
    figure.colorbar(shown, ax=frames, shrink=0.8, label="temperature")
    saved(figure, "result-field")


def sectors() -> None:
    """The whole ring of ``abut verify ring-sector`` by its ninth, displacements five times as large."""
    solution = abut.solve(BENCHMARKS["ring-sector"].model(0))
    mesh, step = solution.model.mesh, solution.steps[-1]
    cells = next(nodes[:, :4] for _, nodes, _ in mesh.cells_of("ring"))
    figure, axes = plots().subplots(figsize=(4.2, 4.0), constrained_layout=True)
    for k in range(9):
        c, s = np.cos(2.0 * np.pi * k / 9.0), np.sin(2.0 * np.pi * k / 9.0)
        points = (mesh.points + 5.0 * step.displacement) @ np.array([[c, s], [-s, c]])
        face, edge = ("#f2d3d0", RED) if k == 0 else ("none", GREY)
        axes.add_collection(PolyCollection(points[cells], facecolors=face, edgecolors=edge, linewidths=0.5))
    axes.set_xlim(-2.2, 2.2)
    axes.set_ylim(-2.2, 2.2)
    axes.set_aspect("equal")
    axes.axis("off")
    saved(figure, "sectors")


PICTURES = (sectors, fields, lever, probes, start, bolt, couplings, connectors, springs, stops, holds, modes, response)

if __name__ == "__main__":
    for draw in PICTURES:
        draw()
