"""A body in contact with itself in the plane and in space, with linear and quadratic cells."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.contact.self_contact import RANK
from abut.contact.sides import Names, moving_sides
from abut.solution import Solution
from models.certificate import faceted
from models.clamps import DEPTH, NAMED, WHOLE, balanced, clamp, tube
from models.folding import accordion
from models.sliding import current, finite

# Two or three facets from the edge of contact to its middle: up to 40 % off between nodes. A single layer of cells of first
# order bends: stresses of it are worth little.
COARSE = {"pressure error"}
BENT = {"quad4": {"stress error"}, "hex8": {"stress error"}}


def closed(cell: str, sides: tuple[Names, Names] = WHOLE) -> Solution:
    return passing(clamp(cell, sides=sides))


def passing(model: abut.Model) -> Solution:
    solution = abut.solve(model)
    assert solution.converged
    assert [check.name for check in solution.certificate if not check.passed and check.name not in COARSE] == []
    return solution


@pytest.mark.parametrize(
    "cell", ["quad4", "quad8", "tri6", "hex8", "hex20", pytest.param("tet10", marks=pytest.mark.long)]
)
def test_a_clamp_closes_as_between_two_surfaces(cell: str) -> None:
    """Jaws level with each other. The body named twice, whole, gives what its two arms as contactor and target give; to the
    tolerance of a step; where the edges of facets are curves in 3D the rule of integration is that of the most curved facet,
    elsewhere on the whole body: 1e-3."""
    whole, named = closed(cell), closed(cell, NAMED)
    balanced(whole)
    tolerance = 1e-3 if cell in ("hex20", "tet10") else 1e-6
    assert np.allclose(whole.contacts[0].force, named.contacts[0].force, rtol=tolerance, atol=tolerance)
    assert whole.contacts[0].max_pressure == pytest.approx(named.contacts[0].max_pressure, rel=tolerance)
    assert np.abs(whole.displacement - named.displacement).max() < tolerance * 0.3


@pytest.mark.long
def test_extruded_by_one_cell() -> None:
    """Between two planes hex8 is quad4 in plane strain, contact included: the means of gaps through the depth are those in
    the plane. (Quadratic facets have pressure functions of their own through the depth: 0.5 % in force.) Bulges are left
    out: at the ends of the depth they are found from more facets."""
    flat, deep = (passing(faceted(clamp(cell, sides=WHOLE))) for cell in ("quad4", "hex8"))
    ids = np.flatnonzero(deep.model.mesh.points[:, 2] == 0.0)
    order = [int(np.argmin(np.abs(deep.model.mesh.points[ids, :2] - x).sum(axis=1))) for x in flat.model.mesh.points]
    assert np.abs(deep.displacement[ids][order][:, :2] - flat.displacement).max() < 1e-7
    assert np.abs(deep.displacement[:, 2]).max() < 1e-7
    assert np.allclose(deep.contacts[0].force[:2] / DEPTH, flat.contacts[0].force, rtol=1e-6)
    assert deep.contacts[0].max_pressure == pytest.approx(flat.contacts[0].max_pressure, rel=1e-6)


def test_quadratic_cells_in_space() -> None:
    flat, deep = closed("quad8", NAMED), closed("hex20", NAMED)
    assert deep.contacts[0].force[1] / DEPTH == pytest.approx(flat.contacts[0].force[1], rel=0.01)


@pytest.mark.long
def test_quadratic_folds_close() -> None:
    """The accordion of quad8 cells goes all the way, and every line of its certificate holds."""
    solution = abut.solve(accordion(1.1, cells=60, cell="quad8"))
    assert solution.converged
    assert all(check.passed for check in solution.certificate)
    force = -solution.contacts[0].force[0]
    assert 49.0 < force < 64.0  # two valleys under uniaxial strain: 49, and the bends


@pytest.mark.parametrize("cell", ["quad4", "hex8"])
def test_one_arm_is_the_contactor_however_the_clamp_is_turned(cell: str) -> None:
    """Ranks go along the direction in which the arms lie apart: all of one are below all of the other, (G12)."""
    model = clamp(cell)
    for angle in np.linspace(0.0, np.pi, 13):
        c, s = np.cos(angle), np.sin(angle)
        turn = np.eye(model.dim)
        turn[:2, :2] = [[c, -s], [s, c]]
        mesh = replace(model.mesh, points=model.mesh.points @ turn.T)
        surface, _ = moving_sides(mesh, "body", "body")
        assert surface.kin is not None
        ranks = []
        for arm in NAMED:
            rows = mesh.surfaces[arm]
            code = np.isin(8 * surface.cells + surface.local, 8 * rows[:, 0] + rows[:, 1])
            jaw = code & (model.mesh.points[surface.nodes[:, 0], 0] > 0.4)
            ranks.append(surface.kin[jaw, RANK])
        assert ranks[0].max() < ranks[1].min() or ranks[1].max() < ranks[0].min()


@pytest.mark.parametrize("cell", ["quad4", "quad8", "tri6", "hex8"])
def test_a_flattened_tube_touches_itself_inside(cell: str) -> None:
    """As between its upper and its lower half, and every line of the certificate holds but those of a coarse mesh."""
    whole, named = (abut.solve(tube(cell, sides=sides)) for sides in (WHOLE, NAMED))
    assert whole.converged
    balanced(whole)
    coarse = COARSE | BENT.get(cell, set())
    assert [check.name for check in whole.certificate if not check.passed and check.name not in coarse] == []
    assert np.allclose(whole.contacts[0].force, named.contacts[0].force, rtol=1e-6, atol=1e-6)
    assert whole.contacts[0].max_pressure == pytest.approx(named.contacts[0].max_pressure, rel=1e-6)


def test_side_faces_do_not_press_on_each_other() -> None:
    """Where the walls of a tube one cell deep overlap between nodes, its front sees its back through the body: no contact,
    and no contact of a front with the inside, which it sees edge-on."""
    solution = abut.solve(tube("hex8"))
    kind = current(finite(solution.model))
    samples = kind.shown(solution.displacement.ravel()).gap_samples
    assert samples is not None
    assert (samples.gap < -1e-3).any()
    assert samples.gap.min() > -0.5 * DEPTH
    assert np.abs(samples.normal[:, 2]).max() < 0.1
