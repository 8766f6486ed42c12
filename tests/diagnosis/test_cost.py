"""What `abut check` says of the time follows from what a run does."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import pytest

import abut
from abut.diagnosis.cost import foresee
from abut.job.load import load_job
from abut.linear.cost_model import effort
from abut.problem.constraints import supports
from abut.problem.contact_pairs import pairs
from models.friction import pushed
from models.oracle import assembled

EXAMPLES = Path(__file__).parents[2] / "examples"


def sprung(*table: tuple[float, float]) -> abut.Model:
    """A block pressed on another by its side's spring, too."""
    return replace(pushed(), springs=[abut.Spring("side", "upper.left", x=list(table) or 10.0)])


def metal() -> abut.Model:
    model = pushed()
    steel = abut.Plastic(1e4, 0.3, 50.0)
    return replace(model, solids=[replace(solid, material=steel) for solid in model.solids])


MODELS: Mapping[str, Callable[[], abut.Model]] = {
    "constant": pushed,
    "linear spring": sprung,
    "spring with a table": lambda: sprung((-1.0, -5.0), (0.0, 0.0), (1.0, 10.0)),
    "metal": metal,
    "bolt drawn by a force": lambda: load_job(EXAMPLES / "bolted-joint" / "job.toml").model,
}


@pytest.mark.parametrize("name", MODELS)
def test_new_factors_are_foreseen_where_the_problem_has_them(name: str) -> None:
    """Displacements are condensed once where the stiffness is constant; where it is not, each iteration has factors."""
    model = MODELS[name]()
    assert effort(model, 100, ()).changing == (not assembled(model).constant)


def test_time_grows_with_steps_as_the_work_of_each_does() -> None:
    """Results are computed at the end of each step, iterations make new factors: ten times the steps, ten times these."""

    def stages(steps: int) -> dict[str, float]:
        model = replace(metal(), solve=abut.SolveOptions(times=[(k + 1) / steps for k in range(steps)]))
        held = supports(model)
        return foresee(model, held, pairs(model, held)).stages

    few, many = stages(10), stages(100)
    assert many["results"] == pytest.approx(10.0 * few["results"])
    assert many["solve"] == pytest.approx(10.0 * few["solve"], rel=0.15)  # the first step has more iterations
    assert many["interface"] == few["interface"]
