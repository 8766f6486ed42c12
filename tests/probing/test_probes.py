"""Probes: what a step says at points, along lines and on sets is what theory says there, and is the same in all units."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.cells import CELLS
from abut.job import load_job
from abut.mesh import make
from abut.mesh.exterior import outside_of_body
from abut.mesh.mesh import Mesh
from abut.mesh.quadrature import gauss_rule
from abut.mesh.reference import reference_nodes
from abut.probing import boxes, find_place, read
from abut.probing.cells import locate
from abut.probing.closest_points import feet
from abut.probing.inverse import nearest
from abut.solution import Step
from models import patch
from models.probes import JOB, distorted, free, two_blocks

PLANE = ("tri3", "tri6", "quad4", "quad8", "quad9")
SOLID = ("tet4", "tet10", "hex8", "hex20", "hex27", "wedge6", "wedge15")
QUADRATIC = tuple(cell for cell in (*PLANE, *SOLID) if CELLS[cell].degree == 2)


def in_cells(mesh: Mesh, count: int, seed: int = 0) -> np.ndarray:
    """Points anywhere in the cells, on faces, edges and corners too: from random and extreme reference coordinates."""
    rng = np.random.default_rng(seed)
    found = []
    for b in mesh.blocks:
        corners = reference_nodes(b.kind)
        for nodes in b.nodes[rng.integers(len(b.nodes), size=count)]:
            share = rng.dirichlet(np.full(len(corners), 0.3))
            places = np.vstack([share @ corners, corners[rng.integers(len(corners))]])
            shapes, _ = abut._core.shape_functions(CELLS[b.kind].code, np.ascontiguousarray(places))
            found.append(shapes @ mesh.points[nodes])
    return np.concatenate(found)


def step_of(model: abut.Model, displacement: np.ndarray, stress: np.ndarray) -> Step:
    """A step with given fields, as if solved."""
    zero = np.zeros(model.dim)
    return Step(1, 1.0, True, (), displacement, stress, zero, {}, zero, ())


@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize("cell", [*PLANE, *SOLID])
def test_linear_fields_are_met_anywhere(cell: str, curved: bool) -> None:
    """Shape functions hold linear functions of position on curved cells too: at any point, on faces, edges and corners,
    displacement and stress come back to rounding (1e-12), and von Mises is that of the stress."""
    mesh = distorted(cell, curved and cell in QUADRATIC)
    dim = mesh.dim
    rng = np.random.default_rng(1)
    slope, rate = rng.normal(size=(dim, dim)), rng.normal(size=(dim, 6))
    points = in_cells(mesh, 20)
    model = free(mesh, *(abut.Probe(f"p{i}", at=tuple(x)) for i, x in enumerate(points)))
    step = step_of(model, mesh.points @ slope, 1.0 + mesh.points @ rate)
    around = boxes(mesh)
    for probe, x in zip(model.probes, points):
        result = read(find_place(model, probe, around), step)
        assert result.values["displacement"][0] == pytest.approx(x @ slope, abs=1e-12)
        assert result.values["stress"][0] == pytest.approx(1.0 + x @ rate, abs=1e-12)
        xx, yy, zz, xy, yz, zx = 1.0 + x @ rate
        mises = np.sqrt(0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * (xy**2 + yz**2 + zx**2))
        assert result.values["von_mises"][0] == pytest.approx(mises, rel=1e-11)
        assert set(result.values) == {"displacement", "stress", "von_mises"}


@pytest.mark.parametrize("cell", QUADRATIC)
def test_reference_coordinates_come_back(cell: str) -> None:
    """Round trip through strongly curved cells, up to those whose map is about to fold over."""
    rng = np.random.default_rng(2)
    nodes = reference_nodes(cell)
    kind = CELLS[cell]
    for _ in range(20):
        x = nodes + np.where(np.arange(len(nodes))[:, None] < kind.corners, 0.05, 0.12) * rng.uniform(
            -1, 1, nodes.shape
        )
        _, slopes = abut._core.shape_functions(kind.code, np.vstack([nodes, gauss_rule(cell, 6)[0]]))
        volume = np.linalg.det(np.einsum("qna,nd->qad", slopes, x))
        if volume.min() < 0.05 * volume.max():
            continue
        xi = rng.dirichlet(np.full(len(nodes), 0.4), 30) @ nodes
        shapes, _ = abut._core.shape_functions(kind.code, np.ascontiguousarray(xi))
        found, miss = nearest(cell, np.broadcast_to(x, (30, *x.shape)), shapes @ x)
        assert np.abs(found - xi).max() < 1e-11
        assert np.abs(miss).max() < 1e-13


@pytest.mark.parametrize("cell", ["tri3", "quad8", "tet10", "hex20", "wedge6"])
def test_points_outside_are_found_to_be(cell: str) -> None:
    """Beside faces, edges and corners by 1 % of the model; a thousandth of a cell's size counts as on the surface."""
    mesh = distorted(cell)
    around = boxes(mesh)
    rng = np.random.default_rng(3)
    inner = rng.uniform(0.0, 1.0, (60, mesh.dim))
    assert len(locate(mesh, around, inner).outside) == 0
    outer = inner.copy()
    axis = rng.integers(mesh.dim, size=60)
    high = rng.integers(2, size=60)
    for size, wrong in ((0.01, 60), (1e-4, 0)):
        outer[np.arange(60), axis] = np.where(high, 1.0 + size, -size)
        inside = locate(mesh, around, outer)
        assert len(inside.outside) == wrong
        if not wrong:
            weights = inside.weights
            assert np.abs(weights.sum(axis=1) - 1.0).max() < 1e-13
            assert np.abs(weights @ mesh.points - outer).max() < 2e-4
    corner = np.full((1, mesh.dim), 1.0 + 1e-13)
    assert len(locate(mesh, around, corner).outside) == 0


