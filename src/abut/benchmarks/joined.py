"""Points that move together: reference points that bend, pull and twist, a lever of equations, a stop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import box, cylinder, join, rectangle
from abut.model import Coupling, Equation, Force, Model, Solid, Support, Term
from abut.model.stop import Stop, add_stops
from abut.solution import Solution

YOUNG, POISSON = 1000.0, 0.3
LENGTH, HEIGHT, FORCE, ARM = 20.0, 2.0, 0.5, 3.0  # a beam of the width 1; how far beside its axis it is pulled
RADIUS, TURN = 2.0, 1e-3
GAP = 0.02
EXACT = "linear strains, which quadratic cells have (nu = 0)"
UNIFORM = "uniform stresses (nu = 0)"


def _beam(level: int) -> Model:
    """Pulled along at a point beside its axis, to which its end is coupled by its mean motion."""
    n = 2**level
    half = HEIGHT / 2.0
    mesh = join({"beam": rectangle((0.0, LENGTH), (-half, half), (5 * n, 2 * n), "quad8")})
    return Model(
        mesh,
        [Solid("beam", LinearElastic(YOUNG, 0.0))],
        [Support("beam.left", x=0, y=0)],
        [Force("eye", (FORCE, 0.0))],
        couplings=[Coupling("eye", "beam.right", "distributing", (LENGTH, ARM))],
        plane="stress",
    )


def _bent(solution: Solution) -> dict[str, float]:
    eye = solution.steps[-1].rigid["eye"]
    axis = solution.model.mesh.nodes_of("beam.right")
    sunk = float(solution.steps[-1].displacement[axis, 1].mean())
    return {
        "way of the eye": float(eye.displacement[0]),
        "turn of the eye": float(eye.rotation[-1]),
        "deflection": sunk,
    }


def _bent_wanted() -> dict[str, Reference]:
    """Along the axis by F L / E A, and turned by M L / E I, which takes the eye along by its arm."""
    area, inertia = HEIGHT, HEIGHT**3 / 12.0
    turn = -FORCE * ARM * LENGTH / (YOUNG * inertia)
    source = "bar and beam under an eccentric force, F L / E A and M L / E I"
    return {
        "way of the eye": Reference(FORCE * LENGTH / (YOUNG * area) - turn * ARM, 1e-8, source, EXACT),
        "turn of the eye": Reference(turn, 1e-8, source, EXACT),
        "deflection": Reference(turn * LENGTH / 2.0, 1e-8, source, EXACT),
    }


def _shaft(level: int) -> Model:
    """Turned at a point on its axis, to which its end is coupled rigidly."""
    n = 2**level
    mesh = join({"shaft": cylinder(RADIUS, (0.0, LENGTH / 2.0), (4 * n, 6 * n), "hex20")})
    return Model(
        mesh,
        [Solid("shaft", LinearElastic(YOUNG, POISSON))],
        [Support("shaft.bottom", x=0, y=0, z=0)],
        couplings=[Coupling("chuck", "shaft.top", reference=(0.0, 0.0, LENGTH), rz=TURN)],
    )


def _torque(solution: Solution) -> dict[str, float]:
    return {"torque": float(solution.steps[-1].rigid["chuck"].moment[2])}


TORQUE = YOUNG / (2.0 * (1.0 + POISSON)) * np.pi * RADIUS**4 / 2.0 * TURN / (LENGTH / 2.0)


def _lever(level: int) -> Model:
    """Two bars side by side; the end of the second one goes half as far as that of the first, which is pulled."""
    n = 2**level
    bars = {"first": (0.0, 1.0), "second": (3.0, 4.0)}
    parts = {name: rectangle(x, (0.0, LENGTH), (n, 5 * n), "quad4") for name, x in bars.items()}
    mesh = join(parts)
    ends = {name: mesh.nodes_of(f"{name}.top") for name in bars}
    sets = {f"{name} {i}": nodes[i : i + 1] for name, nodes in ends.items() for i in range(len(nodes))}
    across = [("first", 0, i, 1.0, 1.0) for i in range(1, len(ends["first"]))]
    across += [("second", 0, i, 1.0, 1.0) for i in range(1, len(ends["second"]))]
    return Model(
        replace(mesh, node_sets={**mesh.node_sets, **sets}),
        [Solid(name, LinearElastic(YOUNG, 0.0)) for name in parts],
        [Support(f"{name}.bottom", x=0, y=0) for name in parts],
        [Force("first.top", (0.0, FORCE))],
        equations=[
            *(Equation((Term(f"{name} {i}", "y", a), Term(f"{name} {k}", "y", -b))) for name, i, k, a, b in across),
            Equation((Term("first 0", "y", 0.5), Term("second 0", "y", -1.0))),
        ],
        plane="stress",
    )


def _ends(solution: Solution) -> dict[str, float]:
    mesh, step = solution.model.mesh, solution.steps[-1]
    found = {f"way of the {name}": float(step.displacement[mesh.nodes_of(f"{name}.top"), 1].mean()) for name in BARS}
    return found | {"force of the second": -float(step.reactions["second.bottom"][1])}


BARS = ("first", "second")
STIFFNESS = YOUNG / LENGTH
LEVER = "two bars on a lever of 2 : 1, whose force is F / (1 + 1/4) on the first"


def _stopped(level: int) -> Model:
    """A bar pulled against a stop, which carries what the bar has not taken when it is there."""
    n = 2**level
    mesh = join({"bar": box((0.0, 1.0), (0.0, 1.0), (0.0, LENGTH), (n, n, 4 * n), "hex8")})
    added = add_stops(mesh, [Stop("bar.top", (0.0, 0.0, 1.0), GAP, "end")])
    return Model(
        added.mesh,
        [Solid("bar", LinearElastic(YOUNG, 0.0))],
        [Support("bar.bottom", x=0, y=0, z=0)],
        [Force("bar.top", (0.0, 0.0, 3.0))],
        added.contacts,
        rigid=added.rigid,
    )


def _held(solution: Solution) -> dict[str, float]:
    step = solution.steps[-1]
    top = solution.model.mesh.nodes_of("bar.top")
    return {"way": float(step.displacement[top, 2].max()), "force of the stop": abs(float(step.contacts[0].force[2]))}


BENCHMARKS = (
    Benchmark(
        "coupled-beam", "beam pulled at an eye beside its axis, coupled to its end by the mean motion", _beam, _bent,
        _bent_wanted(),
    ),
    Benchmark(
        "coupled-shaft", "shaft turned by a point that its end follows rigidly", _shaft, _torque,
        {"torque": Reference(TORQUE, 1e-3, "Coulomb's torsion of a round bar", "facets of second order on the round face")},
    ),
    Benchmark(
        "lever", "two bars whose ends equations make those of a lever", _lever, _ends,
        {
            "way of the first": Reference(FORCE / (1.25 * STIFFNESS), 1e-9, LEVER, UNIFORM),
            "way of the second": Reference(FORCE / (2.5 * STIFFNESS), 1e-9, LEVER, UNIFORM),
            "force of the second": Reference(FORCE / 2.5, 1e-9, LEVER, UNIFORM),
        },
    ),
    Benchmark(
        "stop", "bar pulled against a stop", _stopped, _held,
        {
            "way": Reference(GAP, 1e-9, "the distance of the stop", UNIFORM),
            "force of the stop": Reference(3.0 - STIFFNESS * GAP, 1e-9, "what the force is more than E A way / L", UNIFORM),
        },
    ),
)  # fmt: skip
