"""Node-to-segment contact, kept for comparison: it does what the literature says of it, good and bad."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut._core import shape_functions
from abut.cells import CELLS
from abut.cli import main
from abut.contact.coupling import Coupling
from abut.contact.geometry import by_kind, nodal_normals
from abut.contact.node_to_segment import node_to_segment
from abut.errors import InputError
from abut.mesh.surface import Surface
from models.patch import errors, exact_displacement, model, two_blocks
from models.surfaces import FACETS_3D, SHAPES, grid, line, moved, opposed

TEXT = (Path(__file__).parents[2] / "examples" / "two-blocks" / "job.toml").read_text()
PLANE = ((5, 3), (7, 3))
SOLID = ((2, 3, 2), (3, 2, 2))
DIFFERENT = [
    *(("quad4", "quad4", PLANE), ("quad8", "quad8", PLANE), ("quad9", "tri6", PLANE), ("tri3", "quad4", PLANE)),
    *(("hex8", "hex8", SOLID), ("hex20", "hex20", SOLID), ("tet4", "hex8", SOLID), ("hex27", "tet10", SOLID)),
]


@pytest.mark.parametrize(("lower", "upper", "cells"), DIFFERENT)
def test_one_pass_fails_the_patch_test(lower: str, upper: str, cells: tuple) -> None:
    """Nodal forces at feet are not those of a uniform pressure: errors are of the order of the mesh's difference, far
    above 1e-3 (El-Abbasi and Bathe 2001, section 2), and segments do away with them."""
    mesh = two_blocks(lower, upper, cells)
    pressure, displacement = errors(model(mesh, method="node-to-segment"))
    assert pressure > 1e-3
    assert displacement > 1e-3
    assert max(errors(model(mesh))) < 1e-10


@pytest.mark.parametrize("cell", ["tri3", "quad4", "quad8", "quad9", "tet4", "hex8", "wedge6", "hex27"])
def test_one_pass_is_exact_on_matching_meshes(cell: str) -> None:
    """Nodes face nodes, and the tributary areas are the consistent ones: rounding only."""
    cells = PLANE[0] if cell in ("tri3", "quad4", "quad8", "quad9") else SOLID[0]
    mesh = two_blocks(cell, cell, (cells, cells), distort=0.0)
    assert max(errors(model(mesh, method="node-to-segment"))) < 1e-10


def test_corners_of_quadratic_facets_spoil_even_matching_meshes() -> None:
    """A uniform pressure pulls at the corners of quad8, int N = -1/12 of the facet, which no contact can; it has nothing
    at the corners of tri6. So hex20 fails, and tet10 gets the displacement right, but no pressure at corners."""
    cells = (SOLID[0], SOLID[0])
    assert min(errors(model(two_blocks("hex20", "hex20", cells, distort=0.0), method="node-to-segment"))) > 1e-2
    pressure, displacement = errors(model(two_blocks("tet10", "tet10", cells, distort=0.0), method="node-to-segment"))
    assert displacement < 1e-10
    assert pressure > 1e-2


@pytest.mark.parametrize(("lower", "upper"), [("quad4", "quad4"), ("tri3", "quad4"), ("tri3", "tri3")])
def test_two_passes_pass_in_displacement(lower: str, upper: str) -> None:
    """In 2D with linear facets both sides' nodes together hold the two boundaries at all kinks of either: the linear
    displacement is exact. The pressure is one of many: its passes carry the load together."""
    built = model(two_blocks(lower, upper, PLANE), method="node-to-segment-two-pass")
    solution = abut.solve(built)
    exact = exact_displacement(built)
    assert solution.converged
    assert np.abs(solution.displacement - exact).max() < 1e-10 * np.abs(exact).max()
    first, second = solution.contacts
    assert first.name + " (second pass)" == second.name
    assert first.force - second.force == pytest.approx([0.0, -built.loads[0].value], abs=1e-10 * built.loads[0].value)


def test_two_passes_share_the_pressure_on_matching_meshes() -> None:
    """Every node twice: the smallest of all pressures that balance is a half in each pass."""
    built = model(two_blocks("quad4", "quad4", (PLANE[0], PLANE[0]), distort=0.0), method="node-to-segment-two-pass")
    for contact in abut.solve(built).contacts:
        assert contact.pressure[:, :2] == pytest.approx(0.5 * built.loads[0].value, rel=1e-10)


@pytest.mark.parametrize("cell", ["quad4", "quad8", "hex8", "hex20"])
@pytest.mark.parametrize("method", ["node-to-segment", "node-to-segment-two-pass"])
def test_action_is_reaction(cell: str, method: str) -> None:
    """Forces at feet balance those at nodes, and act on the same lines where the gap is closed; loads and supports too."""
    mesh = two_blocks(cell, cell, PLANE if cell.startswith("quad") else SOLID)
    solution = abut.solve(model(mesh, method=method))
    checks = {c.name: c for c in solution.certificate}
    for name in ("model balance", "force balance", "moment balance"):
        assert checks[name].value < 1e-12, name
    assert "facet moments" not in checks  # nothing is integrated


def foot_points(contactor: Surface, target: Surface, coupling: Coupling) -> tuple[NDArray[np.float64], ...]:
    """Per multiplier: node, normal, gap, and the foot as the operator's own combination of target nodes."""
    rows = np.flatnonzero(coupling.weight)
    gap, normal = coupling.gap[rows] / coupling.weight[rows], nodal_normals(contactor).reshape(-1, contactor.dim)[rows]
    dim, n = contactor.dim, len(contactor.points)
    node = contactor.nodes.reshape(-1)[rows]
    part = coupling.target_part[rows].toarray().reshape(len(rows), -1, dim)[:, n:]
    shapes = -np.einsum("rnd,rd->rn", part, normal) / coupling.weight[rows][:, None]
    assert shapes.sum(axis=1) == pytest.approx(1.0, abs=1e-12)
    return contactor.points[node], normal, gap, shapes @ target.points


