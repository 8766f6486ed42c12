"""What a test needs to start abut on several processes: whether it can be, and the environment it takes."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys

TOLD = ("OMPI_", "PMI_", "PMIX_", "SLURM_")  # variables by which MPI tells processes of each other
OPEN_MPI = {
    "OMPI_MCA_rmaps_base_oversubscribe": "1",  # more processes than cores
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",  # not allowed in containers
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",  # the first, from version 5 on
}
AS_ROOT = {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}


def environment(**more: str) -> dict[str, str]:
    """What started processes get: not what this one was told by an MPI, if any."""
    own = {name: value for name, value in os.environ.items() if not name.startswith(TOLD)}
    root = AS_ROOT if hasattr(os, "getuid") and os.getuid() == 0 else {}
    return {**own, **OPEN_MPI, **root, **more}


def missing() -> str:
    """Why there can be no processes here; asked in a process of its own, because this one must not start MPI."""
    if shutil.which("mpiexec") is None:
        return "mpiexec is not installed"
    ask = "from abut.parallel.launch import require\ntry: require()\nexcept Exception as error: print(error)"
    return subprocess.run(
        [sys.executable, "-c", ask], capture_output=True, text=True, env=environment(), check=True
    ).stdout
