"""Tables and pictures of docs/verification/methods.md: python docs/make/methods.py (about a minute, after inf_sup.py)."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import abut
import inf_sup
from abut.benchmarks.measures import displacement_error, pressure_error
from abut.benchmarks.patch import shaken
from abut.bodies.assemble import stiffness
from abut.job import load_job
from abut.mesh.make import box, join, rectangle
from abut.mesh.surface import Surface
from abut.solution import ContactResult, Solution
from abut.verify.facet_quadrature import facet_forces, force_error, segment_forces
from page import DOCS, error, plots, read_table, save, write_table

PAGE = DOCS / "verification" / "methods.md"
EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
SEGMENT, ONE_PASS, TWO_PASS = "segment-to-segment", "node-to-segment", "node-to-segment-two-pass"
METHODS = {"segments": SEGMENT, "nodes, one pass": ONE_PASS, "nodes, two passes": TWO_PASS}

CELLS = ("tri3", "tri6", "quad4", "quad8", "quad9", "tet4", "tet10", "hex8", "hex20", "hex27")
YOUNG, POISSON, LOAD = 2000.0, 0.3, 25.0


def patch_model(cell: str, method: str) -> abut.Model:
    """Two distorted, non-matching blocks under uniform pressure, free to expand sideways (as benchmark patch-...)."""
    dim = inf_sup.dimension(cell)
    grids = ((2, 3, 2), (3, 2, 2)) if dim == 3 else ((5, 3), (7, 3))
    parts = {"lower": shaken(0, 1, grids[0], cell, 3), "upper": shaken(1, 2, grids[1], cell, 4)}
    sides = [("left", "x"), ("front", "y")][: dim - 1]
    return abut.Model(
        join(parts),
        [abut.Solid(body, abut.LinearElastic(YOUNG, POISSON)) for body in parts],
        [
            abut.Support("lower.bottom", **{"xyz"[dim - 1]: 0.0}),
            *(abut.Support(f"{body}.{side}", **{axis: 0.0}) for body in parts for side, axis in sides),
        ],
        [abut.Pressure("upper.top", LOAD)],
        [abut.Contact(contactor="lower.top", target="upper.bottom", method=method)],
        plane="strain" if dim == 2 else None,
    )


def patch_errors(cell: str, method: str) -> tuple[float, float, float]:
    """Largest errors of the pressure, of the contactor's nodal forces (over the largest exact one) and of the
    displacement."""
    solution = abut.solve(patch_model(cell, method))
    mesh, dim = solution.model.mesh, solution.model.dim
    side, along = (POISSON * (1 + POISSON), 1 - POISSON**2) if dim == 2 else (POISSON, 1.0)

    def exact(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return x * np.array([side] * (dim - 1) + [-along]) * LOAD / YOUNG

    full = stiffness(solution.model.deformable)
    nodes = mesh.nodes_of("lower.top")
    own, wanted = ((full @ u.ravel()).reshape(-1, dim)[nodes, -1] for u in (solution.displacement, exact(mesh.points)))
    return (
        pressure_error(solution, lambda x: np.full(len(x), LOAD)) / LOAD,
        float(np.abs(own - wanted).max() / np.abs(wanted).max()),
        displacement_error(solution, exact),
    )


PATCH_HEADER = ["cells", *(f"{m}: {q}" for m in METHODS for q in ("pressure", "force", "displacement"))]
PATCH_HEADER.remove("nodes, two passes: pressure")  # is not unique


def patch_row(cell: str) -> list[str]:
    errors = [error(value) for method in METHODS.values() for value in patch_errors(cell, method)]
    return [cell, *errors[:6], *errors[7:]]


HALF_WIDTH, PEAK = 6.2146, 3585.36  # Hertz
LAWS = {
    "segments, constraint function": (SEGMENT, "constraint-function"),
    **{name: (method, "complementarity") for name, method in METHODS.items()},
}
CONTACTORS = ("block", "cylinder")


def hertz(x: NDArray[np.float64]) -> NDArray[np.float64]:
    return PEAK * np.sqrt(np.maximum(0.0, 1.0 - (x / HALF_WIDTH) ** 2))


def hertz_solution(cell: str, contactor: str, name: str, level: int) -> Solution:
    """An example's model with its method and law replaced, cells halved ``level`` times."""
    model = load_job(EXAMPLES / "hertz-line" / f"{cell}.toml", refine=level).model
    method, law = LAWS[name]
    sides = ("block.top", "cylinder.round")
    if contactor == "cylinder":
        sides = sides[::-1]
    contact = replace(model.contacts[0], method=method, law=law).forced(*sides)
    return abut.solve(replace(model, contacts=[contact], probes=()))


