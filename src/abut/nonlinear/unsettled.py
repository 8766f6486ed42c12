"""Where an iteration leaves most open, at large displacements, whether iterations go round in a circle, and whether a
material has given way."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from abut.dofs import place_of
from abut.materials.elastic import LinearElastic
from abut.nonlinear.hanging import cured, place
from abut.nonlinear.settings import Settings
from abut.problem.problem import ContactProblem

Vector = NDArray[np.float64]


def circling(errors: Sequence[float], settings: Settings) -> bool:
    """Whether iterations come back to where they were two or three before, which has shown once all around.
    A line search goes on from there: without it ``examples/pipe-clip`` takes 105 iterations, with it 99."""
    for period in range(2, settings.newton.patience + 1):
        before, last = np.array(errors[-2 * period : -period]), np.array(errors[-period:])
        if len(before) == period and (np.abs(last - before) <= settings.newton.same * before).all():
            return True
    return False


def most_at(problem: ContactProblem, forces: Vector, laws: Vector) -> str:
    """Where most is left open: forces (n_unknowns,) and laws (n,), both relative."""
    force, law = (np.abs(part) for part in (forces, laws))
    if not problem.pairs or law.max(initial=0.0) < force.max(initial=0.0):
        free = problem.constraints.free
        point = int(place_of(np.argmax(abs(free) @ force), problem.model.dim))
        return f"most at {place(problem, point)} in the undeformed mesh"
    pair, part = max(zip(problem.pairs, problem.split(law)), key=lambda each: float(each[1].max(initial=0.0)))
    by_function = np.where(pair.index >= 0, part[np.maximum(pair.index, 0)], 0.0).max(axis=1)
    node, name = int(pair.space.node[int(np.argmax(by_function))]), pair.contact.name
    if node < 0:
        return f"most in contact '{name}'"
    cure = cured(pair, np.array([node]))
    return f"most in contact '{name}' at {place(problem, node)} in the undeformed mesh{cure}"


def gives_way(problem: ContactProblem, reason: str) -> str:
    """What to say where cells of a linear elastic body have turned inside out, as the ``reason`` of a failed step says;
    empty elsewhere. Its law is Saint Venant-Kirchhoff's, whose stiffness in compression falls to none: under uniaxial
    strain at a stretch of 1 / sqrt(3)."""
    if "turns inside out" not in reason:
        return ""
    for solid in problem.model.solids:
        if f"of body '{solid.body}'" in reason and isinstance(solid.material, LinearElastic):
            return (
                f"body '{solid.body}' is linear elastic, by Saint Venant-Kirchhoff's law at large strains, which gives "
                'way where it is pressed to about half its length: NeoHooke (kind = "neo-hooke") with the same constants '
                "does not"
            )
    return ""
