"""What an earlier run of a job tells of its mesh."""

from __future__ import annotations

import json
from pathlib import Path

from abut.diagnosis.finding import Finding
from abut.solution.records import STRESS_NOTICED
from abut.solution.stress_error import AIM


def sizes_wanted(results: Path) -> list[Finding]:
    """For each body that touches another the size of cell that would bring the estimated error of its stresses to 5 % there,
    by the summary in a folder of results: that of the step with the largest energy. Nothing without such a summary, or where
    the mesh is fine enough."""
    try:
        steps = json.loads((results / "summary.json").read_text(encoding="utf-8"))["steps"]
        told = [step["stress_error"] for step in steps if "stress_error" in step]
        near = max(told, key=lambda error: float(error["energy"]))["near_contact"] if told else []
        worst: dict[str, tuple[float, float, float]] = {}
        for e in near:
            body, found = str(e["body"]), (float(e["error"]), float(e["size"]), float(e["wanted"]))
            worst[body] = max(worst.get(body, found), found)
    except (OSError, ValueError, KeyError, TypeError):  # none, or of another program
        return []
    return [
        Finding(
            "advice" if error > STRESS_NOTICED else "info",
            f"body '{body}'",
            f"in the run in {results.name}/ the stresses of its elements were off by about {error:.0%} where it touches, "
            f"with cells of {size:.2g}",
            f"cells of {wanted:.2g} there would bring that to {AIM:.0%}",
        )
        for body, (error, size, wanted) in worst.items()
        if error > AIM
    ]