def hertz_pressure(solution: Solution, *, both: bool = True) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """x and pressure at the contactor's nodes; of two passes the sum (``both``), the second carried over to this side."""
    first = solution.contacts[0]
    pressure = first.pressure
    if both and len(solution.contacts) == 2:
        pressure = pressure + solution.contacts[1].target_pressure
    return _along(first, pressure)


def _along(contact: ContactResult, pressure: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    used = contact.contactor.nodes >= 0
    x = contact.contactor.points[contact.contactor.nodes[used]]
    near = x[:, 1] < 1.0  # of the cylinder's round the lower end, where x tells its points apart
    x, first = np.unique(np.round(x[near, 0], 9), return_index=True)
    return x, pressure[used][near][first]


def hertz_error(solution: Solution, *, both: bool = True) -> float:
    """Largest difference from Hertz's pressure inside 0.9 a, over the largest pressure."""
    x, p = hertz_pressure(solution, both=both)
    return float(np.abs(p - hertz(x))[np.abs(x) < 0.9 * HALF_WIDTH].max() / PEAK)


HERTZ_LEVELS = (0, 1, 2)
HERTZ_HEADER = ["cells", "contactor", "method", *("h" if level == 0 else f"h/{2**level}" for level in HERTZ_LEVELS)]


def hertz_row(cell: str, contactor: str, name: str, levels: tuple[int, ...] = HERTZ_LEVELS) -> list[str]:
    errors = [100.0 * hertz_error(hertz_solution(cell, contactor, name, level)) for level in levels]
    return [cell, contactor, name, *(f"{value:.2f} %" for value in errors)]


def hertz_picture() -> None:
    plt = plots()
    figure, axes = plt.subplots(2, 2, figsize=(9.0, 5.6), sharex=True, constrained_layout=True)
    fine = np.linspace(0.0, 1.2 * HALF_WIDTH, 400)
    for column, cell in zip(axes.T, ("quad4", "quad8")):
        column[0].plot(fine / HALF_WIDTH, hertz(fine) / PEAK, color="0.6", lw=3, label="Hertz")
        styles = ("C0-", "C1-", "C2--", "C3-")
        drawn = [(name, *hertz_pressure(hertz_solution(cell, "block", name, 0)), s) for name, s in zip(LAWS, styles)]
        solution = hertz_solution(cell, "block", "nodes, two passes", 0)
        drawn[-1] = ("nodes, two passes: sum", *drawn[-1][1:])
        drawn.append(("nodes, two passes: first pass", *hertz_pressure(solution, both=False), "C3:"))
        for name, x, p, style in drawn:
            right = (x >= 0.0) & (x <= 1.2 * HALF_WIDTH)
            x, p = x[right], p[right]
            column[0].plot(x / HALF_WIDTH, p / PEAK, style, lw=1, marker=".", ms=3, label=name)
            if not name.endswith("first pass"):
                column[1].plot(x / HALF_WIDTH, 100 * (p - hertz(x)) / PEAK, style, lw=1, marker=".", ms=3)
        column[0].set_title(cell, fontsize=9)
        column[1].set_xlabel("x / a")
        column[1].axvspan(0.0, 0.9, color="0.5", alpha=0.08)
        column[1].set_ylim(-12.5, 12.5)
    axes[0, 0].set_ylabel("p / p0")
    axes[1, 0].set_ylabel("(p - Hertz) / p0, %")
    axes[0, 1].legend(fontsize=7, loc="lower left")
    save(figure, "methods-hertz.svg")


POINTS = (2, 3, 4, 5, 10, 20, 50)
MOST = 20  # points per direction in 3D
FACETS = [(k, *n) for k in ("line2", "line3") for n in ((7, 9), (9, 7))] + [("quad4", 7, 9), ("quad8", 7, 9)]
FACET_HEADER = ["facets", "contactor", "target", *map(str, POINTS), "segments"]


def sides(kind: str, n: int, m: int) -> tuple[Surface, Surface]:
    """Flush contactor of n (n x n) and target of m (m x m) equal facets."""
    make = rectangle if kind.startswith("line") else box
    cell = {"line2": "quad4", "line3": "quad8", "quad4": "hex8", "quad8": "hex20"}[kind]
    dim = 2 if make is rectangle else 3
    height = {"xyz"[dim - 1]: (1.0, 2.0)}
    lower, upper = (
        make(cells=(n,) * (dim - 1) + (1,), cell=cell),
        make(cells=(m,) * (dim - 1) + (1,), cell=cell, **height),
    )
    return lower.surface("top"), upper.surface("bottom")


def facet_row(kind: str, n: int, m: int, points: tuple[int, ...] = POINTS) -> list[str]:
    contactor, target = sides(kind, n, m)
    most = POINTS[-1] if kind.startswith("line") else MOST
    errors = [error(force_error(facet_forces(contactor, target, q), target)) if q <= most else "" for q in points]
    count = (str(n), str(m)) if kind.startswith("line") else (f"{n} x {n}", f"{m} x {m}")
    return [kind, *count, *errors, error(force_error(segment_forces(contactor, target), target), 1e-14)]


def facet_picture(rows: list[list[str]]) -> None:
    """From the table; lines for more points than it has are of line2 and line3 only."""
    plt = plots()
    figure, axis = plt.subplots(figsize=(6.4, 3.6), constrained_layout=True)
    styles = {"line2": "C0", "line3": "C1", "quad4": "C2", "quad8": "C3"}
    for kind, n, m, *errors, _ in rows:
        at = [(q, float(e)) for q, e in zip(POINTS, errors) if e]
        if kind.startswith("line"):
            contactor, target = sides(kind, int(n), int(m))
            at = [(q, force_error(facet_forces(contactor, target, q), target)) for q in range(2, 51)]
        axis.loglog(*zip(*at), styles[kind], ls="-" if n[0] == "7" else ":", lw=1.2, label=f"{kind}, {n} on {m}")
    axis.set_xlabel("Gauss points on a contactor facet, per direction")
    axis.set_ylabel("worst nodal force error")
    axis.set_xticks([2, 5, 10, 20, 50], ["2", "5", "10", "20", "50"])
    axis.minorticks_off()
    axis.legend(fontsize=7, ncols=2)
    save(figure, "methods-facets.svg")


INFSUP_HEADER = ["cells", "segments, dual-P1", "segments, P1 or P2", *list(METHODS)[1:]]


def infsup_rows() -> list[list[str]]:
    """From the page of inf-sup constants: segments with the default space (half of the contactor closed) and with
    continuous functions of the displacement's order, and the two other methods."""
    rows = []
    for dim in (2, 3):
        for line in read_table(inf_sup.PAGE, f"summary-{dim}d"):
            highest = "P1" if line["cells"] in inf_sup.LINEAR else "P2"
            rows.append([line["cells"], *(line[name] for name in ("dual-P1", highest, *inf_sup.METHODS))])
    return rows


def main() -> None:
    write_table(PAGE, "patch", PATCH_HEADER, [patch_row(cell) for cell in CELLS])
    write_table(PAGE, "inf-sup", INFSUP_HEADER, infsup_rows())
    rows = [hertz_row(cell, side, name) for cell in ("quad4", "quad8") for side in CONTACTORS for name in LAWS]
    write_table(PAGE, "hertz", HERTZ_HEADER, rows)
    hertz_picture()
    rows = [facet_row(*facets) for facets in FACETS]
    write_table(PAGE, "facets", FACET_HEADER, rows)
    facet_picture(rows)


if __name__ == "__main__":
    main()
