"""Springs: beds, ties to the ground and between points, tables and weak ones, against bars and springs in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.mesh.make import box, join, rectangle
from models.bars_in_a_row import bars_in_a_row

YOUNG, LENGTH, AREA = 1000.0, 4.0, 2.0
EXACT = 1e-8  # stresses are uniform, and springs integrated exactly


def column(springs, force=-10.0, cell="hex20", **more):
    """Upright on its springs, nu = 0, pressed from above."""
    mesh = join({"column": box([0, 1], [0, 2], [0, LENGTH], cells=[2, 2, 2], cell=cell)})
    return abut.Model(
        mesh,
        [abut.Solid("column", abut.LinearElastic(YOUNG, 0.0))],
        [abut.Support("column.left", x=0), abut.Support("column.front", y=0)],
        [abut.Force("column.top", (0.0, 0.0, force))],
        springs=springs,
        **more,
    )


def top(solution):
    mesh = solution.model.mesh
    return solution.displacement[mesh.nodes_of("column.top"), 2].mean()


SPRINGS = {
    "normal": abut.Spring("bed", "column.bottom", normal=50.0),
    "per area": abut.Spring("bed", "column.bottom", normal=25.0, per_area=True),
    "axis": abut.Spring("bed", "column.bottom", z=50.0),
    "table": abut.Spring("bed", "column.bottom", normal=((-1.0, 0.0), (0.0, 0.0), (0.1, 5.0))),
}


@pytest.mark.parametrize("spring", SPRINGS.values(), ids=SPRINGS)
@pytest.mark.parametrize("cell", ["hex8", "hex20", "tet10"])
def test_a_column_on_its_bed(spring, cell):
    solution = abut.solve(column([spring], cell=cell))
    assert top(solution) == pytest.approx(-10.0 / 50.0 - 10.0 * LENGTH / (YOUNG * AREA), rel=EXACT)
    step = solution.steps[-1]
    assert step.springs["bed"] == pytest.approx([0.0, 0.0, 10.0], abs=1e-7)
    assert step.reaction[2] == pytest.approx(10.0, rel=EXACT)
    assert step.stress[:, 2] == pytest.approx(-10.0 / AREA, rel=1e-6)  # on the bed too
    assert all(check.passed for check in solution.certificate)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_a_table_bends_and_goes_on(kinematics):
    """Stiffness 100 up to 4, then 20: 10 = 4 + 20 (u - 0.04)."""
    spring = abut.Spring("bed", "column.bottom", z=((-0.04, -4.0), (0.04, 4.0), (0.05, 4.2)), y=1.0)
    soft = replace(spring, z=((-0.05, -4.2), (-0.04, -4.0), (0.04, 4.0), (0.05, 4.2)))
    model = column([soft], kinematics=kinematics)
    solution = abut.solve(model)
    bottom = solution.displacement[model.mesh.nodes_of("column.bottom"), 2].mean()
    assert bottom == pytest.approx(-0.34, rel=1e-6)
    assert solution.steps[-1].springs["bed"][2] == pytest.approx(10.0, rel=1e-6)


def test_two_bars_with_a_spring_between_their_ends():
    """In a row along x: bar, spring along the line between two nodes, bar: u = F (2 L / E A + 1 / k)."""
    mesh, sides = bars_in_a_row()
    model = abut.Model(
        mesh,
        [abut.Solid(bar, abut.LinearElastic(YOUNG, 0.0)) for bar in mesh.bodies],
        [abut.Support("one.left", x=0), *sides],
        [abut.Force("two.right", (5.0, 0.0, 0.0))],
        springs=[abut.Spring("link", "left end", to="right end", along=20.0)],
    )
    solution = abut.solve(model)
    moved = solution.displacement[mesh.nodes_of("two.right"), 0]
    assert moved == pytest.approx(5.0 * (8.0 / YOUNG + 1.0 / 20.0), rel=EXACT)
    assert solution.steps[-1].springs["link"] == pytest.approx([5.0, 0.0, 0.0], abs=1e-7)


def _plate_on_a_spring(point, law, force):
    """A stiff square that a spring to a fixed point holds, moved along y."""
    mesh = join({"square": rectangle([0, 1], [0, 1], cells=[1, 1])})
    mesh = replace(mesh, node_sets={"corner": mesh.nodes_of("square.bottom")[:1], "all": np.arange(4)})
    return abut.Model(
        mesh,
        [abut.Solid("square", abut.Hencky(1e9, 0.0))],
        [abut.Support("all", x=0)],
        [abut.Traction("square.top", (0.0, force))],
        plane="strain",
        kinematics="finite",
        springs=[abut.Spring("spring", "corner", point=point, along=law)],
    )


@pytest.mark.parametrize("law", [50.0, ((-9.0, -450.0), (9.0, 450.0))], ids=["stiffness", "table"])
def test_a_spring_turns_with_its_ends_at_large_displacements(law):
    """Moved by v from a point a aside and b below: the force along v is k (l - l_0) (b + v) / l, l^2 = a^2 + (b + v)^2."""
    arm, low, rise = 2.0, 1.0, 3.0
    length = np.hypot(arm, low + rise)
    pull = 50.0 * (length - np.hypot(arm, low)) * np.array([-arm, low + rise]) / length
    solution = abut.solve(_plate_on_a_spring((-arm, -low), law, pull[1]))
    assert solution.displacement[:, 1] == pytest.approx(rise, rel=1e-6)
    assert solution.steps[-1].springs["spring"] == pytest.approx([pull[0], -pull[1]], rel=1e-6)


def test_weak_springs_are_judged_by_what_they_carry():
    """A column that nothing else holds along z, pulled by almost nothing, or by all."""
    weak = abut.Spring("weak", "column.bottom", z=1e-3, weak=True)
    loads = [abut.Traction("column.top", (0.0, 0.0, 100.0)), abut.Traction("column.bottom", (0.0, 0.0, -100.0))]
    held = abut.solve(replace(column([weak]), loads=loads))
    assert next(check for check in held.certificate if check.name == "weak springs").passed
    pulled = abut.solve(replace(column([weak]), loads=[abut.Traction("column.top", (0.0, 0.0, 1e-3))]))
    assert not next(check for check in pulled.certificate if check.name == "weak springs").passed


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"on": "column.bottom"}, "no stiffness"),
        ({"on": "column.bottom", "z": -1.0}, "expected a number > 0|positive|> 0"),
        ({"on": "column.bottom", "z": ((0, 0), (1, -1))}, "must not decrease"),
        ({"on": "column.bottom", "along": 1.0}, "along goes with to"),
        ({"on": "nothing", "z": 1.0}, "no surface or node set named 'nothing'"),
        ({"on": "column.bottom", "to": "column.top", "z": 1.0}, "no node set named"),
    ],
)
def test_refused(given, words):
    with pytest.raises(InputError, match=words):
        column([abut.Spring("spring", **given)])


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_to_a_fixed_point(kinematics):
    """Springs at the nodes of the foot along (3, 0, 4) / 5 carry 10 upward, and about three quarters of that across."""
    model = column([], kinematics=kinematics)
    mesh = model.mesh
    foot = {f"foot-{i}": [node] for i, node in enumerate(mesh.nodes_of("column.bottom"))}
    sets = {name: np.array(nodes) for name, nodes in foot.items()}
    springs = [
        abut.Spring(name, name, along=100.0 / len(sets), point=tuple(mesh.points[nodes[0]] - [3.0, 0.0, 4.0]))
        for name, nodes in sets.items()
    ]
    model = replace(
        model,
        mesh=replace(mesh, node_sets={**sets, "all": np.arange(len(mesh.points))}),
        supports=[abut.Support("all", x=0, y=0)],
        springs=springs,
    )
    solution = abut.solve(model)
    carried = sum(solution.steps[-1].springs[name] for name in sets)
    sunk = {n: solution.displacement[at[0], 2] if kinematics == "finite" else 0.0 for n, at in sets.items()}
    across = sum(
        solution.steps[-1].springs[name][2] * 3.0 / (4.0 + sunk[name]) for name in sets
    )  # they turn with the foot
    assert carried == pytest.approx([across, 0.0, 10.0], abs=1e-6)


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({"along": 1.0, "point": (0, 0)}, r"springs\[0\]\.point: expected 3 numbers"),
        ({"x": 1.0, "point": (0, 0, 0)}, "point goes with along alone"),
        ({"along": 1.0, "point": (0, 0, 0), "to": "b"}, "point goes with along alone"),
        ({"along": 1.0}, "or with point"),
    ],
)
def test_points_that_do_not_fit(given, says):
    model = column([])
    mesh = replace(model.mesh, node_sets={"a": np.array([0])})
    with pytest.raises(InputError, match=says):
        replace(model, mesh=mesh, springs=[abut.Spring("s", "a", **given)])
