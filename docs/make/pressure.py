"""Tables and picture of docs/verification/pressure.md: python docs/make/pressure.py [TABLE ...], by default all of them (a
quarter of an hour, after benchmarks.py)."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

import abut
from abut.benchmarks.convergence import PLANE, SOLID
from abut.cells import BY_CODE, CELLS
from abut.mesh.make import join, rectangle
from abut.solution import ContactResult
from page import DOCS, plots, read_table, save, write_table

sys.path.insert(0, str(DOCS.parent / "tests"))
from models import pressure as models

PAGE = DOCS / "verification" / "pressure.md"
BENCHMARKS = DOCS / "verification" / "benchmarks.md"
AUTO = "default"
Array = NDArray[np.float64]


def spaces(cell: str) -> tuple[str, ...]:
    return ("P1", *(("P2",) if CELLS[cell].degree == 2 else ()), "dual", AUTO)


def law(space: str) -> dict[str, object]:
    return {} if space == AUTO else {"pressure": space}


def percent(value: float) -> str:
    return f"{100.0 * value:.1f} %" if value < 1.0 else f"{100.0 * value:.0f} %"


def everywhere(contact: ContactResult, values: Array, corners: bool) -> tuple[Array, Array]:
    """Nodes of all facets and values there, facet by facet: those of a multiplier may differ from facet to facet."""
    used = (contact.contactor.nodes >= 0) & contact.covered[:, None]
    if corners:
        count = np.array([BY_CODE[code].corners for code in contact.contactor.kinds])
        used &= np.arange(9) < count[:, None]
    return contact.contactor.points[contact.contactor.nodes[used]], values[used]


def worst(solution: abut.Solution, radius: float, peak: float, raw: bool = False, corners: bool = True) -> float:
    """Largest error inside 0.9 a over the peak, of the reported pressure or of the multiplier's trace (``raw``)."""
    contact = solution.contacts[0]
    x, p = everywhere(contact, contact.multiplier if raw else contact.pressure, corners)
    error = np.abs(p - models.ellipse(radius, peak, solution.model.dim)(x))
    return float(error[models.distance(x) < models.INSIDE * radius].max() / peak)


LINE_CELLS, LINE_SIZES = ("quad4", "quad8"), (6, 10, 20)
LINE_HEADER = ["cells", "facets over 1.3 a", "pressure", "multiplier", "reported", "with mid-nodes", "L2", "iterations"]


def line_row(cell: str, n: int, space: str) -> list[str]:
    solution = abut.solve(models.line(cell, n, **law(space)))
    where = models.LINE, models.LINE_PEAK
    errors = worst(solution, *where, raw=True), worst(solution, *where), worst(solution, *where, corners=False)
    mean = models.errors(solution, *where)[2]
    return [cell, str(n), space, *map(percent, (*errors, mean)), str(models.iterations(solution))]


RANGES = ((5, 8), (9, 12), (13, 17), (18, 24))
PLACES_HEADER = ["cells", "pressure", *(f"{first} to {last}" for first, last in RANGES)]


def places_row(cell: str, space: str) -> list[str]:
    """Worst reported pressure over all meshes of a range: the edge is at another place of its facet in each."""
    row = [cell, space]
    for first, last in RANGES:
        found = (abut.solve(models.line(cell, n, **law(space))) for n in range(first, last + 1))
        row.append(percent(max(models.errors(s, models.LINE, models.LINE_PEAK)[0] for s in found)))
    return row


SOLID_CELLS = {"hex8": 13, "tet4": 13, "wedge6": 13, "hex20": 7, "hex27": 7, "tet10": 7, "wedge15": 7}
BALL_HEADER = ["cells", "contactor", "pressure", "multiplier", "reported", "root mean square", "L2", "iterations"]


def ball_row(cell: str, contactor: str, space: str) -> list[str]:
    solution = abut.solve(models.quarter_ball(cell, SOLID_CELLS[cell], contactor, **law(space)))
    where = models.quarter_ball_truth(solution)
    inside, rms, mean = models.errors(solution, *where)
    found = worst(solution, *where, raw=True), inside, rms, mean
    return [cell, contactor, space, *map(percent, found), str(models.iterations(solution))]


MEAN_SIZES = {"hex8": (5, 7, 10, 13), "tet4": (5, 7, 10, 13), "hex20": (4, 5, 7, 9), "tet10": (4, 5, 7)}
MEAN_HEADER = ["cells", "contactor", "facets over a", "reported", "averages of the exact one", "best fit",
               "reported: exponent", "averages: exponent", "best fit: exponent"]  # fmt: skip


