"""Every pressure space at current positions: derivatives, sliding, the edge of the target."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.contact.coupling import CouplingOptions, couple
from abut.contact.facet_area import area_change
from abut.contact.geometry import facet_products, full_moments
from abut.contact.pressure_space import pressure_space
from abut.mesh import make
from abut.mesh.surface import Surface
from abut.problem.dual_functions import Mixture
from models.sheets import chain, sheet, turn
from models.sliding import arched, finite, pressed_in_space, tangent_errors

LINEAR = ("P0", "P1", "P1-discontinuous", "dual")
QUADRATIC = (*LINEAR, "P2", "P2-discontinuous")
ALONG_THE_EDGE = 0.45  # moved so far, a part of the contactor hangs over


def over(model: abut.Model, pressure: str) -> abut.Model:
    """With a pressure, and with the upper body moved so that it hangs over the end of the lower one."""
    points = model.mesh.points.copy()
    body = np.unique(np.concatenate([cells.ravel() for _, cells, _ in model.mesh.cells_of("upper")]))
    points[body, 0] += 3.0 - 1.5 + ALONG_THE_EDGE if points.shape[1] == 2 else 2.0 - 1.1 + ALONG_THE_EDGE - 0.1
    contact = replace(model.contacts[0], pressure=pressure)
    return replace(model, mesh=replace(model.mesh, points=points), contacts=[contact])


CASES_2D = [("quad4", name) for name in LINEAR] + [("quad8", name) for name in QUADRATIC]


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize(("cell", "pressure"), CASES_2D)
def test_tangent_in_the_plane(cell: str, pressure: str, friction: float) -> None:
    """Beyond the end of the target too, where functions go over from dual to ordinary ones. Differences of quantities of
    order one leave 1e-9; without the derivative of that transition 1e-3 is wrong."""
    assert max(tangent_errors(finite(over(arched(friction, cell), pressure)), 3e-3)) < 1e-7


@pytest.mark.parametrize("friction", [0.0, 0.3])
@pytest.mark.parametrize("cell", ["quad4", "quad8"])
def test_tangent_round_an_axis(cell: str, friction: float) -> None:
    model = over(arched(friction, cell), "dual")
    assert max(tangent_errors(finite(replace(model, plane="axisymmetric")), 3e-3)) < 1e-7


@pytest.mark.parametrize(
    ("cell", "pressure", "friction"),
    [("hex8", name, 0.3) for name in LINEAR]
    + [("hex8", "dual", 0.0), ("tet10", "dual", 0.3), ("hex20", "dual", 0.3), ("hex27", "P2-discontinuous", 0.3)],
)
def test_tangent_in_space(cell: str, pressure: str, friction: float) -> None:
    assert max(tangent_errors(finite(over(pressed_in_space(friction, cell), pressure)), 1e-3)) < 1e-7


CURVED = {
    **{
        f"{k} {a}": chain(k, 3, lambda s: [2.0 + s, 0.4 * s**2], 0.1, 1, a)
        for k in ("line2", "line3") for a in (False, True)
    },
    **{
        k: sheet(k, 2, lambda s, t: [s, t, 0.3 * s * t + 0.2 * s**2], 0.05, 1)
        for k in ("tri3", "tri6", "quad4", "quad8", "quad9")
    },
}  # fmt: skip


@pytest.mark.parametrize("surface", CURVED.values(), ids=CURVED)
def test_change_of_areas(surface: Surface) -> None:
    """Against central differences, of curved and distorted facets, also round an axis."""
    facets, way = np.array([1, 0, 1]), np.random.default_rng(1).uniform(-1.0, 1.0, surface.points.shape)
    areas = [full_moments(replace(surface, points=surface.points + step * way), 0)[facets, 0] for step in (1e-6, -1e-6)]
    expected = (areas[0] - areas[1]) / 2e-6
    assert np.abs(area_change(surface, facets) @ way.ravel() - expected).max() < 1e-8 * np.abs(expected).max()


def test_dual_functions_of_whole_facets() -> None:
    """Biorthogonal over the whole facets, which no target needs to be opposite to; and what of them is left where one ends:
    functions of the facet at its edge are the ordinary ones, of that beside it by the square of what is covered, all others
    dual, and they always add up to one."""
    contactor = turn(chain("line2", 8, lambda s: [8.0 * s, 0.0 * s]))
    target = chain("line2", 3, lambda s: [-1.0 + 5.3 * s, 0.0 * s])
    coupling = couple(contactor, target, 1, CouplingOptions())
    whole = replace(coupling, weight=full_moments(contactor, 1).ravel(), mass=facet_products(contactor, 1))
    space = pressure_space("dual", contactor, whole)
    rows = (space.transfer - space.plain).tocsr()
    assert abs(rows).sum() > 1.0
    products = np.einsum("fij,fjk->fik", whole.mass[:, :2, :2], _blocks(space.transfer, contactor.nodes))
    assert np.allclose(products, 0.5 * np.eye(2))
    mixture = Mixture.of(contactor, coupling, None)
    assert np.allclose(mixture.share, [1.0, 1.0, 1.0, (0.3 / 0.99) ** 2, 0.0, 0.0, 0.0, 0.0])
    mixed = mixture.space(space)
    assert np.allclose((mixed.transfer @ np.ones(9)).reshape(-1, 9)[:, :2], 1.0)
    assert np.allclose(mixed.transfer.T @ whole.weight, space.weight)
    assert Mixture.of(contactor, coupling, np.ones(8)).space(space).ordinary


@pytest.mark.parametrize("cell", ["line2", "tri3", "quad4"])
@pytest.mark.parametrize("covered", [0.05, 0.2, 0.4, 0.6, 0.9])
@pytest.mark.parametrize("other_end", [False, True])
def test_integrals_over_what_is_covered_are_positive(cell: str, covered: float, other_end: bool) -> None:
    """Of every function of facets that the target covers from one side on: a dual one alone is negative at the far end."""
    begin = 1.0 - covered if other_end else -1.0
    length = covered + 1.0
    if cell == "line2":
        contactor = turn(chain("line2", 1, lambda s: [s, 0.0 * s]))
        target = chain("line2", 1, lambda s: [begin + length * s, 0.0 * s])
    else:
        contactor = turn(sheet(cell, 1, lambda s, t: [s, t, 0.0 * s], 0.0, 1))
        target = sheet("quad4", 1, lambda s, t: [begin + length * s, 4.0 * t - 2.0, 0.0 * s], 0.0, 1)
    coupling = couple(contactor, target, 1, CouplingOptions())
    assert covered == pytest.approx(coupling.covered.sum() / full_moments(contactor, 0)[:, 0].sum())
    whole = replace(coupling, weight=full_moments(contactor, 1).ravel(), mass=facet_products(contactor, 1))
    mixed = Mixture.of(contactor, coupling, None).space(pressure_space("dual", contactor, whole))
    assert (mixed.transfer.T @ coupling.weight > 0.0).all()


def _blocks(transfer: object, nodes: NDArray[np.int32]) -> NDArray[np.float64]:
    dense = transfer.toarray().reshape(len(nodes), 9, -1)[:, :2]
    return np.take_along_axis(dense, nodes[:, None, :2].astype(np.int64), axis=2)


@pytest.mark.long
def test_ordinary_functions_inside_closed_contact() -> None:
    """dual-P1 is P1 where all is closed, in the first step too, and dual where a part opens; frictionless states have no
    past: there and back again is the same."""
    model = arched(0.0, "quad8", slide=0.0)
    states = {}
    for name in ("dual-P1", "dual"):
        own = replace(model, contacts=[replace(model.contacts[0], pressure=name)])
        states[name] = abut.solve(own).contacts[0]
    assert states["dual-P1"].multipliers == states["dual"].multipliers
    flat = make.join({"lower": make.rectangle([0, 2], [0, 1], [4, 2]), "upper": make.rectangle([0, 2], [1, 2], [5, 2])})
    ends = [abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0, y=lambda x: -5e-3 - 2e-3 * x[:, 0])]
    pressures = {
        name: abut.solve(
            replace(model, mesh=flat, supports=ends,
            contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", pressure=name)])
        ).contacts[0].multiplier
        for name in ("dual-P1", "P1", "dual")
    }  # fmt: skip
    top = np.nanmax(pressures["P1"])
    assert np.nanmax(np.abs(pressures["dual-P1"] - pressures["P1"])) < 1e-6 * top
    assert np.nanmax(np.abs(pressures["dual-P1"] - pressures["dual"])) > 1e-3 * top
