"""The half ring of abut verify crushed-ring-friction beside Kratos (quad4) and CalculiX (quad8), each on the same mesh as
abut and with the volumetric energy that it has: rise of the middle over the way of the ends, as far as each comes.

    KRATOS_PYTHON=kratos/bin/python python bench/ring_peers.py [--friction 0.5] [--steps 350] [--seconds 600]

Plane strain; both layers share their nodes. Kratos: augmented Lagrangian mortar contact in 2D, with the block and with the
ring as slave. CalculiX: surface to surface penalty, one layer held in z, half as many facets each way (it takes minutes).
"""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

sys.path.insert(0, str(Path(__file__).parent / "contact"))
import kratos
import ring_calculix
from sliding import prescribed

import abut
from abut.benchmarks.finite_contact import DEPTH, RING
from abut.mesh.make import join, rectangle, ring

CHILD = str(Path(__file__).with_name("ring_kratos.py"))
YOUNG = {"base": 3e8, "outer": 1e9, "inner": 1e11}
TIMES = (0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.75, 0.8, 0.84)
COARSE = 0.5  # facets for CalculiX


def model(cell: str, friction: float, block: bool, volumetric: str) -> abut.Model:
    """``block``: it is the contactor."""
    share = COARSE if cell == "quad8" else 1.0
    base = rectangle((-0.125, 0.125), (-0.145, -RING[2]), (int(50 * share), int(6 * share)), cell)
    arc = ring((RING[0], RING[2]), (180.0, 360.0), cells=(2, int(32 * share)), cell=cell)
    mesh = join({"base": base, "ring": arc})
    ((_, nodes, numbers),) = mesh.cells_of("ring")
    outside = np.linalg.norm(mesh.points[nodes[:, :4]].mean(axis=1), axis=1) > RING[1]
    mesh = replace(mesh, bodies={"base": mesh.bodies["base"], "outer": numbers[outside], "inner": numbers[~outside]})
    down = abut.Amplitude(((0.0, 0.0), (1.0, 1.0)))
    ends = [abut.Support(f"ring.{end}", x=0.0, y=-DEPTH, amplitude=down) for end in ("start", "end")]
    sides = ("base.top", "ring.outer") if block else ("ring.outer", "base.top")
    return abut.Model(
        mesh,
        [abut.Solid(name, abut.NeoHooke(young, 0.3, volumetric=volumetric)) for name, young in YOUNG.items()],
        [abut.Support("base.bottom", x=0.0, y=0.0, amplitude=down), *ends],
        contacts=[abut.Contact(contactor=sides[0], target=sides[1], friction=friction)], plane="strain", kinematics="finite",
    )  # fmt: skip


def by_abut(of: abut.Model, steps: int) -> NDArray[np.float64]:
    """Time and rise (mm) of every step, (n, 2)."""
    probe = abut.Probe("middle", at=(0.0, -RING[2]), body="outer", of=("displacement",))
    solution = abut.solve(replace(of, probes=[probe], solve=abut.SolveOptions(steps=steps)))
    return np.array([(s.factor, 1e3 * s.probes[0].values["displacement"][0, 1]) for s in solution.steps])


def by_kratos(of: abut.Model, steps: int, folder: Path, seconds: float) -> NDArray[np.float64]:
    """The same, as far as it comes."""
    text = "\n".join(kratos.mdpa(of)).replace("SmallDisplacementElement", "TotalLagrangianElement")
    (folder / "case.mdpa").write_text(text + "\n", encoding="ascii")
    materials, parameters = kratos.materials(of), kratos.parameters(of)
    for row in materials["properties"]:
        row["Material"]["constitutive_law"]["name"] = "HyperElasticPlaneStrain2DLaw"
        row["Material"]["Variables"]["THICKNESS"] = 1.0
    settings = parameters["solver_settings"]
    settings |= {
        "time_stepping": {"time_step": 1.0 / steps}, "max_iteration": 30,
        "linear_solver_settings": {"solver_type": "LinearSolversApplication.sparse_lu"},
        "contact_settings": {**settings["contact_settings"], "use_mixed_ulm_solver": False},
    }  # fmt: skip
    parameters["processes"]["constraints_process_list"] = [
        row for i, support in enumerate(of.supports) for row in prescribed(f"support_{i}", support)
    ]
    for name, content in (("materials", materials), ("parameters", parameters)):
        (folder / f"{name}.json").write_text(json.dumps(content, indent=1), encoding="ascii")
    command = [
        os.environ.get("KRATOS_PYTHON", sys.executable),
        CHILD,
        str(folder),
        str(ring_calculix.middle(of.mesh) + 1),
    ]
    one = {**os.environ, "OMP_NUM_THREADS": "1"}
    with (folder / "rows").open("w") as file, contextlib.suppress(subprocess.TimeoutExpired):
        subprocess.run(command, stdout=file, stderr=subprocess.DEVNULL, env=one, check=False, timeout=seconds)
    rows = [line.split() for line in (folder / "rows").read_text().splitlines() if line.startswith("ROW ")]
    return np.array([(float(row[1]), float(row[2])) for row in rows]).reshape(-1, 2)


def line(name: str, path: NDArray[np.float64]) -> str:
    """Least rise, way of the ends where it is zero again, rise at ``TIMES``."""
    if not len(path):
        return f"| {name} | none |"
    time, rise = np.vstack([[0.0, 0.0], path]).T
    low = int(rise.argmin())
    zero = np.interp(0.0, rise[low:], time[low:]) * DEPTH * 1e3 if rise[-1] > 0.0 else np.nan
    values = [f"{np.interp(t, time, rise):.3f}" if t <= time[-1] + 1e-9 else "" for t in TIMES]
    return f"| {name} | {time[-1]:.3f} | {rise[-1]:.2f} | {rise[low]:.3f} | {zero:.2f} | " + " | ".join(values) + " |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--friction", type=float, default=0.5)
    parser.add_argument("--steps", type=int, default=350, help="of Kratos; abut and CalculiX take 100 or fewer")
    parser.add_argument("--seconds", type=float, default=600.0, help="that Kratos and CalculiX each may take")
    parser.add_argument("--codes", nargs="+", choices=("kratos", "calculix"), default=["kratos", "calculix"])
    arguments = parser.parse_args()
    few = min(arguments.steps, 100)
    print("| | reached | rise | least | zero at |", " | ".join(map(str, TIMES)), "|")
    print("|" + "---|" * (5 + len(TIMES)))
    cases = [("kratos", block) for block in (True, False)] + [("calculix", False)]
    for code, block in [case for case in cases if case[0] in arguments.codes]:
        cell, volumetric = ("quad4", "log-squared") if code == "kratos" else ("quad8", "isochoric")
        of, side = model(cell, arguments.friction, block, volumetric), "block" if block else "ring"
        print(line(f"abut, {cell}, {side}, {few} steps", by_abut(of, few)), flush=True)
        with tempfile.TemporaryDirectory() as folder:
            run, steps = (by_kratos, arguments.steps) if code == "kratos" else (ring_calculix.path, few)
            print(line(f"{code}, {cell}, {side}", run(of, steps, Path(folder), arguments.seconds)), flush=True)


if __name__ == "__main__":
    main()
