"""Contacts and ties that act for a part of the time: two blocks of 1 x 1 x 1 in a row, E = 1000, no Poisson's ratio, so that
each is a spring of 1000 and both together are one of 500; meshed unalike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.mesh.make import box, join
from abut.nonlinear import friction as friction_search
from abut.nonlinear import search
from abut.nonlinear.active_set import ActiveSet, Trial
from abut.nonlinear.interior_point import Interior, iterate
from abut.nonlinear.newton import End
from abut.output.restart import description, load_steps, save_step

E = 1000.0
MESH = join(
    {
        "low": box((0, 1), (0, 1), (0, 1), (2, 2, 2), "hex8"),
        "top": box((0, 1), (0, 1), (1, 2), (3, 3, 2), "hex8"),
    }
)
SIDES = ("top.bottom", "low.top")
GLUE = abut.Contact(*SIDES, name="glue", kind="tied", until=0.5)
TOUCH = abut.Contact(*SIDES, name="touch", since=0.5)


def _way(*points: tuple[float, float]) -> abut.Amplitude:
    return abut.Amplitude(points)


def _blocks(contacts: Sequence[abut.Contact], way: abut.Amplitude, times: Sequence[float], **more: Any) -> abut.Model:
    """The upper end is led along ``way`` along z, and does not move sideways unless it is told to."""
    finite = more.get("kinematics", "small") == "finite"
    material = abut.Hencky(E, 0.0) if finite else abut.LinearElastic(E, 0.0)
    supports = [
        abut.Support("low.bottom", x=0, y=0, z=0),
        abut.Support("top.top", z=1.0, amplitude=way),
        *more.pop("sideways", [abut.Support("top.top", x=0, y=0)]),
    ]
    solids = [abut.Solid(body, material) for body in ("low", "top")]
    return abut.Model(
        MESH, solids, supports, contacts=contacts, solve=abut.SolveOptions(times=tuple(times)), **more
    )  # fmt: skip


def _solved(model: abut.Model) -> abut.Solution:
    solution = abut.solve(model)
    assert solution.converged
    assert all(check.passed for check in solution.certificate)
    return solution


def _force(solution: abut.Solution, name: str) -> list[float]:
    """On the upper block, upward, step by step."""
    return [next(float(c.force[2]) for c in step.contacts if c.name == name) for step in solution.steps]


def _below(solution: abut.Solution) -> list[float]:
    """What holds the lower block, step by step."""
    return [float(step.reactions["low.bottom"][2]) for step in solution.steps]


PULLED = _way((0.0, 0.0), (0.25, 0.1), (0.75, 0.1), (1.0, -0.1))
TIMES = (0.25, 0.5, 0.625, 0.75, 1.0)


def _stretched(way: float, kinematics: str) -> float:
    """Force of both blocks stretched by ``way``; large strains: logarithmic ones, over a section that does not change."""
    return 0.5 * E * way if kinematics != "finite" else E * np.log1p(0.5 * way) / (1.0 + 0.5 * way)


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("kinematics", ["small", "small-strain", "finite"])
def test_glue_that_lets_go(kinematics: str, friction: float) -> None:
    """Pulled while glued; let go at once both parts are without stress; pushed together they press without pulling."""
    contacts = [GLUE, replace(TOUCH, friction=friction)]
    solution = _solved(_blocks(contacts, PULLED, TIMES, kinematics=kinematics))
    pull, push = _stretched(0.1, kinematics), _stretched(-0.1, kinematics)
    assert _force(solution, "glue") == pytest.approx([-pull, -pull, 0.0, 0.0, 0.0], rel=1e-9, abs=1e-9)
    assert _force(solution, "touch") == pytest.approx([0.0, 0.0, 0.0, 0.0, -push], rel=1e-9, abs=1e-9)
    assert _below(solution) == pytest.approx([-pull, -pull, 0.0, 0.0, -push], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_forces_fade(kinematics: str) -> None:
    """Up to ``released`` in a straight line."""
    contacts = [replace(GLUE, released=0.75), TOUCH]
    solution = _solved(_blocks(contacts, PULLED, TIMES, kinematics=kinematics))
    pull, push = _stretched(0.1, kinematics), _stretched(-0.1, kinematics)
    assert _below(solution) == pytest.approx([-pull, -pull, -0.5 * pull, 0.0, -push], rel=1e-9, abs=1e-6)


def test_pressure_is_handed_over() -> None:
    """Pressed while glued: contact takes the pressure over, and nothing moves, at once or slowly; so does bilateral contact,
    and contact that is glued again."""
    pressed = _way((0.0, 0.0), (0.25, -0.1), (1.0, -0.1))
    for released in (None, 0.75):
        for kind in ("contact", "bilateral"):
            again = abut.Contact(*SIDES, name="again", kind="tied", since=0.75)
            contacts = [replace(GLUE, released=released), replace(TOUCH, kind=kind, until=0.75), again]
            solution = _solved(_blocks(contacts, pressed, TIMES))
            assert _below(solution) == pytest.approx([50.0] * 5, rel=1e-9)
            half = 25.0 if released else 0.0
            assert _force(solution, "touch") == pytest.approx([0.0, 0.0, 50.0 - half, 50.0, 0.0], rel=1e-9, abs=1e-9)
            assert _force(solution, "again") == pytest.approx([0.0] * 4 + [50.0], rel=1e-9, abs=1e-9)


def test_glue_that_sets() -> None:
    """Pressed to 50, glued, and drawn apart: one bar. Glued across a gap that has opened: both are without stress then."""
    contacts = [replace(TOUCH, since=0.0, until=0.5), replace(GLUE, since=0.5, until=None)]
    for first, force in ((-0.1, (50.0, -50.0)), (0.02, (0.0, -40.0))):
        way = _way((0.0, 0.0), (0.25, first), (0.5, first), (1.0, 0.1))
        solution = _solved(_blocks(contacts, way, (0.25, 0.5, 0.75, 1.0)))
        half = (force[0] + force[1]) / 2.0
        assert _below(solution) == pytest.approx([force[0], force[0], half, force[1]], rel=1e-9, abs=1e-9)
        assert _force(solution, "glue") == pytest.approx([0.0, 0.0, half, force[1]], rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize("friction", ["rough", 0.1])
def test_friction_takes_shear_over(friction: float | str, kinematics: str) -> None:
    """Glued, pressed, and sheared; as the glue fades, surfaces that never slip take the shear over as it is; those that do
    carry their pressure times the coefficient, as without glue, since the shear is more than that."""
    shear = _way((0.0, 0.0), (0.25, 0.0), (0.5, 1.0), (1.0, 1.0))
    sideways = [abut.Support("top.top", x=0.1, y=0, amplitude=shear)]
    contacts = [replace(GLUE, released=1.0), replace(TOUCH, friction=friction, pressure="P1")]
    pressed = _way((0.0, 0.0), (0.25, -0.1), (1.0, -0.1))
    model = _blocks(contacts, pressed, (0.25, 0.5, 0.625, 0.75, 0.875, 1.0), sideways=sideways, kinematics=kinematics)
    solution = abut.solve(model)
    assert solution.converged
    glued, last = (next(s for s in solution.steps if s.factor == time) for time in (0.5, 1.0))
    shear_force, pressure = np.abs(last.contacts[1].force[[0, 2]])
    if friction == "rough":
        near = 1e-8 if kinematics == "small" else 1e-5  # slips over a way that turns a little
        assert shear_force == pytest.approx(abs(glued.contacts[0].force[0]), rel=10.0 * near)
        assert last.displacement == pytest.approx(glued.displacement, abs=near)
        return
    assert abs(glued.contacts[0].force[0]) > 1.5 * shear_force
    if kinematics == "small":
        assert shear_force == pytest.approx(friction * pressure, rel=1e-9)
    never = replace(model, contacts=[replace(contacts[1], since=0.0)])
    assert last.contacts[1].force == pytest.approx(abut.solve(never).steps[-1].contacts[0].force, abs=1e-4)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_the_constraint_function_is_left_out_too(friction: float, kinematics: str) -> None:
    """As the first test, with a law that is smoothed by next to nothing."""
    contacts = [GLUE, replace(TOUCH, friction=friction, law="constraint-function")]
    solution = abut.solve(_blocks(contacts, PULLED, TIMES, kinematics=kinematics))
    pull, push = _stretched(0.1, kinematics), _stretched(-0.1, kinematics)
    assert _below(solution) == pytest.approx([-pull, -pull, 0.0, 0.0, -push], rel=1e-4, abs=1e-4)


def test_a_run_that_goes_on(tmp_path: Path) -> None:
    """By restart files, from the middle of the time in which forces fade, and from where glue has set, to the same end."""
    sets = [replace(TOUCH, since=0.0, until=0.25), abut.Contact(*SIDES, name="glue", kind="tied", since=0.25)]
    for number, contacts in enumerate(([replace(GLUE, released=0.75), TOUCH], sets)):
        model, folder = _blocks(contacts, PULLED, TIMES), tmp_path / str(number)
        said = description(model)
        whole = abut.solve(model, on_step=lambda _, one, at=folder, said=said: save_step(at, said, one))
        rest = abut.solve(model, resume=load_steps(folder, said)[:3])
        for one, other in zip(whole.steps, rest.steps):
            assert other.displacement == pytest.approx(one.displacement, abs=1e-12)


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_interior_points_leave_out_what_is_away(friction: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first test again, where the search for the contact status gives active sets of contact up at once: no iterate of
    interior points has forces of the tie that has let go."""
    ended, seen = ActiveSet.ended, list[float]()

    def looked(at: Any, manner: Any) -> Interior:
        here = iterate(at, manner)
        away = at.programme.solver.system.away
        seen.append(float(np.abs(here.state.multipliers[away]).max(initial=0.0)))
        return here

    def gives_up(method: ActiveSet, there: Trial) -> End | None:
        system = method._solver.system
        return ended(method, there) if (system.tied | system.away).all() else End.STALLED

    monkeypatch.setattr(ActiveSet, "ended", gives_up)
    for module in (search, friction_search):
        monkeypatch.setattr(module, "iterate", looked)
    contacts = [GLUE, replace(TOUCH, friction=friction)]
    last = abut.solve(_blocks(contacts, PULLED, TIMES)).steps[-1]
    assert last.contacts[0].force == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)
    assert last.contacts[1].force[2] == pytest.approx(50.0, rel=1e-7)
    assert seen or friction
    assert max(seen, default=0.0) < 1e-9


