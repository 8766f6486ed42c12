"""FEBio's own contact cases, solved by abut.

python bench/suites/febio.py FOLDER [NAME ...] [--seconds 120] [--table OUT.md]

FOLDER holds .feb files, as the folder Verify of FEBio's TestSuite. Each is read as ``febio_model`` says, and solved with
friction and large displacements. Where FEBio has been run, and the file asks for displacements of nodes in a text file
(<node_data data="ux;uy;uz" file="...">), these are compared: the largest difference at the end over the largest
displacement.
"""

from __future__ import annotations

import argparse
import xml.etree.ElementTree as ElementTree
from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from febio_model import read_model
from foreign_mesh import NotReadable
from numpy.typing import NDArray

import abut
from abut.errors import AbutError


@dataclass(frozen=True)
class Outcome:
    """status: "solved", "stopped" (abut ended before the end) or "not read". force: on the first side of the first contact;
    failed: lines of the certificate that do; error: from FEBio's displacements, NaN where there are none."""

    name: str
    status: str
    contact: str = ""
    steps: int = 0
    iterations: int = 0
    force: str = ""
    failed: str = ""
    error: float = float("nan")
    detail: str = ""


def displacements(text: str) -> dict[int, NDArray[np.float64]]:
    """Of nodes, the last in a text file of FEBio's: blocks of lines "*Step", "*Time", "*Data", then number and values."""
    found: dict[int, NDArray[np.float64]] = {}
    for line in text.splitlines():
        words = line.replace(",", " ").split()
        if line.startswith("*") or not words:
            continue
        found[int(words[0])] = np.array([float(x) for x in words[1:4]])
    return found


def reference(path: Path) -> dict[int, NDArray[np.float64]]:
    """FEBio's displacements that lie beside a case; empty where there are none."""
    for asked in ElementTree.parse(path).getroot().iterfind("Output/logfile/node_data"):
        file = path.parent / str(asked.get("file"))
        if asked.get("data") == "ux;uy;uz" and asked.get("file") and file.exists():
            return displacements(file.read_text())
    return {}


def compared(path: Path, mesh_points: NDArray[np.float64], moved: NDArray[np.float64]) -> float:
    """Largest difference over the largest displacement; nodes by their numbers in the file, which are those of the mesh but
    for nodes of no cell."""
    known = reference(path)
    if not known:
        return float("nan")
    place = {}
    for node in ElementTree.parse(path).getroot().iterfind("Mesh/Nodes/node"):
        place[int(str(node.get("id")))] = np.array([float(x) for x in (node.text or "").split(",")])
    largest = max(float(np.linalg.norm(u)) for u in known.values())
    worst = 0.0
    for number, u in known.items():
        near = np.flatnonzero(np.abs(mesh_points - place[number]).max(axis=1) < 1e-12)
        if len(near):  # where bodies meet in one place: the one that moves alike
            worst = max(worst, min(float(np.linalg.norm(moved[i] - u)) for i in near))
    return worst / max(largest, 1e-300)


def outcome(path: Path, seconds: float) -> Outcome:
    """Of a file."""
    name = path.stem
    try:
        model = read_model(path)
    except (NotReadable, AbutError) as reason:
        return Outcome(name, "not read", detail=" ".join(str(reason).split())[:150])
    contact = ", ".join(sorted({"friction" if c.frictional else c.kind for c in model.contacts}))
    try:
        solution = abut.solve(replace(model, solve=replace(model.solve, seconds=seconds)))
    except AbutError as reason:
        return Outcome(name, "stopped", contact, detail=" ".join(str(reason).split())[:150])
    whole = solution.converged and solution.complete
    force = ", ".join(f"{x:.5g}" for x in solution.contacts[0].force)
    failed = ", ".join(sorted({check.name for check in solution.certificate if not check.passed}))
    return Outcome(
        name, "solved" if whole else "stopped", contact, len(solution.steps), sum(len(s.iterations) for s in solution.steps),
        force, failed, compared(path, model.mesh.points, solution.displacement) if whole else float("nan"),
        "" if whole else f"at {solution.steps[-1].factor:.3g} of the way {solution.steps[-1].reason}",
    )  # fmt: skip


def row(found: Outcome) -> list[str]:
    """In the columns of a table."""
    return [
        f"`{found.name}`", found.status, found.contact, str(found.steps or ""), str(found.iterations or ""), found.force,
        found.failed, f"{100 * found.error:.2g} %" if np.isfinite(found.error) else "", found.detail,
    ]  # fmt: skip


HEAD = ["case", "result", "contact", "steps", "iterations", "force", "certificate fails", "difference", "why"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--seconds", type=float, default=120.0, help="for one case")
    parser.add_argument("--table", type=Path, help="write what was solved or stopped as a table")
    arguments = parser.parse_args()
    paths = [p for p in sorted(arguments.folder.glob("*.feb")) if "<contact " in p.read_text(encoding="latin-1")]
    paths = [p for p in paths if p.stem in arguments.names] if arguments.names else paths
    every = []
    for path in paths:
        every.append(outcome(path, arguments.seconds))
        print(" | ".join(row(every[-1])), flush=True)
    print(dict(Counter(found.status for found in every)))
    if arguments.table:
        rows = [HEAD, ["---"] * len(HEAD), *(row(f) for f in every if f.status != "not read")]
        arguments.table.write_text("".join(f"| {' | '.join(cells)} |\n" for cells in rows))


if __name__ == "__main__":
    main()
