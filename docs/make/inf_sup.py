"""Tables and pictures of docs/verification/inf-sup.md: python docs/make/inf_sup.py (about five minutes)."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

import abut
from abut.mesh.make import box, join, rectangle
from abut.verify import InfSup, inf_sup
from page import DOCS, plots, save, write_table

PAGE = DOCS / "verification" / "inf-sup.md"
PLANE, SOLID = ("quad4", "quad8", "quad9", "tri3", "tri6"), ("hex8", "hex20", "hex27", "tet4", "tet10")
LINEAR = ("quad4", "tri3", "hex8", "tet4")
SPACES = ("P0", "P1", "P1-discontinuous", "P2", "P2-discontinuous", "dual", "dual-P1")
METHODS = {"nodes, one pass": "node-to-segment", "nodes, two passes": "node-to-segment-two-pass"}
TARGETS = {"matching": Fraction(1), "half": Fraction(1, 2), "three quarters": Fraction(3, 4)}
LEVELS = {2: (4, 8, 16, 32), 3: (2, 4, 6, 8)}
ZERO = 2e-3  # where the pictures draw what is zero


def dimension(cell: str) -> int:
    return 3 if cell in SOLID else 2


def pressures(cell: str) -> list[str]:
    """The pressure spaces that a cell type allows, and the node-to-segment methods."""
    return [s for s in SPACES if not (s.startswith("P2") and cell in LINEAR)] + list(METHODS)


def sizes(cell: str, target: str) -> list[tuple[int, int]]:
    """Facets along an edge of contactor and target, coarse to fine."""
    share = TARGETS[target]
    return [(n, int(n * share)) for n in LEVELS[dimension(cell)] if (n * share).denominator == 1]


def model(cell: str, pressure: str, n: int, m: int) -> abut.Model:
    """Two unit squares (cubes) on each other, far sides clamped; n cells along each edge of the contactor's, m of the
    target's."""
    dim = dimension(cell)
    make = rectangle if dim == 2 else box
    last = "xyz"[dim - 1]
    parts = {
        "lower": make(cells=(n,) * dim, cell=cell),
        "upper": make(cells=(m,) * dim, cell=cell, **{last: (1.0, 2.0)}),
    }
    clamped = dict.fromkeys("xyz"[:dim], 0.0)
    how = {"method": METHODS[pressure]} if pressure in METHODS else {"pressure": pressure}
    return abut.Model(
        join(parts),
        [abut.Solid(body, abut.LinearElastic(1.0, 0.3)) for body in parts],
        [abut.Support("lower.bottom", **clamped), abut.Support("upper.top", **clamped)],
        contacts=[abut.Contact(contactor="lower.top", target="upper.bottom", **how)],
        plane="strain" if dim == 2 else None,
    )


def half(points: np.ndarray) -> np.ndarray:
    """Where contact counts as closed, for "dual-P1": half of the contactor."""
    return np.asarray(points[:, 0] <= 0.5 + 1e-9)


def measure(cell: str, pressure: str, sizes: Sequence[tuple[int, int]]) -> InfSup:
    """The constants of one pair on meshes of n and m cells along an edge."""
    return inf_sup([model(cell, pressure, n, m) for n, m in sizes], closed=half)


def verdict(result: InfSup) -> str:
    if result.levels[-1].spurious:
        return "fails: zero"
    if result.stable:
        return "stable"
    return "weak" if result.verdict.startswith("weak") else f"fails: h^{result.rate:.2f}"


def row(cell: str, pressure: str, target: str, result: InfSup) -> list[str]:
    at = {n: f"{level.trace:.3f}" for (n, _), level in zip(sizes(cell, target), result.levels)}
    last = result.levels[-1]
    betas = [at.get(n, "") for n in LEVELS[dimension(cell)]]
    return [cell, pressure, target, *betas, f"{last.mesh:.3f}", str(last.spurious), verdict(result)]


def header(dim: int) -> list[str]:
    levels = [str(n) for n in LEVELS[dim]]
    return ["cells", "pressure", "target", *levels, "h M", "spurious", "verdict"]


def summary(rows: Sequence[Sequence[str]], dim: int) -> list[list[str]]:
    """For each pair the worst of its targets: smallest constant on the finest mesh, in brackets if it fails."""
    column = header(dim).index("h M") - 1
    table = []
    for cell in PLANE if dim == 2 else SOLID:
        line = [cell]
        for pressure in (*SPACES, *METHODS):
            own = [r for r in rows if r[0] == cell and r[1] == pressure]
            worst = min((r[column] for r in own), key=float, default="")
            failing = [r for r in own if r[-1] != "stable"]
            line.append(f"({min((r[column] for r in failing), key=float)})" if failing else worst)
        table.append(line)
    return table


def picture(rows: Sequence[Sequence[str]], dim: int) -> None:
    plt = plots()
    figure, axes = plt.subplots(1, 3, figsize=(10.5, 4.0), sharey=True)
    colours = dict(zip((*SPACES, *METHODS), ("C0", "C1", "C2", "C3", "C4", "C5", "C9", "C7", "k")))
    markers = dict(zip(PLANE if dim == 2 else SOLID, "osD^v"))
    for axis, target in zip(axes, TARGETS):
        for cell, pressure, own, *betas, _, _, judged in rows:
            if own != target:
                continue
            points = [(1 / n, max(float(beta), ZERO)) for n, beta in zip(LEVELS[dim], betas) if beta]
            stable = judged == "stable"
            axis.loglog(
                *zip(*points), color=colours[pressure], marker=markers[cell], ms=4, lw=1, ls="-" if stable else "--",
                mfc=colours[pressure] if stable else "white",
            )  # fmt: skip
        axis.set_title({"matching": "matching"}.get(target, f"{target} as many target facets"), fontsize=9)
        axis.set_xlabel("h")
        axis.set_xticks([1 / n for n in LEVELS[dim]], [f"1/{n}" for n in LEVELS[dim]])
        axis.minorticks_off()
        axis.invert_xaxis()
    axes[0].set_yticks([ZERO, 0.01, 0.1, 1.0], ["0", "0.01", "0.1", "1"])
    axes[0].set_ylabel("inf-sup constant, trace norm")
    line = plt.Line2D
    legend = [line([], [], color=colour, label=name) for name, colour in colours.items()]
    legend += [line([], [], color="0.4", marker=mark, ls="", ms=4, label=cell) for cell, mark in markers.items()]
    legend += [line([], [], color="0.4", ls="-", marker="o", ms=4, label="stable")]
    legend += [line([], [], color="0.4", ls="--", marker="o", ms=4, mfc="white", label="weak or failing")]
    figure.legend(handles=legend, loc="center right", fontsize=8, frameon=False)
    figure.subplots_adjust(left=0.06, right=0.82, bottom=0.12, top=0.92, wspace=0.06)
    save(figure, f"inf-sup-{dim}d.svg")


def main() -> None:
    for dim, cells in ((2, PLANE), (3, SOLID)):
        rows = []
        for cell in cells:
            for pressure in pressures(cell):
                for target in TARGETS:
                    rows.append(row(cell, pressure, target, measure(cell, pressure, sizes(cell, target))))
                    print(*rows[-1], flush=True)
        write_table(PAGE, f"{dim}d", header(dim), rows)
        write_table(PAGE, f"summary-{dim}d", ["cells", *SPACES, *METHODS], summary(rows, dim))
        picture(rows, dim)


if __name__ == "__main__":
    main()
