"""Bodies that go on the way and come back without stress: springs side by side, contact, friction, large strains."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.benchmarks import BENCHMARKS
from abut.mesh import make

YOUNG, LENGTH, FORCE = 1000.0, 2.0, 30.0
STIFFNESS = YOUNG / LENGTH  # of each post, 1 x 1
TIMES = (0.25, 0.5, 0.75, 1.0)
STEADY = abut.Amplitude(((0.0, 0.0), (0.25, 1.0)))


def _posts(removals, **more):
    """Two posts under a rigid beam that is pressed down from 0 to 0.25 and stays loaded; unlike meshes in contact."""
    size = {"left": (0.0, 1.0), "right": (2.0, 3.0)}
    parts = {name: make.rectangle(x, (0.0, LENGTH), (3, 4)) for name, x in size.items()}
    parts["beam"] = make.rectangle((-0.25, 3.25), (LENGTH, LENGTH + 0.5), (5, 1))
    return abut.Model(
        make.join(parts),
        [abut.Solid(name, abut.LinearElastic(YOUNG, 0.0)) for name in size],
        [abut.Support(f"{name}.bottom", x=0, y=0) for name in size],
        [abut.Force("beam", (0.0, -FORCE), amplitude=STEADY)],
        [abut.Contact(f"{name}.top", "beam.bottom", name=name, **more) for name in size],
        plane="stress",
        rigid=[abut.Rigid("beam", x=0, rz=0)],
        removals=removals,
        solve=abut.SolveOptions(times=TIMES),
    )


@pytest.mark.parametrize("more", [{}, {"friction": 0.3}], ids=["smooth", "friction"])
def test_a_post_that_goes_leaves_its_load_to_the_other_and_comes_back_where_it_was(more):
    """The right post stands from 0.5 to 0.75 as it was left, compressed to half; back at 0.75 it is without stress at that
    length, and the beam, which has sunk by as much again, presses it by the rest: springs side by side."""
    solution = abut.solve(_posts([abut.Removal("right", until=0.25, since=0.75)], **more))
    assert solution.converged
    both, alone = FORCE / 2.0 / STIFFNESS, FORCE / STIFFNESS
    again = (FORCE / STIFFNESS + both) / 2.0  # left: k w, right: k (w - both)
    way = [-step.rigid["beam"].displacement[1] for step in solution.steps]
    assert way == pytest.approx([both, alone, alone, again], rel=1e-6)  # what is away keeps 1e-9
    of_right = [abs(float(step.contacts[1].force[1])) for step in solution.steps]
    assert of_right == pytest.approx([FORCE / 2.0, 0.0, 0.0, STIFFNESS * (again - both)], rel=1e-6, abs=1e-6)
    assert solution.steps[1].contacts[1].area == 0.0
    failed = [check.name for check in solution.certificate if not check.passed]
    assert failed == []


def test_both_passes_of_a_contact_open():
    """Node-to-segment contact both ways under a beam that deforms, whose top is led down: both passes are closed nowhere
    while the post is away. The beam, as long as a post is high over 4, is 1000 times as stiff."""
    given = _posts([abut.Removal("right", until=0.25)], method="node-to-segment-two-pass")
    down = abut.Support("beam.top", x=0, y=-0.06, amplitude=STEADY)
    solids = [*given.solids, abut.Solid("beam", abut.LinearElastic(1000.0 * YOUNG, 0.0))]
    solution = abut.solve(replace(given, solids=solids, supports=[*given.supports, down], rigid=(), loads=()))
    assert solution.converged
    forces = [[abs(float(c.force[1])) for c in step.contacts] for step in solution.steps]
    names = [contact.name for contact in solution.contacts]
    assert names == ["left", "left (second pass)", "right", "right (second pass)"]
    pressed = 0.06 * STIFFNESS
    assert sum(forces[0][2:]) == pytest.approx(pressed, rel=1e-2)
    for step, of in zip(solution.steps[1:], forces[1:]):
        assert sum(of[:2]) == pytest.approx(pressed, rel=1e-2)
        assert [contact.area for contact in step.contacts[2:]] == [0.0, 0.0]
        assert of[2:] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_forces_of_what_goes_fade():
    solution = abut.solve(BENCHMARKS["half-returns"].model(0))
    assert all(check.passed for check in solution.certificate)
    right = solution.model.mesh.bodies["right"]
    nodes = np.unique(solution.model.mesh.blocks[0].nodes[right])
    inside = nodes[solution.model.mesh.points[nodes, 0] > 0.75]
    assert np.abs(solution.steps[1].stress[inside]).max() == 0.0  # away: no stress, though its force has not gone yet


def test_large_strains_count_from_the_place_of_the_return():
    """A bar of two halves side by side, pulled to twice its length while one is away and on to three times it: that one is
    stretched by 3/2 in the end, by Hencky's law: sigma = E ln(stretch) / stretch, as the width stays."""
    whole = make.join({"bar": make.rectangle((0.0, 1.0), (0.0, 1.0), (4, 4))})
    middle = whole.points[whole.blocks[0].nodes].mean(axis=1)[:, 0]
    halves = {name: np.flatnonzero((middle < 0.5) == (i == 0)) for i, name in enumerate(("left", "right"))}
    model = abut.Model(
        replace(whole, bodies=halves),
        [abut.Solid(name, abut.Hencky(YOUNG, 0.0)) for name in halves],
        [abut.Support("bar.bottom", x=0, y=0), abut.Support("bar.top", y=2.0)],
        plane="strain",
        kinematics="finite",
        removals=[abut.Removal("right", since=0.5)],
        solve=abut.SolveOptions(times=(0.25, 0.5, 0.75, 1.0)),
    )
    solution = abut.solve(model)
    x = model.mesh.points[:, 0]
    last = solution.steps[-1].stress[:, 1]
    assert last[x < 0.3] == pytest.approx(YOUNG * np.log(3.0) / 3.0, rel=1e-5)
    assert last[x > 0.7] == pytest.approx(YOUNG * np.log(1.5) / 1.5, rel=1e-5)
    assert np.abs(solution.steps[1].stress[x > 0.7]).max() == 0.0


