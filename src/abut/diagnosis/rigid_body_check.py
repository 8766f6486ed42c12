"""Rigid-body check: the modes that contact alone constrains, and those that nothing constrains."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.diagnosis.finding import Finding, Motion, from_error
from abut.errors import SingularModelError
from abut.model import Model
from abut.model.conditions import weights
from abut.problem.constraints import Supports
from abut.problem.contact_pairs import Pair
from abut.problem.free_modes import regularise
from abut.problem.loads import loads
from abut.problem.restraint import Restraint, require_held, restraint
from abut.problem.rigid_modes import each_motion, free_motions

SHOWN = 0.1  # size of a motion over that of its body, for the eye


def motions(model: Model, held: Supports, pairs: Sequence[Pair]) -> tuple[list[Finding], list[Motion]]:
    """Findings, and each motion that supports leave free with its displacement. ``pairs``: all that could be built."""
    held_by = restraint(model.mesh, held, pairs)
    findings: list[Finding] = []
    complete = len(pairs) == len(model.contacts)
    every = free_motions([held_by.supports])
    lost = free_motions(held_by.everything)
    by_contact = every - lost @ (lost.T @ every)
    basis, size, _ = np.linalg.svd(by_contact, full_matrices=False)
    shown = _motions(model, held_by, basis[:, size > 0.5], "contact")
    if shown and complete:
        findings.append(
            Finding(
                "info",
                "bodies",
                f"{len(shown)} rigid-body modes are constrained by contact{_rub(pairs)} alone, which carries no tension",
                details=tuple(motion.text for motion in shown),
            )
        )
    shown += _motions(model, held_by, lost, "nothing")
    if complete:
        findings += _unheld(model, held_by)
    return findings, shown


def _rub(pairs: Sequence[Pair]) -> str:
    return " and friction" if any(pair.frictional for pair in pairs) else ""


def _unheld(model: Model, held_by: Restraint) -> list[Finding]:
    """An error for an unconstrained mode on which loads do work; else advice for each free mode."""
    ends, held = loads(model).at_ends(model), held_by.held
    try:
        unit = sp.identity(held.free.shape[1], format="csr")
        loose = regularise(held_by.rigid, held_by.everything, held, unit, ends)
        factors = [weights(model.histories, time) for time in model.solve.ends]
        require_held(held_by.helped_by(loose.gram), ends, factors)
    except SingularModelError as error:
        return [from_error(error, "bodies")]
    return [
        Finding(
            "advice",
            "bodies",
            text,
            "if its position matters, add a support or a symmetry plane",
        )
        for text in loose.notes
    ]


def _motions(model: Model, held_by: Restraint, free: NDArray[np.float64], resisted_by: str) -> list[Motion]:
    """The motions (n_modes, m), each a single shift or turn of one body where that is possible."""
    result = []
    for text, motion in each_motion(held_by.rigid, free):
        displacement = (held_by.rigid.modes @ motion).reshape(-1, model.dim)
        moved = np.abs(displacement).max(axis=1) > 1e-9
        extent = float(np.ptp(model.mesh.points[moved], axis=0).max()) if moved.any() else 1.0
        result.append(Motion(text, resisted_by, SHOWN * extent * displacement))
    return result
