"""The C++ of the compiled core by itself: clipping, projection, shape functions. Each program here is compiled and run."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent
CORE = Path(__file__).parents[2] / "cpp"
PROGRAMS = sorted(HERE.glob("*.cpp"))
NAMES = [
    (program, name)
    for program in PROGRAMS
    for name in re.findall(r"^TEST\((\w+)\)", program.read_text(encoding="utf-8"), re.MULTILINE)
]
FLAGS = ("-std=c++20", "-O1", "-Wall", "-Wextra")
WERROR = ("-Werror",) if os.environ.get("ABUT_WERROR") else ()  # of compilers that are known, as in CI


def compiler() -> str:
    """A compiler as CMake would find; without one the tests are skipped, unless they are asked for."""
    found = next(
        (path for name in (os.environ.get("CXX", ""), "c++", "g++", "clang++") if (path := shutil.which(name))), ""
    )
    if not found and os.environ.get("ABUT_CPP_TESTS") == "required":
        pytest.fail("no C++ compiler: install g++ or clang++")
    if not found or sys.platform == "win32":
        pytest.skip("needs a C++ compiler that takes GCC's options")
    return found


@pytest.fixture(scope="session")
def programs(tmp_path_factory: pytest.TempPathFactory) -> dict[Path, Path]:
    """The compiled program of each file, compiled when asked for first."""
    return {source: tmp_path_factory.mktemp("core") / source.stem for source in PROGRAMS}


@pytest.mark.parametrize(("source", "name"), NAMES, ids=[f"{source.stem}-{name}" for source, name in NAMES])
def test_core(source: Path, name: str, programs: dict[Path, Path]) -> None:
    program = programs[source]
    if not program.exists():
        command = [compiler(), *FLAGS, *WERROR, f"-I{CORE}", f"-I{HERE}", str(source), "-o", str(program)]
        built = subprocess.run(command, capture_output=True, text=True, check=False)
        assert built.returncode == 0, built.stderr
    run = subprocess.run([str(program), name], capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stdout


def test_each_program_has_tests() -> None:
    assert {source for source, _ in NAMES} == set(PROGRAMS)
    assert {source.stem for source in PROGRAMS} == {"clipping", "duals", "modes", "projection", "shape_functions"}
