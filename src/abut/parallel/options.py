"""What the user's PETSc options ask for."""

from __future__ import annotations

from abut.errors import InputError
from abut.parallel.krylov import MULTIGRID, STIFFNESS
from abut.parallel.systems import FACTORS

PRECONDITIONERS = ("pc_type", f"{STIFFNESS}pc_type")  # options that name one
KRYLOV = ("ksp_type", f"{STIFFNESS}ksp_type")


def require_known() -> None:
    """Raise InputError for preconditioners and Krylov methods that this PETSc does not have: before it looks for them on all
    processes at once."""
    from petsc4py import PETSc

    given, own = PETSc.Options(), PETSc.COMM_SELF
    for names, what, kind in ((PRECONDITIONERS, "preconditioner", PETSc.PC), (KRYLOV, "Krylov method", PETSc.KSP)):
        for name in (name for name in names if given.hasName(name)):
            tried, wanted = kind().create(own), given.getString(name)
            try:
                tried.setType(wanted)
            except PETSc.Error:
                raise InputError(
                    f"-{name} {wanted}: this PETSc has no {what} of that name; check the spelling, or leave the option out"
                ) from None
            finally:
                tried.destroy()


def preconditioner() -> str:
    """PETSc's name of what preconditions the stiffness."""
    from petsc4py import PETSc

    options = PETSc.Options()
    given = options.getString("pc_type", MULTIGRID["pc_type"])
    return str(options.getString(STIFFNESS + "pc_type", given))


def krylov_method() -> str:
    """What the user's PETSc options name, else nothing."""
    from petsc4py import PETSc

    return str(PETSc.Options().getString("ksp_type", ""))


def wants_factors() -> bool:
    """Whether the user's PETSc options ask for a direct solver."""
    from petsc4py import PETSc

    return str(PETSc.Options().getString("pc_type", "")) in FACTORS


def wants_iterations() -> bool:
    """Whether they ask for another preconditioner, or another Krylov method."""
    from petsc4py import PETSc

    options = PETSc.Options()
    return not wants_factors() and any(options.hasName(name) for name in ("pc_type", "ksp_type", "stiffness_pc_type"))
