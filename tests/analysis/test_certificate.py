"""The certificate: a sound run passes every check, and every check can fail."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.analysis.certificate import BALANCE, certificate
from abut.cli import main
from abut.contact.nodal_recovery import facet_node_values
from abut.job import load_job
from abut.mesh.make import join, rectangle
from abut.output.results import summary
from abut.problem.constraints import supports
from abut.problem.contact_pairs import pair
from abut.problem.pair import Pair
from abut.solution import Check
from models.patch import model, two_blocks

EXAMPLES = Path(__file__).parents[2] / "examples"
SOLID = ((2, 3, 2), (3, 2, 2))
CONTACT = (
    *("force balance", "moment balance", "penetration", "overlap", "faceting", "sliding"),
    *(
        "tension",
        "complementarity",
        "oscillation",
        "resolution",
        "largest pressure",
        "pressure error",
        "contactor's edges",
    ),
    *("facet moments", "loaded area without target", "removed multipliers", "covered twice"),
)


def checks(solution: abut.Solution) -> dict[str, Check]:
    return {check.name: check for check in solution.certificate}


def failed(solution: abut.Solution) -> set[str]:
    return {check.name for check in solution.certificate if not check.passed}


def pressed(n: int, m: int, cell: str = "quad4", **contact: object) -> abut.Model:
    """Two unit squares, clamped on the far sides, pressed and sheared: a pressure that varies along the interface."""
    mesh = join(
        {"lower": rectangle((0, 1), (0, 1), (n, n), cell), "upper": rectangle((0, 1), (1, 2), (m, m), cell)},
    )
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(1.0, 0.3)) for body in mesh.bodies],
        [abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0.02, y=-0.05)],
        contacts=[abut.Contact(contactor="lower.top", target="upper.bottom", **contact)],
        plane="strain",
    )


SOUND: dict[str, Callable[[], abut.Model]] = {
    "patch hex8": lambda: model(two_blocks("hex8", "hex8", SOLID)),
    "patch hex20": lambda: model(two_blocks("hex20", "tet10", SOLID)),
    "pressed Q1": lambda: pressed(12, 9),
    "pressed Q2": lambda: pressed(8, 6, "quad9"),
    "pressed Q1 matching": lambda: pressed(8, 8),
    "smooth law": lambda: pressed(12, 9, law="constraint-function"),
    "example": lambda: load_job(EXAMPLES / "two-blocks" / "job.toml").model,
}


@pytest.mark.parametrize("name", SOUND)
def test_a_sound_run_passes(name: str) -> None:
    solution = abut.solve(SOUND[name]())
    assert failed(solution) == set()
    assert tuple(checks(solution)) == ("model balance", "response", "strain", "rotation", "stress error", *CONTACT)
    assert all(check.meaning for check in solution.certificate)
    assert all(np.isfinite(check.value) and check.value >= 0.0 for check in solution.certificate)


def test_ties_are_checked_for_their_integration_only() -> None:
    assert tuple(checks(abut.solve(pressed(4, 3, kind="tied")))) == (
        "model balance",
        "response",
        "strain",
        "rotation",
        "stress error",
        "force balance",
        *CONTACT[13:],
    )


@pytest.mark.parametrize(
    ("cell", "pressure", "n", "m"),
    [("quad4", "P1-discontinuous", 16, 16), ("quad4", "P1-discontinuous", 12, 9)],
)
def test_oscillation_of_spurious_modes(cell: str, pressure: str, n: int, m: int) -> None:
    """With spurious modes the law picks one of many solutions: a corner of their set, where facets' values jump by about the
    pressure, or one from its inside without any, where interior points end. Which is up to rounding, and so is whether the
    equations of matching meshes are refused as singular on the way."""
    try:
        solution = abut.solve(pressed(n, m, cell, pressure=pressure))
    except abut.SingularModelError:
        assert n == m
        solution = None
    if solution is not None:
        own = solution.contacts[0].multiplier
        even = np.nanmax(own) < 1.2 * np.nanmin(own)
        assert even or "oscillation" in failed(solution)
        assert even or checks(solution)["oscillation"].value > 0.2
    assert checks(abut.solve(pressed(n, m, cell)))["oscillation"].value < 0.01


@pytest.mark.parametrize(("cell", "facets"), [("quad4", (7, 9)), ("quad8", (12, 9))])
def test_oscillation_of_node_to_segment(cell: str, facets: tuple[int, int]) -> None:
    """Its pressure rings from node to node where the meshes differ."""
    built = model(two_blocks(cell, cell, ((facets[0], 3), (facets[1], 3))), method="node-to-segment")
    assert failed(abut.solve(built)) == {"oscillation"}


@pytest.mark.parametrize(("cell", "points"), [("hex8", 1), ("hex20", 2)])
def test_facet_moments_of_too_few_points(cell: str, points: int) -> None:
    """One Gauss point does not integrate linear functions over clipped polygons' triangles times a bilinear map; two do
    not integrate quadratic ones."""
    pressure = "P2" if cell == "hex20" else "auto"
    blocks = two_blocks(cell, cell, ((4, 4, 2), (5, 5, 2)))  # few facets with common edges, which are cut little
    built = model(blocks, integration=abut.Integration("gauss", points), pressure=pressure)
    assert "facet moments" in failed(abut.solve(built))


def test_two_layers_of_target() -> None:
    """Two thin sheets lie one on the other above the contactor and both belong to the target: the nearer one counts."""
    mesh = join(
        {
            "base": rectangle((0, 1), (0, 1), (4, 4), "quad4"),
            "sheet": rectangle((0, 1), (1, 1.05), (3, 1), "quad4"),
            "cover": rectangle((0, 1), (1.05, 1.5), (5, 2), "quad4"),
        }
    )
    both = np.concatenate([mesh.surfaces["sheet.bottom"], mesh.surfaces["cover.bottom"]])
    mesh = replace(mesh, surfaces={**mesh.surfaces, "both": both})
    built = abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(1.0, 0.0)) for body in mesh.bodies],
        [
            abut.Support("base.bottom", x=0, y=0),
            *(abut.Support(f"{body}.top", x=0, y=-0.01) for body in ("sheet", "cover")),
        ],
        contacts=[abut.Contact(contactor="base.top", target="both")],
        plane="strain",
    )
    single = abut.solve(replace(built, contacts=[abut.Contact(contactor="base.top", target="sheet.bottom")]))
    layered = abut.solve(built)
    assert checks(layered)["covered twice"].value < 1e-12
    assert np.abs(layered.displacement - single.displacement).max() < 1e-12 * np.abs(single.displacement).max()


def test_tension_of_the_dual_basis_is_not_shown() -> None:
    """Dual functions are negative at their neighbours' nodes: 2 and -1. Where a block that is about to tip rests on one
    edge, one coefficient carries all, and the multiplier beside it is half as large and pulls; its averages do not."""
    built = pressed(8, 6)
    tipping = replace(
        built,
        supports=[abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0)],
        loads=[abut.Force("upper.right", (0.0, -0.02))],
    )
    solution = abut.solve(tipping)
    contact = solution.contacts[0]
    assert np.nanmin(contact.multiplier) == pytest.approx(-0.5 * np.nanmax(contact.multiplier), rel=1e-9)
    assert np.nanmin(contact.pressure) == 0.0
    assert checks(solution)["tension"].value == 0.0


def test_complementarity_of_a_run_that_did_not_converge(tmp_path: Path) -> None:
    """A ball on a plane starts from one point of contact; the state after one iteration violates the law."""
    text = (EXAMPLES / "hertz-sphere" / "job.toml").read_text().replace("cells = 16", "cells = 3")
    job = tmp_path / "job.toml"
    job.write_text(text.replace("hex20", "hex8") + "\n[solve]\nmax_iterations = 1\n")
    solution = abut.solve(load_job(job).model)
    assert not solution.converged
    assert "complementarity" in failed(solution)
    assert not summary(solution)["certificate"]["passed"]


@cache
def sound() -> tuple[Pair, NDArray[np.float64]]:
    """A pair under uniform pressure, 6 x 6 on 4 x 4 facets, and the coefficients of that pressure."""
    built = model(two_blocks("hex8", "hex8", ((6, 6, 2), (4, 4, 2))))
    own = pair(built, built.contacts[0], supports(built))
    return own, own.space.transfer @ np.ones(len(own))


def certified(own: Pair, values: NDArray[np.float64], *, penetration: float = 0.0, residual: float = 0.0) -> set[str]:
    nodal = facet_node_values(own.contactor, own.coupling.degree, values)
    return {c.name for c in certificate(own, values, nodal, penetration, residual) if not c.passed}


def coupled(own: Pair, **changed: object) -> Pair:
    return replace(own, coupling=replace(own.coupling, **changed))


def test_a_uniform_pressure_is_certified() -> None:
    assert certified(*sound()) == set()


def test_balance_is_checked() -> None:
    """A target force off by twice the limit, and one displaced by it (a couple alone)."""
    own, values = sound()
    target = own.coupling.target_part
    more = coupled(own, target_part=target * (1.0 + 4.0 * BALANCE))
    assert "force balance" in certified(more, values)
    shifted = target.copy().tocsc()
    turn = shifted.tolil()
    total = np.asarray(target.T @ values)
    order = np.argsort(-np.abs(total))
    first, second = order[0], next(k for k in order[1:] if k % 3 == order[0] % 3)
    row = int(np.flatnonzero(values)[0])
    turn[row, first] += (
        0.1 * total[first]
    )  # the same force in the same direction, taken from one node, given to another
    turn[row, second] -= 0.1 * total[first]
    assert certified(coupled(own, target_part=turn.tocsr()), values) == {"moment balance"}


def test_balance_of_a_tie_is_checked() -> None:
    """By components: a shear of 1 beside a compression of 1 is half of the forces' size, and a target that gets 4e-9 more
    than that misses by 2e-9."""
    built = model(two_blocks("hex8", "hex8", ((6, 6, 2), (4, 4, 2))), kind="tied")
    own = pair(built, built.contacts[0], supports(built))
    values = np.zeros((own.space.transfer.shape[0], 3))
    for a, traction in enumerate((1.0, 0.0, -1.0)):
        component = own.components[a]
        values[:, a] = component.transfer @ np.full(len(component), traction)
    normal = facet_node_values(own.contactor, own.coupling.degree, -values[:, 2])

    def verdict(certified: Pair) -> dict[str, Check]:
        return {check.name: check for check in certificate(certified, values, normal, 0.0, 0.0)}

    assert all(check.passed for check in verdict(own).values())
    more = verdict(coupled(own, target_part=own.coupling.target_part * (1.0 + 4.0 * BALANCE)))
    assert {name for name, check in more.items() if not check.passed} == {"force balance"}
    assert more["force balance"].value == pytest.approx(2.0 * BALANCE, rel=1e-3)
    assert abut.solve(pressed(4, 3, kind="tied")).steps[-1].contacts[0].checks[0].value < 1e-14


def test_penetration_and_law_are_checked() -> None:
    own, values = sound()
    assert certified(own, values, penetration=0.005 * own.size) == set()
    assert certified(own, values, penetration=0.02 * own.size) == {"penetration"}
    assert certified(own, values, residual=2e-6) == {"complementarity"}


def test_tension_is_checked() -> None:
    own, values = sound()
    negative = values.copy()
    negative[own.space.transfer[:, 0].nonzero()[0]] = -0.1  # one node at the edge pulls
    assert certified(own, negative) == {"tension"}


def chequered(own: Pair, amount: float) -> NDArray[np.float64]:
    """Pressure 1 with an alternating part from node to node of the structured contactor, flat values (9 n_facets,)."""
    surface = own.contactor
    rank = [np.unique(np.round(surface.points[surface.node_ids] @ t, 6)) for t in _axes(own)]
    at = [np.searchsorted(r, np.round(surface.points @ t, 6)) for r, t in zip(rank, _axes(own))]
    sign = (-1.0) ** (at[0] + at[1])
    return np.where(surface.nodes >= 0, 1.0 + amount * sign[np.maximum(surface.nodes, 0)], 0.0).ravel()


def _axes(own: Pair) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    from models.patch import ROTATION

    return ROTATION[:, 0], ROTATION[:, 1]


def test_alternating_pressure_is_seen() -> None:
    """1 +- a from node to node differs from the mean of its neighbours by 2 a: that over 1 + a is the value."""
    built = model(two_blocks("hex8", "hex8", ((6, 6, 2), (4, 4, 2)), distort=0.0))
    own = pair(built, built.contacts[0], supports(built))
    for amount, expected in ((0.02, set()), (0.05, {"oscillation"})):
        values = chequered(own, amount)
        assert certified(own, values) == expected
        nodal = facet_node_values(own.contactor, 1, values)
        (check,) = (c for c in certificate(own, values, nodal, 0.0, 0.0) if c.name == "oscillation")
        assert check.value == pytest.approx(2.0 * amount / (1.0 + amount), rel=1e-9)


@pytest.mark.parametrize("amount", [0.02, 0.05])
def test_alternating_facets_are_seen(amount: float) -> None:
    """The same of a P0 pressure from facet to facet of a line."""
    built = pressed(12, 12, pressure="P0")
    own = pair(built, built.contacts[0], supports(built))
    x = own.contactor.points[own.contactor.nodes[:, :2], 0].mean(axis=1)
    values = np.zeros((len(own.contactor), 9))
    values[np.argsort(x), :2] = (1.0 + amount * (-1.0) ** np.arange(len(x)))[:, None]
    assert certified(own, values.ravel()) == (set() if amount < 0.03 else {"oscillation"})


@pytest.mark.parametrize("degree", [1, 2])
def test_smooth_pressures_are_not_called_oscillating(degree: int) -> None:
    """A parabola that falls to zero within the surface, as under a ball, has no alternating part."""
    own = pair(built := pressed(16, 12, "quad9" if degree == 2 else "quad4"), built.contacts[0], supports(built))
    p = np.maximum(1.0 - (4.0 * (own.contactor.points[:, 0] - 0.5)) ** 2, 0.0)
    values = np.where(own.contactor.nodes >= 0, p[np.maximum(own.contactor.nodes, 0)], 0.0).ravel()
    assert "oscillation" not in certified(own, values)


def test_cover_is_checked() -> None:
    """A third of every loaded facet covered is too little; so is one multiplier in fifty that is left."""
    own, values = sound()
    part = own.coupling.covered / 3.0
    assert certified(coupled(own, covered=part), values) == {"loaded area without target"}
    few = replace(own, space=replace(own.space, removed=50 * len(own.space)))
    assert certified(few, values) == {"removed multipliers"}


def test_integration_and_cover_are_checked() -> None:
    own, values = sound()
    weight = own.coupling.weight.copy()
    weight[0] *= 1.1
    assert certified(coupled(own, weight=weight), values) == {"facet moments"}
    covered = own.coupling.covered.copy()
    covered[0] *= 1.5
    assert certified(coupled(own, covered=covered), values) == {"covered twice"}


def test_values_that_are_no_numbers_fail() -> None:
    """A comparison with NaN is false: what cannot be computed does not pass."""
    assert not Check("", "x", float("nan"), 1.0, "").passed
    assert Check("", "x", 1.0, 1.0, "").passed
    own, values = sound()
    weight = own.coupling.weight.copy()
    weight[0] = np.nan
    assert "facet moments" in certified(coupled(own, weight=weight), values)


def test_model_balance_and_the_worst_step() -> None:
    """Each check is reported at its worst over the steps; the model's balance from loads and reactions."""
    solution = abut.solve(replace(pressed(4, 3), solve=abut.SolveOptions(steps=2)))
    first, last = solution.steps
    wrong = replace(first, reaction=first.reaction + 1e-3 * np.abs(first.contacts[0].force).max())
    (contact,) = first.contacts
    bad = tuple(replace(c, value=7.0) if c.name == "tension" else c for c in contact.checks)
    doctored = replace(solution, steps=(replace(wrong, contacts=(replace(contact, checks=bad),)), last))
    assert failed(doctored) == {"model balance", "tension"}
    half = first.contacts[0].max_pressure / last.contacts[0].max_pressure  # relative to the largest pressure of the run
    assert checks(doctored)["tension"].value == pytest.approx(7.0 * half)
    nothing = tuple(replace(c, value=float("nan")) if c.name == "tension" else c for c in contact.checks)
    for steps in (
        (replace(first, contacts=(replace(contact, checks=nothing),)), last),
        (first, replace(last, contacts=(replace(contact, checks=nothing),))),
    ):
        assert failed(replace(solution, steps=steps)) == {"tension"}


