"""Preloads in the report: what every bolt carries, step by step."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from abut.model.preload import sections
from abut.solution import Solution
from abut.solution.load_factor import load_factors

HEAD = ["preload", "step", "tension", "shear", "bending moment", "shortening", "state"]
FACTOR_HEAD = ["preload", "load factor", "change of tension", "change of loads along it", "why there is none"]


def preload_rows(solution: Solution) -> list[list[str]]:
    """One for each preload and step."""
    return list(_rows(solution))


def factor_rows(solution: Solution) -> list[list[str]]:
    """One for each preload, at the end of the last step."""
    return [
        [name, "" if one.value is None else f"{one.value:.6g}", f"{one.tension:.6g}", f"{one.load:.6g}", one.why]
        for name, one in load_factors(solution).items()
    ]


def _rows(solution: Solution) -> Iterator[list[str]]:
    for step in solution.steps:
        for section in sections(solution.model.mesh, solution.model.preloads):
            result = step.preloads[section.preload.name]
            across = result.force - (result.force @ section.normal) * section.normal
            bent = result.moment
            if len(bent) == 3:
                bent = bent - (bent @ section.normal) * section.normal
            state = (
                "locked"
                if result.kept is not None
                else "shortening given"
                if result.prescribed is None
                else "force given"
            )
            numbers = (result.tension, np.linalg.norm(across), np.linalg.norm(bent), result.shortening)
            yield [section.preload.name, f"{step.number}", *(f"{value:.6g}" for value in numbers), state]
