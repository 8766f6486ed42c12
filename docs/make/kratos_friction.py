"""The hub of ccx_friction.py with linear cells by abut and by Kratos' mortar contact, on one mesh.

KRATOS_PYTHON=/path/to/python python docs/make/kratos_friction.py [SECONDS [OPTIONS ...]] (an environment of its own with
KratosContactStructuralMechanicsApplication). Prints torques; of Kratos, whether each step converged and how soon.
OPTIONS: other settings as JSON, of its solver and of its contact, such as '{"contact": {"tangent_factor": 1.0}}'.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "bench" / "contact"))

import kratos
import numpy as np

import abut
from abut.mesh import make
from ccx_friction import FIT, FRICTION, LENGTH, RADIUS, STEPS, TURN, turned

CHILD = Path(__file__).parent / "kratos_friction_child.py"


def linear_hub() -> abut.Mesh:
    """As ``hub_on_shaft``, of hex8."""
    shaft = make.cylinder(RADIUS, [0, 45], cells=(1, 32, 10), cell="hex8", inner=4.0)
    hub = make.cylinder(30.0, [15, 15 + LENGTH], cells=(2, 32, 6), cell="hex8", inner=RADIUS)
    mesh = make.join({"shaft": shaft, "hub": hub})
    top = mesh.nodes_of("hub.top")
    grip = top[np.hypot(*mesh.points[top, :2].T) > 22.0]
    return replace(mesh, node_sets={**mesh.node_sets, "grip": grip})


def pressed(mesh: abut.Mesh) -> abut.Model:
    """What Kratos is given, the interference built into the shaft; step 1 is the fit, the others turn the grip."""
    points = mesh.points.copy()
    points[mesh.nodes_of("shaft.round"), :2] *= 1.0 + FIT / RADIUS
    steel = abut.LinearElastic(210e3, 0.3)
    return abut.Model(
        replace(mesh, points=points),
        [abut.Solid(body, steel) for body in ("shaft", "hub")],
        [abut.Support("shaft.bottom", x=0, y=0, z=0), abut.Support("grip", x=0, y=0, z=0)],
        contacts=[abut.Contact(contactor="hub.inner", target="shaft.round", friction=FRICTION)],
    )


def settings(case: abut.Model, options: dict[str, dict[str, object]]) -> dict[str, object]:
    """Kratos' parameters: those of the benchmarks, steps, and a grip that turns."""
    result = kratos.parameters(case)
    result["problem_data"]["end_time"] = STEPS + 1.0
    result["solver_settings"]["time_stepping"] = {"time_step": 1.0}
    result["solver_settings"] |= options.get("solver", {})
    result["processes"]["contact_process_list"][0]["Parameters"] |= options.get("contact", {})
    hold, still = result["processes"]["constraints_process_list"]
    move = json.loads(json.dumps(still))
    still["Parameters"]["interval"] = [0.0, 1.0]
    rate = TURN / STEPS
    move["Parameters"] |= {"interval": [1.0, "End"], "value": [f"-{rate}*Y*(t-1.0)", f"{rate}*X*(t-1.0)", 0.0]}
    result["processes"]["constraints_process_list"] = [hold, still, move]
    return result


def by_kratos(case: abut.Model, options: dict[str, dict[str, object]], seconds: float) -> list[dict[str, object]]:
    """A row for each step: time, whether it converged, iterations, torque on the grip. As far as it gets in ``seconds``."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        kratos.write(case, folder)
        (folder / "parameters.json").write_text(json.dumps(settings(case, options), indent=1), encoding="ascii")
        command = ["timeout", str(seconds), os.environ["KRATOS_PYTHON"], str(CHILD)]
        one = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONPATH": ""}
        done = subprocess.run(command, cwd=folder, env=one, capture_output=True, text=True, check=False)
        rows = [json.loads(line) for line in done.stdout.splitlines() if line.startswith('{"time"')]
        if done.returncode:
            print(f"ended with {done.returncode}: {done.stdout[-1000:]} {done.stderr[-1000:]}", file=sys.stderr)
        return rows


def main() -> None:
    seconds = float(sys.argv[1]) if len(sys.argv) > 1 else 300.0
    for step in turned(linear_hub()).steps:
        torque = -step.contacts[0].resultant.moment[2] / 1e3
        print(f"abut: step {step.number}, {len(step.iterations)} iterations, {torque:.2f} N m", flush=True)
    case = pressed(linear_hub())
    for text in sys.argv[2:] or ["{}"]:
        print("Kratos", text, flush=True)
        for row in by_kratos(case, json.loads(text), seconds):
            print(row, flush=True)


if __name__ == "__main__":
    main()
