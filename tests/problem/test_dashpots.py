"""Dashpots: backward Euler's recurrence to the ground, between points, along turning lines, by tables; restarts, energy."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.cli import main
from abut.errors import InputError
from abut.mesh.make import join, rectangle
from models.bars_in_a_row import bars_in_a_row

YOUNG, STIFFNESS, DAMPING, END = 1000.0, 50.0, 80.0, 4.0
STEPS = np.array([0.5, 1.0, 2.0, 4.0])  # of unlike durations
AT_ONCE = abut.Amplitude(((0.0, 1.0), (END, 1.0)))


def square(springs, force=-10.0, kinematics="small", **more):
    """Uniform, held along x, on springs and dashpots, under a force that is there at once."""
    mesh = join({"square": rectangle([0, 1], [0, 1], cells=[1, 1])})
    mesh = replace(mesh, node_sets={"corner": mesh.nodes_of("square.bottom")[:1], "all": np.arange(4)})
    given = {"solve": abut.SolveOptions(end=END, times=tuple(STEPS)), **more}
    return abut.Model(
        mesh,
        [abut.Solid("square", abut.Hencky(1e9, 0.0) if kinematics == "finite" else abut.LinearElastic(1e9, 0.0))],
        [abut.Support("all", x=0)],
        [abut.Force("square.top", (0.0, force), amplitude=AT_ONCE)],
        plane="strain",
        kinematics=kinematics,
        springs=springs,
        **given,
    )


def euler(force, law=lambda speed: DAMPING * speed):
    """Where a spring and a dashpot are, step by step: k u + f((u - u before) / dt) = F, by bisection."""
    found, before = [], 0.0
    for duration in np.diff(STEPS, prepend=0.0):
        low, high = 0.0, force / STIFFNESS
        for _ in range(200):
            here = 0.5 * (low + high)
            below = STIFFNESS * here + law((here - before) / duration) < force
            low, high = (here, high) if below else (low, here)
        found.append(before := here)
    return np.array(found)


SPRING = abut.Spring("spring", "square.bottom", y=STIFFNESS)
DASHPOTS = {
    "normal": abut.Spring("dashpot", "square.bottom", normal=DAMPING, dashpot=True),
    "per area": abut.Spring("dashpot", "square.bottom", y=DAMPING, per_area=True, dashpot=True),
    "nodes": abut.Spring("dashpot", "all", y=DAMPING, dashpot=True),
    "point": abut.Spring("dashpot", "corner", point=(0.0, -3.0), along=DAMPING, dashpot=True),
}


def moved(solution):
    nodes = solution.model.mesh.nodes_of("square.bottom")
    return np.array([step.displacement[nodes, 1].mean() for step in solution.steps])


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize("dashpot", DASHPOTS.values(), ids=DASHPOTS)
def test_beside_a_spring(dashpot, kinematics):
    """Its force is c times the speed, its energy force times way; the certificate's balance of energy is complete."""
    solution = abut.solve(square([SPRING, dashpot], kinematics=kinematics))
    exact = euler(10.0)
    assert -moved(solution) == pytest.approx(exact, rel=1e-6)  # the square gives way by 1e-8
    ways = np.diff(exact, prepend=0.0)
    forces = DAMPING * ways / np.diff(STEPS, prepend=0.0)
    assert [step.springs["dashpot"][1] for step in solution.steps] == pytest.approx(forces, rel=1e-6)
    assert [step.energy.dashpots for step in solution.steps] == pytest.approx(forces * ways, rel=1e-6)
    assert all(step.energy.error < 1e-8 for step in solution.steps)
    assert all(check.passed for check in solution.certificate), [c for c in solution.certificate if not c.passed]


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_a_table_of_speeds(kinematics):
    """Twice as stiff beyond a speed."""
    table = ((-1.0, -120.0), (-0.05, -4.0), (0.05, 4.0), (1.0, 156.0))
    dashpot = abut.Spring("dashpot", "square.bottom", normal=table, dashpot=True)
    solution = abut.solve(square([SPRING, dashpot], kinematics=kinematics))
    speeds, forces = np.array(table).T
    exact = euler(10.0, lambda speed: float(np.interp(speed, speeds, forces)))
    assert -moved(solution) == pytest.approx(exact, rel=1e-6)


def test_alone_it_gives_way_at_a_steady_speed():
    """Nothing else holds the square along y: F = c v in every step."""
    solution = abut.solve(square([DASHPOTS["normal"]]))
    assert -moved(solution) == pytest.approx(10.0 / DAMPING * STEPS, rel=1e-6)