def _loaded(model: abut.Model, *force: tuple[float, float]) -> abut.Model:
    """By a force, in place of the motion of the upper end."""
    held = [support for support in model.supports if support.on == "low.bottom" or support.z is None]
    return replace(model, supports=held, loads=[abut.Force("top.top", (0.0, 0.0, 1.0), _way(*force))])


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_what_glue_alone_holds(kinematics: str) -> None:
    """A block that a force pulls while it is glued, and presses when it is not: contact holds it from then on."""
    model = _blocks([GLUE, TOUCH], PULLED, (0.25, 0.5, 0.75, 1.0), kinematics=kinematics)
    solution = abut.solve(_loaded(model, (0.0, 0.0), (0.25, 1.0), (0.5, 0.0), (0.75, -4.0), (1.0, -4.0)))
    assert solution.converged
    steps = [next(step for step in solution.steps if step.factor == time) for time in (0.25, 0.5, 0.75, 1.0)]
    below = [float(step.reactions["low.bottom"][2]) for step in steps]
    assert below == pytest.approx([-1.0, 0.0, 4.0, 4.0], rel=1e-6, abs=1e-6)
    assert [step.contacts[0].active > 0 for step in steps] == [True, True, False, False]


def test_what_nothing_holds_any_more() -> None:
    """Where the force still pulls, the run says that nothing holds the block, and when."""
    model = _loaded(_blocks([GLUE, TOUCH], PULLED, (0.5, 1.0)), (0.0, 0.0), (0.5, 1.0), (1.0, 1.0))
    with pytest.raises(abut.SingularModelError, match=r"body 'top'.*pull it off its contact in step 2"):
        abut.solve(model)
    with pytest.raises(abut.SingularModelError, match="body 'top'"):
        abut.solve(replace(model, contacts=[GLUE]))


