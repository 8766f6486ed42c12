"""What many processes find is what one does: the same model by the serial direct solver and by PETSc, tests/mpi/agree.py."""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

Run = Callable[..., subprocess.CompletedProcess[str]]
PROGRAM = str(Path(__file__).with_name("agree.py"))
# Equilibrium of iterations is met to 1e-11 of the forces; pressures follow from it with the condition of the interface,
# some tens to hundreds. Factorisations are met to rounding.
AGREE = 2e-8
PATCHES = ["hex8", "tet10-hex20", "wedge6-tet4", "hex27-wedge15", "plane", "tied", "smooth", "node-to-segment"]


def compared(mpirun: Run, n: int, cases: list[str], *options: str, timeout: float = 200.0) -> dict[str, dict[str, Any]]:
    """The differences of some cases, which are checked."""
    result = mpirun(n, ",".join(cases), *options, program=(PROGRAM,), timeout=timeout)
    assert result.returncode == 0, result.stderr
    found = {row["case"]: row for row in map(json.loads, result.stdout.splitlines())}
    assert list(found) == cases
    for row in found.values():
        assert row["converged"]
        assert max(row[what] for what in ("displacement", "pressure", "stress", "reaction")) < AGREE, row
        assert max(row.get(what, 0.0) for what in ("traction", "slip", "remembered")) < AGREE, row
        assert len(row["cells"]) == n
    return found


@pytest.mark.parametrize("n", [1, 2, 3])
def test_patch_tests_and_laws(mpirun: Run, n: int) -> None:
    """Every cell type, law and method, on supports in a general position, by factorisation."""
    for row in compared(mpirun, n, PATCHES).values():
        assert "direct" in row["solver"]


@pytest.mark.parametrize("n", [1, 2, 3])
def test_multigrid(mpirun: Run, n: int) -> None:
    """The same by iterations, with bodies that contact alone holds in one direction."""
    for row in compared(mpirun, n, ["hex8", "tet10-hex20", "tied", "press", "larger"], "-pc_type", "gamg").values():
        assert "gamg" in row["solver"]


@pytest.mark.parametrize("n", [2, 3])
@pytest.mark.parametrize("option", ["mumps", "gamg"])
def test_friction(mpirun: Run, n: int, option: str) -> None:
    """Several steps with reversal, in which contact opens, sticks and slips: status, traction and slip of every step as on
    one process, by factors of an unsymmetric matrix and by iterations."""
    options = ["-pc_type", "gamg"] if option == "gamg" else []
    found = compared(mpirun, n, ["pushed", "rubbed"], *options)
    assert all(option in row["solver"] and row["slip"] > 0.0 for row in found.values())


def test_pressures_that_processes_share(mpirun: Run) -> None:
    """Mixed tet10 cells: metal and rubber, small strains and finite, stick and slip, by factors; multigrid has the pressures
    in its matrix."""
    found = compared(mpirun, 3, ["volumes", "volumes-finite", "volumes-rubber"])
    assert all("direct" in row["solver"] for row in found.values())
    assert "gamg" in compared(mpirun, 3, ["volumes"], "-pc_type", "gamg")["volumes"]["solver"]


@pytest.mark.parametrize("case", ["metal", "metal-finite", "softening"])
def test_materials_with_a_history(mpirun: Run, case: str) -> None:
    """Metal that yields under small and finite strains, and a user's own law: histories over loading and unloading."""
    for row in compared(mpirun, 2, [case]).values():
        assert "direct" in row["solver"]


@pytest.mark.parametrize("n", [1, 2, 3])
def test_terms_with_rates(mpirun: Run, n: int) -> None:
    """Newmark's method and masses that a user's physics adds, with contact that closes on the way, small and finite."""
    for row in compared(mpirun, n, ["swinging", "swinging-finite"]).values():
        assert "direct" in row["solver"]
        assert row["solutions"] == row["alone"]


@pytest.mark.parametrize("n", [1, 2, 3])
def test_fields_beside_displacements(mpirun: Run, n: int) -> None:
    """Temperatures at nodes, coupled both ways, with contact; internal unknowns of cells; forces of connectors
    at large turns: iterations as on one process."""
    cases = ["heated", "heated-moving", "bent", "hinged-lever", "slider-crank", "hinged-beams"]
    for case, row in compared(mpirun, n, cases).items():
        assert "direct" in row["solver"]
        assert row["solutions"] == row["alone"]
        assert ("remembered" in row) == case.startswith("heated")


