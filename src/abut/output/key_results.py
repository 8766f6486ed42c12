"""The numbers of a solution that a sweep compares, by name."""

from __future__ import annotations

import math

import numpy as np

from abut.probing.table import peaks
from abut.solution import Solution

VERDICT = {"fail": 0, "warn": 1}  # the worst counts; others pass


def key_results(solution: Solution) -> dict[str, float]:
    """At the end of the last step: of each contact force, largest pressure and area; the tension of each preload; the force
    of each support; force and free motions of each connector; peaks of each probe; the largest displacement. What does not
    exist is left out."""
    step = solution.steps[-1]
    found: dict[str, float] = {}
    for contact in step.contacts:
        found[f"{contact.name}: force"] = float(np.linalg.norm(contact.force))
        found[f"{contact.name}: largest pressure"] = contact.max_pressure
        found[f"{contact.name}: area"] = contact.area
    found |= {f"{name}: tension": result.tension for name, result in step.preloads.items()}
    found |= {f"{name}: reaction": float(np.linalg.norm(force)) for name, force in step.reactions.items()}
    for name, joint in step.connectors.items():
        found[f"{name}: force"] = float(np.linalg.norm(joint.force))
        found |= {f"{name}: {what}": value for what, value in joint.motion.items()}
    for result in step.probes:
        found |= {f"{result.name}: {name}": value for name, value in peaks(result).items() if value is not None}
    found["largest displacement"] = float(np.linalg.norm(step.displacement, axis=1).max())
    return {name: value for name, value in found.items() if math.isfinite(value)}


def verdict(solution: Solution) -> str:
    """The worst line of the certificate: "pass", "warn" or "fail"."""
    worst = min((VERDICT.get(check.verdict.lower(), 2) for check in solution.certificate), default=2)
    return {0: "fail", 1: "warn"}.get(worst, "pass")