def sampled(target: Surface, n: int) -> NDArray[np.float64]:
    """Points all over the facets of a surface."""
    s = np.linspace(-1.0, 1.0, n)
    points = []
    for kind, facets in by_kind(target):
        cell = CELLS[kind]
        xi = np.stack(np.meshgrid(*[s] * cell.dim, indexing="ij"), axis=-1).reshape(-1, cell.dim)
        if cell.dim == 2 and cell.corners == 3:
            xi = xi[(xi >= 0.0).all(axis=1) & (xi.sum(axis=1) <= 1.0)]
        shape, _ = shape_functions(cell.code, np.ascontiguousarray(xi))
        points.append(np.einsum("pn,fnd->fpd", shape, target.points[target.nodes[facets, : cell.nodes]]))
    return np.concatenate([p.reshape(-1, target.dim) for p in points])


@pytest.mark.parametrize("shape", SHAPES)
@pytest.mark.parametrize(("kc", "kt"), [("line2", "line2"), ("line3", "line3"), *zip(FACETS_3D, FACETS_3D[::-1])])
def test_feet_against_brute_force(kc: str, kt: str, shape: str) -> None:
    """Every foot lies on the node's normal at the distance of the gap (rounding), and it is that point of a fine sampling
    of the target which lies nearest to the normal: off by the distance of samples. A node without a foot has no sample
    near its normal."""
    contactor, target = opposed(kc, kt, 1, shape, size=1.1, shift=0.3, gap=0.05)
    coupling, space = node_to_segment(contactor, target)
    x, normal, gap, foot = foot_points(contactor, target, coupling)
    assert foot == pytest.approx(x + gap[:, None] * normal, abs=1e-12)
    n = 400 if contactor.dim == 2 else 61
    samples, apart = sampled(target, n), 4.0 / n
    for own, nv, g in zip(x, normal, gap):
        to = samples - own
        along = to @ nv
        aside = np.linalg.norm(to - along[:, None] * nv, axis=1)
        assert aside.min() < apart
        assert along[aside.argmin()] == pytest.approx(g, abs=apart)
    seen = set(space.node)
    normals = nodal_normals(contactor)
    unseen = [k for k in contactor.node_ids if k not in seen]
    assert space.removed == len(unseen)
    assert len(seen) + len(unseen) == len(contactor.node_ids)
    for k in unseen:
        nv = normals[contactor.nodes == k][0]
        to = samples - contactor.points[k]
        aside = np.linalg.norm(to - (to @ nv)[:, None] * nv, axis=1)
        assert aside.min() > 0.1 / n


def test_feet_on_a_concentric_arc() -> None:
    """Contactor nodes on a circle of radius 1 look outward at one of radius 1.1 (40 parabolas over a quarter turn, off by
    1e-8): the gap is 0.1 wherever the normal points along the radius."""

    def arc(radius: float, n: int, up: bool) -> Surface:
        flat = line("line3", n, up=up)
        t = 0.5 * np.pi * (1.0 - flat.points[:, 0])
        return moved(flat, lambda x: radius * np.column_stack([np.cos(t), np.sin(t)]))

    contactor, target = arc(1.0, 20, True), arc(1.1, 40, False)
    coupling, space = node_to_segment(contactor, target)
    x, normal, gap, foot = foot_points(contactor, target, coupling)
    radial = np.linalg.norm(normal - x, axis=1) < 1e-4  # but for the ends, where only one facet gives the normal
    assert radial.sum() >= len(space) - 2 >= 37
    assert gap[radial] == pytest.approx(0.1, abs=1e-6)
    assert np.linalg.norm(foot, axis=1) == pytest.approx(1.1, abs=1e-6)


