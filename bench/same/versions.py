"""Two versions of abut side by side: where their files are, and how to run each one's own code."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
THREADS = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS")
FIXED = {"PYTHONHASHSEED": "0", "PYTHONDONTWRITEBYTECODE": "1"}
EXTRAS = ("scikit-fem>=10",)  # for the example of another code


class VersionError(Exception):
    """A version cannot be fetched, built or run; the text says why."""


@dataclass(frozen=True)
class Version:
    """A version in ``tree``, run by ``python``; ``source``: its folder src with a compiled core, None where installed."""

    tree: Path
    python: Path
    source: Path | None = None

    @property
    def environment(self) -> dict[str, str]:
        """One thread, the same order of sets in every run, and no other abut than this one."""
        inherited = {key: value for key, value in os.environ.items() if key not in ("PYTHONPATH", "PYTHONHOME")}
        path = {} if self.source is None else {"PYTHONPATH": str(self.source)}
        return {**inherited, **dict.fromkeys(THREADS, "1"), **FIXED, **path}


@contextmanager
def checked_out(what: str | None, name: str, folder: Path) -> Iterator[Version]:
    """A version to be run: of a folder, as it is; else a copy in ``folder``, of a commit or (None) of the working tree,
    which ``install`` is still to build. The copy of a commit is a git worktree, which is removed at the end.

    Raises VersionError for what is neither a folder nor a commit, and for a folder without a compiled core.
    """
    if what is not None and Path(what).is_dir():
        source = Path(what).resolve() / "src"
        if not list(source.glob("abut/_core/*.so")) + list(source.glob("abut/_core/*.pyd")):
            raise VersionError(f"{what}: no compiled core in {source}; run make build there, or give a commit")
        yield Version(source.parent, Path(sys.executable), source)
        return
    tree, environment = folder / f"{name}-tree", folder / f"{name}-venv"
    version = Version(tree, environment / ("Scripts/python.exe" if os.name == "nt" else "bin/python"))
    if what is None:
        copy_working_tree(ROOT, tree)
        yield version
        return
    commit = ran(["git", "rev-parse", "--verify", "--quiet", f"{what}^{{commit}}"], f"{what}: no folder, and no commit")
    ran(["git", "worktree", "add", "--quiet", "--detach", str(tree), commit], f"{what}: cannot be checked out")
    try:
        yield version
    finally:
        ran(["git", "worktree", "remove", "--force", str(tree)], f"{tree}: cannot be removed; try git worktree prune")


def copy_working_tree(root: Path, tree: Path) -> None:
    """Files that git knows or does not ignore, as they are now."""
    names = ran(
        ["git", "-C", str(root), "ls-files", "-z", "-co", "--exclude-standard"], f"{root}: not a git repository"
    )
    for name in names.split("\0"):
        if name and (root / name).is_file():
            (tree / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(root / name, tree / name)


def install(version: Version) -> None:
    """Compile the core and install abut into an environment of its own; nothing for a folder. Raises VersionError."""
    if version.source is None:
        ran([sys.executable, "-m", "venv", str(version.python.parents[1])], "no environment can be made")
        command = [str(version.python), "-m", "pip", "install", "--quiet", str(version.tree), *EXTRAS]
        ran(command, f"{version.tree}: cannot be installed")
    where = Path(ran([str(version.python), "-c", "import abut; print(abut.__file__)"], "abut", version.environment))
    expected = version.source or version.python.parents[1]
    if not where.is_relative_to(expected):
        raise VersionError(f"abut is imported from {where}, not from {expected}")


def ran(command: list[str], failure: str, environment: dict[str, str] | None = None) -> str:
    """What a command prints. Raises VersionError with ``failure`` and the end of what it says where it fails."""
    child = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    if child.returncode:
        said = "\n".join((child.stderr or child.stdout).strip().splitlines()[-15:])
        raise VersionError(f"{failure}\n{said}".strip())
    return child.stdout.strip()