def test_many_cells_and_points_agree_with_brute_force() -> None:
    """The cell found is one whose box holds the point, for points in any order and some of them equal."""
    mesh = make.join({"a": make.box(cells=[6, 5, 4], cell="hex8")})
    rng = np.random.default_rng(4)
    points = rng.uniform(0.0, 1.0, (300, 3))
    points[100:120] = points[7]
    weights = locate(mesh, boxes(mesh), points).weights
    assert np.abs(weights @ mesh.points - points).max() < 1e-13
    for row, x in enumerate(points):
        used = mesh.points[weights[row].indices]
        assert (used.min(axis=0) <= x + 1e-12).all()
        assert (used.max(axis=0) >= x - 1e-12).all()
        assert (np.ptp(used, axis=0) < np.array([1 / 6, 1 / 5, 1 / 4]) + 1e-12).all()


@pytest.mark.parametrize("lower", [*PLANE, *SOLID])
def test_uniform_pressure_is_uniform_along_a_line(lower: str) -> None:
    """The contact patch test read by probes: along the interface and beyond its ends, on the whole contactor, on the target,
    at corners; stress and displacement where the bodies are, all to 1e-9 of theory."""
    dim = CELLS[lower].dim
    upper = "quad9" if dim == 2 else "hex20"
    model = patch.model(patch.two_blocks(lower, upper, ((3,) * dim, (4,) * dim)), rotate=False)
    middle = [0.37] * (dim - 2)
    line = ([0.0, *middle, 1.0], [1.0, *middle, 1.0])
    longer = ([-0.25, *middle, 1.0], [1.25, *middle, 1.0])
    model = replace(
        model,
        probes=(
            abut.Probe("along", line=line, points=7, body="lower"),
            abut.Probe("beyond", line=longer, points=7, of=["pressure", "gap"]),
            abut.Probe("set", on="lower.top"),
            abut.Probe("target", on="upper.bottom"),
            abut.Probe("upper side", line=line, points=5, body="upper"),
            abut.Probe("corner", at=[0.0] * (dim - 1) + [1.0], body="lower"),
            abut.Probe("inside", at=[0.41] * (dim - 1) + [1.37]),
            abut.Probe("above", line=([0.2, *middle, 1.4], [0.8, *middle, 1.4]), points=4, of=["pressure"]),
        ),
    )
    solution = abut.solve(model)
    own = {result.name: result for result in solution.probes}
    load = model.loads[0].value
    strain = load / 1.0
    side, along = (
        (patch.POISSON * (1 + patch.POISSON) * strain, -(1 - patch.POISSON**2) * strain)
        if dim == 2
        else (patch.POISSON * strain, -strain)
    )
    for name in ("along", "set", "target", "upper side", "corner", "above"):
        assert own[name].values["pressure"] == pytest.approx(load, rel=1e-9), name
    for name in ("along", "set", "corner"):
        assert np.abs(own[name].values["gap"]).max() < 1e-9 * strain, name
    for name in ("target", "upper side", "inside"):
        assert "gap" not in own[name].values
    beyond = own["beyond"].values["pressure"]
    assert np.isnan(beyond).tolist() == [True] + [False] * 5 + [True]
    assert beyond[1:-1] == pytest.approx(load, rel=1e-9)
    assert set(own["beyond"].values) == {"pressure", "gap"}
    assert set(own["inside"].values) == {"displacement", "stress", "von_mises"}
    for name in ("along", "upper side", "inside", "set"):
        result = own[name]
        x = result.points
        stress = np.zeros((len(x), 6))
        stress[:, dim - 1] = -load
        stress[:, 2] -= patch.POISSON * load if dim == 2 else 0.0
        exact = np.column_stack([side * x[:, :-1], along * x[:, -1:]])
        assert np.abs(result.values["displacement"] - exact).max() < 1e-9 * strain, name
        assert np.abs(result.values["stress"] - stress).max() < 1e-8 * load, name
    assert own["along"].distance == pytest.approx(np.linspace(0.0, 1.0, 7), abs=1e-15)
    assert (own["set"].nodes == model.mesh.nodes_of("lower.top")).all()
    assert any("projected" in note and "'above'" in note for note in solution.notes)


