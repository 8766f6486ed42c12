"""Gmsh as a program: found, asked for its version, run on a script. It is under the GPL and never imported."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from abut.errors import InputError

OLDEST = (4, 8)  # names of fields and sizes are those from this version on
INSTALL = "install it (Debian: apt install gmsh; elsewhere https://gmsh.info or pip install gmsh), or give --gmsh PATH"
SHOWN = 5  # lines of what Gmsh says


def find_gmsh(given: str = "gmsh") -> str:
    """The program's path. given: a name or a path. Raises InputError where it is missing or too old."""
    program = shutil.which(given)
    if program is None:
        raise InputError(f"abut mesh: no program '{given}' to make meshes with; {INSTALL}")
    text = _run([program, "--version"], Path.cwd())
    found = re.search(r"^\s*(\d+)\.(\d+)", text, re.MULTILINE)
    if found is None:
        raise InputError(f"abut mesh: {program} does not say its version, so it may not be Gmsh; give --gmsh PATH")
    version = int(found[1]), int(found[2])
    if version < OLDEST:
        oldest = ".".join(map(str, OLDEST))
        raise InputError(
            f"abut mesh: {program} is version {found[0].strip()}, older than {oldest}; install a newer one"
        )
    return program


def run_script(program: str, script: Path, mesh: Path) -> str:
    """Make the three-dimensional mesh of a script; returns what Gmsh has printed. Raises InputError with Gmsh's errors."""
    options = ["-3", "-format", "msh41", "-bin", "-o", str(mesh), "-nt", "1", "-v", "3"]
    printed = _run([program, str(script), *options], script.parent)
    if not mesh.exists():
        raise InputError(f"abut mesh: Gmsh made no mesh: {_errors(printed)}")
    return printed


def _run(command: Sequence[str], folder: Path) -> str:
    try:
        done = subprocess.run(command, cwd=folder, capture_output=True, stdin=subprocess.DEVNULL, check=False)
    except OSError as error:
        raise InputError(f"abut mesh: cannot start {command[0]}: {error.strerror}; {INSTALL}") from None
    printed = (done.stdout + b"\n" + done.stderr).decode("utf-8", "replace")
    if done.returncode:
        raise InputError(f"abut mesh: Gmsh ended with status {done.returncode}: {_errors(printed)}")
    return printed


def _errors(printed: str) -> str:
    """Gmsh's own errors, without the colours that it prints them in."""
    plain = re.sub(r"\x1b\[[0-9;]*m", "", printed)
    lines = [line.partition(":")[2].strip() for line in plain.splitlines() if line.startswith("Error")]
    text = "; ".join(dict.fromkeys(line for line in lines[:SHOWN] if line))
    return text or "it does not say why; a larger --size, or a repaired part, may help"
