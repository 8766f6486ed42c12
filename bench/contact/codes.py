"""The codes compared: whether each is there, what it needs written, how it is run, what a run has given."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from process import Run

HERE = Path(__file__).parent
TYPES = {"calculix-mortar": "mortar", "calculix-penalty": "penalty"}
CODES = ("abut", "abut-tied", "abut-dual", "pyamg", *TYPES, "kratos")
DISTRIBUTION = "KratosContactStructuralMechanicsApplication"


@dataclass(frozen=True)
class Code:
    """A code ready to run, or not: ``version`` is empty where it is missing.

    prepare: command that writes its input for (case, dofs) into a folder, or None; command: what is then run in that
    folder; read: (run, folder) -> status, iterations, force and, if the code tells, seconds.
    """

    name: str
    family: str
    version: str
    prepare: Callable[[str, int, Path], list[str]] | None
    command: Callable[[str, int], list[str]]
    read: Callable[[Run, Path], dict[str, Any]]
    environment: dict[str, str] | None = None


def _script(name: str, *arguments: object) -> list[str]:
    return [sys.executable, str(HERE / name), *map(str, arguments)]


def _said(run: Run, _: Path) -> dict[str, Any]:
    """What a child of ours printed."""
    return run.json() or {"status": "failed: it printed no result"}


def _output(command: list[str], check: bool = True) -> str:
    """What a command prints, or nothing where it fails (``check``: also by its exit status)."""
    try:
        return subprocess.run(command, capture_output=True, text=True, timeout=60, check=check).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return ""


def _abut(name: str, linear: str) -> Code:
    options = ["--linear", linear, *({"abut-tied": ["--tied"], "abut-dual": ["--dual"]}.get(name, []))]
    version = _output([sys.executable, "-c", "import abut; print(abut.__version__)"])
    return Code(name, "abut", version, None, lambda case, dofs: _script("abut_child.py", case, dofs, *options), _said)


def _pyamg(name: str) -> Code:
    version = _output([sys.executable, "-c", "import pyamg; print(pyamg.__version__)"])
    return Code(name, "PyAMG", version, None, lambda case, dofs: _script("pyamg_child.py", case, dofs), _said)


def _calculix(name: str, ccx: str) -> Code:
    path = shutil.which(ccx)
    found = re.search(r"Version (\S+)", _output([path, "-v"], check=False)) if path else None
    version = found[1] if found else "of unknown version" if path else ""
    return Code(
        name,
        "CalculiX",
        version,
        lambda case, dofs, folder: _script("calculix.py", case, dofs, TYPES[name], folder),
        lambda case, dofs: [str(path), "deck"],
        _calculix_results,
    )


def _calculix_results(run: Run, folder: Path) -> dict[str, Any]:
    """Iterations and the force on the lower body's foot from what a run of CalculiX wrote."""
    if "Job finished" not in run.output:
        errors = [line.strip(" *") for line in run.output.splitlines() if "*ERROR" in line]
        return {"status": f"failed: {errors[0] if errors else 'it stopped without a message'}"}
    lines = (folder / "deck.cvg").read_text(encoding="ascii", errors="replace").splitlines()
    iterations = sum(bool(re.match(r"\s*\d+\s+\d+\s+\d+\s+\d+\s", line)) for line in lines)
    sums = re.findall(r"total force.*time +(\S+)\s+(\S+)\s+(\S+)\s+(\S+)", (folder / "deck.dat").read_text("ascii"))
    if not sums or float(sums[-1][0]) < 1.0:
        return {"status": "not converged", "iterations": iterations}
    return {"status": "ok", "iterations": iterations, "force": abs(float(sums[-1][3]))}


def _kratos(name: str, python: str) -> Code:
    version = _output([python, "-c", f"import importlib.metadata as m; print(m.version({DISTRIBUTION!r}))"])
    return Code(
        name,
        "Kratos",
        version,
        lambda case, dofs, folder: _script("kratos.py", case, dofs, folder),
        lambda case, dofs: [python, str(HERE / "kratos_child.py")],
        _said,
        {key: value for key, value in os.environ.items() if key != "PYTHONPATH"},
    )


def code(name: str, linear: str, ccx: str, kratos_python: str) -> Code:
    """A code by its name in CODES."""
    if name.startswith("abut"):
        return _abut(name, linear)
    if name == "pyamg":
        return _pyamg(name)
    return _calculix(name, ccx) if name in TYPES else _kratos(name, kratos_python)
