"""Pressure penetration: how far a fluid gets, against closed forms, at small and large displacements."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.benchmarks.penetration import BASE, HEAD, LIGAMENT, THEN, TOE, WEIGHT, uplift
from abut.bodies.follower import follower_pressure
from abut.job.convert import write_job
from abut.job.load import load_job
from abut.mesh.make import box, join, rectangle
from abut.problem.fluid_frames import fluids
from abut.problem.wetting import at_corners
from abut.solution import Saved
from models.oracle import assembled

CELLS = 20
FACET = BASE / CELLS


def _solved(model: abut.Model) -> abut.Solution:
    solution = abut.solve(model)
    assert solution.converged
    return solution


@pytest.mark.parametrize("pressure", ["P1", "dual", "dual-P1"])
@pytest.mark.parametrize("dim", [2, pytest.param(3, marks=pytest.mark.long)])
def test_any_pressure_space_opens_as_far(dim: int, pressure: str) -> None:
    """The crack under a dam with full uplift, c = 3 (F e - p b^2 / 2) / (F - p b), within a facet, at every pressure. Forces
    of the fluid on both sides are equal."""
    cells = 2 * CELLS if dim == 2 else CELLS
    model = uplift(dim, cells)
    model = replace(model, contacts=[replace(model.contacts[0], pressure=pressure)])
    steps = _solved(model).steps
    for step in steps:
        fluid = step.penetrations["joint"]
        ligament = 3.0 * (WEIGHT * TOE - fluid.pressure * BASE**2 / 2.0) / (WEIGHT - fluid.pressure * BASE)
        assert fluid.area == pytest.approx(max(BASE - ligament, 0.0), abs=BASE / cells)
        assert np.abs(fluid.contactor + fluid.target).max() < 1e-10 * WEIGHT
    assert steps[-1].penetrations["joint"].area > 4.0
    assert steps[-1].reactions["layer.bottom"][-1] == pytest.approx(WEIGHT, rel=1e-9)


@pytest.mark.parametrize("cell", ["tri6", *(pytest.param(cell, marks=pytest.mark.long) for cell in ("quad8", "tri3"))])
def test_any_cells_open_as_far(cell: str) -> None:
    """As above, at large displacements (turns of .02), with layer and block meshed unalike."""
    model = uplift(2, CELLS, "finite")
    mesh = join(
        {
            "layer": rectangle((0.0, BASE), (-1.0, 0.0), (CELLS, 1), cell),
            "block": rectangle((0.0, BASE), (0.0, 5.0), (CELLS - 7, 1), cell),
        }
    )
    step = _solved(replace(model, mesh=mesh)).steps[-1]
    fluid = step.penetrations["joint"]
    assert fluid.area == pytest.approx(BASE - LIGAMENT, abs=1.5 * FACET)
    # where it is open the block has turned from the layer, and its base is as much shorter from above
    assert -fluid.target[1] == pytest.approx(fluid.contactor[1], abs=HEAD * BASE * (1.0 - np.cos(0.02)))


LONG = pytest.mark.long


@pytest.mark.parametrize("cell", ["quad4", pytest.param("quad8", marks=LONG), pytest.param("tri6", marks=LONG)])
@pytest.mark.parametrize("facets", [(1, 3), (3, 1), (5, 3)])
def test_unlike_meshes_are_of_second_order(cell: str, facets: tuple[int, int]) -> None:
    """Forces of the fluid on both sides are equal and opposite to rounding, whatever the meshes, and the toe settles by
    what the pressure there, p + 2 (F - p b) / c, asks of its column, with an error of second order in the facets' size:
    the crack ends within a facet, where pressures are linear for one with a kink."""
    wanted, errors = HEAD + 2.0 * (WEIGHT - HEAD * BASE) / LIGAMENT, []
    for coarse in (21, 81):
        mesh = join(
            {
                "layer": rectangle((0.0, BASE), (-1.0, 0.0), (coarse * facets[0], 1), cell),
                "block": rectangle((0.0, BASE), (0.0, 5.0), (coarse * facets[1], 1), cell),
            }
        )
        step = _solved(replace(uplift(2, CELLS), mesh=mesh)).steps[-1]
        fluid = step.penetrations["joint"]
        assert np.abs(fluid.contactor + fluid.target).max() < 1e-12 * WEIGHT
        assert step.reactions["layer.bottom"][-1] == pytest.approx(WEIGHT, rel=1e-10)
        base = mesh.nodes_of("block.bottom")
        toe = base[np.argmax(mesh.points[base, 0])]
        errors.append(abs(-100.0 * step.displacement[toe, 1] / wanted - 1.0))
    assert errors[1] < errors[0] * (21 / 81) ** 1.5
    slope = 2.0 * (WEIGHT - HEAD * BASE) / LIGAMENT**2
    assert errors[1] < slope * (BASE / 81) ** 2 / 8.0 / WEIGHT  # what a kink between two points is missed by


@pytest.mark.parametrize("pressure", ["P1", "dual"])
@pytest.mark.parametrize("cell", ["quad4", "quad8", "hex8", "tet10"])
def test_both_sides_feel_the_same(cell: str, pressure: str) -> None:
    """Force and moment of a fluid in half a closed joint, on either side as contactor, the finer or the coarser one."""
    for low, top in ((9, 4), (4, 9), (3, 9)):
        model = _pressed(cell, low, top, pressure)
        problem, points = assembled(model), model.mesh.points
        term, pair = fluids(problem), problem.pairs[0]
        wet = term.wettings[0].at(pair, points[:, 0] < 0.55, np.zeros(len(points), dtype=bool), points)
        on = [force.reshape(points.shape) for force, _ in term.on_sides(0, wet, 1.0, points)]
        assert np.abs(on[0].sum(axis=0)).max() > 0.4
        both = on[0] + on[1]
        assert both.sum(axis=0) == pytest.approx(np.zeros(model.mesh.dim), abs=1e-12)
        assert points.T @ both == pytest.approx(np.zeros((model.mesh.dim,) * 2), abs=1e-12)


def _pressed(cell: str, low: int, top: int, pressure: str) -> abut.Model:
    """Two blocks whose joint, y or z = 0, has as many facets along x."""
    sizes = {"low": (low, (-1, 0)), "top": (top, (0, 1))}
    if cell.startswith("quad"):
        mesh = join({name: rectangle((0, 1), high, (n, 1), cell) for name, (n, high) in sizes.items()})
    else:
        mesh = join({name: box((0, 1), (0, 1), high, (n, n // 2, 1), cell) for name, (n, high) in sizes.items()})
    held = [abut.Support(side, x=0, y=0, z=0 if mesh.dim == 3 else None) for side in ("low.bottom", "top.top")]
    return abut.Model(
        mesh,
        [abut.Solid(name, abut.LinearElastic(100.0, 0.0)) for name in sizes],
        held,
        contacts=[abut.Contact(contactor="low.top", target="top.bottom", name="joint", pressure=pressure)],
        plane="strain" if mesh.dim == 2 else None,
        penetrations=[abut.Penetration("joint", "low.left", 1.0)],
    )


def test_what_presses_more_than_the_fluid_seals() -> None:
    """Before the crack the least pressure is F / b (1 - 6 (b / 2 - e) / b) = .8: a fluid of .75 stays outside, one of .85
    gets in."""
    for pressure, wet in ((0.75, False), (0.85, True)):
        model = uplift(2, 4 * CELLS)
        fluid = replace(model.penetrations[0], value=pressure)
        last = _solved(replace(model, penetrations=[fluid])).steps[-1]
        assert (last.penetrations["joint"].area > 0.0) == wet
        assert (last.remembered["fluid_pressure"].max() > 0.0) == wet


def test_a_fluid_that_is_let_off_leaves() -> None:
    """Without friction what is let off is as if it had never been there."""
    model = uplift(2, CELLS)
    pulse = abut.Amplitude(((0.0, 0.0), (0.5, 0.0), (0.75, 1.0), (1.0, 0.0)))
    fluid = replace(model.penetrations[0], amplitude=pulse)
    steps = _solved(replace(model, penetrations=[fluid], solve=abut.SolveOptions(times=(0.5, 0.75, 1.0)))).steps
    areas = [step.penetrations["joint"].area for step in steps]
    assert areas[1] > 4.0
    assert areas[0] == areas[2] == 0.0
    assert steps[2].displacement == pytest.approx(steps[0].displacement, abs=1e-9 * np.abs(steps[1].displacement).max())


@pytest.mark.parametrize("dim", [2, pytest.param(3, marks=pytest.mark.long)])
def test_small_strains_open_as_far(dim: int) -> None:
    """As the test above, also with positions that follow the displacements, within a facet."""
    last = _solved(uplift(dim, CELLS, "small-strain")).steps[-1]
    assert last.penetrations["joint"].area == pytest.approx(BASE - LIGAMENT, abs=BASE / CELLS)
    assert last.reactions["layer.bottom"][-1] == pytest.approx(WEIGHT, rel=1e-4)


@pytest.mark.parametrize("kinematics", ["small", pytest.param("finite", marks=pytest.mark.long)])
def test_a_fluid_from_the_target_s_side(kinematics: str) -> None:
    """The source may be named on either side, or as a point."""
    model, areas = uplift(2, CELLS, kinematics), []
    for source in ("layer.left", "block.left", (0.0, 0.0)):
        last = _solved(replace(model, penetrations=[abut.Penetration("joint", source, HEAD, THEN)])).steps[-1]
        areas.append(last.penetrations["joint"].area)
    assert areas[0] == areas[1] == areas[2] > 4.0


@pytest.mark.parametrize("kinematics", ["small", pytest.param("finite", marks=pytest.mark.long)])
def test_a_run_that_goes_on(kinematics: str) -> None:
    """From a step that was saved with the fluid inside, to the same end."""
    model, saved = uplift(2, CELLS, kinematics), list[Saved]()
    whole = abut.solve(model, on_step=lambda _, one: saved.append(one))
    last = abut.solve(model, resume=saved[:-1])
    assert len(last.steps) == len(whole.steps)
    for one, other in zip(whole.steps, last.steps):
        assert other.penetrations["joint"].area == one.penetrations["joint"].area
        size = np.abs(one.displacement).max()
        assert other.displacement == pytest.approx(one.displacement, abs=1e-9 * size)


def test_two_blocks_blown_apart() -> None:
    """A fluid all over a joint that nothing else presses on: each block is pressed together by it, p h / E."""
    young, high = 100.0, 2.0
    mesh = join(
        {name: box((0, 1), (0, 1), z, (2, 2, 2), "hex8") for name, z in (("low", (-high, 0)), ("top", (0, high)))}
    )
    solids = [abut.Solid(name, abut.LinearElastic(young, 0.0)) for name in ("low", "top")]
    held = [abut.Support("low.bottom", x=0, y=0, z=0), abut.Support("top.top", x=0, y=0, z=0)]
    contact = abut.Contact("top.bottom", "low.top", name="joint")
    fluid = abut.Penetration("joint", "low.left", 5.0, name="oil")
    last = _solved(abut.Model(mesh, solids, held, contacts=[contact], penetrations=[fluid])).steps[-1]
    opened = last.displacement[mesh.nodes_of("top.bottom"), 2]
    assert opened == pytest.approx(np.full(9, 5.0 * high / young), rel=1e-9)
    assert last.penetrations["oil"].share == pytest.approx(1.0)
    assert last.reactions["top.top"] == pytest.approx([0.0, 0.0, -5.0], abs=1e-9)


def test_a_joint_that_leaks_all_over_has_no_equilibrium() -> None:
    """A fluid of more than the mean pressure opens all of it, and then nothing holds the block down."""
    model = uplift(2, CELLS)
    leaking = replace(model, penetrations=[replace(model.penetrations[0], value=3.0)])
    with pytest.raises(abut.SingularModelError, match="the loads pull it off its contact"):
        abut.solve(leaking)


def test_the_tangent_of_a_share_of_a_pressure() -> None:
    """Derivative by the positions against central differences, of triangles and of edges round an axis."""
    rng = np.random.default_rng(3)
    flat = join({"a": rectangle((1.0, 2.0), (0.0, 1.0), (2, 2), "tri6")})
    solid = join({"a": box((0, 1), (0, 1), (0, 1), (2, 1, 1), "hex8")})
    for mesh, name in ((replace(flat, axisymmetric=True), "a.top"), (solid, "a.top")):
        surface = mesh.surface(name)
        points = mesh.points + 0.05 * rng.standard_normal(mesh.points.shape)
        share = at_corners(surface, rng.random(len(points)), dual=True)
        moved = rng.standard_normal(points.shape)

        def force(x, share=share, surface=surface):
            return follower_pressure(replace(surface, points=x), 2.0, share=share)

        by = (force(points + 1e-6 * moved)[0] - force(points - 1e-6 * moved)[0]) / 2e-6
        assert force(points)[1] @ moved.ravel() == pytest.approx(by, abs=1e-7)


JOB = """schema = 1
model.plane = "strain"
mesh.bodies.low = {{ kind = "rectangle", x = [0, 4], y = [-1, 0], cells = [4, 1], cell = "quad4" }}
mesh.bodies.top = {{ kind = "rectangle", x = [0, 4], y = [0, 1], cells = [4, 1], cell = "quad4" }}
materials.steel = {{ kind = "linear-elastic", young = 1000, poisson = 0.0 }}
solids = [{{ body = "low", material = "steel" }}, {{ body = "top", material = "steel" }}]
supports = [{{ on = "low.bottom", x = 0, y = 0 }}, {{ on = "top.top", x = 0, y = 0 }}]
[[contacts]]
name = "joint"
surfaces = ["low.top", "top.bottom"]
[[penetrations]]
contact = "{contact}"
source = {source}
value = {value}
[[steps]]
name = "pump"
period = 4
"""


def _job(folder: Path, contact: str = "joint", source: str = '"low.left"', value: str = "2") -> Path:
    path = folder / "job.toml"
    path.write_text(JOB.format(contact=contact, source=source, value=value), encoding="utf-8")
    return path


@pytest.mark.parametrize("source", ['"low.left"', "[4, 0]"])
def test_jobs(tmp_path: Path, source: str) -> None:
    """Read, solved, written and read again."""
    job = load_job(_job(tmp_path, source=source))
    copy, _ = write_job(tmp_path / "copy.toml", job)
    assert load_job(copy).model.penetrations == job.model.penetrations
    assert _solved(job.model).steps[-1].penetrations["joint"].contactor[1] == pytest.approx(-8.0)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"contact": "joynt"}, r"penetrations\[0\].contact: no contact named 'joynt'.*joint"),
        ({"source": '"low.lef"'}, r"penetrations\[0\].source: no surface or node set named 'low.lef'"),
        ({"source": '"top.top"'}, "source: 'top.top' has no point of either side of contact 'joint'"),
        ({"source": "[1, 2, 3]"}, r"penetrations\[0\].source: expected 2 numbers, got 3"),
        ({"value": "-2"}, "penetration of 'joint': value: expected a number > 0"),
    ],
)
def test_what_cannot_be(tmp_path: Path, given: dict[str, str], told: str) -> None:
    with pytest.raises(abut.AbutError, match=told):
        abut.solve(load_job(_job(tmp_path, **given)).model)
