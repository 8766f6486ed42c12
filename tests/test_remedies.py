"""What abut advises where a run does not converge: the advice follows the cause."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import abut
from abut.analysis.remedies import Remedy, remedies, unsettled
from abut.io.results import summary, write
from abut.mesh import make
from abut.state import Iteration, Solution, Step


def model(
    upper: int = 4, lower: int = 4, young: tuple[float, float] = (1e3, 1e3), tilt: float = 0.0, **contact: Any
) -> abut.Model:
    """A block pressed on another: ``upper``, ``lower`` cells along them, the upper being the contactor."""
    mesh = make.join(
        {
            "lower": make.rectangle(x=[0, 3], y=[0, 1], cells=[3 * lower, lower], cell="quad4"),
            "upper": make.rectangle(x=[1, 2], y=[1, 2], cells=[upper, upper], cell="quad4"),
        }
    )
    x, y = mesh.points.T
    mesh = replace(mesh, points=np.column_stack([x, y + np.where(y > 1.0 - 1e-9, tilt * (x - 1.0) ** 2, 0.0)]))
    return abut.Model(
        mesh,
        plane="strain",
        solids=[
            abut.Solid(body, abut.LinearElastic(E, 0.3)) for body, E in zip(("upper", "lower"), young)
        ],
        supports=[abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0, y=-0.01)],
        contacts=[abut.Contact("upper.bottom", "lower.top", name="c", **contact)],
    )  # fmt: skip


def failed(model: abut.Model, rows: list[tuple[int, int]], residual: float = 1e-14, facets: tuple[int, ...] = (0, 1),
           solver: str = "") -> Solution:  # fmt: skip
    """The solution of a model as it would be, had its iterations been ``rows`` = (active, changed) and not converged."""
    solution = abut.solve(model)
    step: Step = solution.steps[-1]
    iterations = tuple(
        Iteration(1, i, active, changed, residual, 0.1, 0.0, 0.0) for i, (active, changed) in enumerate(rows, start=1)
    )
    cycling = {"c": np.array(facets)} if facets else {}
    step = replace(step, converged=False, iterations=iterations, cycling=cycling)
    return replace(solution, steps=(step,), solver=solver or solution.solver)


def actions(solution: Solution) -> list[str]:
    found = remedies(solution)
    assert len(found) == 3
    assert all(isinstance(remedy, Remedy) and remedy.reason for remedy in found)
    return [remedy.action for remedy in found]


CYCLE = [(3, 2), (4, 2), (3, 2), (4, 2), (3, 2)]


def test_contactor_finer_than_target() -> None:
    found = actions(failed(model(upper=12, lower=2), CYCLE))
    assert found[0] == 'contact \'c\': swap the sides (contactor = "lower.top", target = "upper.bottom")'
    assert found[1] == "contact 'c': refine 'lower.top' 6 times"  # facets of 1/12 against 1/2


def test_contactor_stiffer_than_target() -> None:
    first = remedies(failed(model(young=(2e5, 1e3)), CYCLE))[0]
    assert "swap the sides" in first.action
    assert "200 times as stiff" in first.reason
    assert "finer" not in first.reason


def test_softer_coarser_contactor_is_left_where_it_is() -> None:
    assert not any("swap" in action for action in actions(failed(model(young=(1e3, 2e5), upper=2), CYCLE)))


def test_constraint_function() -> None:
    found = actions(failed(model(law="constraint-function"), [(4, 0)] * 5))
    assert found[0] == "contact 'c': law = \"complementarity\""
    assert not any('law = "constraint-function"' in action for action in found)


def test_unstable_pressure() -> None:
    assert "contact 'c': pressure = \"auto\"" in actions(failed(model(pressure="P0"), CYCLE))


def test_contact_that_moves_far() -> None:
    found = remedies(failed(model(), [(5, 0), (1, 4), (4, 3), (1, 3)]))
    assert found[0].action == "solve.steps = 4"
    assert "80 % of the interface" in found[0].reason  # 4 of 5 multipliers


def test_limit_reached_while_settling() -> None:
    found = actions(failed(model(), [(4, 4), (4, 3), (3, 2), (3, 1)]))
    assert "solve.max_iterations = 200" in found


def test_large_residual() -> None:
    found = actions(failed(model(), [(4, 0)], residual=1e-3, facets=(), solver="multigrid (PyAMG)"))
    assert found[0].startswith("check the units")
    assert found[1] == 'solve.linear = "direct"'
    assert found[2].startswith("add supports")


def test_none_where_nothing_failed() -> None:
    solution = abut.solve(model())
    assert remedies(solution) == ()
    assert summary(solution)["remedies"] == []
    assert summary(solution)["steps"][-1]["unsettled"] == []


def test_place_is_named_with_nodes_and_coordinates(tmp_path: Path) -> None:
    """Facets 0 and 1 of four along x = 1 ... 2 at y = 1 end at x = 1, 1.25, 1.5."""
    solution = failed(model(), CYCLE)
    (place,) = unsettled(solution.steps[-1])
    assert sorted(place.coordinates[:, 0].tolist()) == pytest.approx([1.0, 1.25, 1.5])
    assert place.coordinates[:, 1].tolist() == pytest.approx([1.0] * 3)
    np.testing.assert_array_equal(solution.model.mesh.points[place.nodes], place.coordinates)
    assert str(place) == "contact 'c': facets [0, 1] do not settle, 2 in all, within (1, 1) to (1.5, 1)"
    write(solution, tmp_path)
    written = json.loads((tmp_path / "summary.json").read_text())
    assert written["steps"][-1]["unsettled"][0]["nodes"] == place.nodes.tolist()
    assert len(written["remedies"]) == 3
    from test_restart import arrays

    shown = dict(arrays(tmp_path / "contact_c_0001.vtu"))
    assert shown["unsettled"].sum() == 2
    assert shown["unsettled"][shown["side"] == 1].sum() == 0


def test_real_failure_names_what_really_helps() -> None:
    """A ball that touches in a point starts far from where it ends: with one iteration it is said to be still settling, or
    moving; with more iterations it converges."""
    mesh = make.join(
        {
            "ball": make.half_disc(centre=[0, 1], cells=8, cell="quad4"),
            "block": make.rectangle(x=[-1, 1], y=[-1, 0], cells=[16, 8], cell="quad4"),
        }
    )
    ball = abut.Model(
        mesh,
        plane="strain",
        solids=[abut.Solid("ball", abut.LinearElastic(1.0, 0.3)), abut.Solid("block", abut.LinearElastic(1.0, 0.3))],
        supports=[abut.Support("block.bottom", x=0, y=0), abut.Support("ball.flat", x=0, y=-0.02)],
        contacts=[abut.Contact("ball.round", "block.top")],
        solve=abut.SolveOptions(max_iterations=2),
    )
    solution = abut.solve(ball)
    assert not solution.converged
    assert any(a.startswith(("solve.max_iterations", "solve.steps")) for a in actions(solution))
    assert unsettled(solution.steps[-1])
    assert abut.solve(replace(ball, solve=abut.SolveOptions())).converged
