"""Rigid-body check: the modes that contact alone constrains, and those that nothing constrains."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.bodies.rigid_modes import SUPPORTED, each_motion, free_motions
from abut.diagnosis.all_restraint import all_restraint
from abut.diagnosis.finding import Finding, Motion, from_error
from abut.errors import SingularModelError
from abut.model import Model
from abut.model.conditions import weights
from abut.problem.connectors import Connectors
from abut.problem.constraints import Constraints
from abut.problem.free_modes import floats_of, free_mode_springs
from abut.problem.held_motions import neutral_in
from abut.problem.loads import loads
from abut.problem.pair import Pair
from abut.problem.restraint import Restraint, require_held

LOOSE = "if it matters, give the connector a stiffness, limits or a motion"
SHOWN = 0.1  # size of a motion over that of its body, for the eye


def motions(model: Model, constraints: Constraints, pairs: Sequence[Pair]) -> tuple[list[Finding], list[Motion]]:
    """Findings, and each motion that supports leave free with its displacement. ``pairs``: all that could be built."""
    restrained = all_restraint(model, constraints, pairs)
    findings: list[Finding] = []
    complete = len(pairs) == len(model.contacts)
    every = free_motions([restrained.supports], SUPPORTED)
    lost = free_motions(restrained.everything, SUPPORTED)
    by_contact = every - lost @ (lost.T @ every)
    basis, size, _ = np.linalg.svd(by_contact, full_matrices=False)
    shown = _motions(model, restrained, basis[:, size > 0.5], "contact")
    if shown and complete:
        modes = "one rigid-body mode is" if len(shown) == 1 else f"{len(shown)} rigid-body modes are"
        findings.append(
            Finding(
                "info",
                "bodies",
                f"{modes} constrained by contact{_rub(pairs)} alone, which carries no tension",
                details=tuple(motion.text for motion in shown),
            )
        )
    shown += _motions(model, restrained, lost, "nothing")
    if complete:
        findings += _unheld(model, restrained)
    return findings, shown


def _rub(pairs: Sequence[Pair]) -> str:
    return " and friction" if any(pair.frictional for pair in pairs) else ""


def _unheld(model: Model, restrained: Restraint) -> list[Finding]:
    """An error for an unconstrained mode on which loads do work; else advice for each free mode."""
    ends, constraints = loads(model).at_ends(model), restrained.constraints
    joined = Connectors.of(model, constraints.bodies)
    try:
        if joined is not None:
            joined.require_held(restrained, ends)
        unit = sp.identity(constraints.free.shape[1], format="csr")
        neutral, settled = neutral_in(model, restrained, ends)
        springs = free_mode_springs(
            restrained.rigid, restrained.everything, constraints, unit, ends, neutral, settled, floats_of(model)
        )
        factors = [weights(model.histories, time) for time in model.ends]
        require_held(restrained.helped_by(springs.gram), ends, factors)
    except SingularModelError as error:
        return [from_error(error, "bodies")]
    loose = [] if joined is None else joined.free_in(restrained)
    return [
        *(Finding("advice", "connectors", f"nothing resists {text}", LOOSE) for text in loose),
        *(
            Finding(
                "advice",
                "bodies",
                text,
                "if its position matters, add a support or a symmetry plane",
            )
            for text in springs.notes
        ),
    ]


def _motions(model: Model, restrained: Restraint, free: NDArray[np.float64], resisted_by: str) -> list[Motion]:
    """The motions (n_modes, m), each a single shift or turn of one body where that is possible."""
    result = []
    for text, motion in each_motion(restrained.rigid, free):
        displacement = (restrained.rigid.modes @ motion).reshape(-1, model.dim)
        moved = np.abs(displacement).max(axis=1) > 1e-9
        extent = float(np.ptp(model.mesh.points[moved], axis=0).max()) if moved.any() else 1.0
        result.append(Motion(text, resisted_by, SHOWN * extent * displacement))
    return result
