"""Contacts of whole assemblies, found with nothing named: which facets face which, and that the run converges on them.

What truly faces what is found again by rays, one from the middle of every facet on the outside, which hit the first facet
there is: no tree, no cutting, no sizes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.contact.coupling import CouplingOptions, couple
from abut.diagnosis import check
from abut.mesh.exterior import exterior
from models.assembly import ASSEMBLIES, Assembly, fir_tree

pytest.importorskip("gmsh")

NEAR = 0.3  # of a facet: a gap within which nobody would doubt that two facets face each other
OPPOSITE = -0.7  # cosine of the normals, likewise
COARSE = {  # lines of the certificate that a mesh of this size fails for a good reason: contact on less than three facets
    "bearing": set(),
    "fir tree": {"overlap", "resolution"},  # flanks end on each other's corners
    "wall": {"overlap"},  # each pier stands on one facet of the floor, which is the coarser side
    "o-ring": set(),
    "flange": set(),
    "gears": {"overlap", "resolution"},  # one flank bears on a single facet
    "clevis": {"resolution"},
}
DEEP = {"bearing": 0.051, "clevis": 0.2}  # interference; of the clevis that of its chords


@cache
def made(name: str) -> Assembly:
    return ASSEMBLIES[name]()


@dataclass(frozen=True)
class Skin:
    """The outside of an assembly with straight facets: corners (n, dim, dim), middle, normal (n, dim), size (n,), body."""

    rows: dict[tuple[int, int], int]
    corners: NDArray[np.float64]
    middle: NDArray[np.float64]
    normal: NDArray[np.float64]
    size: NDArray[np.float64]
    body: NDArray[np.str_]


@cache
def skin(name: str) -> Skin:
    mesh = made(name).mesh
    rows = exterior(mesh)
    surface = mesh.facets(rows, "outside")
    corners = surface.points[surface.nodes[:, : mesh.dim]]  # ends of lines, corners of triangles
    edges = np.diff(corners, axis=1)
    normal = np.stack([edges[:, 0, 1], -edges[:, 0, 0]], 1) if mesh.dim == 2 else np.cross(edges[:, 0], edges[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    body = np.empty(mesh.n_cells, dtype="U20")
    for own, cells in mesh.bodies.items():
        body[cells] = own
    size = np.linalg.norm(edges, axis=2).max(axis=1)
    numbers = {(int(c), int(f)): i for i, (c, f) in enumerate(rows)}
    return Skin(numbers, corners, corners.mean(axis=1), normal, size, body[rows[:, 0]])


def rays(own: Skin, start: NDArray[np.float64], way: NDArray[np.float64], itself: NDArray[np.int64]):
    """The facet that each ray hits first, -1 for none, and how far away: by Cramer's rule, ray against facet."""
    hit, far = np.full(len(start), -1), np.full(len(start), np.inf)
    first, edges = own.corners[:, 0], own.corners[:, 1:] - own.corners[:, :1]
    for i in range(len(start)):
        matrix = np.concatenate([edges, np.broadcast_to(-way[i], (len(edges), 1, len(way[i])))], axis=1)
        regular = np.abs(own.normal @ way[i]) > 1e-6
        regular[itself[i]] = False
        solved = np.linalg.solve(matrix[regular].transpose(0, 2, 1), (start[i] - first[regular])[..., None])[..., 0]
        inside = (solved[:, :-1] >= -1e-9).all(axis=1) & (solved[:, :-1].sum(axis=1) <= 1 + 1e-9) & (solved[:, -1] > 0)
        if inside.any():
            best = np.argmin(np.where(inside, solved[:, -1], np.inf))
            hit[i], far[i] = np.flatnonzero(regular)[best], solved[best, -1]
    return hit, far


def facing_pairs(name: str) -> list[tuple[int, int]]:
    """Facets that beyond doubt face one of another body: the first that the ray out of the middle hits."""
    own, deep = skin(name), DEEP.get(name, 1e-6)
    hit, far = rays(own, own.middle - deep * own.normal, own.normal, np.arange(len(own.middle)))
    return [
        (i, int(j))
        for i, (j, distance) in enumerate(zip(hit, far))
        if j >= 0
        and distance - deep < NEAR * min(own.size[i], own.size[j])
        and own.body[i] != own.body[j]
        and own.normal[i] @ own.normal[j] < OPPOSITE
    ]