@pytest.mark.parametrize(("strained", "stretch"), [(True, 3.0), (False, 1.5)])
def test_strained_bodies_come_back_as_they_were_laid_out(strained, stretch):
    """Two bars, pulled to twice and then three times their length, one away up to twice: it carries the stress of three
    times its length, or of one and a half."""
    mesh = make.join(
        {name: make.rectangle((x, x + 1.0), (0.0, 1.0), (2, 2)) for name, x in (("one", 0.0), ("two", 2.0))}
    )
    sides = [abut.Support(f"{bar}.bottom", x=0, y=0) for bar in ("one", "two")]
    model = abut.Model(
        mesh,
        [abut.Solid(bar, abut.Hencky(YOUNG, 0.0)) for bar in ("one", "two")],
        [*sides, *(abut.Support(f"{bar}.top", y=2.0) for bar in ("one", "two"))],
        plane="strain",
        kinematics="finite",
        removals=[abut.Removal("two", until=0.25, since=0.5, strained=strained)],
        solve=abut.SolveOptions(times=(0.25, 0.5, 0.75, 1.0)),
    )
    last = abut.solve(model).steps[-1].stress[mesh.nodes_of("two"), 1]
    assert last == pytest.approx(YOUNG * np.log(stretch) / stretch, rel=1e-5)


def test_warmth_counts_from_the_return():
    """Held between walls, heated evenly by 100: half of the way before the return, half after it."""
    mesh = make.join(
        {
            "block": make.rectangle((0.0, 1.0), (0.0, 1.0), (2, 2)),
            "other": make.rectangle((2.0, 3.0), (0.0, 1.0), (2, 2)),
        }
    )
    steel = abut.LinearElastic(YOUNG, 0.0, expansion=1e-4)
    model = abut.Model(
        mesh,
        [abut.Solid(name, steel, temperature=60.0) for name in ("block", "other")],
        [abut.Support(f"{name}.{side}", x=0, y=0) for name in ("block", "other") for side in ("bottom", "top")],
        [abut.Temperature(name, 40.0) for name in ("block", "other")],
        plane="stress",
        removals=[abut.Removal("other", since=0.5)],
        solve=abut.SolveOptions(times=(0.5, 1.0)),
    )
    solution = abut.solve(model)
    at = {name: mesh.nodes_of(f"{name}.top") for name in ("block", "other")}
    stress = {name: float(solution.steps[-1].stress[nodes, 1].mean()) for name, nodes in at.items()}
    assert stress["block"] == pytest.approx(-YOUNG * 1e-2, rel=0.05)  # walls that hold x, too: a little more at corners
    assert stress["other"] == pytest.approx(stress["block"] / 2.0, rel=1e-9)


