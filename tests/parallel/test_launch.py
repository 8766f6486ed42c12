"""Several processes, as far as it goes without MPI: who was started with whom, who speaks, and what PETSc is given."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

import abut.cli
from abut.cli import main
from abut.errors import InputError
from abut.parallel import launch
from models.steps import job

TOLD = ("OMPI_", "PMI_", "PMIX_", "SLURM_")


@pytest.fixture(autouse=True)
def _alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """No variables of an MPI that this process itself runs under; short waits; OMP_NUM_THREADS as it was afterwards."""
    for name in [name for name in os.environ if name.startswith(TOLD)]:
        monkeypatch.delenv(name)
    monkeypatch.setenv("OMP_NUM_THREADS", "1")
    monkeypatch.setattr(abut.cli, "PAUSE", 0.0)


def started(patch: pytest.MonkeyPatch, size: int, rank: int) -> None:
    patch.setenv("OMPI_COMM_WORLD_SIZE", str(size))
    patch.setenv("OMPI_COMM_WORLD_RANK", str(rank))


@pytest.mark.parametrize(
    ("told", "expected"),
    [
        ({}, (1, 0)),
        ({"OMPI_COMM_WORLD_SIZE": "4", "OMPI_COMM_WORLD_RANK": "3"}, (4, 3)),
        ({"PMI_SIZE": "2", "PMI_RANK": "1"}, (2, 1)),
        ({"SLURM_STEP_NUM_TASKS": "8", "PMIX_RANK": "5", "SLURM_PROCID": "5"}, (8, 5)),
        ({"SLURM_STEP_NUM_TASKS": "8", "SLURM_PROCID": "6"}, (8, 6)),
        ({"SLURM_NTASKS": "8", "SLURM_PROCID": "0"}, (1, 0)),  # the batch script, before srun
        # mpiexec inside an allocation of srun's, which is one step of one task:
        ({"SLURM_STEP_NUM_TASKS": "1", "SLURM_PROCID": "0", "PMI_SIZE": "3", "PMI_RANK": "2"}, (3, 2)),
        ({"OMPI_COMM_WORLD_SIZE": "many", "OMPI_COMM_WORLD_RANK": "0"}, (1, 0)),
    ],
)
def test_who_was_started(told: dict[str, str], expected: tuple[int, int], monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in told.items():
        monkeypatch.setenv(name, value)
    assert (launch.processes(), launch.rank()) == expected


def test_the_command_line_starts_without_numpy_and_mpi() -> None:
    """OMP_NUM_THREADS must be set before NumPy reads it; a serial start stays fast."""
    script = "import abut.cli, sys; print(*(n for n in ('numpy', 'mpi4py', 'petsc4py') if n in sys.modules))"
    result = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert result.stdout.strip() == ""


@pytest.mark.parametrize(("given", "expected"), [(None, "1"), ("3", "3")])
def test_one_thread_a_process_unless_told(
    given: str | None, expected: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    started(monkeypatch, 2, 1)
    monkeypatch.delenv("OMP_NUM_THREADS") if given is None else monkeypatch.setenv("OMP_NUM_THREADS", given)
    assert main(["schema", "--output", str(tmp_path / "schema.json")]) == 0
    assert os.environ["OMP_NUM_THREADS"] == expected
    assert not list(tmp_path.iterdir())  # process 0 writes it, alone


def without(patch: pytest.MonkeyPatch, name: str) -> None:
    """Make a package unknown, installed or not."""

    class Finder:
        def find_spec(self, full: str, *_: Any) -> None:
            if full.split(".")[0] == name:
                raise ModuleNotFoundError(f"No module named {full!r}", name=full)

    for known in [known for known in sys.modules if known.split(".")[0] == name]:
        patch.delitem(sys.modules, known)
    patch.setattr(sys, "meta_path", [Finder(), *sys.meta_path])


def packages(patch: pytest.MonkeyPatch, scalar: Any, size: int) -> None:
    """petsc4py and mpi4py that say so much of themselves."""
    library = SimpleNamespace(ImportPETSc=lambda: SimpleNamespace(ScalarType=scalar))
    world = SimpleNamespace(COMM_WORLD=SimpleNamespace(size=size))
    for name, module in {"petsc4py": ModuleType("petsc4py"), "petsc4py.lib": library, "mpi4py": ModuleType("mpi4py"),
                         "mpi4py.MPI": world}.items():  # fmt: skip
        patch.setitem(sys.modules, name, module)


def test_what_is_missing_is_said_with_the_recipe(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    import numpy as np

    monkeypatch.setattr(launch, "DEBIAN", tmp_path)
    monkeypatch.delenv("PETSC_DIR", raising=False)
    packages(monkeypatch, np.float64, 1)
    launch.require()
    with monkeypatch.context() as patch:
        without(patch, "mpi4py")
        with pytest.raises(InputError, match=r"(?s)mpi4py is not installed.*apt-get install.*conda install"):
            launch.require()
    with monkeypatch.context() as patch:
        packages(patch, np.complex128, 1)
        with pytest.raises(InputError, match=r"compiled for complex numbers.*PETSC_DIR"):
            launch.require()
    with monkeypatch.context() as patch:
        started(patch, 4, 0)
        with pytest.raises(
            InputError, match=r"4 processes were started, but mpi4py knows of 1: mpiexec belongs to ano"
        ):
            launch.require()

    def other_numpy() -> None:
        raise ValueError("numpy.dtype size changed")

    with monkeypatch.context() as patch:
        patch.setitem(sys.modules, "petsc4py.lib", SimpleNamespace(ImportPETSc=other_numpy))
        with pytest.raises(InputError, match=r'(?s)cannot be loaded \(numpy.dtype size changed\).*"numpy<2"'):
            launch.require()
    without(monkeypatch, "petsc4py")
    with pytest.raises(InputError, match=r"(?s)petsc4py is not installed.*apt-get install.*conda install"):
        launch.require()
    there = tmp_path / "petsc3.18" / "arch-real"
    (there / launch.PYTHON / "petsc4py").mkdir(parents=True)
    with pytest.raises(InputError, match=rf"export PETSC_DIR={there}\n"):
        launch.require()


ORDER = "import builtins; builtins.order = [*getattr(builtins, 'order', []), __name__]\n"
BUNDLED = {  # what its wheel and those that it needs bring
    "dolfinx_solver": "import mpi4py.MPI\n",
    "mpi4py": "",
    "mpi4py/MPI": "class COMM_WORLD: size = 1\n",
    "petsc4py": "",
    "petsc4py/lib": "import numpy\ndef ImportPETSc():\n    import petsc4py.PETSc as found\n    return found\n",
    "petsc4py/PETSc": "import numpy\nScalarType = numpy.float64\n",
}


def bundle(folder: Path, **changes: str) -> str:
    """Packages of these names there, which note when they are imported; what ``require`` says, and that order."""
    for name, code in {**BUNDLED, **changes}.items():
        file = folder / f"{name}.py" if "/" in name else folder / name / "__init__.py"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(ORDER + code)
    ask = (
        "import builtins\nfrom abut.parallel.launch import require\n"
        "try: require()\nexcept Exception as error: print(type(error).__name__, error)\nprint(builtins.order)"
    )
    source = str(Path(abut.__file__).parents[1])
    own = {name: value for name, value in os.environ.items() if not name.startswith(TOLD)}
    paths = {"PYTHONPATH": os.pathsep.join([str(folder), source])}
    return subprocess.run(
        [sys.executable, "-c", ask], capture_output=True, text=True, env={**own, **paths}, check=True
    ).stdout


def test_petsc_in_wheels_is_imported_in_its_order(tmp_path: Path) -> None:
    """As dolfinx-solver-real asks: itself, then MPI, then petsc4py. What it says of another one in its way is told."""
    assert (
        bundle(tmp_path)
        == str(["dolfinx_solver", "mpi4py", "mpi4py.MPI", "petsc4py", "petsc4py.lib", "petsc4py.PETSc"]) + "\n"
    )
    said = bundle(tmp_path, dolfinx_solver="raise ImportError('petsc4py is installed\\n beside. Uninstall it')\n")
    assert said.startswith(
        "InputError dolfinx-solver-real cannot be used: petsc4py is installed beside. Uninstall it\n"
    )
    said = bundle(tmp_path, dolfinx_solver="import what_is_not_there\n")
    assert said.startswith(
        "InputError dolfinx-solver-real cannot be loaded (No module named 'what_is_not_there'): install"
    )


def test_without_petsc_only_process_0_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = job(tmp_path)
    without(monkeypatch, "petsc4py")
    said = []
    for rank in range(3):
        started(monkeypatch, 3, rank)
        assert main(["run", str(path)]) == 2
        said.append("".join(capsys.readouterr()))
    assert said[0].startswith("abut: error: petsc4py is not installed")
    assert said[1:] == ["", ""]
    assert [p.name for p in tmp_path.iterdir()] == ["job.toml"]


def test_a_job_may_ask_for_petsc_on_one_process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    without(monkeypatch, "petsc4py")
    assert main(["run", str(job(tmp_path, linear="petsc"))]) == 2
    assert "petsc4py is not installed" in capsys.readouterr().err


def led(patch: pytest.MonkeyPatch) -> list[list[str]]:
    """Stand in for the leading process: keeps the options for PETSc, and solves alone."""
    given: list[list[str]] = []

    def lead(function: Any, options: list[str]) -> int:
        given.append(options)
        return int(function(None))

    patch.setattr("abut.parallel.team.lead", lead)
    patch.setattr("abut.cli.run.unused", lambda options: [])
    return given


def test_options_reach_petsc(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    given = led(monkeypatch)
    started(monkeypatch, 2, 0)
    path = str(job(tmp_path))
    options = ["-ksp_type", "minres", "-ksp_monitor", "-shift", "-1e-3"]
    assert main(["run", path, *options, "--quiet"]) == 0
    assert main(["run", "--quiet", path]) == 0
    assert given == [options, []]


@pytest.mark.parametrize(
    ("size", "options"),
    [
        (1, ["-ksp_type", "minres"]),  # PETSc is not in use
        (1, ["--quite"]),
        (2, ["--quite"]),  # PETSc's own have one dash: this is a slip of the pen
        (2, ["-ksp_type", "minres", "gmres"]),
        (2, ["other.toml"]),
    ],
)
def test_what_nobody_knows_is_refused(
    size: int,
    options: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    path = job(tmp_path)
    for rank in range(size):
        started(monkeypatch, size, rank)
        with pytest.raises(SystemExit) as end:
            main(["run", str(path), *options])
        assert end.value.code == (0 if rank else 2)  # mpiexec ends all when one fails: process 0 speaks first
        said = capsys.readouterr().err
        assert said == "" if rank else said.endswith(f"unrecognized arguments: {' '.join(options)}\n")
    with pytest.raises(SystemExit):
        main(["check", str(path), "-ksp_type", "minres"])
    assert [p.name for p in tmp_path.iterdir()] == ["job.toml"]


@pytest.mark.parametrize("linear", ["direct", "amg"])
def test_solvers_of_one_process_are_refused_on_two(
    linear: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    led(monkeypatch)
    started(monkeypatch, 2, 0)
    assert main(["run", str(job(tmp_path, linear=linear))]) == 2
    assert f'"{linear}" runs on one process, but 2 were started; take it out' in capsys.readouterr().err
    assert [p.name for p in tmp_path.iterdir()] == ["job.toml"]


def test_other_commands_run_on_process_0(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(job(tmp_path))
    said = []
    for rank in range(2):
        started(monkeypatch, 2, rank)
        assert main(["check", path]) == 0
        said.append("".join(capsys.readouterr()))
    assert said[0]
    assert said[1] == ""
    with pytest.raises(SystemExit) as end:
        main(["run", "--help"])
    assert end.value.code == 0
    assert capsys.readouterr().out == ""
