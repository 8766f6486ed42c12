"""Two dies pressed into a slab and drawn along it at large displacements, friction 0.3, in abut and in Kratos on the same
mesh: iterations and processor time.

    kratos/bin/pip install KratosContactStructuralMechanicsApplication KratosConstitutiveLawsApplication
    KRATOS_PYTHON=kratos/bin/python python bench/sliding.py [--case die ironing] [--level 0] [--steps 20]

die: hex8 in 3D. ironing: shallow ironing in plane strain, quad4.
Kratos: augmented Lagrangian mortar contact with friction, total Lagrangian cells, its neo-Hookean law, sparse LU, else its
own defaults, as many equal steps as asked for. abut: once with the same steps, once with those that it finds. Each is a
process of its own on one thread.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent / "contact"))
import kratos

import abut
from abut.benchmarks import finite_contact, finite_contact_3d

CHILD = str(Path(__file__).with_name("sliding_kratos.py"))
STEPS = {"die": 20, "ironing": 60}
LAWS = {2: "HyperElasticPlaneStrain2DLaw", 3: "HyperElastic3DLaw"}


def model(name: str, level: int) -> abut.Model:
    """The die or ironing; ``level`` halves the cells."""
    return finite_contact_3d.model(level, "hex8") if name == "die" else finite_contact.ironing(level)


def files(case: abut.Model, folder: Path, steps: int) -> None:
    """What Kratos reads: as for small displacements, but for cells, law, and what is prescribed over time."""
    text = "\n".join(kratos.mdpa(case)).replace("SmallDisplacementElement", "TotalLagrangianElement")
    (folder / "case.mdpa").write_text(text + "\n", encoding="ascii")
    materials = kratos.materials(case)
    for row in materials["properties"]:
        row["Material"]["constitutive_law"]["name"] = LAWS[case.mesh.dim]
    parameters = kratos.parameters(case)
    parameters["solver_settings"]["time_stepping"] = {"time_step": 1.0 / steps}
    parameters["solver_settings"]["linear_solver_settings"] = {"solver_type": "LinearSolversApplication.sparse_lu"}
    parameters["processes"]["constraints_process_list"] = [
        row for i, support in enumerate(case.supports) for row in _prescribed(f"support_{i}", support)
    ]
    for name, content in (("materials", materials), ("parameters", parameters)):
        (folder / f"{name}.json").write_text(json.dumps(content, indent=1), encoding="ascii")


def _prescribed(part: str, support: abut.Support) -> Iterator[dict[str, Any]]:
    """One process for each straight part of the support's history."""
    history = support.amplitude.points if support.amplitude is not None else ((0.0, 1.0), (1.0, 1.0))
    for (start, first), (end, last) in pairwise(history):
        factor = f"({first!r}+({last!r}-{first!r})*(t-{start!r})/({end!r}-{start!r}))"
        values = [support.x, support.y, support.z]
        yield {
            "python_module": "assign_vector_variable_process",
            "kratos_module": "KratosMultiphysics",
            "Parameters": {
                "model_part_name": f"Structure.{part}",
                "variable_name": "DISPLACEMENT",
                "constrained": [value is not None for value in values],
                "value": [None if value is None else f"{value!r}*{factor}" for value in values],
                "interval": [start and start + 1e-6, "End" if end == 1.0 else end + 1e-6],
            },
        }


def own(name: str, level: int, steps: int) -> dict[str, Any]:
    """abut, with so many equal steps, or those that it finds (0)."""
    case = model(name, level)
    if steps:
        case = replace(case, solve=abut.SolveOptions(times=tuple((i + 1) / steps for i in range(steps))))
    before = resource.getrusage(resource.RUSAGE_SELF)
    solution = abut.solve(case)
    after = resource.getrusage(resource.RUSAGE_SELF)
    return {
        "cpu": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
        "iterations": sum(len(step.iterations) for step in solution.steps), "steps": len(solution.steps),
        "unconverged": sum(not step.converged for step in solution.steps),
        "force": [float(solution.steps[-1].reactions["slab.bottom"][i]) for i in (0, case.mesh.dim - 1)],
    }  # fmt: skip


def _run(python: str, *arguments: str) -> dict[str, Any]:
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run([python, *arguments], capture_output=True, text=True, env=environment, check=False)
    if done.returncode:
        return {"failed": (done.stderr or done.stdout).strip().splitlines()[:1]}
    return json.loads(done.stdout.splitlines()[-1])


def compare(name: str, level: int, steps: int) -> None:
    """One case, as a table."""
    of_case = ("--own", name, "--level", str(level))
    with tempfile.TemporaryDirectory() as folder:
        files(model(name, level), Path(folder), steps)
        runs = {
            "abut": _run(sys.executable, __file__, *of_case, "--steps", "0"),
            f"abut, {steps} steps": _run(sys.executable, __file__, *of_case, "--steps", str(steps)),
            "Kratos": _run(os.environ.get("KRATOS_PYTHON", sys.executable), CHILD, folder),
        }
    first = runs[f"abut, {steps} steps"].get("cpu", 1.0)
    print(f"| {name} | steps | not converged | iterations | CPU s | over abut's | force along, down |")
    print("|---|---|---|---|---|---|---|")
    for code, run in runs.items():
        if "failed" in run:
            print(f"| {code} | failed: {run['failed']} |")
            continue
        force = run.get("stopped") or ", ".join(f"{value:.4g}" for value in run["force"])
        counts = f"{run['steps']} | {run['unconverged']} | {run['iterations']}"
        print(f"| {code} | {counts} | {run['cpu']:.1f} | {run['cpu'] / first:.2f} | {force} |")
    print()


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--case", nargs="+", choices=STEPS, default=list(STEPS))
    parser.add_argument("--level", type=int, default=0)
    parser.add_argument("--steps", type=int, help="equal ones; else 20 for the die, 60 for ironing")
    parser.add_argument("--own", choices=STEPS, help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.own:
        print(json.dumps(own(arguments.own, arguments.level, arguments.steps)))
        return
    for name in arguments.case:
        compare(name, arguments.level, arguments.steps or STEPS[name])


if __name__ == "__main__":
    main()
