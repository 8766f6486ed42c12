"""Round bodies cut at planes of symmetry: normals and pressures next to these are those of the whole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.contact.coupling import couple
from abut.contact.geometry import nodal_normals
from abut.contact.nodal_recovery import averages
from abut.contact.symmetry_planes import evened
from abut.mesh.make import box, join, ring
from abut.problem.constraints import supports
from abut.problem.contact_normals import contact_normals
from abut.problem.contact_pairs import pair

Array = NDArray[np.float64]
STEEL = abut.LinearElastic(1000.0, 0.3)


def lame() -> float:
    """Pressure of two tubes of radii 1, 2 and 3 in plane strain with an interference of .01: p r (1 + nu) / E times
    ((1 - 2 nu) r^2 + a^2) / (r^2 - a^2) is what the inner one of radii a, r gives way, that of the outer one
    ((1 - 2 nu) r^2 + b^2) / (b^2 - r^2)."""
    inwards, outwards = (0.4 * 4.0 + 1.0) / (4.0 - 1.0), (0.4 * 4.0 + 9.0) / (9.0 - 4.0)
    return 0.01 / (2.0 * 1.3 / 1000.0 * (inwards + outwards))


def fit(cell: str, facets: tuple[int, int]) -> abut.Model:
    """A quarter of two rings of radii 1, 2 and 3."""
    parts = {name: ring([r, r + 1], cells=[3, n], cell=cell) for name, r, n in zip("ab", (1, 2), facets)}
    ends = {"start": {"y": 0.0}, "end": {"x": 0.0}}
    return abut.Model(
        join(parts),
        [abut.Solid(body, STEEL) for body in parts],
        [abut.Support(f"{body}.{end}", **held) for body in parts for end, held in ends.items()],
        contacts=[abut.Contact(contactor="a.outer", target="b.inner", offset=-0.01)],
        plane="strain",
    )


def shown(model: abut.Model) -> Array:
    pressure = abut.solve(model).contacts[0].pressure
    return np.asarray(pressure[np.isfinite(pressure)])


def test_rings_of_quadrilaterals_are_round() -> None:
    """Facets that match: what is alike all round is alike at every node, ends included, to rounding."""
    pressure = shown(fit("quad4", (8, 8)))
    assert np.ptp(pressure) < 1e-9 * pressure.max()
    assert pressure == pytest.approx(lame(), rel=0.02)


def test_rings_of_triangles() -> None:
    """Triangles and their mirror images make no even mesh: nodal forces on the plane are off by the stress around the ring
    in the middle of a triangle, theory (P25); what is shown is not."""
    assert shown(fit("tri3", (8, 12))) == pytest.approx(lame(), rel=0.05)


def test_even_parabolas_stay_and_the_resultant_too() -> None:
    """In 2D: averages that are an even parabola, whatever force the last node takes from the next."""
    own = pair(model := fit("tri3", (8, 8)), model.contacts[0], supports(model))
    assert own.planes is not None
    at = averages(own.contactor, own.coupling)
    turn = np.arctan2(own.contactor.points[:, 1], own.contactor.points[:, 0])
    here = np.flatnonzero(at.weight > 0.0)
    end, following = here[np.argsort(turn[here])[:2]]
    chord = np.linalg.norm(own.contactor.points - own.contactor.points[end], axis=1)
    even = np.where(at.weight > 0.0, 3.0 - 0.2 * chord**2, 0.0)
    moved = even.copy()
    moved[end] += 0.3 / at.weight[end]
    moved[following] -= 0.3 / at.weight[following]
    result = evened(own.contactor, at, moved, own.planes)
    assert result @ at.weight == pytest.approx(even @ at.weight, rel=1e-13)
    assert result[here][:-2] == pytest.approx(even[here][:-2], rel=1e-12)


@pytest.mark.parametrize("slope", [0.0, 0.3])
def test_normals_of_a_cone_lean_along_its_axis_only(slope: float) -> None:
    """A quarter of a cone between planes of symmetry, its ends held along its axis: normals on the planes lie in these, and
    lean along the axis as all others do."""
    square = box([0, 1], [0, 90], [0, 1], cells=[1, 6, 3], cell="hex8")
    height, turn = square.points[:, 2], np.deg2rad(square.points[:, 1])
    parts = {}
    for name, first in (("a", 1.0), ("b", 2.0)):
        r = first + square.points[:, 0] + slope * height
        parts[name] = replace(square, points=np.column_stack([r * np.cos(turn), r * np.sin(turn), height]))
    held = {"front": {"y": 0.0}, "back": {"x": 0.0}, "bottom": {"z": 0.0}, "top": {"z": 0.0}}
    model = abut.Model(
        join(parts),
        [abut.Solid(body, STEEL) for body in parts],
        [abut.Support(f"{body}.{side}", **on) for body in parts for side, on in held.items()],
        contacts=[abut.Contact(contactor="a.right", target="b.left", offset=-0.01)],
    )
    contactor, target = model.sides(model.contacts[0])
    used = contactor.nodes >= 0
    plain = nodal_normals(contactor)[used]
    normals = contact_normals(model, contactor, target, 0.0, 1.0, couple)[used]
    x = contactor.points[contactor.nodes[used]]
    for axis in (0, 1):
        plane = np.abs(x[:, axis]) < 1e-9
        assert np.abs(plain[plane, axis]).max() > 0.1
        assert normals[plane, axis] == pytest.approx(0.0, abs=1e-12)
    lean = slope / np.hypot(1.0, slope)
    assert np.abs(normals[:, 2] + lean).max() <= np.abs(plain[:, 2] + lean).max() + 1e-12
