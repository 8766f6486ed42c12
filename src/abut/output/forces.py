"""forces.csv: force over displacement of supports, couplings, rigid bodies, connectors, springs, preloads, step by step."""

from __future__ import annotations

import csv
import io
from typing import Any

import numpy as np

from abut.model import Coupling
from abut.model.preload import sections
from abut.solution import Solution, Step

FILE = "forces.csv"


def table(solution: Solution) -> str:
    """A row for each step and each support, coupling, rigid body, connector, spring and preload: motion, and force (moment)
    that holds or moves it.

    Of a support (surface, node set or body) the displacement is the mean of its nodes, the force the sum of theirs, and the
    moment that about their mean; of couplings and rigid bodies all are those of the reference. Rotations of supports are
    empty. Free components have no force. Of a preload the displacement is its shortening along the normal of the section,
    force and moment what the side before the section exerts on that beyond it. Of a connector there are its free motions,
    force and moment about the joint on the body ``on``, and what its stop and drive do along the first motion, and the stop
    of the second one where any has limits."""
    dim = solution.model.dim
    axes, turns = "xyz"[:dim], "z" if dim == 2 else "xyz"
    head = ["step", "factor", "converged", "kind", "name"]
    head += [f"{name}_{axis}" for name in ("displacement", "force") for axis in axes]
    model = solution.model
    turning = bool(model.referenced or model.preloads or any(equation.supports for equation in model.equations))
    if turning:
        head += [f"{name}_{axis}" for name in ("rotation", "moment") for axis in turns]
    free = list(dict.fromkeys(name for joint in solution.model.connectors for name in joint.motions))
    acts = ["stop", *(["stop2"] if any(joint.limits2 for joint in model.connectors) else []), "drive"]
    joints = [*free, *acts] if model.connectors else []
    head += joints
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(head)
    empty, beside = [""] * (len(head) - 5 - 2 * dim), [""] * len(joints)
    none = [""] * len(turns)
    nodes = {name: solution.model.mesh.nodes_of(name) for name in solution.steps[0].reactions}
    for step in solution.steps:
        for name, own in nodes.items():
            motion = step.displacement[own].mean(axis=0) if len(own) else np.zeros(dim)
            moment = step.moments[name].tolist() if name in step.moments else none
            values = [*motion.tolist(), *step.reactions[name].tolist(), *([*none, *moment] if turning else []), *beside]
            rows.writerow([*_step(step), "support", name, *values])
        for body in solution.model.referenced:
            kind, own_name = ("coupling" if isinstance(body, Coupling) else "rigid body"), body.name
            result = step.rigid[own_name]
            parts = (result.displacement, result.force, result.rotation, result.moment)
            rows.writerow([*_step(step), kind, own_name, *np.concatenate(parts).tolist(), *beside])
        for name, joint in step.connectors.items():
            moved = [joint.motion.get(what, "") for what in free]
            exerted = [*joint.force.tolist(), *[""] * len(turns), *joint.moment.tolist()]
            along = ["" if value is None else value for value in (getattr(joint, what) for what in acts)]
            rows.writerow([*_step(step), "connector", name, *[""] * dim, *exerted, *moved, *along])
        for spring in solution.model.springs:
            motion = step.displacement[solution.model.mesh.nodes_of(spring.on)].mean(axis=0)
            rows.writerow(
                [*_step(step), "spring", spring.name, *motion.tolist(), *step.springs[spring.name].tolist(), *empty]
            )
        for section in sections(solution.model.mesh, solution.model.preloads):
            carried = step.preloads[section.preload.name]
            values = [*(carried.shortening * section.normal).tolist(), *carried.force.tolist(), *[""] * len(turns)]
            rows.writerow([*_step(step), "preload", section.preload.name, *values, *carried.moment.tolist(), *beside])
    return text.getvalue()


def _step(step: Step) -> list[Any]:
    return [step.number, step.factor, int(step.converged)]