def mean_row(cell: str, contactor: str) -> list[str]:
    """Errors on the finest mesh, exponents from all."""
    fine, *errors = np.transpose([models.quarter_ball_in_the_mean(cell, m, contactor) for m in MEAN_SIZES[cell]])
    rates = (-np.polyfit(np.log(fine), np.log(own), 1)[0] for own in errors)
    sizes = f"{fine[0]:.1f} to {fine[-1]:.1f}"
    return [cell, contactor, sizes, *(percent(own[-1]) for own in errors), *(f"{rate:.2f}" for rate in rates)]


POLE_SIZES = (12, 16, 20, 24, 28)


def pole_row() -> list[str]:
    found = (abut.solve(models.octant("tet4", n)) for n in POLE_SIZES)
    return ["error", *(percent(models.errors(s, models.OCTANT, models.OCTANT_PEAK)[0]) for s in found)]


AXIS_HEADER = ["cells", "facets over 1.3 a", "pressure", "on the axis", "reported"]


def axis_row(cell: str, n: int, space: str) -> list[str]:
    solution = abut.solve(models.balls(cell, n, "upper", **law(space)))
    x, p = models.at_corners(solution.contacts[0])
    axis = p[np.argmin(x[:, 0])] / models.BALLS_PEAK - 1.0
    return [cell, str(n), space, f"{100 * axis:+.1f} %", percent(worst(solution, models.BALLS, models.BALLS_PEAK))]


PARTS = (0.05, 0.15, 0.3, 0.5, 0.8, 1.0)


def square_row(space: str) -> list[str]:
    found = [abut.solve(models.square_punch(t, whole=6, **law(space))).contacts[0] for t in PARTS]
    return [space, *(f"{np.nanmax(c.pressure):.1f}" for c in found)]


