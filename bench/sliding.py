"""A die pressed into a slab and drawn along it at large displacements, friction 0.3, in abut and in Kratos on the same mesh:
iterations and processor time.

    kratos/bin/pip install KratosContactStructuralMechanicsApplication KratosConstitutiveLawsApplication
    KRATOS_PYTHON=kratos/bin/python python bench/sliding.py [--level 0] [--steps 20]

Kratos: augmented Lagrangian mortar contact with friction, total Lagrangian cells of 8 nodes, its neo-Hookean law, sparse LU,
else its own defaults, as many equal steps as asked for. abut: once with the same steps, once with those that it finds. Each
is a process of its own on one thread.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent / "contact"))
import kratos

import abut
from abut.benchmarks.finite_contact_3d import DEPTH, model

CHILD = str(Path(__file__).with_name("sliding_kratos.py"))
PRESSED = 0.3  # time at which the die is down


def files(case: abut.Model, folder: Path, steps: int) -> None:
    """What Kratos reads: as for small displacements, but for cells, law, and what is prescribed over time."""
    text = "\n".join(kratos.mdpa(case)).replace("SmallDisplacementElement3D8N", "TotalLagrangianElement3D8N")
    (folder / "case.mdpa").write_text(text + "\n", encoding="ascii")
    materials = kratos.materials(case)
    for row in materials["properties"]:
        row["Material"]["constitutive_law"]["name"] = "HyperElastic3DLaw"
    parameters = kratos.parameters(case)
    parameters["solver_settings"]["time_stepping"] = {"time_step": 1.0 / steps}
    parameters["solver_settings"]["linear_solver_settings"] = {"solver_type": "LinearSolversApplication.sparse_lu"}
    down, along = [f"-{DEPTH}*t/{PRESSED}", f"-{DEPTH}"], ["0.0", f"(t-{PRESSED})/{1.0 - PRESSED}"]
    middle = PRESSED + 1e-6
    parameters["processes"]["constraints_process_list"] = [
        _prescribed("support_0", [0.0, 0.0, 0.0], [0.0, "End"]),
        _prescribed("support_1", [along[0], 0.0, down[0]], [0.0, middle]),
        _prescribed("support_1", [along[1], 0.0, down[1]], [middle, "End"]),
    ]
    for name, content in (("materials", materials), ("parameters", parameters)):
        (folder / f"{name}.json").write_text(json.dumps(content, indent=1), encoding="ascii")


def _prescribed(part: str, value: list[Any], interval: list[Any]) -> dict[str, Any]:
    return {
        "python_module": "assign_vector_variable_process",
        "kratos_module": "KratosMultiphysics",
        "Parameters": {
            "model_part_name": f"Structure.{part}",
            "variable_name": "DISPLACEMENT",
            "constrained": [True, True, True],
            "value": value,
            "interval": interval,
        },
    }


def own(level: int, steps: int) -> dict[str, Any]:
    """abut, with so many equal steps, or those that it finds (0)."""
    case = model(level, "hex8")
    if steps:
        case = replace(case, solve=abut.SolveOptions(times=tuple((i + 1) / steps for i in range(steps))))
    before = resource.getrusage(resource.RUSAGE_SELF)
    solution = abut.solve(case)
    after = resource.getrusage(resource.RUSAGE_SELF)
    return {
        "cpu": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
        "iterations": sum(len(step.iterations) for step in solution.steps), "steps": len(solution.steps),
        "unconverged": sum(not step.converged for step in solution.steps),
        "force": [float(solution.steps[-1].reactions["slab.bottom"][i]) for i in (0, 2)],
    }  # fmt: skip


def _run(python: str, *arguments: str) -> dict[str, Any]:
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run([python, *arguments], capture_output=True, text=True, env=environment, check=False)
    if done.returncode:
        return {"failed": (done.stderr or done.stdout).strip().splitlines()[:1]}
    return json.loads(done.stdout.splitlines()[-1])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--level", type=int, default=0)
    parser.add_argument("--steps", type=int, default=20)
    parser.add_argument("--own", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    level, steps = str(arguments.level), str(arguments.steps)
    if arguments.own:
        print(json.dumps(own(arguments.level, arguments.steps)))
        return
    with tempfile.TemporaryDirectory() as folder:
        files(model(arguments.level, "hex8"), Path(folder), arguments.steps)
        runs = {
            "abut": _run(sys.executable, __file__, "--own", "--level", level, "--steps", "0"),
            f"abut, {steps} steps": _run(sys.executable, __file__, "--own", "--level", level, "--steps", steps),
            "kratos": _run(os.environ.get("KRATOS_PYTHON", sys.executable), CHILD, folder),
        }
    first = runs["abut"].get("cpu", 1.0)
    print("| | steps | not converged | iterations | CPU over abut's | force along, down |\n|---|---|---|---|---|---|")
    for name, run in runs.items():
        if "failed" in run:
            print(f"| {name} | failed: {run['failed']} |")
            continue
        force = ", ".join(f"{value:.4g}" for value in run["force"])
        counts = f"{run['steps']} | {run['unconverged']} | {run['iterations']}"
        print(f"| {name} | {counts} | {run['cpu'] / first:.2f} | {force} |")


if __name__ == "__main__":
    main()
