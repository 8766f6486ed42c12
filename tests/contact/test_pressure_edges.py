"""The pressure that is reported, with defaults: its resultant, linear fields, rims, edges within facets, jumps of the gap,
fine and stiff contactors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from abut.cells import BY_CODE
from abut.contact.nodal_recovery import averages
from abut.diagnosis.cures import cure
from abut.job import load_job
from abut.problem.constraints import supports
from abut.problem.contact_pairs import pair
from models.certificate import line as unlike
from models.overlap import strip
from models.pressure import (
    along,
    approach,
    at_corners,
    bent,
    bent_pressure,
    flat_punch,
    iterations,
    line,
    opened,
    quarter_ball,
    square_punch,
    stepped,
)

EXAMPLES = Path(__file__).parents[2] / "examples"
SECOND = ("quad8", "quad9", "tri6", "hex20", "hex27", "tet10", "wedge15")
FIRST = ("quad4", "tri3", "hex8", "tet4", "wedge6")


@pytest.mark.parametrize("kind", ["contact", "tied"])
@pytest.mark.parametrize("cell", SECOND)
def test_linear_pressure_is_exact(cell: str, kind: str) -> None:
    """On cells of second order, at all nodes, mid-nodes included, on meshes that do not match, rims included."""
    contact = abut.solve(bent(cell, 3, kind)).contacts[0]
    used = contact.contactor.nodes >= 0
    exact = bent_pressure(contact.contactor.points[contact.contactor.nodes[used]])
    assert np.abs(contact.pressure[used] - exact).max() < 1e-11


@pytest.mark.parametrize("cell", FIRST)
def test_linear_pressure_on_cells_of_first_order(cell: str) -> None:
    """Their displacements cannot follow: 12 % of the peak at most on three facets (tet4), less on more."""
    found = []
    for n in (3, 16 if cell in ("quad4", "tri3") else 9):
        x, p = at_corners(abut.solve(bent(cell, n)).contacts[0])
        found.append(np.abs(p - bent_pressure(x)).max() / 1.8)
    assert found[0] < 0.12
    assert found[1] < 0.8 * found[0]


MODELS = {
    "flat, covered all over": lambda: bent("hex20", 3),
    "flat, opens": lambda: opened(8),
    "flat, covered in part": lambda: square_punch(0.3),
    "flat under a curved target": lambda: line("quad8", 6),
    "tetrahedra": lambda: quarter_ball("tet4", 5, "block"),
    "curved": lambda: line("quad4", 6, "cylinder"),
}


@pytest.mark.parametrize("name", MODELS)
def test_continuous_positive_and_of_the_right_resultant(name: str) -> None:
    solution = abut.solve(MODELS[name]())
    contact, own = solution.contacts[0], pair(solution.model, solution.model.contacts[0], supports(solution.model))
    used = contact.contactor.nodes >= 0
    nodes, p = contact.contactor.nodes[used], contact.pressure[used]
    size, n = p.max(), len(contact.contactor.points)
    low, high = np.full(n, np.inf), np.full(n, -np.inf)
    np.minimum.at(low, nodes, p)
    np.maximum.at(high, nodes, p)
    assert np.abs(high - low)[nodes].max() <= 1e-14 * size
    assert p.min() >= -1e-12 * size
    at = averages(contact.contactor, own.coupling)
    corners = at.corners >= 0
    values = np.zeros(n)
    values[at.corners[corners]] = contact.pressure[corners]
    if name != "curved":  # flat: averages over its facets
        # Sums of averages are it; those of values of second order nearly, where a root ends within a facet.
        # With four triangles on the radius of a ball those of the exact pressure are 2 % more.
        close = {"flat, opens": 3e-2, "flat under a curved target": 3e-2, "tetrahedra": 5e-2}.get(name, 1e-12)
        force = float(
            own.coupling.weight.ravel() @ np.nan_to_num(contact.multiplier).ravel()
        )  # normals lean under a round target
        assert values @ at.weight == pytest.approx(force, rel=close)
        # The same as an integral, facet by facet.
        integral = np.einsum("fij,fj->", at.mass, np.where(corners, contact.pressure, 0.0))
        assert integral == pytest.approx(force, rel=close)


@pytest.mark.long
@pytest.mark.parametrize("n", [6, 12, 24])
def test_no_bias_at_a_rim(n: int) -> None:
    """Contact that is closed at the contactor's rim and opens elsewhere: the average there would lag behind by a third of
    the pressure's change over a facet. What is left is of second order: a twentieth of the change on 6 facets."""
    (x, p), (at, found) = along(opened(48)), along(opened(n))
    error = found - np.interp(at, x, p)
    change = p[-1] - np.interp(at[-2], x, p)
    assert abs(error[-1]) < 0.05 * change * 6 / n + 0.001 * p.max()
    assert np.abs(error[-3:-1]).max() < 0.05 * change + 0.002 * p.max()


