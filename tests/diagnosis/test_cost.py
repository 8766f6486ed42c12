"""What `abut check` says of the time follows from what a run does."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import pytest

import abut
from abut.analysis.interpolation_error import is_mended
from abut.diagnosis.cost import foresee
from abut.job.load import load_job
from abut.linear.cost_model import effort, seconds
from abut.mesh.make import box, join, rectangle
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


def pressed(cell: str, friction: float = 0.0, **given: object) -> abut.Model:
    """A block pressed on a wider one that does not match."""
    if cell in ("tri3", "quad4"):
        lower, upper = rectangle((0, 4), (0, 1), (6, 2), cell), rectangle((1, 3), (1, 2), (4, 2), cell)
        held = [abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0, y=-0.01)]
        given = {"plane": "strain", **given}
    else:
        lower = box((0, 4), (0, 4), (0, 1), (4, 4, 2), cell)
        upper = box((1, 3), (1, 3), (1, 2), (3, 3, 2), cell)
        held = [abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", x=0, y=0, z=-0.01)]
    steel = abut.LinearElastic(1e3, 0.3)
    solids = [abut.Solid(body, steel) for body in ("lower", "upper")]
    contacts = [abut.Contact("upper.bottom", "lower.top", friction=friction)]
    return abut.Model(join({"lower": lower, "upper": upper}), solids, held, contacts=contacts, **given)


AGAIN: Mapping[str, tuple[Callable[[], abut.Model], int]] = {
    "triangles": (lambda: pressed("tri3"), 2),
    "tetrahedra": (lambda: pressed("tet4"), 1),
    "quadrilaterals": (lambda: pressed("quad4"), 0),
    "friction": (lambda: pressed("tri3", 0.3), 0),
    "large displacements": (lambda: pressed("tri3", kinematics="finite"), 0),
    "metal": (
        lambda: replace(
            pressed("tri3"), solids=[abut.Solid(body, abut.Plastic(1e3, 0.3, 50.0)) for body in ("lower", "upper")]
        ),
        0,
    ),
}


@pytest.mark.parametrize("name", AGAIN)
def test_further_solutions_are_foreseen_where_a_run_has_them(name: str) -> None:
    """Triangles and tetrahedra of first order in contact are solved once more, in the plane twice."""
    make, times = AGAIN[name]
    model = make()
    held, problem = supports(model), assembled(model)
    found = effort(model, 100, pairs(model, held) if not model.finite else problem.pairs)
    assert found.again == times
    assert is_mended(problem) == (times > 0)


@pytest.mark.parametrize("solver", ["direct", "amg"])
def test_a_further_solution_takes_time(solver: str) -> None:
    """As long for each, in the results of every step; nothing else takes longer."""
    model = pressed("tet4")
    own = effort(model, 20_000, pairs(model, supports(model)))
    none, once, twice = (seconds(replace(own, again=times), solver) for times in (0, 1, 2))
    assert once["results"] > 1.2 * none["results"]
    assert twice["results"] - once["results"] == pytest.approx(once["results"] - none["results"])
    assert {**twice, "results": 0.0} == {**none, "results": 0.0}
    many = seconds(replace(own, steps=5), solver)
    assert many["results"] == pytest.approx(5.0 * once["results"])