def test_along_a_line_that_turns():
    """A point goes past by v a second, a aside of the other end: c dl / dt along the line that there is then."""
    arm, low, speed = 2.0, 1.0, 1.5
    dashpot = abut.Spring("dashpot", "corner", point=(-arm, -low), along=DAMPING, dashpot=True)
    model = square([dashpot], kinematics="finite")
    model = replace(
        model,
        loads=[],
        supports=[abut.Support("all", x=0), abut.Support("square.bottom", y=speed * END)],
    )
    solution = abut.solve(model)
    lengths = np.hypot(arm, low + speed * np.concatenate([[0.0], STEPS]))
    pulls = DAMPING * np.diff(lengths) / np.diff(STEPS, prepend=0.0)
    for step, pull, length, time in zip(solution.steps, pulls, lengths[1:], STEPS):
        assert step.springs["dashpot"] == pytest.approx(-pull / length * np.array([arm, low + speed * time]), rel=1e-9)


def test_between_two_points():
    """In a row: a bar that is held, a dashpot between nodes, a bar that is drawn at a steady speed."""
    mesh, sides = bars_in_a_row()
    steady = abut.Amplitude(((0.0, 1.0), (END, 1.0)))
    model = abut.Model(
        mesh,
        [abut.Solid(bar, abut.LinearElastic(YOUNG, 0.0)) for bar in mesh.bodies],
        [abut.Support("one.left", x=0), *sides],
        [abut.Force("two.right", (5.0, 0.0, 0.0), amplitude=steady)],
        springs=[abut.Spring("link", "left end", to="right end", along=20.0, dashpot=True)],
        solve=abut.SolveOptions(end=END, times=tuple(STEPS)),
    )
    solution = abut.solve(model)
    for step, time in zip(solution.steps, STEPS):
        far = step.displacement[mesh.nodes_of("two.right"), 0]
        assert far == pytest.approx(5.0 * (8.0 / YOUNG + time / 20.0), rel=1e-8)
        assert step.springs["link"] == pytest.approx([5.0, 0.0, 0.0], abs=1e-7)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_restart(kinematics):
    """What it does after a restart, and the forces of the steps before, are those of the whole run."""
    model, saved = square([SPRING, DASHPOTS["point"]], kinematics=kinematics), []
    whole = abut.solve(model, on_step=lambda _, one: saved.append(one))
    again = abut.solve(model, resume=saved[:2])
    for one, other in zip(whole.steps, again.steps, strict=True):
        assert other.springs["dashpot"] == pytest.approx(one.springs["dashpot"], rel=1e-9, abs=1e-12)
        assert other.energy.dashpots == pytest.approx(one.energy.dashpots, rel=1e-9)
    assert moved(again) == pytest.approx(moved(whole), rel=1e-12)


def test_not_beside_modes():
    with pytest.raises(InputError, match=r"springs\[0\]\.dashpot: frequencies, buckling and vibrations have no dash"):
        square([DASHPOTS["normal"]], modes=[abut.Frequencies()])


JOB = """schema = 1
[model]
plane = "strain"
[mesh.bodies.square]
kind = "rectangle"
x = [0, 1]
y = [0, 1]
cells = [1, 1]
[materials.steel]
kind = "linear-elastic"
young = 1e9
poisson = 0.0
[[solids]]
body = "square"
material = "steel"
[[supports]]
on = "square.left"
x = 0
[[loads]]
kind = "force"
on = "square.top"
value = [0, -10]
amplitude = [[0, 1], [{end}, 1]]
[[springs]]
name = "spring"
on = "square.bottom"
normal = 50
[[springs]]
name = "dashpot"
on = "square.bottom"
normal = 80
dashpot = true
[[steps]]
name = "first"
period = 1
increments = 2
{more}
[output]
restart = true
"""
SECOND = '[[steps]]\nname = "second"\nperiod = 3\nincrements = 3\n'


def test_steps_of_a_job_and_its_start(tmp_path):
    """Steps of two durations; a job that begins with the steps of the one before ends where one of all steps does."""
    ends = {}
    for name, end, more in (
        ("whole", 4, SECOND),
        ("first", 1, ""),
        ("rest", 4, SECOND + '[start]\nresults = "first"\ntime = "first"\n'),
    ):
        (tmp_path / f"{name}.toml").write_text(JOB.format(end=end, more=more))
        assert main(["run", str(tmp_path / f"{name}.toml"), "--output", str(tmp_path / name), "--quiet"]) == 0
        ends[name] = json.loads((tmp_path / name / "summary.json").read_text())["steps"][-1]
    moved, speed = 0.0, 0.0
    for duration in (0.5, 0.5, 1.0, 1.0, 1.0):
        speed = (10.0 - STIFFNESS * moved) / (DAMPING + STIFFNESS * duration)
        moved += speed * duration
    for name in ("whole", "rest"):
        assert ends[name]["springs"]["dashpot"][1] == pytest.approx(DAMPING * speed, rel=1e-6)
        assert ends[name]["springs"]["spring"][1] == pytest.approx(STIFFNESS * moved, rel=1e-6)
        assert ends[name]["energy"]["dashpots"] == pytest.approx(DAMPING * speed**2 * 1.0, rel=1e-6)
