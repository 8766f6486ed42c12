"""One solve under mpiexec: mpiexec -n N python bench/scaling/child.py CASE DOFS [OPTION OF PETSC ...]; or, serial,
python bench/scaling/child.py CASE DOFS --serial

Process 0 prints one line of JSON: seconds from a model in memory to results on disk, in all and by stage, iterations, and
the peak memory of each process.
"""

from __future__ import annotations

import json
import resource
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "contact"))

import cases
import numpy as np

from abut.analysis import solve
from abut.output.fields import write_fields
from abut.output.parallel import Pieces
from abut.output.results import write
from abut.parallel.team import Store, Team, lead

CASE, DOFS, *OPTIONS = sys.argv[1:] if len(sys.argv) > 2 else ("flat-hex8", "1000")


def peak(_: Store) -> float:
    """Largest resident memory of a process so far, MB."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


class Timed(Team):
    """A team that adds up the seconds in which all processes work, and the bytes that come back to process 0."""

    seconds = 0.0
    sent = 0

    def each(self, function: Any, *shared: Any, own: Any = None) -> list[Any]:
        start = time.perf_counter()
        result = super().each(function, *shared, own=own)
        self.seconds += time.perf_counter() - start
        self.sent += size((shared, (own or [()])[1:], result[1:]))
        return result


def size(item: Any) -> int:
    """Bytes of the arrays in something that travels."""
    if isinstance(item, np.ndarray):
        return item.nbytes
    if isinstance(item, dict):
        return size(list(item.values()))
    if isinstance(item, (list, tuple)):
        return sum(map(size, item))
    return size(vars(item)) if hasattr(item, "__dict__") and not callable(item) else 0


def measure(team: Team | None) -> int:
    """Solve, write, and print what it took."""
    if team is not None:
        team = Timed(team.comm)
    model = cases.with_options(cases.model(CASE, int(DOFS)), linear="amg" if team is None else "petsc", tied=False)
    start = time.perf_counter()
    solution = solve(model, team=team)
    with tempfile.TemporaryDirectory() as folder:
        write(solution, folder, fields=write_fields if team is None or team.size == 1 else Pieces(team))
    contact = solution.contacts[0]
    seconds = time.perf_counter() - start
    result = {
        "case": CASE,
        "dofs": cases.dofs(model),
        "processes": 0 if team is None else team.size,
        "seconds": seconds,
        "stages": {**solution.timings, "writing": seconds - sum(solution.timings.values())},
        "newton": len(solution.steps[0].iterations),
        "linear": int(next((note for note in solution.notes if "linear iterations" in note), "0").split()[0]),
        "multipliers": contact.multipliers,
        "together": 0.0 if team is None else team.seconds,
        "sent_mb": 0.0 if team is None else team.sent / 1e6,
        "force": abs(float(contact.force[2])),
        "peak_mb": [peak({})] if team is None else team.each(peak),
    }
    print(json.dumps(result), flush=True)
    return 0


if __name__ == "__main__":
    if OPTIONS == ["--serial"]:
        sys.exit(measure(None))
    sys.exit(lead(measure, OPTIONS))