def test_load_steps_end_where_contacts_change() -> None:
    """Without a word about them."""
    model = replace(_blocks([replace(GLUE, released=0.75), TOUCH], PULLED, TIMES), solve=abut.SolveOptions())
    assert model.ends == (0.5, 0.75, 1.0)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"since": 0.5, "until": 0.5}, "expected times 0 <= since < until <= released, got"),
        ({"until": 0.5, "released": 0.25}, "expected times"),
        ({"released": 0.5}, "released goes with until"),
        ({"since": "now"}, "since"),
        ({"since": 0.5, "method": "node-to-segment"}, "since, until: go with method segment-to-segment"),
    ],
)
def test_times_that_cannot_be(given: dict[str, Any], told: str) -> None:
    with pytest.raises(InputError, match=told):
        abut.Contact(*SIDES, **given)


def test_what_cannot_be_at_one_time() -> None:
    """Two contacts of the same facets in the same time; glue that sets after large sliding."""
    with pytest.raises(InputError, match="would be determined twice"):
        _blocks([GLUE, replace(TOUCH, since=0.25)], PULLED, TIMES)
    with pytest.raises(InputError, match="since: a tie begins on the way with kinematics"):
        _blocks([replace(GLUE, since=0.25)], PULLED, TIMES, kinematics="finite")
    fluid = abut.Penetration("touch", "low.left", 1.0)
    with pytest.raises(InputError, match="'touch', which a fluid enters"):
        _blocks([TOUCH], PULLED, TIMES, penetrations=[fluid])


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_one_contact_after_another(kinematics: str) -> None:
    """Of the same sides: each has all of its functions, so that the pressure, which is even, is at every point."""
    pressed = _way((0.0, 0.0), (0.25, -0.1), (1.0, -0.1))
    contacts = [replace(TOUCH, name="first", since=0.0, until=0.5), replace(TOUCH, friction=0.1)]
    solution = _solved(_blocks(contacts, pressed, (0.25, 0.5, 0.75, 1.0), kinematics=kinematics))
    even = -_stretched(-0.1, kinematics)
    assert _below(solution) == pytest.approx([even] * 4, rel=1e-9)
    for number, step in ((0, 1), (1, 3)):
        pressure = solution.steps[step].contacts[number].pressure
        assert pressure[np.isfinite(pressure)] == pytest.approx(even, rel=1e-7)


def test_times_up_to_any_end() -> None:
    """With an end of 60 they are given up to that; a time after it is refused with its place."""
    ways = _way((0.0, 0.0), (15.0, 0.1), (45.0, 0.1), (60.0, -0.1))
    minute = abut.SolveOptions(times=(15.0, 60.0), end=60.0)
    glue, touch = replace(GLUE, until=30.0, released=45.0), replace(TOUCH, since=30.0)
    supports = [abut.Support("low.bottom", x=0, y=0, z=0), abut.Support("top.top", x=0, y=0, z=1.0, amplitude=ways)]
    solids = [abut.Solid(body, abut.LinearElastic(E, 0.0)) for body in ("low", "top")]
    model = abut.Model(MESH, solids, supports, contacts=[glue, touch], solve=minute)
    assert model.ends == (0.25, 0.5, 0.75, 1.0)
    assert _below(_solved(model)) == pytest.approx([-50.0, -50.0, 0.0, 50.0], rel=1e-9, abs=1e-9)
    with pytest.raises(InputError, match=r"contacts\[0\]: released.* 60"):
        abut.Model(MESH, solids, supports, contacts=[replace(glue, released=61.0)], solve=minute)