def test_written_and_printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """`abut run` ends with one line for each check; summary.json has value, limit and verdict of each. The edges of the
    upper block are sharp, where no mesh shows the largest pressure and stresses have no limit, and so coarse cells are 4 %
    too stiff: warnings, with what to do."""
    assert main(["run", str(EXAMPLES / "two-blocks" / "job.toml"), "--output", str(tmp_path / "out")]) == 0
    lines = capsys.readouterr().out.splitlines()
    written = json.loads((tmp_path / "out" / "summary.json").read_text())["certificate"]
    assert written["passed"] is True
    assert [c["name"] for c in written["checks"]] == [
        "model balance",
        "response",
        "strain",
        "rotation",
        "stress error",
        *CONTACT,
    ]
    start = lines.index("certificate   value      limit")
    told = [text for text in lines[start + 1 : -1] if not text.strip().startswith("cure: ")]
    assert len(told) == len(written["checks"]) == len(lines) - start - 5  # three cures; then only where the results are
    assert [c["name"] for c in written["checks"] if c["verdict"] != "pass"] == [
        "stress error",
        "largest pressure",
        "pressure error",
    ]
    report = (tmp_path / "out" / "report.html").read_text()
    assert "checks pass, with a warning of stress error, blocks: largest pressure, blocks: pressure error." in report
    assert "<span class=warn>warn</span>" in report
    for check, text in zip(written["checks"], told):
        assert check["passed"] is (check["value"] <= check["limit"]) is True
        assert check["meaning"]
        name = f"{check['contact']}: {check['name']}" if check["contact"] else check["name"]
        assert bool(check["cure"]) is (check["verdict"] == "warn")
        assert text.split() == [check["verdict"], f"{check['value']:.2e}", f"{check['limit']:.2e}", *name.split()]


def test_failures_are_printed(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A failed check is said so, in the table and in summary.json; the run itself is done (status 0)."""
    text = (EXAMPLES / "two-blocks" / "job.toml").read_text()
    job = tmp_path / "job.toml"
    job.write_text(text + 'integration = { rule = "gauss", points = 1 }\n')
    assert main(["run", str(job)]) == 0
    (line,) = [text for text in capsys.readouterr().out.splitlines() if text.split()[:1] == ["FAIL"]]
    assert line.endswith("blocks: facet moments")
    written = json.loads((tmp_path / "results" / "summary.json").read_text())["certificate"]
    assert written["passed"] is False
    assert [c["name"] for c in written["checks"] if not c["passed"]] == ["facet moments"]