def flat_punch(cell: str, n: int, contactor: str, **contact: object) -> abut.Model:
    """A nearly rigid flat punch, plane strain, n facets over its width on both sides, unit force on a block 40 wide."""
    block = rectangle((-20, 20), (-20, 0), (n, n // 2), cell, fine={"x": [-1, 1], "y": [-1, 0]})
    sides = ("block.top", "punch.bottom") if contactor == "block" else ("punch.bottom", "block.top")
    return abut.Model(
        join({"punch": rectangle((-1, 1), (0, 1), (n, n), cell), "block": block}),
        [abut.Solid("punch", abut.LinearElastic(1e7, 0.3)), abut.Solid("block", abut.LinearElastic(1e3, 0.3))],
        [abut.Support("block.bottom", x=0, y=0), abut.Support("punch.top", x=0)],
        [abut.Force("punch.top", (0.0, -1.0))],
        [abut.Contact(contactor=sides[0], target=sides[1], **contact)],
        plane="strain",
    )


FLAT_HEADER = ["cells", "contactor", "pressure", "multiplier", "reported", "iterations"]


def flat_row(cell: str, contactor: str, space: str) -> list[str]:
    """Largest relative error for |x| < 0.8, of 1 / (pi (1 - x^2)^1/2)."""
    solution = abut.solve(flat_punch(cell, 16, contactor, **law(space)))
    contact, errors = solution.contacts[0], []
    for values in (contact.multiplier, contact.pressure):
        x, p = everywhere(contact, values, corners=True)
        near = np.abs(x[:, 0]) < 0.8
        errors.append(np.abs(p[near] * np.pi * np.sqrt(1.0 - x[near, 0] ** 2) - 1.0).max())
    return [cell, contactor, space, *map(percent, errors), str(models.iterations(solution))]


BENT_HEADER = ["cells", "contact, 3 facets", "contact, 6 facets", "tied, 3 facets", "tied, 6 facets"]


def bent_row(cell: str) -> list[str]:
    """Largest error at any node, over the largest pressure."""
    row = [cell]
    for kind in ("contact", "tied"):
        for n in (3, 6):
            contact = abut.solve(models.bent(cell, n, kind)).contacts[0]
            x, p = everywhere(contact, contact.pressure, corners=False)
            error = float(np.abs(p - models.bent_pressure(x)).max() / 1.8)
            row.append("< 1e-10" if error < 1e-10 else percent(error))
    return row


RIM_SIZES = (6, 12, 24)


def rim_row() -> list[str]:
    """Error at a closed rim over the change of the pressure over its facet; the exact one continues that of 48 facets."""
    x, p = models.along(models.opened(48))
    p[-1] = np.polyval(np.polyfit(x[-5:-1], p[-5:-1], 3), x[-1])
    row = []
    for n in RIM_SIZES:
        at, found = models.along(models.opened(n))
        row.append(f"{(found[-1] - p[-1]) / (p[-1] - np.interp(at[-2], x, p)):.2f}")
    return ["error over change", *row]


def rate_rows() -> list[list[str]]:
    """From the page of benchmarks."""
    rates = {(r["name"].strip("`"), r["quantity"]): r["rate (theory)"] for r in read_table(BENCHMARKS, "benchmarks")}
    return [
        [cell, *(rates.get((f"{family}-{cell}", q), "") for family in ("smooth", "signorini") for q in QUANTITIES)]
        for cell in PLANE + SOLID
    ]


QUANTITIES = ("displacement", "energy", "pressure")
RATE_HEADER = ["cells", *(f"{name}: {q}" for name in ("smooth", "edge") for q in QUANTITIES)]


def picture() -> None:
    plt = plots()
    figure, axes = plt.subplots(1, 2, figsize=(9.0, 3.6), sharey=True, constrained_layout=True)
    for axis, contactor in zip(axes, ("ball", "block")):
        fine = np.linspace(0.0, 1.0, 300)
        axis.plot(fine, np.sqrt(1.0 - fine**2), color="0.6", lw=3, label="Hertz", zorder=0)
        for space, raw, style, label in (
            ("P2", True, "C3x", "multiplier, P2"),
            ("P1", True, "C1+", "multiplier, P1"),
            (AUTO, False, "C0o", "reported, default"),
        ):
            solution = abut.solve(models.quarter_ball("hex20", SOLID_CELLS["hex20"], contactor, **law(space)))
            radius, peak = models.quarter_ball_truth(solution)
            contact = solution.contacts[0]
            x, p = everywhere(contact, contact.multiplier if raw else contact.pressure, corners=True)
            near = models.distance(x) < 1.3 * radius
            axis.plot(models.distance(x)[near] / radius, p[near] / peak, style, ms=4, mew=0.8, label=label)
        axis.set_title(f"{contactor} as contactor", fontsize=9)
        axis.set_xlabel("r / a")
    axes[0].set_ylabel("p / p0")
    axes[0].legend(fontsize=7)
    save(figure, "pressure-ball.svg")


BODIES = ("ball", "block")
BENT_CELLS = (
    "quad4", "tri3", "quad8", "quad9", "tri6", "hex8", "tet4", "wedge6", "hex20", "hex27", "tet10", "wedge15",
)  # fmt: skip
TABLES: dict[str, Callable[[], tuple[list[str], list[list[str]]]]] = {
    "line": lambda: (LINE_HEADER, [line_row(cell, n, s) for cell in LINE_CELLS for n in LINE_SIZES for s in spaces(cell)]),
    "places": lambda: (PLACES_HEADER, [places_row(cell, space) for cell in LINE_CELLS for space in spaces(cell)]),
    "ball": lambda: (BALL_HEADER, [ball_row(c, side, s) for c in SOLID_CELLS for side in BODIES for s in spaces(c)]),
    "mean": lambda: (MEAN_HEADER, [mean_row(cell, side) for cell in MEAN_SIZES for side in BODIES]),
    "pole": lambda: (["cells over 1.1", *map(str, POLE_SIZES)], [pole_row()]),
    "axis": lambda: (
        AXIS_HEADER,
        [axis_row(c, n, s) for c in ("tri3", "quad4", "tri6", "quad8") for n in (10, 24) for s in ("P1", AUTO)],
    ),
    "square": lambda: (["pressure", *map(str, PARTS)], [square_row(space) for space in ("P1", "dual", AUTO)]),
    "flat": lambda: (
        FLAT_HEADER, [flat_row(c, side, s) for c in LINE_CELLS for side in ("block", "punch") for s in spaces(c)]
    ),
    "bent": lambda: (BENT_HEADER, [bent_row(cell) for cell in BENT_CELLS]),
    "rim": lambda: (["facets", *map(str, RIM_SIZES)], [rim_row()]),
    "rates": lambda: (RATE_HEADER, rate_rows()),
}  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tables", nargs="*", choices=[*TABLES, "picture", []], metavar="TABLE")
    asked = parser.parse_args().tables or [*TABLES, "picture"]
    for name in asked:
        if name == "picture":
            picture()
        else:
            write_table(PAGE, name, *TABLES[name]())


if __name__ == "__main__":
    main()
