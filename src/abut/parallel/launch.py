"""The number of processes of a run, and whether the packages it needs are installed, without importing them."""

from __future__ import annotations

import ctypes
import importlib
import os
from collections.abc import Sequence
from pathlib import Path

from abut.errors import InputError

LAUNCHERS = (  # what each tells its processes: how many there are, and which one this is
    ("OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"),  # mpiexec of Open MPI
    ("PMI_SIZE", "PMI_RANK"),  # mpiexec of MPICH and Intel MPI; srun --mpi=pmi2
    ("SLURM_STEP_NUM_TASKS", "PMIX_RANK"),  # srun --mpi=pmix
    ("SLURM_STEP_NUM_TASKS", "SLURM_PROCID"),  # srun by other ways; a batch script itself has no step
)
DEBIAN = Path("/usr/lib/petscdir")  # petsc4py of Debian and Ubuntu is in here, for PETSC_DIR to choose
PYTHON = Path("lib/python3/dist-packages")
BUNDLE = "dolfinx_solver"  # of PyPI's dolfinx-solver-real: PETSc, petsc4py and MPICH in wheels, in that order
RECIPE = """it takes petsc4py and mpi4py, which belong to an MPI:
  Linux on x86-64, Python 3.12 or newer, in an environment of its own:
                  pip install ".[mpi]"      (in abut's folder)
  Debian, Ubuntu: apt-get install python3-petsc4py python3-mpi4py python3-venv
                  export PETSC_DIR=$(echo /usr/lib/petscdir/petsc3*/*-real)
                  /usr/bin/python3 -m venv --system-site-packages mpi
                  mpi/bin/pip install . "numpy<2"      (in abut's folder)
  conda:          conda install -c conda-forge petsc4py mpi4py
                  pip install .
(docs/mpi.md says more)"""

DEBIAN_SLEPC = Path("/usr/lib/slepcdir")
SLEPC = """install it from where petsc4py is:
  pip install ".[mpi]" (Linux on x86-64, Python 3.12 or newer): dolfinx-solver-real, which has both
  Debian, Ubuntu:      apt-get install python3-slepc4py
                       export SLEPC_DIR=$(echo /usr/lib/slepcdir/slepc3*/*-real)
  conda:               conda install -c conda-forge slepc4py
One process without PETSc (solve.linear) finds them as well"""


def processes() -> int:
    """How many processes were started together, as whoever started them says; 1 where nobody does."""
    return _told()[0]


def rank() -> int:
    """Which of them this one is, from 0; process 0 leads and speaks."""
    return _told()[1]


def _told() -> tuple[int, int]:
    for names in LAUNCHERS:
        size, rank = (os.environ.get(name, "") for name in names)
        if size.isdecimal() and rank.isdecimal():
            return max(int(size), 1), int(rank)
    return 1, 0


def require() -> None:
    """Raise InputError, with what to install, where petsc4py or mpi4py are missing, do not fit, or know of other processes
    than were started. Starts MPI."""
    _bundle()
    try:
        library = importlib.import_module("petsc4py.lib").ImportPETSc()  # unlike petsc4py.PETSc, does not start PETSc
    except (ImportError, AttributeError, ValueError) as error:  # the latter two: compiled for another NumPy
        raise InputError(f"{_missing('petsc4py', error)}: {_hint()}{RECIPE}") from None
    if library.ScalarType().dtype.kind != "f":
        raise InputError(
            "petsc4py is compiled for complex numbers; abut needs one for real numbers: set PETSC_DIR to it (Debian: "
            f'{DEBIAN}/petsc3*/*-real; conda: petsc="*=real*")'
        )
    try:
        world = importlib.import_module("mpi4py.MPI").COMM_WORLD
    except (ImportError, RuntimeError) as error:  # the latter: no MPI library
        raise InputError(f"{_missing('mpi4py', error)}: {RECIPE}") from None
    if world.size != processes():
        raise InputError(
            f"{processes()} processes were started, but mpi4py knows of {world.size}: mpiexec belongs to another MPI than "
            "mpi4py; use the mpiexec that was installed with it"
        )


def require_slepc() -> None:
    """Raise InputError, with what to install, where slepc4py is missing or does not go with petsc4py. Starts MPI."""
    require()
    try:
        importlib.import_module("slepc4py.lib").ImportSLEPc()
    except (ImportError, AttributeError, ValueError) as error:
        raise InputError(
            f"{_missing('slepc4py', error)}: frequencies and buckling on several processes, or by PETSc, take it beside "
            f"petsc4py: {_slepc_hint()}{SLEPC}"
        ) from None


def _bundle() -> None:
    """Import the package that brings PETSc in wheels, where there is one: it loads its MPI before what is bound to it.
    Raises InputError with its own words where another petsc4py or MPI is in its way."""
    try:
        importlib.import_module(BUNDLE)
    except ModuleNotFoundError as error:
        if error.name != BUNDLE:
            raise InputError(f"{_missing('dolfinx-solver-real', error)}: install it anew") from None
    except ImportError as error:
        raise InputError(f"dolfinx-solver-real cannot be used: {' '.join(str(error).split())}") from None


def unused(options: Sequence[str]) -> list[str]:
    """Those of the options given to PETSc that it has not asked for so far: misspelt, or of no use to what was run."""
    database = ctypes.CDLL(importlib.import_module("petsc4py.PETSc").__file__)
    result = []
    for option in options:
        asked = ctypes.c_int(1)
        if option[:1] == "-" and option[1:2].isalpha():  # petsc4py itself can tell from 3.20 on only
            database.PetscOptionsUsed(None, option[1:].encode(), ctypes.byref(asked))
        if not asked.value:
            result.append(option)
    return result


def _slepc_hint() -> str:
    """What to set where Debian's slepc4py is there but Python has not been told."""
    if os.environ.get("SLEPC_DIR"):
        return ""
    found = sorted(str(path) for path in DEBIAN_SLEPC.glob("slepc3*/*-real") if (path / PYTHON / "slepc4py").is_dir())
    return (
        f"it is on this machine, for Debian's own Python after\n  export SLEPC_DIR={found[-1]}\nElse " if found else ""
    )


def _missing(name: str, error: Exception) -> str:
    if getattr(error, "name", None) == name:
        return f"{name} is not installed for this Python"
    reason = (str(error).strip().splitlines() or [type(error).__name__])[0]
    return f"{name} cannot be loaded ({reason})"


def _hint() -> str:
    """What to set where Debian's petsc4py is there but Python has not been told."""
    if os.environ.get("PETSC_DIR"):
        return ""
    found = sorted(str(path) for path in DEBIAN.glob("petsc3*/*-real") if (path / PYTHON / "petsc4py").is_dir())
    return (
        f"it is on this machine, for Debian's own Python after\n  export PETSC_DIR={found[-1]}\nElse " if found else ""
    )
