"""Time that `abut check` foresees beside what the run takes: CPU seconds on one thread, model by model.

OMP_NUM_THREADS=1 python bench/estimates.py [--models NAME,...] [--stages]

--stages: the stages of each run too, and what the model of the cost (abut.diagnosis.cost) says of them.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import abut
from abut.diagnosis.cost import foresee
from abut.job import load_job
from abut.mesh.make import box, join
from abut.problem import clock
from abut.problem.constraints import supports
from abut.problem.contact_pairs import pairs

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT / "tests"))
from models.assembly import ASSEMBLIES
from models.search import ball, beam, pin


def blocks(cell: str, cells: int) -> abut.Model:
    """Two blocks, the upper one pressed down and turned a little, so that a part of the interface closes."""
    lower = box(x=(0, 10), y=(0, 10), z=(0, 10), cells=(cells,) * 3, cell=cell)
    finer = max(cells * 3 // 4, 2)
    upper = box(x=(0, 10), y=(0, 10), z=(10, 20), cells=(finer,) * 3, cell=cell)
    x, z = upper.points[:, 0].copy(), upper.points[:, 2].copy()
    tilted = upper.points.copy()
    tilted[:, 2], tilted[:, 0] = z + 0.004 * x, x - 0.004 * (z - 10)
    mesh = join({"lower": lower, "upper": replace(upper, points=tilted)})
    steel = abut.LinearElastic(210e3, 0.3)
    held = [abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", x=0, y=0, z=-0.02)]
    contacts = [abut.Contact(contactor="lower.top", target="upper.bottom")]
    return abut.Model(mesh, [abut.Solid(body, steel) for body in mesh.bodies], held, contacts=contacts)


def finds_its_steps(model: abut.Model) -> abut.Model:
    """The same without times of its steps."""
    return replace(model, solve=abut.SolveOptions())


def example(name: str) -> abut.Model:
    return load_job(ROOT / "examples" / name).model


MODELS: Mapping[str, Callable[[], abut.Model]] = {
    "blocks hex8": lambda: blocks("hex8", 16),
    "blocks hex8 large": lambda: blocks("hex8", 30),
    "blocks tet4": lambda: blocks("tet4", 16),
    "blocks tet4 large": lambda: blocks("tet4", 26),
    "blocks hex20": lambda: blocks("hex20", 9),
    "blocks hex20 large": lambda: blocks("hex20", 16),
    "blocks tet10": lambda: blocks("tet10", 8),
    "beam": lambda: beam(400, "quad8"),
    "ball": lambda: ball(192),
    "ball in 4 steps": lambda: ball(96, steps=4),
    "loose pin": lambda: pin(60, 1.0),
    "pin and lug": lambda: example("pin-lug/job.toml"),
    "ball on block": lambda: example("hertz-sphere/job.toml"),
    "clevis": lambda: ASSEMBLIES["clevis"]().model(),
    "wall": lambda: ASSEMBLIES["wall"]().model(),
    "bearing": lambda: ASSEMBLIES["bearing"]().model(),
    "o-ring": lambda: ASSEMBLIES["o-ring"]().model(),
    "flange": lambda: ASSEMBLIES["flange"]().model(),
    "bolted joint": lambda: finds_its_steps(example("bolted-joint/job.toml")),
    "pushed block": lambda: example("pushed-block/job.toml"),
    "twisted hub": lambda: example("twisted-hub/job.toml"),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", default="", help="names, separated by commas")
    parser.add_argument("--stages", action="store_true")
    args = parser.parse_args()
    clock.time = SimpleNamespace(perf_counter=time.process_time)
    abut.solve(pin(8, 1.0))  # libraries are loaded once
    for name in args.models.split(",") if args.models else MODELS:
        model = MODELS[name]()
        held = supports(model)
        foreseen = foresee(model, held, pairs(model, held))
        start = time.process_time()
        solution = abut.solve(model)
        spent = time.process_time() - start
        count = sum(len(step.iterations) for step in solution.steps)
        print(
            f"{name:20s} {held.free.shape[1]:7d} dofs {count:3d} solutions: foreseen {foreseen.seconds:7.2f} s, took "
            f"{spent:7.2f} s, ratio {foreseen.seconds / spent:5.2f}",
            flush=True,
        )
        if args.stages:
            stages = " ".join(f"{key} {value:.2f}" for key, value in solution.timings.items())
            print(f"{'':20s} {stages}; foreseen {foreseen.stages}", flush=True)


if __name__ == "__main__":
    main()