@pytest.mark.long
@pytest.mark.parametrize("name", ASSEMBLIES)
def test_bodies_that_face_each_other(name: str) -> None:
    """All pairs of bodies, and no others: not the neighbours of a ball, nor a bolt and what a washer hides."""
    assembly = made(name)
    assert {frozenset(found.bodies) for found in assembly.found()} == assembly.pairs


@pytest.mark.long
@pytest.mark.parametrize("name", ASSEMBLIES)
def test_every_facet_that_faces_another(name: str) -> None:
    """Belongs to a pair with that one's body."""
    own = skin(name)
    sides: dict[tuple[str, str], set[int]] = {}
    for found in made(name).found():
        for (a, b), rows in zip((found.bodies, found.bodies[::-1]), (found.contactor_facets, found.target_facets)):
            sides.setdefault((a, b), set()).update(own.rows[int(c), int(f)] for c, f in rows)
    truth = facing_pairs(name)
    assert len(truth) >= 4
    missing = [(i, j) for i, j in truth if i not in sides.get((str(own.body[i]), str(own.body[j])), set())]
    assert missing == []


@pytest.mark.long
@pytest.mark.parametrize("name", ASSEMBLIES)
def test_no_facet_sees_a_wrong_one(name: str) -> None:
    """What the run integrates: no target lies behind the thickness of a body (opposite faces of a lobe), and none behind
    another facet."""
    assembly, own, deep = made(name), skin(name), DEEP.get(name, 1e-6)
    model = assembly.model()
    for contact in model.contacts:
        contactor, target = model.sides(contact)
        at = couple(contactor, target, 0, CouplingOptions(points=1, keep_points=True)).points
        assert at is not None
        mine = np.array([own.rows[int(c), int(f)] for c, f in zip(contactor.cells, contactor.local)])[at.facet]
        theirs = np.array([own.rows[int(c), int(f)] for c, f in zip(target.cells, target.local)])[at.target_facet]
        assert (np.einsum("ij,ij->i", own.normal[mine], own.normal[theirs]) < 0.0).all()
        assert at.gap.min() > -deep - 0.01 * own.size[mine].min()
        middle, _ = np.unique(np.stack([mine, theirs], 1)[at.gap > deep], axis=0, return_index=True)
        way = own.middle[middle[:, 1]] - own.middle[middle[:, 0]]
        way = own.normal[middle[:, 0]] if not len(way) else way / np.linalg.norm(way, axis=1, keepdims=True)
        hit, far = rays(own, own.middle[middle[:, 0]] + 1e-6 * own.normal[middle[:, 0]], way, middle[:, 0])
        length = np.linalg.norm(own.middle[middle[:, 1]] - own.middle[middle[:, 0]], axis=1)
        crossed = (hit >= 0) & (far < 0.5 * length) & (own.body[hit] == own.body[middle[:, 0]])
        assert not crossed.any()


@pytest.mark.long
@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.long) if name in ("wall", "bearing") else name for name in ASSEMBLIES]
)
def test_run_with_defaults(name: str) -> None:
    """Converges; nothing is out of balance, and the certificate fails no line but those that a coarse mesh accounts for."""
    model = made(name).model()
    report = check(model)
    assert report.status == 0
    assert not any("auto = true" in finding.line or "too small" in finding.line for finding in report.findings)
    solution = abut.solve(model)
    assert solution.converged
    assert {line.name for line in solution.certificate if not line.passed} <= COARSE[name]
    assert max(contact.max_pressure for contact in solution.contacts) > 0.0


@pytest.mark.parametrize("size", [0.3, 0.8, 2.0, 4.0])
def test_lobes_thinner_than_facets(size: float) -> None:
    """A facet may be longer than a lobe is thick: its far side, which touches the disc as well, is no target."""
    assembly = fir_tree(size)
    (found,) = assembly.found()
    assert found.gap[0] > -1e-9
    model = assembly.model()
    at = couple(*model.sides(model.contacts[0]), 0, CouplingOptions(points=1, keep_points=True)).points
    assert at is not None
    assert at.gap.min() > -1e-9