def parabolas(at: np.ndarray, ends: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Values (n,) of the parabolas through values (m, 3) at the ends (m, 2) of facets, and their middles."""
    result = np.empty(len(at))
    for k, x in enumerate(at):
        s = (2.0 * x - ends.sum(axis=1)) / (ends[:, 1] - ends[:, 0])
        facet = int(np.argmin(np.abs(s)))
        t = s[facet]
        result[k] = values[facet] @ [0.5 * t * (t - 1.0), 0.5 * t * (t + 1.0), 1.0 - t**2]
    return result


def test_jumps_are_read_as_means() -> None:
    """Pressures are continuous, between nodes as the facet's own functions, also of P0. Where gaps jump, the mean is read;
    of facets without a gap only the other counts."""
    model = two_blocks(
        abut.Probe("line", line=([0.5, 1], [1.5, 1]), points=7, of=["pressure", "gap"]),
        abut.Probe("set", on="upper.bottom"),
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", pressure="P0")],
    )
    solution = abut.solve(model)
    contact = solution.contacts[0]
    x = contact.contactor.points[contact.contactor.nodes[:, :2]][..., 0]
    order = np.argsort(x.ravel())
    line, own = solution.probes
    exact = parabolas(line.points[:, 0], x, contact.pressure[:, :3])
    assert line.values["pressure"] == pytest.approx(exact, rel=1e-12)
    at = dict(zip(own.points[:, 0].round(6), own.values["pressure"]))
    node = round(0.5 + 1 / 3, 6)
    assert at[node] == pytest.approx(
        np.interp(node, x.ravel()[order], contact.pressure[:, :2].ravel()[order]),
        rel=1e-5,  # the key is rounded
    )
    gap = contact.gap.copy()
    gap[np.argsort(x.mean(axis=1))[0]] = np.nan
    step = replace(solution.steps[-1], contacts=(replace(contact, gap=gap),))
    read_again = read(find_place(model, model.probes[0]), step).values["gap"]
    assert np.isnan(read_again).tolist() == [True, True] + [False] * 5


def test_hertz_beneath_a_cylinder() -> None:
    """Stress below the middle of a line contact: sigma_y = -p0 / (1 + (z/a)^2)^(1/2), largest shear 0.30 p0 at 0.79 a; the
    pressure along the top is the ellipse; the cylinder is no half-space, hence 3 % of p0."""
    path = JOB.parents[1] / "hertz-line" / "quad8.toml"
    peak, half = 3585.36, 6.2146
    model = replace(
        load_job(path).model,
        probes=(
            abut.Probe("axis", line=([0, 0], [0, -2 * half]), points=21, body="block", of=["stress"]),
            abut.Probe("top", line=([-0.8 * half, 0], [0.8 * half, 0]), points=41, of=["pressure", "gap"]),
            abut.Probe("round", line=([-0.8 * half, 0], [0.8 * half, 0]), points=41, of=["pressure"], body="cylinder"),
        ),
    )
    axis, top, carried = abut.solve(model).probes
    z = axis.distance / half
    xx, yy = axis.values["stress"][:, 0], axis.values["stress"][:, 1]
    assert np.abs(yy[1:] + peak / np.sqrt(1 + z[1:] ** 2)).max() < 0.03 * peak
    shear = 0.5 * (xx - yy)
    assert shear.max() == pytest.approx(0.30 * peak, rel=0.06)  # nodal averages of cells a fifth of a wide
    assert z[np.argmax(shear)] == pytest.approx(0.79, abs=0.11)
    s = (top.distance - 0.8 * half) / half
    for values in (top.values["pressure"], carried.values["pressure"]):
        assert np.abs(values - peak * np.sqrt(1 - s**2)).max() < 0.05 * peak


def test_feet_on_a_kinked_and_bent_surface() -> None:
    """Above the edge of a convex kink the foot is the edge, not beside; beyond the rim there is none; on a circle the foot
    of a point outside is on its own radius."""
    mesh = make.join({"a": make.box(cells=[2, 2, 2])})
    rows = np.concatenate([mesh.surfaces["a.top"], mesh.surfaces["a.right"]])
    surface = mesh.facets(rows)
    points = np.array(
        [[1.1, 0.3, 1.1], [1.1, 0.5, 1.2], [0.3, 0.3, 1.5], [-0.1, 0.3, 1.0], [0.5, 1.2, 1.0], [1.1, 0.0, 1.1]]
    )
    own = feet(surface, points)
    assert own.beside.tolist() == [False, False, False, True, True, False]
    assert own.distance[:4] == pytest.approx([0.02**0.5, 0.05**0.5, 0.5, 0.1], rel=1e-12)
    used = surface.points[np.maximum(surface.nodes[own.facet], 0)]
    x = np.einsum("kn,knd->kd", own.weights, used)
    assert np.abs(x[own.point == 0] - [1.0, 0.3, 1.0]).max() < 1e-12
    disc = make.join({"d": make.disc(radius=1.0, cells=6, cell="quad8")})
    surface = disc.facets(outside_of_body(disc, "d"))
    angle = np.linspace(0.1, 6.0, 17)
    own = feet(surface, 1.4 * np.column_stack([np.cos(angle), np.sin(angle)]))
    assert not own.beside.any()
    assert own.distance == pytest.approx(0.4, abs=2e-3)  # a circle by parabolas


def test_which_body_is_read() -> None:
    """On the interface of two bodies the first in the mesh is read, with a note, or the one asked for."""
    at = [1.0, 1.0]
    solution = abut.solve(
        two_blocks(abut.Probe("a", at=at), abut.Probe("b", at=at, body="upper"), abut.Probe("c", at=at, body="lower"))
    )
    a, b, c = solution.probes
    mesh = solution.model.mesh
    lower = mesh.nodes_of("lower")
    (node,) = lower[np.linalg.norm(mesh.points[lower] - at, axis=1) < 1e-9]
    assert a.values["displacement"][0] == pytest.approx(solution.displacement[node], abs=1e-15)
    assert (a.values["stress"] == c.values["stress"]).all()
    assert np.abs(a.values["stress"] - b.values["stress"]).max() > 1e-6
    (note,) = (text for text in solution.notes if "probe" in text)
    assert note == "probe 'a': it lies in 'lower' and 'upper'; read in 'lower' (body = \"upper\" for the other)"


def test_every_step_has_its_own_values() -> None:
    """Where contact does not change, everything is proportional to the time."""
    model = two_blocks(abut.Probe("spot", at=[1.0, 0.5]), solve=abut.SolveOptions(times=(0.25, 1.0)))
    quarter, whole = (step.probes[0].values for step in abut.solve(model).steps)
    for name in ("displacement", "stress", "von_mises"):
        assert 4.0 * quarter[name] == pytest.approx(whole[name], rel=1e-9, abs=1e-9)


def test_units_do_not_matter() -> None:
    """In metres, millimetres and nanometres the same points are inside, and outside."""
    for unit in (1e-9, 1.0, 1e3):
        mesh = distorted("hex20", curved=True)
        mesh = replace(mesh, points=unit * mesh.points)
        around = boxes(mesh)
        points = in_cells(mesh, 10)
        inside = locate(mesh, around, points)
        assert len(inside.outside) == 0
        assert np.abs(inside.weights @ mesh.points - points).max() < 1e-13 * unit
        assert len(locate(mesh, around, points + 10.0 * unit).outside) == len(points)
