"""Preloads: sections that abut finds, cuts open and draws together, against bars and springs in closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.benchmarks.preloads import sleeve
from abut.errors import InputError
from abut.mesh.make import box, join, rectangle

YOUNG, LENGTH, AREA = 1000.0, 10.0, 2.0
EXACT = 1e-9  # stresses are uniform: linear cells have them exactly


def bar(preload, cell="hex8", kinematics="small", **more):
    """Clamped at both ends, nu = 0."""
    mesh = join({"bar": box([0, 1], [0, 2], [0, LENGTH], cells=[2, 2, 7], cell=cell)})
    return abut.Model(
        mesh,
        [abut.Solid("bar", abut.LinearElastic(YOUNG, 0.0))],
        [abut.Support("bar.bottom", x=0, y=0, z=0), abut.Support("bar.top", x=0, y=0, z=0)],
        preloads=[preload],
        kinematics=kinematics,
        **more,
    )


PLANE = {"body": "bar", "point": (0.5, 1.0, 4.0), "normal": (0, 0, 2)}


@pytest.mark.parametrize("cell", ["hex8", "tet4", "tet10", "hex20"])
@pytest.mark.parametrize(
    "where", [{"body": "bar"}, PLANE, {**PLANE, "normal": (0, 0, -1)}], ids=["found", "plane", "other"]
)
def test_a_shortening_stretches_the_bar(cell, where):
    """E A d / L, wherever the section is, through whatever cells it runs."""
    solution = abut.solve(bar(abut.Preload("bolt", shortening=0.02, **where), cell))
    result = solution.steps[-1].preloads["bolt"]
    assert result.shortening == pytest.approx(0.02, rel=EXACT)
    assert result.tension == pytest.approx(YOUNG * AREA * 0.02 / LENGTH, rel=EXACT)
    assert solution.steps[-1].reactions["bar.bottom"][2] == pytest.approx(-result.tension, rel=1e-8)
    assert np.abs(result.moment).max() < 1e-8
    if cell.startswith("hex"):  # at the section too
        assert solution.steps[-1].stress[:, 2] == pytest.approx(result.tension / AREA, rel=1e-6)


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_a_force_is_what_the_section_carries(kinematics):
    solution = abut.solve(bar(abut.Preload("bolt", body="bar", force=4.0), kinematics=kinematics))
    result = solution.steps[-1].preloads["bolt"]
    assert result.tension == pytest.approx(4.0, rel=1e-8)
    assert result.shortening == pytest.approx(
        4.0 * LENGTH / (YOUNG * AREA), rel=EXACT if kinematics == "small" else 5e-3
    )
    assert all(check.passed for check in solution.certificate)


def test_the_found_section_is_that_of_the_shank():
    """A rod with a thick head: the middle of the thin part, along the axis."""
    rod, head = (
        rectangle((0.0, 1.0), (0.0, 20.0), (2, 10), "quad4"),
        rectangle((0.0, 4.0), (20.0, 23.0), (8, 3), "quad4"),
    )
    mesh = join({"rod": rod, "head": head})
    nodes = (
        np.concatenate([mesh.blocks[0].nodes, mesh.blocks[1].nodes]) if len(mesh.blocks) > 1 else mesh.blocks[0].nodes
    )
    _, first, inverse = np.unique(np.round(mesh.points, 9), axis=0, return_index=True, return_inverse=True)
    glued = abut.Mesh(
        mesh.points[first], (abut.mesh.mesh.CellBlock("quad4", inverse.ravel()[nodes].astype(np.int32)),),
        {"bolt": np.arange(len(nodes))}, {"bottom": mesh.surfaces["rod.bottom"], "top": mesh.surfaces["head.top"]},
    )  # fmt: skip
    model = abut.Model(
        glued, [abut.Solid("bolt", abut.LinearElastic(YOUNG, 0.3))],
        [abut.Support("bottom", x=0, y=0), abut.Support("top", x=0, y=0)], plane="strain",
        preloads=[abut.Preload("bolt", body="bolt", shortening=0.01)],
    )  # fmt: skip
    (preload,) = model.preloads
    assert abs(preload.normal[1]) == pytest.approx(1.0, abs=0.02)
    assert preload.point[1] == pytest.approx(10.0, abs=1.5)


def test_a_surface_between_cells_is_a_section_and_a_cut_mesh_stays_cut():
    mesh = join({"bar": box([0, 1], [0, 2], [0, LENGTH], cells=[1, 1, 5])})
    mesh = replace(mesh, surfaces={**mesh.surfaces, "inside": np.array([[1, 5]])})
    given = bar(abut.Preload("other", shortening=0.02, **PLANE))
    model = replace(given, mesh=mesh, preloads=[abut.Preload("bolt", surface="inside", shortening=0.02)])
    assert len(model.mesh.points) == len(mesh.points) + 4
    again = replace(model, plane=None)
    assert len(again.mesh.points) == len(model.mesh.points)
    result = abut.solve(again).steps[-1].preloads["bolt"]
    assert result.tension == pytest.approx(YOUNG * AREA * 0.02 / LENGTH, rel=EXACT)


@pytest.mark.parametrize("lock", [None, 0.5])
def test_a_bolt_under_a_free_head_is_stretched_evenly(lock):
    """What contact alone holds moves with the shortening: two facets across the bolt, another body under the head."""
    model = replace(sleeve("small", cells=2), solve=abut.SolveOptions(steps=2))
    model = replace(model, preloads=[replace(model.preloads[0], lock=lock)])
    step = abut.solve(model).steps[-1]
    top = step.displacement[model.mesh.nodes_of("bolt.top"), 1]
    assert top == pytest.approx(-10000.0 * 50.0 / (210e3 * 400.0), rel=1e-6)
    assert step.preloads["bolt"].shortening == pytest.approx(0.0297619048, rel=1e-6)


def test_a_locked_bolt_goes_on_after_a_restart():
    model = replace(sleeve("small", apart=6000.0), solve=abut.SolveOptions(steps=4))
    saved = []
    whole = abut.solve(model, on_step=lambda _, record: saved.append(record))
    assert [step.factor for step in whole.steps] == [0.25, 0.5, 0.75, 1.0]
    rest = abut.solve(model, resume=saved[:2])
    for step, again in zip(whole.steps, rest.steps):
        assert again.preloads["bolt"].tension == pytest.approx(step.preloads["bolt"].tension, rel=1e-9)
    assert whole.steps[2].preloads["bolt"].tension == pytest.approx(10600.0, rel=1e-6)


def test_two_bolts_one_after_the_other():
    """Tightening the second one takes from the first, which is locked: springs side by side under a rigid head."""
    one = sleeve("small")
    first = replace(one.preloads[0], lock=0.5)
    later = replace(
        one, loads=[abut.Force("head", (0.0, -6000.0), abut.Amplitude(((0.5, 0.0), (1.0, 1.0))))], preloads=[first]
    )
    tension = abut.solve(later).steps[-1].preloads["bolt"].tension
    assert tension == pytest.approx(10000.0 - 1200.0, rel=1e-6)


@pytest.mark.parametrize(
    ("preload", "words"),
    [
        ({"body": "bar"}, "either force or shortening"),
        ({"force": 1.0}, "either body or surface"),
        ({"body": "bar", "force": 1.0, "point": (0, 0, 1)}, "point and normal go together"),
        ({"body": "bar", "shortening": 1.0, "lock": 0.5}, "lock goes with force"),
        ({"body": "bar", "force": 1.0, "lock": 1.0}, "before 1, the end of the run"),
        ({"body": "rod", "force": 1.0}, "no body named 'rod'"),
        ({**PLANE, "point": (0, 0, 40), "force": 1.0}, "goes through no cells"),
        ({"surface": "bar.bottom", "force": 1.0}, "outside of a body"),
        ({"body": "bar", "force": 1.0, "point": (0.5, 1), "normal": (0, 1)}, "expected 3 numbers"),
    ],
)
def test_refused(preload, words):
    with pytest.raises(InputError, match=words):
        bar(abut.Preload("bolt", **preload))


def test_a_section_that_supports_hold_open_is_refused():
    model = bar(abut.Preload("bolt", force=1.0, **PLANE))
    sides = abut.Support("bar.front", z=0)
    with pytest.raises((InputError, abut.SingularModelError), match="hold both sides"):
        abut.solve(replace(model, supports=[*model.supports, sides]))


def test_a_model_without_the_preload_of_its_cut_mesh_is_refused():
    """Its mesh is open there, and nothing would hold both sides together."""
    model = bar(abut.Preload("bolt", "bar", force=3.0))
    with pytest.raises(InputError, match=r"cut open at the section of 'bolt'.*shortening = 0"):
        replace(model, preloads=[])
    closed = replace(model, preloads=[replace(model.preloads[0], force=None, shortening=0.0)])
    assert abut.solve(closed).steps[-1].preloads["bolt"].tension == pytest.approx(0.0, abs=1e-12)
    whole = bar(abut.Preload("bolt", "bar", force=3.0)).mesh
    with pytest.raises(InputError, match="of 'bolt'"):
        replace(model, preloads=[abut.Preload("nut", "bar", force=1.0)], mesh=whole)