@pytest.mark.parametrize("n", [1, 2])
def test_the_constraint_function_by_multigrid(mpirun: Run, n: int) -> None:
    """Its rows look at points: where it is all closed, and where contact ends within a facet."""
    for row in compared(mpirun, n, ["smooth", "press-smooth"], "-pc_type", "gamg").values():
        assert "gamg" in row["solver"]


def test_the_constraint_function_with_friction_is_for_factors(mpirun: Run) -> None:
    result = mpirun(2, "rubbed-smooth", "-pc_type", "gamg", program=(PROGRAM,))
    assert result.returncode != 0
    assert "PETSc's iterations know friction by Coulomb's law alone" in result.stderr


SYMMETRIC = [("pushed", "friction"), ("smooth", "the constraint function"), ("beam", "finite kinematics")]


@pytest.mark.parametrize(("case", "why"), SYMMETRIC)
def test_what_is_not_symmetric(mpirun: Run, case: str, why: str) -> None:
    """MINRES would not converge to the solution: it is refused by its name."""
    result = mpirun(2, case, "-ksp_type", "minres", program=(PROGRAM,))
    assert result.returncode != 0
    assert f"-ksp_type minres is for symmetric matrices, which {why} does not leave" in result.stderr


def test_other_solvers(mpirun: Run) -> None:
    """hypre in place of GAMG, MINRES in place of FGMRES, by PETSc's options."""
    cases = ["hex8", "press"]
    assert all("hypre" in row["solver"] for row in compared(mpirun, 2, cases, "-pc_type", "hypre").values())
    other = compared(mpirun, 2, cases, "-ksp_type", "minres")
    flexible = compared(mpirun, 2, cases, "-pc_type", "gamg")
    assert all(other[case]["note"] != flexible[case]["note"] for case in cases)  # not the same count of iterations


@pytest.mark.parametrize("n", [1, 2, 3])
def test_steps_loads_and_constraints(mpirun: Run, n: int) -> None:
    """Two steps with weight and heat where contact opens; a rigid tool and an equation, which couple points of several
    parts; a surface in two contacts, lists and bodies; no contact at all, by factors and by conjugate gradients."""
    compared(mpirun, n, ["press", "press-tet10", "rigid", "alone", "clevis", "two-rings"])
    assert "gamg" in compared(mpirun, n, ["alone"], "-pc_type", "gamg")["alone"]["solver"]


@pytest.mark.parametrize("n", [2, 3])
def test_parts_of_every_kind(mpirun: Run, n: int) -> None:
    """Contact across processes, a process without facets of the contact, more processes than cells of a body, and than
    cells."""
    found = compared(mpirun, n, ["press", "tower", "one-cell", "two-cells"])
    ((contactor, target),) = found["press"]["facets"]
    assert sum(c + t > 0 for c, t in zip(contactor, target)) > 1
    if n == 3:  # contact is in the middle of the tower: the parts at its ends have none
        ((contactor, target),) = found["tower"]["facets"]
        assert min(c + t for c, t in zip(contactor, target)) == 0
    ((contactor, _),) = found["one-cell"]["facets"]
    assert sum(contactor) == 1
    assert min(found["two-cells"]["cells"]) == (0 if n == 3 else 1)


@pytest.mark.parametrize("n", [1, 2, 3])
def test_hertz_and_the_pin(mpirun: Run, n: int) -> None:
    """Hertz's line by the constraint function; his ball (19 341 displacements) and the pin in its lug by multigrid."""
    found = compared(mpirun, n, ["hertz-line", "ball", "pin-lug"])
    assert all("gamg" in found[case]["solver"] for case in ("ball", "pin-lug"))


@pytest.mark.parametrize("n", [1, 2])
@pytest.mark.parametrize("option", ["mumps", "gamg"])
def test_search(mpirun: Run, n: int, option: str) -> None:
    """Active sets that are hard to find, by interior points, in as few linear solutions as on one process."""
    options = ["-pc_type", "gamg"] if option == "gamg" else []
    for row in compared(mpirun, n, ["lifted", "loose"], *options).values():
        assert option in row["solver"]
        assert max(row["solutions"]) <= 20
