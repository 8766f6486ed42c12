"""Section forces of shells and beams in the report: the largest of each, step by step."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from abut.solution import Solution
from abut.solution.beam_forces import unknown
from abut.solution.beam_lines import forces
from abut.solution.mid_surface import laminates, of_step

BEAM_HEAD = ["beam", "step", "normal force, from", "to", "shear force", "bending moment", "torque", ""]
SHELL_HEAD = ["shell", "step", "membrane force, from", "to", "moment, from", "to", "shear force"]
MOST = 200  # rows


def thin_tables(solution: Solution) -> list[tuple[list[str], list[list[str]], str]]:
    """Head, rows and title of each, of the last steps where they are many."""
    mesh, found = solution.model.mesh, []
    if mesh.beams:
        title = "Forces across the sections of beams: the least and the largest along each"
        found.append((BEAM_HEAD, list(_beams(solution))[-MOST:], title))
    if mesh.shells:
        title = "Forces of shells on their mid-surfaces, per length: principal ones, and the largest across"
        found.append((SHELL_HEAD, list(_shells(solution))[-MOST:], title))
    return found


def _beams(solution: Solution) -> Iterator[list[str]]:
    for body in solution.model.mesh.beams:
        why = unknown(solution.model, body)
        if why:
            yield [body, *[""] * 6, f"not known: it {why}"]
    for step in solution.steps:
        for body, of in forces(solution.model, step).items():
            across = (np.linalg.norm(each, axis=1).max() for each in (of.shear_force, of.bending_moment))
            numbers = (of.normal_force.min(), of.normal_force.max(), *across, np.abs(of.torque).max())
            yield [body, f"{step.number}", *(f"{value:.6g}" for value in numbers), ""]


def _shells(solution: Solution) -> Iterator[list[str]]:
    model = solution.model
    for step in solution.steps:
        for body in (*model.mesh.shells, *laminates(model.mesh)):
            of = of_step(model.mesh, step, body, model.small_strains)
            numbers = (*_principal(of.membrane), *_principal(of.moment), np.linalg.norm(of.shear, axis=1).max())
            yield [body, f"{step.number}", *(f"{value:.6g}" for value in numbers)]


def _principal(tensor: NDArray[np.float64]) -> tuple[float, float]:
    """Least and largest principal value of rows 11, 22, 12."""
    middle, half = (tensor[:, 0] + tensor[:, 1]) / 2.0, (tensor[:, 0] - tensor[:, 1]) / 2.0
    radius = np.hypot(half, tensor[:, 2])
    return float((middle - radius).min()), float((middle + radius).max())
