"""The space "dual-P1": dual functions along the edge of contact, ordinary ones inside; gaps that jump; what is averaged."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.cells import CELLS
from abut.contact.clearance import of_corners
from abut.contact.coupling import CouplingOptions, couple
from abut.contact.nodal_recovery import at_facet_nodes, averages
from abut.contact.pressure_space import inner_facets, pressure_space, resolve, with_plain_facets
from abut.errors import InputError
from abut.mesh.make import join, rectangle
from abut.problem.constraints import supports
from abut.problem.contact_pairs import pair, with_plain_functions
from models.surfaces import FACETS_3D, grid


def coupled(kind: str) -> tuple:
    """A distorted contactor of 5 x 4 facets on a target that leaves a part of it uncovered, degree 1."""
    contactor = grid(kind, (5, 4), distort=0.15, seed=1)
    target = grid("quad4", (3, 3), distort=0.1, up=False, seed=2)
    target = replace(target, points=target.points + np.array([0.07, -0.05, 0.0]))
    coupling = couple(contactor, target, resolve("auto", contactor)[1], CouplingOptions(keep_gap_samples=True))
    return contactor, of_corners(contactor, target, coupling)


@pytest.mark.parametrize("kind", FACETS_3D)
def test_functions_are_biorthogonal_and_keep_their_integrals(kind: str) -> None:
    """int phi_k N_l = delta_kl int N_l; ordinary functions on some facets leave int phi_k as it is."""
    contactor, coupling = coupled(kind)
    space = pressure_space("dual-P1", contactor, coupling)
    mass = np.zeros((9 * len(contactor),) * 2)
    for f, block in enumerate(coupling.mass):
        mass[9 * f : 9 * f + 9, 9 * f : 9 * f + 9] = block
    products = space.transfer.T @ mass @ space.plain
    assert products == pytest.approx(np.diag(np.diag(products)), abs=1e-12 * products.max())
    assert np.diag(products) == pytest.approx(space.weight, rel=1e-9)
    some = np.arange(len(contactor)) % 2 == 0
    mixed = with_plain_facets(space, contactor, coupling, some)
    assert mixed.transfer.T @ coupling.weight == pytest.approx(space.weight, rel=1e-12)
    assert not mixed.ordinary
    assert with_plain_facets(space, contactor, coupling, np.ones(len(contactor), dtype=bool)).ordinary


def test_ordinary_functions_keep_two_facets_away_from_open_ones() -> None:
    """In a row of twelve facets with the last multiplier open, the last three facets stay dual; one not covered all over
    does the same. Linear facets: all or none."""
    for cell, inside in (("quad8", 9), ("quad4", 0)):
        lower, upper = rectangle((0, 12), (0, 1), (12, 1), cell), rectangle((0, 12), (1, 2), (12, 1), cell)
        model = abut.Model(
            join({"lower": lower, "upper": upper}),
            [abut.Solid(body, abut.LinearElastic(1.0, 0.0)) for body in ("lower", "upper")],
            contacts=[abut.Contact(contactor="lower.top", target="upper.bottom")], plane="strain",
        )  # fmt: skip
        own = pair(model, model.contacts[0], supports(model))
        x = own.contactor.points[own.contactor.nodes[:, :2], 0].mean(axis=1)
        active = own.contactor.points[own.space.node, 0] < 11.5
        covered = np.ones(len(x), dtype=bool)
        inner = inner_facets(own.space, own.contactor, covered, active)
        assert inner.tolist() == (x < inside).tolist()
        every = np.ones(len(own), dtype=bool)
        assert inner_facets(own.space, own.contactor, covered, every).all()
        assert inner_facets(own.space, own.contactor, x < 11.0, every).tolist() == (x < inside).tolist()
        assert with_plain_functions(model, own, supports(model), every).space.ordinary
        assert (with_plain_functions(model, own, supports(model), active) is own) == (cell == "quad4")


def test_gap_of_a_step_is_that_on_either_side() -> None:
    """Half of a facet looks down a step of 1: its node beside the closed half has no gap, where a linear fit has -1/4."""
    contactor = rectangle((0, 1), (0, 1), (1, 1), "quad4")
    steps = join(
        {"high": rectangle((0, 0.5), (1, 2), (1, 1), "quad4"), "low": rectangle((0.5, 1), (2, 3), (1, 1), "quad4")}
    )
    mesh = join({"contactor": contactor, "high": steps})
    both = np.concatenate([mesh.surfaces["high.high.bottom"], mesh.surfaces["high.low.bottom"]])
    top = mesh.surface("contactor.top")
    raw = couple(top, mesh.facets(both), 1, CouplingOptions(reach=2.0, keep_gap_samples=True))
    fit = np.linalg.solve(raw.mass[0, :2, :2], raw.gap[:2])
    assert sorted(fit) == pytest.approx([-0.25, 1.25])
    kept = np.linalg.solve(raw.mass[0, :2, :2], of_corners(top, mesh.facets(both), raw).gap[:2])
    assert sorted(kept) == pytest.approx([0.0, 1.0], abs=1e-12)


@pytest.mark.parametrize("kind", ["tri3", "quad4"])
@pytest.mark.parametrize("side", ["contactor", "target"])
def test_gap_of_a_bulge_is_that_at_the_corners(kind: str, side: str) -> None:
    """Over flat facets 0.1 apart that bulge by 0.05 at their edges' middles the gap at every corner is 0.1, where a linear
    fit lies below."""
    top, bottom = grid(kind, (2, 2)), grid(kind, (2, 2), up=False)
    bottom = replace(bottom, points=bottom.points + np.array([0.0, 0.0, 0.1]))
    n = CELLS[kind].corners
    bulge = np.zeros((len(top), 9))
    bulge[:, n : 2 * n] = 0.05
    pair = [replace(s, bulge=bulge) if name == side else s for name, s in (("contactor", top), ("target", bottom))]
    raw = couple(pair[0], pair[1], 1, CouplingOptions(reach=1.0, keep_gap_samples=True, keep_points=True))
    coupling = of_corners(pair[0], pair[1], raw)
    mass = coupling.mass[:, :n, :n]
    before, after = (np.linalg.solve(mass, c.gap.reshape(-1, 9)[:, :n, None]) for c in (raw, coupling))
    assert before.min() < 0.08
    assert after == pytest.approx(0.1, rel=1e-9)


@pytest.mark.parametrize("kind", FACETS_3D)
def test_averages_have_the_resultant_and_sharpened_ones_linear_fields(kind: str) -> None:
    contactor = grid(kind, (5, 4), distort=0.15, seed=1)
    target = grid("quad4", (3, 3), distort=0.1, up=False, seed=2)
    coupling = couple(contactor, target, 1)
    at = averages(contactor, coupling)
    values = np.random.default_rng(3).random(9 * len(contactor))
    assert at.of(values) @ at.weight == pytest.approx(coupling.weight @ values, rel=1e-12)
    linear = contactor.points @ [2.0, -1.0, 0.0] + 3.0
    nodes = np.maximum(contactor.nodes, 0)
    average = at.of(np.where(contactor.nodes >= 0, linear[nodes], 0.0).ravel())
    corner = at.weight > 0.0
    assert np.abs(average - linear)[corner].max() > 0.02  # at the rim averages lag behind
    sharp = at.sharpened(average, at.surface.points)
    assert sharp[corner] == pytest.approx(linear[corner], abs=1e-11)
    assert sharp @ at.weight == pytest.approx(average @ at.weight, rel=1e-13)
    shown = at_facet_nodes(at.surface, sharp)[contactor.nodes >= 0]
    assert shown == pytest.approx(linear[contactor.nodes[contactor.nodes >= 0]], abs=1e-11)


def test_dual_functions_and_the_constraint_function_are_refused() -> None:
    for pressure in ("dual", "dual-P1"):
        with pytest.raises(InputError, match="point by point"):
            abut.Contact(contactor="a", target="b", pressure=pressure, law="constraint-function")