@pytest.mark.parametrize(("part", "limit"), [(0.05, 12), (0.15, 12), (0.3, 6), (0.5, 6), (0.8, 12), (1.0, 12)])
def test_square_punch_whose_edge_ends_within_facets(part: float, limit: float) -> None:
    """A sharp, nearly rigid punch on a plate, the contactor: exact pressures have no bound at the edge. Largest one over the
    mean; slivers do not blow up."""
    contact = abut.solve(square_punch(part, whole=6)).contacts[0]
    assert np.nanmax(contact.pressure) <= limit
    assert contact.max_pressure <= 6.0
    assert contact.force[2] == pytest.approx(-1.0, rel=1e-9)


@pytest.mark.parametrize("cell", ["quad8", "quad9", "tri6"])
def test_next_to_a_sharp_edge(cell: str) -> None:
    """A flat punch, 1 / (pi (1 - x^2)^1/2), the contactor, whose pressure has no bound at its edge: what its last node shows
    is no part of a quadratic's averages, and the node before it is within what its own average is off there, a tenth (of
    d^-1/2 at the distance h over its function (8 2^1/2 - 8) / 3)."""
    solution = abut.solve(flat_punch(cell, 8))
    x, p = at_corners(solution.contacts[0])
    off = p * np.pi * np.sqrt(np.maximum(1.0 - x[:, 0] ** 2, 0.0)) - 1.0
    beside = np.abs(np.abs(x[:, 0]) - 0.875) < 1e-9
    assert beside.sum() == 2
    assert np.abs(off[beside]).max() < (8.0 * np.sqrt(2.0) - 8.0) / 3.0 - 1.0


@pytest.mark.parametrize(("cells", "young"), [((16, 4), 1e4), ((12, 6), 1e4), ((16, 4), 1e6)])
def test_stiff_and_fine_contactor_fails_with_advice(cells: tuple[int, int], young: float) -> None:
    """Ten times and a thousand times as stiff as its target and two or four times as fine: it touches the target's corners
    only, node by node, which no pressure space mends. It converges, is found out, and the cure is to swap."""
    solution = abut.solve(unlike("quad4", cells, (young, 1e3)))
    assert solution.converged
    (failed,) = (check for check in solution.certificate if check.name == "oscillation")
    assert failed.value > 5 * failed.limit
    assert "swap" in cure(failed, solution)
    swapped = abut.solve(unlike("quad4", cells, (young, 1e3), "block"))
    assert all(check.passed for check in swapped.certificate if check.name == "oscillation")


def test_isolated_loaded_nodes_fail() -> None:
    """Every fourth node carries everything, none of their neighbours does: what a difference of neighbours alone misses."""
    solution = abut.solve(unlike("quad4", (16, 4), (1e6, 1e3)))
    _, p = along(solution.model)
    loaded = p > 0.1 * p.max()
    assert loaded.sum() >= 3
    assert not (loaded[1:] & loaded[:-1]).any()
    (alternates,) = (check.value for check in solution.certificate if check.name == "oscillation")
    assert alternates > 1.0 - 1e-9  # all of it; more, as it is compared with what more than such peaks carry


@pytest.mark.long
@pytest.mark.parametrize("space", ["auto", "dual"])
def test_adjusted_in_part(space: str) -> None:
    """Gaps up to 0.005 are taken away, which on some meshes is a part of a facet: nothing is pushed apart, and the punch
    comes down as on a fine mesh. With three facets contact is that of a single one: 12 % on three, 10 on five."""
    fine = approach(abut.solve(strip(24, pressure="P2")), "punch.top")
    for facets, limit in ((3, 0.15), (5, 0.15), (6, 0.1)):
        assert approach(abut.solve(strip(facets, pressure=space)), "punch.top") == pytest.approx(fine, rel=limit)


@pytest.mark.parametrize("space", ["auto", "dual"])
def test_a_step_of_the_target(space: str) -> None:
    """The target steps up by ten times the approach within a facet of the contactor: that must not push the bodies apart.
    With three facets the force is that of the fine mesh; where the step leaves a sliver it is too small, and the certificate
    says so."""
    fine = -abut.solve(stepped(24, pressure="P2")).contacts[0].force[1]
    assert -abut.solve(stepped(3, pressure=space)).contacts[0].force[1] == pytest.approx(fine, rel=0.05)
    sliver = abut.solve(stepped(5, pressure=space))
    assert 0.6 * fine < -sliver.contacts[0].force[1] < 1.05 * fine
    assert not all(check.passed for check in sliver.certificate)


@pytest.mark.long
def test_along_the_bore_of_the_lug() -> None:
    """From the edge of contact inwards the pressure rises: no dip of more than 3 % behind the edge (continuous functions of
    second order had 8 %, after 23 iterations)."""
    solution = abut.solve(load_job(EXAMPLES / "pin-lug" / "job.toml").model)
    assert iterations(solution) <= 12
    contact = solution.contacts[0]
    assert {BY_CODE[code].name for code in contact.contactor.kinds} == {"tri6"}
    x, p = at_corners(contact)
    angle = np.degrees(np.arctan2(x[:, 1], x[:, 0]))
    for plane in (0.0, 8.0):
        here = np.abs(x[:, 2] - plane) < 1e-6
        inwards = p[here][np.argsort(-angle[here])]
        dip = (np.maximum.accumulate(inwards) - inwards).max() / inwards.max()
        assert inwards.max() > 100.0
        assert dip <= 0.03
