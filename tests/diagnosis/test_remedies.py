"""What abut advises where a run does not converge: the advice follows the cause."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import abut
from abut.diagnosis.advice import Remedy, remedies, unsettled
from abut.diagnosis.contactor import swap
from abut.mesh import make
from abut.nonlinear.settings import DEFAULT
from abut.output.results import summary, write
from abut.solution import Iteration, Solution, Step
from models.assemblies import PLANE
from models.overlap import ball_on_block, strip


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
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", name="c", **contact)],
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


def applied(model: abut.Model, remedy: Remedy) -> abut.Model:
    """The model with a remedy as it is written: a key and its value, of the solver or of a contact."""
    where, _, change = remedy.action.rpartition("': ")
    names = re.findall("'([^']*)'", where + "'")
    if change.startswith("solve."):
        key, value = change.removeprefix("solve.").split(" = ")
        return replace(model, solve=replace(model.solve, **{key: int(value)}))
    if change.startswith("swap the sides"):
        _, contactor, _, target, _ = change.split('"')
        new = {"contactor": contactor, "target": target}
    else:
        key, value = change.split(" = ")
        new = {key: value.strip('"')}
    return replace(model, contacts=[replace(c, **new) if c.name in names else c for c in model.contacts])


CYCLE = [(3, 2), (4, 2), (3, 2), (4, 2), (3, 2)]


def ball(**solve: Any) -> abut.Model:
    """A ball that touches in a point starts far from where it ends."""
    mesh = make.join(
        {
            "ball": make.half_disc(centre=[0, 1], cells=8, cell="quad4"),
            "block": make.rectangle(x=[-1, 1], y=[-1, 0], cells=[16, 8], cell="quad4"),
        }
    )
    return abut.Model(
        mesh,
        plane="strain",
        solids=[abut.Solid("ball", abut.LinearElastic(1.0, 0.3)), abut.Solid("block", abut.LinearElastic(1.0, 0.3))],
        supports=[abut.Support("block.bottom", x=0, y=0), abut.Support("ball.flat", x=0, y=-0.02)],
        contacts=[abut.Contact(contactor="ball.round", target="block.top")],
        solve=abut.SolveOptions(**solve),
    )


def test_more_iterations_cure_a_limit_that_is_too_low() -> None:
    solution = abut.solve(ball(max_iterations=2))
    assert not solution.converged
    assert unsettled(solution.steps[-1])
    (remedy,) = remedies(solution)
    assert remedy.action == "solve.max_iterations = 50"
    assert abut.solve(applied(solution.model, remedy)).converged


def test_complementarity_cures_a_newton_that_fails() -> None:
    """The constraint function without a line search, so that it fails at once."""
    impatient = replace(DEFAULT, newton=replace(DEFAULT.newton, halvings=0))
    original = ball()
    smooth = replace(original, contacts=[replace(original.contacts[0], law="constraint-function")])
    solution = abut.solve(smooth, settings=impatient)
    assert not solution.converged
    (remedy,) = remedies(solution)
    assert remedy.action == "contact 'ball.round-block.top': law = \"complementarity\""
    assert abut.solve(applied(solution.model, remedy)).converged


def overlapping(kind: str) -> tuple[abut.Model, str]:
    """A model whose surfaces overlap unseen, and what is to cure it first."""
    if kind == "pressure":
        return strip(pressure="P1"), 'pressure = "auto"'
    return rigid_ball(), 'law = "constraint-function"'


def rigid_ball() -> abut.Model:
    """The block carries the pressure because the ball is rigid: its sides cannot be swapped."""
    model = ball_on_block("block.top", "ball.round", 4)
    return replace(
        model,
        solids=[solid for solid in model.solids if solid.body == "block"],
        supports=[support for support in model.supports if support.on == "block.bottom"],
        rigid=[abut.Rigid("ball", x=0.0, y=-0.002, rz=0.0)],
    )


@pytest.mark.parametrize("kind", ["pressure", "law"])
def test_what_is_advised_where_surfaces_overlap_cures_it(kind: str) -> None:
    def fails(solution: abut.Solution) -> bool:
        return any(check.name == "overlap" and not check.passed for check in solution.certificate)

    model, expected = overlapping(kind)
    solution = abut.solve(model)
    assert fails(solution)
    (remedy,) = (remedy for remedy in remedies(solution) if expected in remedy.action)
    assert not fails(abut.solve(applied(model, remedy)))


def test_refining_cures_overlap() -> None:
    """The contact is 0.08 wide and hides in facets of 0.22; with facets of 0.03 it shows."""
    solution = abut.solve(ball_on_block("block.top", "ball.round", 4))
    assert any("refine both surfaces" in remedy.action for remedy in remedies(solution))
    finer = abut.solve(ball_on_block("block.top", "ball.round", 32))
    assert all(check.passed for check in finer.certificate if check.name == "overlap")


def test_no_sides_are_swapped_that_the_model_refuses() -> None:
    rigid = abut.solve(rigid_ball())
    assert swap(rigid.model, rigid.model.contacts[0]) == ""
    assert "swap" not in "".join(str(remedy) for remedy in remedies(rigid))
    bridge = abut.solve(PLANE["bridge"](np.random.default_rng(1)))
    load = bridge.model.contacts[-1]
    assert swap(bridge.model, load) == ""  # the softer side carries the pressure already
    turned = load.forced(load.target, load.contactor)
    other = replace(bridge.model, contacts=[*bridge.model.contacts[:-1], turned])
    assert swap(other, turned) == f'swap the sides (contactor = "{load.contactor}", target = "{load.target}")'


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
    assert str(place) == "contact 'c': the contact status of 2 facets keeps changing: [0, 1], within (1, 1) to (1.5, 1)"
    write(solution, tmp_path)
    written = json.loads((tmp_path / "summary.json").read_text())
    assert written["steps"][-1]["unsettled"][0]["nodes"] == place.nodes.tolist()
    assert written["remedies"] == []
    from models.steps import arrays

    shown = dict(arrays(tmp_path / "contact_c_0001.vtu"))
    assert shown["unsettled"].sum() == 2
    assert shown["unsettled"][shown["side"] == 1].sum() == 0


def pulled(force: float, **more: Any) -> abut.Model:
    """A block between a plate and a lid that presses 27.5 or so on either of its faces, friction 0.2; then it is pulled."""
    mesh = make.join(
        {
            "plate": make.rectangle(x=[0, 4], y=[0, 1], cells=[8, 2], cell="quad4"),
            "block": make.rectangle(x=[1, 3], y=[1, 2], cells=[5, 3], cell="quad4"),
            "lid": make.rectangle(x=[0, 4], y=[2, 3], cells=[8, 2], cell="quad4"),
        }
    )
    then = abut.Amplitude(((0.0, 0.0), (0.5, 0.0), (1.0, 1.0)))
    return abut.Model(
        mesh, plane="strain",
        solids=[abut.Solid(body, abut.LinearElastic(1e3, 0.3)) for body in ("plate", "block", "lid")],
        supports=[
            abut.Support("plate.bottom", x=0, y=0), abut.Support("lid.top", x=0),
            abut.Support("lid.top", y=-0.05, amplitude=abut.Amplitude(((0.0, 0.0), (0.5, 1.0)))),
            *more.pop("supports", ()),
        ],
        loads=[abut.Force("block.right", (force, 0.0), amplitude=then)],
        contacts=[
            abut.Contact(contactor="block.bottom", target="plate.top", name="under", friction=0.2),
            abut.Contact(contactor="block.top", target="lid.bottom", name="over", friction=0.2),
        ],
        solve=abut.SolveOptions(times=[0.5, 0.75, 1.0]),
    )  # fmt: skip


@pytest.mark.long
def test_what_friction_no_longer_holds_is_said() -> None:
    """Both faces slip when the pull is as large as their bounds; the parts of the step end just below, and what is said
    names both with what they carry."""
    solution = abut.solve(pulled(40.0))
    assert not solution.converged
    last = solution.steps[-2]
    bound = sum(c.friction.force_limit for c in last.contacts if c.friction is not None)
    assert 80.0 * (last.factor - 0.5) == pytest.approx(bound, abs=40.0 / 64.0)  # parts of a step go down to 1/64 of it
    (remedy,) = remedies(solution)
    assert remedy.action.startswith("a support")
    for name in ("under", "over"):
        assert f"'{name}' carries" in remedy.reason


@pytest.mark.long
def test_what_friction_never_held_is_said() -> None:
    """The first step failed, so that nothing is known but that loads push what supports leave free."""
    solution = abut.solve(pulled(40.0))
    step = replace(solution.steps[0], converged=False)
    (remedy,) = remedies(replace(solution, steps=(step,)))
    assert remedy.reason == "loads may push along what friction alone holds, in contact 'under', 'over'"


def test_rubber_is_advised_for_the_body_that_gives_way() -> None:
    """Of both, the one that the reason names, as both bear large stresses; neither where stresses are small."""
    solution = abut.solve(replace(pulled(1.0), contacts=[], loads=[], kinematics="finite", supports=[
        abut.Support(f"{body}.{side}", x=0, y=0.0 if side == "bottom" else -0.2)
        for body in ("plate", "block", "lid") for side in ("bottom", "top")
    ]))  # fmt: skip
    step = replace(solution.steps[-1], converged=False, reason="cell 9 of body 'lid' turns inside out")
    ends = remedies(replace(solution, steps=(step,)))
    assert "of body 'lid'" in ends[0].action
    gentle = replace(step, stress=0.1 * step.stress)
    assert not [remedy for remedy in remedies(replace(solution, steps=(gentle,))) if "neo-hooke" in remedy.action]


def test_friction_at_its_limit_is_no_reason_where_supports_hold() -> None:
    model = pulled(40.0, supports=[abut.Support("block.left", x=-0.5, y=0)])
    solution = abut.solve(model)
    steps = tuple(replace(step, converged=step.number < 3) for step in solution.steps)
    assert all(rub.force_by_area > 0.95 * rub.force_limit for c in steps[1].contacts if (rub := c.friction))
    assert not [r for r in remedies(replace(solution, steps=steps)) if "friction" in r.reason]
