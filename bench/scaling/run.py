"""Strong and weak scaling: python bench/scaling/run.py [--page docs/scaling.md]

Needs mpiexec and a Python with petsc4py (docs/mpi.md). Every process gets a core of its own, so there are no more of them
than cores.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1] / "contact"))

from report import markdown, plain, put_into

CHILD = Path(__file__).with_name("child.py")
STAGES = ("partition", "assembly", "interface", "set-up", "solve", "results", "writing")
HEAD = [
    "case", "dofs", "processes", "s", "/ one", *STAGES, "process 0 alone", "Newton", "linear", "sent MB", "MB a process",
    "/ serial",
]  # fmt: skip
Row = dict[str, Any]


def median(case: str, dofs: int, processes: int, repeat: int, limit: float) -> Row:
    """The run with the median time; ``processes`` 0: abut's own solver, without MPI."""
    command = [sys.executable, str(CHILD), case, str(dofs)]
    command = ["mpiexec", "-n", str(processes), *command] if processes else [*command, "--serial"]
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "MKL_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    rows = []
    for _ in range(repeat):
        done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=limit, check=False)
        if done.returncode:
            sys.exit(f"{' '.join(command)} failed:\n{done.stderr}")
        rows.append(json.loads(done.stdout.splitlines()[-1]))
        print(f"# {case} {dofs} on {processes}: {rows[-1]['seconds']:.1f} s", file=sys.stderr, flush=True)
    middle = statistics.median_low([row["seconds"] for row in rows])
    return next(row for row in rows if row["seconds"] == middle)


def cells(row: Row, rows: list[Row]) -> list[str]:
    """A row of the table, beside the same model on one process and in serial."""

    def other(processes: int) -> Row | None:
        same = (r for r in rows if r["processes"] == processes and (r["case"], r["dofs"]) == (row["case"], row["dofs"]))
        return next(same, None)

    one, serial = other(1), other(0)
    return [
        row["case"],
        f"{row['dofs']:,}".replace(",", " "),
        str(row["processes"] or "serial"),
        f"{row['seconds']:.2f}",
        f"{row['seconds'] / one['seconds']:.2f}" if one else "",
        *(f"{row['stages'].get(stage, 0.0):.2f}" for stage in STAGES),
        f"{row['seconds'] - row['together']:.2f}" if row["processes"] else "",
        str(row["newton"]),
        str(row["linear"]),
        f"{row['sent_mb']:.0f}" if row["processes"] else "",
        ", ".join(f"{mb:.0f}" for mb in row["peak_mb"]),
        f"{max(row['peak_mb']) / serial['peak_mb'][0]:.2f}" if serial else "",
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", default="flat-hex8,tilted-hex8", help="names as in bench/contact/cases.py")
    parser.add_argument("--dofs", default="100000,200000,400000")
    parser.add_argument("--processes", default="0,1,2", help="numbers; 0 is abut without MPI")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--limit", type=float, default=600.0, help="seconds for a run")
    parser.add_argument("--page", type=Path, help="put the table into this file")
    arguments = parser.parse_args()
    rows = [
        median(case, int(dofs), int(processes), arguments.repeat, arguments.limit)
        for case in arguments.cases.split(",")
        for dofs in arguments.dofs.split(",")
        for processes in arguments.processes.split(",")
    ]
    table = [HEAD, *(cells(row, rows) for row in rows)]
    print(plain(table))
    if arguments.page:
        put_into(arguments.page, markdown(table))


if __name__ == "__main__":
    main()