def test_metal_comes_back_without_history():
    """Stretched into flow twice as far as the yield strain, away, back, and stretched by half of that strain: elastic."""
    mesh = make.join(
        {"bar": make.rectangle((0.0, 1.0), (0.0, 1.0), (1, 2)), "aside": make.rectangle((2.0, 3.0), (0.0, 1.0), (1, 2))}
    )
    limit = 1e-3
    metal = abut.Plastic(YOUNG, 0.0, ((0.0, YOUNG * limit),))
    pull = abut.Amplitude(((0.0, 0.0), (0.25, 2.0), (0.5, 2.0), (1.0, 2.5)))
    model = abut.Model(
        mesh,
        [abut.Solid(name, metal) for name in ("bar", "aside")],
        [
            item
            for name in ("bar", "aside")
            for item in (
                abut.Support(f"{name}.bottom", y=0),
                abut.Support(f"{name}.left", x=0),
                abut.Support(f"{name}.top", y=limit, amplitude=pull),
            )
        ],
        plane="stress",
        removals=[abut.Removal("aside", until=0.25, since=0.5)],
        solve=abut.SolveOptions(times=(0.25, 0.5, 1.0)),
    )
    solution = abut.solve(model)
    aside, bar = (mesh.nodes_of(name) for name in ("aside", "bar"))
    assert solution.steps[0].stress[aside, 1] == pytest.approx(YOUNG * limit, rel=1e-6)
    assert solution.steps[2].stress[aside, 1] == pytest.approx(YOUNG * limit / 2.0, rel=1e-6)
    assert solution.steps[2].stress[bar, 1] == pytest.approx(YOUNG * limit, rel=1e-6)


def test_a_run_that_is_taken_up_again_ends_alike():
    model = _posts([abut.Removal("right", until=0.25, since=0.75)])
    kept = []
    whole = abut.solve(model, on_step=lambda _, saved: kept.append(saved))
    resumed = abut.solve(model, resume=kept[:2])
    assert np.abs(resumed.steps[-1].displacement - whole.steps[-1].displacement).max() == 0.0


@pytest.mark.parametrize(
    ("removal", "word"),
    [
        (lambda: abut.Removal("right"), "not there at any time"),
        (lambda: abut.Removal("right", until=0.5, since=0.4), "expected times"),
        (lambda: abut.Removal("right", until=0.5, released=0.8, since=0.7), "expected times"),
        (lambda: _posts([abut.Removal("rihgt", since=0.5)]), "did you mean 'right'"),
        (lambda: _posts([abut.Removal("beam", since=0.5)]), "is rigid"),
        (
            lambda: _posts([abut.Removal("right", until=0.2), abut.Removal("right", until=0.5, since=0.6)]),
            "twice at once",
        ),
        (lambda: replace(_posts([abut.Removal("left", since=0.5)]), modes=[abut.Frequencies()]), "leave physics"),
    ],
)
def test_what_does_not_fit_is_told(removal, word):
    with pytest.raises(abut.InputError, match=word):
        removal()


@pytest.mark.long
def test_mixed_tetrahedra_that_go_and_come_back() -> None:
    """The posts in space, of material that keeps its volume and may grow sideways: the same springs."""
    parts = {
        name: make.box(x, (0.0, 1.0), (0.0, LENGTH), (2, 2, 3), "tet10")
        for name, x in {"left": (0.0, 1.0), "right": (2.0, 3.0)}.items()
    }
    parts["beam"] = make.box((-0.25, 3.25), (-0.25, 1.25), (LENGTH, LENGTH + 0.5), (3, 2, 1))
    solution = abut.solve(
        abut.Model(
            make.join(parts),
            [abut.Solid(name, abut.LinearElastic(YOUNG, 0.5)) for name in ("left", "right")],
            [
                abut.Support(f"{name}.{side}", **{axis: 0})
                for name in ("left", "right")
                for side, axis in {"bottom": "z", "left": "x", "front": "y"}.items()
            ],
            [abut.Force("beam", (0.0, 0.0, -FORCE), amplitude=STEADY)],
            [abut.Contact(f"{name}.top", "beam.bottom", name=name) for name in ("left", "right")],
            rigid=[abut.Rigid("beam", x=0, y=0, rx=0, ry=0, rz=0)],
            removals=[abut.Removal("right", until=0.25, since=0.75)],
            solve=abut.SolveOptions(times=TIMES),
        )
    )
    assert solution.converged
    both, alone = FORCE / 2.0 / STIFFNESS, FORCE / STIFFNESS
    way = [-step.rigid["beam"].displacement[2] for step in solution.steps]
    assert way == pytest.approx([both, alone, alone, (alone + both) / 2.0], rel=1e-6)
