"""Averages at the axis of bodies of revolution, theory (P28)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.contact.coupling import couple
from abut.contact.even_axis import even_at_axis
from abut.contact.nodal_recovery import Averages, averages
from abut.mesh.make import join, rectangle

RADII = np.array([0.0, 0.5, 0.9, 1.5, 2.0, 3.0])
Array = NDArray[np.float64]


def table(cell: str, exact: bool) -> Averages:
    """Of a disc whose facets end at RADII."""
    mesh = join(
        {name: rectangle((0.0, 5.0), y, (5, 2), cell) for name, y in (("low", (-1.0, 0.0)), ("up", (0.0, 1.0)))}
    )
    points = mesh.points.copy()
    points[:, 0] = np.interp(points[:, 0], np.arange(6.0), RADII)
    contact = abut.Contact(contactor="up.bottom", target="low.top")
    model = abut.Model(
        replace(mesh, points=points), [abut.Solid(name, abut.LinearElastic(1.0, 0.3)) for name in mesh.bodies],
        [abut.Support("low.bottom", y=0.0), abut.Support("up.top", y=0.0)], contacts=[contact], plane="axisymmetric",
    )  # fmt: skip
    contactor, target = model.sides(contact)
    return averages(contactor, couple(contactor, target, 1), np.full(len(contactor), exact))


def moment(at: Averages, node: int, power: int) -> float:
    """int N r^power r dr of a point's function, by polynomials in r."""
    r, k = at.surface.points[node, 0], int(np.argmin(np.abs(RADII - at.surface.points[node, 0])))
    total = 0.0
    for end in [RADII[j] for j in (k - 1, k + 1) if 0 <= j < len(RADII)]:
        hat = np.polynomial.Polynomial([-end, 1.0]) / (r - end)
        whole = (hat * np.polynomial.Polynomial([0.0] * (power + 1) + [1.0])).integ()
        total += abs(whole(r) - whole(end))
    return total


def even(at: Averages) -> tuple[NDArray[np.int64], Array]:
    """Points by radius, and averages of 3 - r^2 / 4, (n_points,)."""
    ids = at.surface.node_ids
    order = ids[np.argsort(at.surface.points[ids, 0])]
    result = np.zeros(len(at.weight))
    result[order] = [3.0 - 0.25 * moment(at, i, 2) / moment(at, i, 0) for i in order]
    return order, result


def test_misplaced_force_comes_back() -> None:
    """What the first two points of an even pressure take from each other is put right, all else stays."""
    at = table("tri3", exact=True)
    order, right = even(at)
    off = right.copy()
    off[order[:2]] += np.array([1.0, -1.0]) * 0.05 / at.weight[order[:2]]
    found = even_at_axis(at, off)
    assert np.abs(off - right).max() > 0.05
    assert found == pytest.approx(right, rel=1e-12)


def test_an_even_pressure_keeps_its_force() -> None:
    """Whatever the averages are: the resultant is the same, and further points keep theirs."""
    at = table("tri3", exact=True)
    order, _ = even(at)
    given = np.zeros(len(at.weight))
    given[order] = [3.1, 2.7, 2.9, 2.2, 1.0, 0.5]
    found = even_at_axis(at, given)
    assert at.weight @ found == pytest.approx(at.weight @ given, rel=1e-12)
    assert (found[order[2:]] == given[order[2:]]).all()


def test_others_stay() -> None:
    """Facets whose forces are no better, and contact that is narrower than four points."""
    at = table("tri3", exact=True)
    order, given = even(at)
    given[order[3:]] = 0.0
    assert (even_at_axis(at, given) == given).all()
    for other in (table("tri3", exact=False), table("tri6", exact=False)):
        _, values = even(other) if len(other.surface.node_ids) == len(RADII) else (None, np.ones(len(other.weight)))
        assert (even_at_axis(other, values) == values).all()
