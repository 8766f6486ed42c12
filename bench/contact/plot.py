"""Time against dofs as a picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from report import Row, cores

ACROSS = 3  # panels in a row


def plot(rows: Sequence[Row], file: Path) -> bool:
    """Time against dofs, a panel for each case, solid on the fewest cores; False where matplotlib is missing."""
    try:
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot
    except ImportError:
        return False
    cases, codes = (list(dict.fromkeys(row[key] for row in rows)) for key in ("case", "code"))
    every = sorted({row["cores"] for row in rows})
    across = min(len(cases), ACROSS)
    down = -(-len(cases) // across)
    figure, grid = pyplot.subplots(
        down, across, figsize=(4 * across, 3.2 * down), sharex=True, sharey=True, squeeze=False, layout="constrained"
    )
    panels = grid.ravel()
    for panel, case in zip(panels, cases):
        for i, code in enumerate(codes):
            for n in every:
                own: list[Any] = [r for r in rows if (r["case"], r["code"], r["cores"]) == (case, code, n)]
                own = [r for r in own if r["status"] == "ok"]
                if own:
                    style = "-" if n == every[0] else "--"
                    label = f"{code}, {cores(n)}"
                    x, y = [r["dofs"] for r in own], [r["seconds"] for r in own]
                    panel.loglog(x, y, f"o{style}", color=f"C{i}", markersize=3, label=label)
        panel.set(title=case)
        panel.grid(True, which="both", alpha=0.3)
    for panel in panels[len(cases) :]:
        panel.axis("off")
    figure.supxlabel("dofs")
    figure.supylabel("seconds")
    lines = {label: line for panel in panels for line, label in zip(*panel.get_legend_handles_labels())}
    if lines:
        figure.legend(lines.values(), lines.keys(), fontsize=7, loc="outside right upper")
    figure.savefig(file, dpi=120)
    pyplot.close(figure)
    return True
