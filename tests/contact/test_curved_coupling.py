"""Coupling integrals of curved facets: how exact they are, whichever way facets are found and carried."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.contact.coupling import CouplingOptions, couple, surface_degree
from abut.contact.geometry import full_moments, nodal_normals, turning_within
from abut.contact.quadrature import moment_tolerance
from abut.mesh.surface import Surface
from models.surfaces import FACETS_3D, PAIRS, grid, planar

Array = NDArray[np.float64]
MANY = 14  # points per direction: further ones change nothing above 1e-13
every_pair = pytest.mark.parametrize(("kc", "kt"), [pair for pair in PAIRS if pair[0] in FACETS_3D])


def domes(kc: str, kt: str, seed: int, height: float) -> tuple[Surface, Surface]:
    """A contactor of 3 x 3 distorted facets under a larger target of 4 x 4, both on one paraboloid as far as they can."""
    place = planar(3, seed, size=1.5, shift=0.1)

    def dome(x: Array) -> Array:
        return np.column_stack([x[:, :2], height * ((x[:, :2] - 0.4) ** 2).sum(axis=1)])

    contactor = grid(kc, (3, 3), distort=0.2, up=True, bulge=dome, seed=seed)
    target = grid(kt, (4, 4), distort=0.2, up=False, bulge=lambda x: dome(place(x)), seed=seed + 1)
    return contactor, target


def worst(matrix: Array, facets: int) -> Array:
    """Largest entry of each facet's rows, (facets,)."""
    return np.asarray(np.abs(matrix).reshape(facets, -1).max(axis=1))


@every_pair
@pytest.mark.parametrize("height", [0.05, 0.2])
def test_curved_facets_meet_their_tolerance(kc: str, kt: str, height: float) -> None:
    """Of int H_k N_j N and int H_k H_l, summed over the segments of a facet, theory (Q6) leaves the larger of both
    facets' tolerances times the area: segments are smaller than the facets on which the rule was chosen."""
    contactor, target = domes(kc, kt, 3, height)
    degree = surface_degree(contactor)
    own, exact = (couple(contactor, target, degree, CouplingOptions(points=n)) for n in ("auto", MANY))
    assert np.array_equal(own.segments, exact.segments)
    area = full_moments(contactor, 0)[:, 0]
    own_turn, other_turn = (turning_within(s, nodal_normals(s)) for s in (contactor, target))
    tolerance = np.maximum(moment_tolerance(3, own_turn), moment_tolerance(3, other_turn).max())
    for part in ("contactor_part", "target_part"):
        error = worst((getattr(own, part) - getattr(exact, part)).toarray(), len(contactor))
        assert np.all(error < tolerance * area)
    assert np.all(worst(own.mass - exact.mass, len(contactor)) < tolerance * area)


@pytest.mark.parametrize("kind", ["quad4", "tri6", "quad8", "quad9"])
def test_the_tolerance_falls_with_the_fourth_power_of_the_angle(kind: str) -> None:
    """(Q6) again, with half and a quarter of the height: points are added as the facets flatten, until affine ones are
    integrated to rounding."""
    for height in (0.1, 0.05, 0.025):
        contactor, target = domes(kind, kind, 5, height)
        own, exact = (couple(contactor, target, 1, CouplingOptions(points=n)) for n in ("auto", MANY))
        turn = max(turning_within(s, nodal_normals(s)).max() for s in (contactor, target))
        error = np.abs((own.operator - exact.operator).toarray()).max() / full_moments(contactor, 0)[:, 0].max()
        assert error < min(1e-5, 0.1 * turn**4)


def by_itself(surface: Surface) -> tuple[Surface, sp.csr_matrix]:
    """Every facet with points of its own, and the matrix (own points, points) that finds their old numbers."""
    used = surface.nodes >= 0
    old = surface.nodes[used]
    nodes = surface.nodes.copy()
    nodes[used] = np.arange(len(old))
    chosen = sp.csr_matrix((np.ones(len(old)), (np.arange(len(old)), old)), shape=(len(old), len(surface.points)))
    return replace(surface, points=surface.points[old], nodes=nodes), chosen


@every_pair
def test_nodes_carried_once_or_facet_by_facet(kc: str, kt: str) -> None:
    """A point of several target facets has one image in a contactor facet's plane, (S5), whichever facet asks for it
    first: with points of their own, target facets get the same integrals, to the rounding of the sums."""
    contactor, target = domes(kc, kt, 7, 0.2)
    alone, chosen = by_itself(target)
    degree = surface_degree(contactor)
    whole, parts = (couple(contactor, t, degree, CouplingOptions(points=5, hidden=True)) for t in (target, alone))
    assert np.array_equal(whole.segments, parts.segments)
    ahead = 3 * len(contactor.points)  # the target's columns come after the contactor's
    assert np.abs((whole.contactor_part[:, :ahead] - parts.contactor_part[:, :ahead]).toarray()).max() < 1e-15
    gathered = parts.target_part[:, ahead:] @ sp.kron(chosen, sp.eye(3))
    assert np.abs((whole.target_part[:, ahead:] - gathered).toarray()).max() < 1e-15


@every_pair
def test_no_target_within_sight_is_left_out(kc: str, kt: str) -> None:
    """Targets are left out where a bound says that they cannot be seen. From a hill of few facets, normals spread: its
    facets see more of a fine plane far above them than lies over them, and their whole area is covered."""
    tops = grid(kc, (2, 2), bulge=lambda x: np.column_stack([x[:, :2], -0.3 * ((x[:, :2] - 0.5) ** 2).sum(axis=1)]))
    plane = grid(kt, (24, 24), up=False, bulge=lambda x: 2.4 * x + [-0.7, -0.7, 0.5])
    own = couple(tops, plane, surface_degree(tops), CouplingOptions(reach=2.0))
    area = full_moments(tops, 0)[:, 0]
    assert own.covered / area == pytest.approx(1.0, abs=1e-5)  # (Q6)