def test_partial_overlap_and_reach() -> None:
    """A target over the left half of the contactor, 0.3 away: nodes beyond it have no multiplier, and none has where the
    reach is shorter than the distance. Tributary areas sum to the length of the contactor that has multipliers."""
    contactor = line("line2", 10)
    half = moved(line("line2", 7, up=False), lambda x: np.column_stack([0.5 * x[:, 0], x[:, 1] + 0.3]))
    coupling, space = node_to_segment(contactor, half, reach=0.31)
    assert (len(space), space.removed) == (6, 5)
    assert np.sort(contactor.points[space.node, 0]) == pytest.approx(np.arange(6) / 10, abs=1e-12)
    assert coupling.gap[coupling.weight > 0] / coupling.weight[coupling.weight > 0] == pytest.approx(0.3, abs=1e-12)
    assert coupling.weight.sum() == pytest.approx(0.55, abs=1e-12)
    coupling, space = node_to_segment(contactor, half, reach=0.29)
    assert len(space) == 0
    assert not coupling.segments.any()


def test_the_nearer_of_two_layers_is_taken() -> None:
    near, far = (moved(grid("quad4", (3, 3), up=False), lambda x, h=h: x + np.array([0.0, 0.0, h])) for h in (0.1, 0.4))
    points = np.concatenate([far.points, near.points])
    nodes = np.concatenate([far.nodes, np.where(near.nodes >= 0, near.nodes + len(far.points), -1)])
    both = Surface(points, np.tile(near.kinds, 2), nodes, np.tile(near.cells, 2), np.tile(near.local, 2))
    coupling, _ = node_to_segment(grid("quad4", (4, 4)), both)
    used = coupling.weight > 0
    assert coupling.gap[used] / coupling.weight[used] == pytest.approx(0.1, abs=1e-12)


def test_surfaces_that_look_away_do_not_pair() -> None:
    """A target whose normal points the same way is the far side of a body."""
    contactor, away = line("line2", 4), moved(line("line2", 4, up=True), lambda x: x + np.array([0.0, 0.1]))
    assert len(node_to_segment(contactor, away)[1]) == 0
    built = model(two_blocks("quad4", "quad4", PLANE), method="node-to-segment", target="upper.top")
    with pytest.raises(InputError, match=r"no facet of 'lower\.top' faces 'upper\.top'"):
        abut.solve(built)


@pytest.mark.parametrize("method", ["node-to-segment", "node-to-segment-two-pass"])
@pytest.mark.parametrize(
    "option", [{"kind": "tied"}, {"law": "constraint-function"}, {"pressure": "P1"}, {"pressure": "P0"}]
)
def test_what_it_does_not_know_is_refused(method: str, option: dict[str, str]) -> None:
    with pytest.raises(InputError, match=rf"contact 'joint': method {method} is a reference .* use segment-to-segment"):
        abut.Contact(contactor="a", target="b", name="joint", method=method, **option)


def test_unknown_method() -> None:
    with pytest.raises(InputError, match="method"):
        abut.Contact(contactor="a", target="b", method="node-to-surface")


@pytest.mark.parametrize("method", ["node-to-segment", "node-to-segment-two-pass"])
def test_job_file(method: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The contact force is the reaction, as with segments; the second pass has its own line in the summary."""
    job = tmp_path / "job.toml"
    job.write_text(TEXT + f'method = "{method}"\n')
    assert main(["run", str(job)]) == 0
    assert capsys.readouterr().err == ""
    (step,) = json.loads((tmp_path / "results" / "summary.json").read_text())["steps"]
    names = [c["name"] for c in step["contacts"]]
    assert names == ["blocks"] if method == "node-to-segment" else ["blocks", "blocks (second pass)"]
    signs = (1.0, -1.0)
    total = sum(sign * c["force"][2] for sign, c in zip(signs, step["contacts"]))
    assert total == pytest.approx(-step["reactions"]["upper.top"][2], rel=1e-9)


def test_job_file_with_an_option_it_does_not_know(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job = tmp_path / "job.toml"
    job.write_text(TEXT + 'method = "node-to-segment"\nlaw = "constraint-function"\n')
    assert main(["run", str(job)]) == 2
    assert "contact 'blocks': method node-to-segment is a reference for comparison" in capsys.readouterr().err


def test_two_blocks_agree_with_segments() -> None:
    """Not a patch test: the force through a smooth contact problem is that of segments within a few per cent."""
    mesh = two_blocks("quad4", "quad4", ((12, 6), (9, 6)), distort=0.0)
    built = model(mesh)
    pressed = replace(built, loads=[], supports=[*built.supports, abut.Support("upper.top", y=-1e-3)])
    forces = [
        abut.solve(replace(pressed, contacts=[replace(built.contacts[0], method=m)])).contacts[0].force[1]
        for m in ("segment-to-segment", "node-to-segment")
    ]
    assert forces[1] == pytest.approx(forces[0], rel=0.05)
