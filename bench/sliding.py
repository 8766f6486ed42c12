"""Two dies pressed into a slab and drawn along it at large displacements, in abut and in Kratos on the same mesh: iterations
and processor time.

    kratos/bin/pip install KratosContactStructuralMechanicsApplication KratosConstitutiveLawsApplication
    KRATOS_PYTHON=kratos/bin/python python bench/sliding.py [--case die ironing frictionless] [--level 0] [--steps 20]

die: in 3D, friction 0.3. ironing: shallow ironing, one layer of cells, friction 0.3 or none (sliding_cases.py).
Kratos: augmented Lagrangian mortar contact, total Lagrangian cells of hex8, its neo-Hookean law, sparse LU, else its
own defaults but for what the case says, and its load steps. abut: once with the same steps, once with those that it
finds; where Kratos does not come to the end, as far as it came. Each is a process of its own on one thread.
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
from sliding_cases import CASES, Case

import abut

CHILD = str(Path(__file__).with_name("sliding_kratos.py"))
SLIGHTLY = 1e-9  # of time


def files(case: Case, level: int, folder: Path) -> None:
    """What Kratos reads: as for small displacements, but for cells, law, what is prescribed over time, and settings."""
    model = case.model(level)
    text = "\n".join(kratos.mdpa(model)).replace("SmallDisplacementElement", "TotalLagrangianElement")
    (folder / "case.mdpa").write_text(text + "\n", encoding="ascii")
    materials = kratos.materials(model)
    for row in materials["properties"]:
        row["Material"]["constitutive_law"]["name"] = "HyperElastic3DLaw"
    parameters = kratos.parameters(model)
    solver, processes = parameters["solver_settings"], parameters["processes"]
    contact = {**solver["contact_settings"], **case.solver.get("contact_settings", {})}
    solver |= {
        **case.solver, "contact_settings": contact, "time_stepping": {"time_step_table": case.step_table()},
        "linear_solver_settings": {"solver_type": "LinearSolversApplication.sparse_lu"},
    }  # fmt: skip
    processes["contact_process_list"][0]["Parameters"] |= case.contact
    processes["constraints_process_list"] = [
        row for i, support in enumerate(model.supports) for row in prescribed(f"support_{i}", support)
    ]
    for name, content in (("materials", materials), ("parameters", parameters)):
        (folder / f"{name}.json").write_text(json.dumps(content, indent=1), encoding="ascii")


def prescribed(part: str, support: abut.Support) -> Iterator[dict[str, Any]]:
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


def until(model: abut.Model, end: float) -> abut.Model:
    """The model with its histories as far as a time, which becomes 1."""

    def cut(support: abut.Support) -> abut.Support:
        whole = support.amplitude or abut.Amplitude(((0.0, 0.0), (1.0, 1.0)))
        points = [point for point in whole.points if point[0] < end - SLIGHTLY]
        return replace(support, amplitude=abut.Amplitude((*((t / end, f) for t, f in points), (1.0, whole(end)))))

    return replace(model, supports=[cut(support) for support in model.supports])


def solved(model: abut.Model, times: tuple[float, ...] | None) -> dict[str, Any]:
    """abut, with load steps that end at ``times``, or those that it finds."""
    before = resource.getrusage(resource.RUSAGE_SELF)
    solution = abut.solve(replace(model, solve=abut.SolveOptions(times=times)))
    after = resource.getrusage(resource.RUSAGE_SELF)
    return {
        "cpu": after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime,
        "iterations": sum(len(step.iterations) for step in solution.steps), "steps": len(solution.steps),
        "unconverged": sum(not step.converged for step in solution.steps),
        "force": [float(solution.steps[-1].reactions["slab.bottom"][i]) for i in (0, 2)],
    }  # fmt: skip


def _own(case: Case, level: int, end: float, found: bool) -> dict[str, Any]:
    model = case.model(level)
    model = until(model, end) if end < 1.0 - SLIGHTLY else model
    times = tuple(min(time / end, 1.0) for time in case.times() if time < end + SLIGHTLY)
    return solved(model, None if found else times)


def _run(python: str, *arguments: str) -> dict[str, Any]:
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run([python, *arguments], capture_output=True, text=True, env=environment, check=False)
    if done.returncode:
        return {"failed": (done.stderr or done.stdout).strip().splitlines()[-1:]}
    return json.loads(done.stdout.splitlines()[-1])


def compare(name: str, level: int, steps: int | None) -> None:
    """One case, as a table."""
    case, of_steps = with_steps(CASES[name], steps), ("--steps", str(steps)) if steps else ()
    with tempfile.TemporaryDirectory() as folder:
        files(case, level, Path(folder))
        other = _run(os.environ.get("KRATOS_PYTHON", sys.executable), CHILD, folder)
    end = other.get("reached") or 1.0
    of_case = (__file__, "--own", name, "--level", str(level), "--end", repr(end), *of_steps)
    runs = {
        "abut, steps it finds": _run(sys.executable, *of_case, "--found"),
        "abut, the same steps": _run(sys.executable, *of_case), "Kratos": other,
    }  # fmt: skip
    first = runs["abut, the same steps"]
    columns = ("steps", "not converged", "iterations", "over abut's", "CPU s", "over abut's", "force along, down")
    print(f"| {name}, to t = {end:.3f} |", " | ".join(columns), "|")
    print("|---|---|---|---|---|---|---|---|")
    for code, run in runs.items():
        if "failed" in run or not run["steps"]:
            print(f"| {code} | failed: {run.get('failed') or run['stopped']} |")
            continue
        ratios = [f"{run[key] / first[key]:.2f}" if key in first else "" for key in ("iterations", "cpu")]
        force = ", ".join(f"{value:.4g}" for value in run["force"])
        print(
            f"| {code} | {run['steps']} | {run['unconverged']} | {run['iterations']} | {ratios[0]} "
            f"| {run['cpu']:.1f} | {ratios[1]} | {force} |"
        )
    print(f"\nKratos stopped {other['stopped']}\n" if other.get("stopped") else "")


def with_steps(case: Case, steps: int | None) -> Case:
    """The case with another number of load steps in its last part."""
    return replace(case, parts=(*case.parts[:-1], (1.0, steps))) if steps else case


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--case", nargs="+", choices=CASES, default=list(CASES))
    parser.add_argument("--level", type=int, default=0)
    parser.add_argument(
        "--steps", type=int, help="equal ones of the last part (the die has one part): else 20, 500, 100"
    )
    for hidden, kind in (("--own", str), ("--end", float)):
        parser.add_argument(hidden, type=kind, help=argparse.SUPPRESS)
    parser.add_argument("--found", action="store_true", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.own:
        case = with_steps(CASES[arguments.own], arguments.steps)
        print(json.dumps(_own(case, arguments.level, arguments.end, arguments.found)))
        return
    for name in arguments.case:
        compare(name, arguments.level, arguments.steps)


if __name__ == "__main__":
    main()
