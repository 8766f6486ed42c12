"""What an iteration at large displacements costs: a block pressed into a slab and drawn along it, friction 0.3, hex8, on one
thread; processor time of its stages, and memory beside a run at small displacements.

    python bench/finite_iteration.py [--facets 50] [--layers 8] [--iterations 3] [--linear direct]

The block has facets^2 contact facets, and layers of cells; 50 and 8 make 146 000 degrees of freedom. Each run is a process
of its own, and ends after some iterations: the first is without contact forces.
"""

from __future__ import annotations

import argparse
import contextlib
import cProfile
import json
import os
import pstats
import resource
import subprocess
import sys
import time
from typing import Any

import abut
from abut.mesh.make import box, join
from abut.solution import Iteration

STAGES = {
    "contact with derivatives": ("current.py", "at"),
    "  of it compiled coupling": ("coupling_tangent.py", "differentiated"),
    "  of it slips": ("slip_points.py", "slip_now"),
    "bodies": ("finite_bodies.py", "evaluate"),
    "whole linearisation": ("finite.py", "_expanded"),
    "linear solve": ("saddle_point.py", "newton_step"),
    "multigrid, set up": ("iterative.py", "_at_state"),
    "linear solve by multigrid": ("iterative.py", "solve"),
    "  of it analysis": ("direct.py", "analyse"),
    "  of it factorisation": ("repeated.py", "_factorise"),
    "  of it iterations with old factors": ("repeated.py", "_iterate"),
}


def model(facets: int, layers: int, kinematics: str, linear: str) -> abut.Model:
    """One load step; meshes that do not match."""
    more = facets + 2
    slab = box((0.0, 1.04), (0.0, 1.04), (0.0, 0.2), (more, more, layers), "hex8")
    block = box((0.01, 1.01), (0.03, 1.03), (0.2, 0.4), (facets, facets, layers), "hex8")
    material = abut.NeoHooke(10.0, 0.3) if kinematics == "finite" else abut.LinearElastic(10.0, 0.3)
    return abut.Model(
        join({"slab": slab, "block": block}), [abut.Solid("slab", material), abut.Solid("block", material)],
        [abut.Support("slab.bottom", x=0.0, y=0.0, z=0.0), abut.Support("block.top", x=0.002, y=0.0, z=-0.002)],
        contacts=[abut.Contact(contactor="block.bottom", target="slab.top", friction=0.3)], kinematics=kinematics,
        solve=abut.SolveOptions(linear=linear, times=(1.0,)),
    )  # fmt: skip


class Enough(Exception):
    """As many iterations as were asked for."""


def run(facets: int, layers: int, kinematics: str, most: int, linear: str) -> dict[str, Any]:
    """Processor time of each stage, calls, iterations and peak memory in MB."""
    case, rows = model(facets, layers, kinematics, linear), []

    def observe(event: object) -> None:
        if isinstance(event, Iteration):
            rows.append(event)
            if len(rows) >= most:
                raise Enough

    profile = cProfile.Profile(time.process_time)
    profile.enable()
    with contextlib.suppress(Enough):
        abut.solve(case, observer=observe)
    profile.disable()
    stages: dict[str, tuple[int, float]] = {}
    for (file, _, function), (_, calls, _, spent, _) in pstats.Stats(profile).stats.items():  # type: ignore[attr-defined]
        for name, of_stage in STAGES.items():
            if file.endswith("/" + of_stage[0]) and function == of_stage[1]:
                stages[name] = calls, spent
    return {
        "dofs": case.mesh.points.size, "iterations": len(rows), "stages": stages,
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0,
    }  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--facets", type=int, default=50)
    parser.add_argument("--layers", type=int, default=8)
    parser.add_argument("--iterations", type=int, default=3)
    parser.add_argument("--linear", choices=["direct", "amg"], default="direct")
    parser.add_argument("--own", choices=["finite", "small"], help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.own:
        most, linear = arguments.iterations, arguments.linear
        print(json.dumps(run(arguments.facets, arguments.layers, arguments.own, most, linear)))
        return
    runs = {}
    for kinematics in ("small", "finite"):
        command = [sys.executable, __file__, "--own", kinematics, *sys.argv[1:]]
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        done = subprocess.run(command, capture_output=True, text=True, env=environment, check=True)
        runs[kinematics] = json.loads(done.stdout.splitlines()[-1])
    finite, memory = runs["finite"], {name: each["memory"] for name, each in runs.items()}
    print(f"{finite['dofs']} degrees of freedom, {arguments.facets**2} facets, {finite['iterations']} iterations")
    print(f"memory {memory['finite']:.0f} MB, {memory['finite'] / memory['small']:.2f} times small displacements\n")
    print("| stage | calls | CPU s a call |\n|---|---|---|")
    for name in STAGES:
        if name in finite["stages"]:
            calls, spent = finite["stages"][name]
            print(f"| {name.strip()} | {calls} | {spent / calls:.3f} |")


if __name__ == "__main__":
    main()
