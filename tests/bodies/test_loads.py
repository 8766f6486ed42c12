"""Temperature, nodal forces, load histories and adjusted gaps, each where theory gives the answer."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.errors import InputError
from abut.job import load_job
from abut.mesh.make import box, join, rectangle
from abut.mesh.mesh import Mesh

EXACT = 1e-10
YOUNG, NU, ALPHA = 200e3, 0.3, 1.2e-5
STEEL = abut.LinearElastic(YOUNG, NU, expansion=ALPHA)


def pinned(mesh: Mesh, **options: object) -> abut.Model:
    """A body held at its origin and two neighbours only, free to strain."""
    at = {tuple(np.round(x, 9)): i for i, x in enumerate(mesh.points)}
    dim = mesh.dim
    unit = [tuple(float(v) for v in row) for row in np.eye(dim)]
    sets = {"origin": (0.0,) * dim, "x": unit[0], "y": unit[1]}
    mesh = replace(mesh, node_sets={name: np.array([at[where]]) for name, where in sets.items()})
    held = [abut.Support("origin", **dict.fromkeys("xyz"[:dim], 0.0)), abut.Support("x", y=0.0)]
    if dim == 3:
        held += [abut.Support("x", z=0.0), abut.Support("y", z=0.0)]
    bodies = list(mesh.bodies)
    return abut.Model(mesh, [abut.Solid(b, STEEL) for b in bodies], held, **options)


def single(mesh: Mesh) -> Mesh:
    return join({"body": mesh})


def linear(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return 40.0 + 25.0 * points[:, 0] - 60.0 * points[:, 1] + 10.0 * points[:, -1]


@pytest.mark.parametrize("cell", ["hex8", "tet4", "tet10", "hex20", "wedge15"])
def test_a_uniform_temperature_strains_without_stress(cell: str) -> None:
    mesh = single(box((0, 1), (0, 1), (0, 1), (2, 3, 2), cell))
    solution = abut.solve(pinned(mesh, loads=[abut.Temperature("body", 50.0)]))
    assert np.abs(solution.displacement - ALPHA * 50.0 * mesh.points).max() < EXACT * ALPHA * 50.0
    assert np.abs(solution.steps[-1].stress).max() < EXACT * YOUNG * ALPHA * 50.0


@pytest.mark.parametrize(("cell", "plane"), [("hex20", None), ("hex27", None), ("tet10", None), ("quad8", "stress")])
def test_a_linear_temperature_leaves_no_stress(cell: str, plane: str | None) -> None:
    """Strains alpha T with T linear are compatible, and quadratic cells hold their displacements."""
    solid = plane is None
    mesh = single(box((0, 1), (0, 1), (0, 1), (2, 2, 2), cell) if solid else rectangle((0, 1), (0, 1), (3, 2), cell))
    solution = abut.solve(pinned(mesh, loads=[abut.Temperature("body", linear)], plane=plane))
    stress = solution.steps[-1].stress
    assert np.abs(stress).max() < EXACT * YOUNG * ALPHA * 50.0
    assert np.abs(solution.displacement).max() > 0.1 * ALPHA * 50.0


@pytest.mark.parametrize("cell", ["quad4", "quad8", "tri6"])
def test_a_blocked_bar_is_pressed(cell: str) -> None:
    """Between walls, free sideways: -E alpha T, and the supports carry it."""
    mesh = single(rectangle((0, 1), (0, 1), (4, 2), cell))
    model = abut.Model(
        mesh, [abut.Solid("body", STEEL)],
        [abut.Support("body.left", x=0), abut.Support("body.right", x=0), abut.Support("body.bottom", y=0)],
        [abut.Temperature("body", 30.0)], plane="stress", solve=abut.SolveOptions(steps=2),
    )  # fmt: skip
    for step in abut.solve(model).steps:
        exact = -YOUNG * ALPHA * 30.0 * step.factor
        assert np.abs(step.stress[:, 0] / exact - 1.0).max() < EXACT
        assert np.abs(step.stress[:, 1:]).max() < EXACT * abs(exact)
        assert step.reactions["body.left"][0] == pytest.approx(-exact, rel=1e-9)


def test_a_bimetal_bends() -> None:
    """Timoshenko (1925): two strips of equal thickness and modulus, heated by T: curvature 3/2 (a1 - a2) T / h. With nu = 0
    in plane stress, and a beam long against h, ends aside."""
    h, length, change = 0.1, 2.0, 10.0
    lower = rectangle((0, length), (0, h / 2), (40, 2), "quad8")
    upper = rectangle((0, length), (h / 2, h), (30, 2), "quad8")
    mesh = join({"lower": lower, "upper": upper})
    mesh = replace(mesh, node_sets={"foot": np.array([np.abs(mesh.points).sum(axis=1).argmin()])})
    model = abut.Model(
        mesh,
        [abut.Solid("lower", abut.LinearElastic(1e3, 0.0, expansion=2e-5)),
         abut.Solid("upper", abut.LinearElastic(1e3, 0.0, expansion=1e-5))],
        [abut.Support("lower.left", x=0), abut.Support("upper.left", x=0), abut.Support("foot", y=0)],
        [abut.Temperature("lower", change), abut.Temperature("upper", change)],
        [abut.Contact(contactor="upper.bottom", target="lower.top", kind="tied")],
        plane="stress",
    )  # fmt: skip
    u = abut.solve(model).displacement
    bottom = (np.abs(mesh.points[:, 1]) < 1e-9) & (mesh.points[:, 0] > 0.2) & (mesh.points[:, 0] < 1.6)
    curvature = 2.0 * np.polyfit(mesh.points[bottom, 0], u[bottom, 1], 2)[0]
    assert curvature == pytest.approx(1.5 * 1e-5 * change / h, rel=2e-3)  # end effects die out within a few thicknesses


def test_temperature_of_a_ring() -> None:
    """Axisymmetric: a uniformly heated ring grows by alpha T r."""
    mesh = single(rectangle((1, 2), (0, 1), (3, 2), "quad8"))
    model = abut.Model(
        mesh, [abut.Solid("body", STEEL)], [abut.Support("body.bottom", y=0)], [abut.Temperature("body", 50.0)],
        plane="axisymmetric",
    )  # fmt: skip
    solution = abut.solve(model)
    assert np.abs(solution.displacement - ALPHA * 50.0 * mesh.points).max() < EXACT * ALPHA * 50.0
    assert np.abs(solution.steps[-1].stress).max() < EXACT * YOUNG * ALPHA * 50.0


def test_temperatures_add_up() -> None:
    """Of a solid, of its nodes, and of one of its node sets."""
    mesh = single(box((0, 1), (0, 1), (0, 1), (2, 2, 2), "hex8"))
    model = pinned(mesh)
    model = replace(
        model,
        mesh=replace(model.mesh, node_sets={**model.mesh.node_sets, "all": np.arange(len(mesh.points))}),
        solids=[abut.Solid("body", STEEL, temperature=25.0)],
    )
    model = replace(model, loads=[abut.Temperature("body", 20.0), abut.Temperature("all", 5.0)])
    got = abut.solve(model).displacement
    assert np.abs(got - ALPHA * 50.0 * mesh.points).max() < EXACT * ALPHA * 50.0


def test_nodal_forces() -> None:
    """Each node gets the whole force: supports carry their sum, and a bar of linear cells stretches by F L / (E A)."""
    mesh = single(rectangle((0, 1), (0, 1), (4, 2), "quad4"))
    corners = np.flatnonzero((mesh.points[:, 0] == 1.0) & (mesh.points[:, 1] != 0.5))
    mesh = replace(mesh, node_sets={"corners": corners})
    model = abut.Model(
        mesh, [abut.Solid("body", abut.LinearElastic(1000.0, 0.0))],
        [abut.Support("body.left", x=0), abut.Support("body.bottom", y=0)],
        [abut.NodalForce("body.right", (1.0, 0.0)), abut.NodalForce("corners", (-0.5, 0.0))], plane="stress",
    )  # fmt: skip
    solution = abut.solve(model)  # 1/2, 1, 1/2: a uniform traction of 2
    assert solution.steps[-1].reactions["body.left"] == pytest.approx([-2.0, 0.0], abs=1e-12)
    assert np.abs(solution.displacement[:, 0] - 2e-3 * mesh.points[:, 0]).max() < EXACT * 2e-3


def flush(gap: float = 0.0, **contact: object) -> abut.Model:
    """Two columns between walls, free sideways, pressed together by 0.002."""
    lower = box((0, 1), (0, 1), (0, 1), (2, 2, 2), "hex8")
    upper = box((0, 1), (0, 1), (1 + gap, 2 + gap), (3, 3, 2), "hex8")
    mesh = join({"lower": lower, "upper": upper})
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(1000.0, 0.0)) for body in mesh.bodies],
        [abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", x=0, y=0, z=-0.002)],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", **contact)],
    )


@pytest.mark.parametrize("method", ["segment-to-segment", "node-to-segment"])
@pytest.mark.parametrize("gap", [0.001, -0.001])
def test_adjust_takes_gaps_and_overlaps_away(gap: float, method: str) -> None:
    """p = E d / H with the gap or overlap taken for none; without, the gap counts."""
    for adjust, expected in ((0.001, 1.0), (0.0, 1.0 - gap / 0.002)):
        force = abut.solve(flush(gap, adjust=adjust, method=method)).contacts[0].force[2]
        tolerance = 1e-9 if method == "segment-to-segment" else 0.05  # whose pressure is not uniform
        assert force == pytest.approx(expected, rel=tolerance)


def test_adjust_comes_before_the_offset() -> None:
    pressure = abut.solve(flush(0.001, adjust=0.001, offset=-0.002)).contacts[0].pressure
    assert np.nanmax(np.abs(pressure / 2.0 - 1.0)) < 1e-3


def test_swapped_contacts_are_refused() -> None:
    model = flush()
    with pytest.raises(InputError, match="sides swapped: the pressure between them would be determined twice"):
        replace(
            model, contacts=[*model.contacts, abut.Contact(contactor="lower.top", target="upper.bottom", name="again")]
        )


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: abut.Amplitude(()), "at least one pair"),
        (lambda: abut.Amplitude(((0.0, 1.0), (0.0, 2.0))), "times must increase"),
        (lambda: abut.Amplitude(((-0.5, 0.0), (1.0, 1.0))), "there is a point at -0.5;"),
        (lambda: abut.Amplitude(((0.0, float("nan")),)), "finite number"),
        (lambda: abut.Amplitude((1.0, 2.0)), "pairs of time and factor"),
        (lambda: abut.Support("top", x=0, amplitude=2.0), "expected an Amplitude"),
        (lambda: abut.SolveOptions(times=(0.5, 0.5)), "increasing"),
        (lambda: abut.SolveOptions(steps=3, times=(0.5, 1.0)), "give one of them"),
        (lambda: abut.Contact(contactor="a", target="b", adjust=-1.0), "adjust"),
        (lambda: abut.Temperature("a", float("inf")), "finite"),
        (lambda: abut.NodalForce("a", (1.0,)), "2 or 3 numbers"),
    ],
)
def test_bad_records_are_refused(make: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()  # type: ignore[operator]


UP_AND_DOWN = abut.Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, 0.0)))


@pytest.mark.parametrize("law", ["complementarity", "constraint-function"])
def test_unloading_returns_to_nothing(law: str) -> None:
    """Linear and reversible: at every time the pressure is that of the factor, and nothing is left at the end."""
    model = flush(law=law)
    supports = [replace(support, amplitude=UP_AND_DOWN) for support in model.supports]
    model = replace(model, supports=supports, solve=abut.SolveOptions(steps=8))
    solution = abut.solve(model)
    assert solution.converged
    assert [step.factor for step in solution.steps] == pytest.approx(np.arange(1, 9) / 8)
    tolerance = EXACT if law == "complementarity" else 5e-2
    for step in solution.steps[:-1]:
        assert np.nanmax(np.abs(step.contacts[0].pressure / UP_AND_DOWN(step.factor) - 1.0)) < tolerance
    last = solution.steps[-1]
    assert np.nanmax(np.abs(last.contacts[0].pressure)) < (1e-12 if law == "complementarity" else tolerance)
    assert np.abs(last.displacement).max() < 1e-12 * 0.002 or law != "complementarity"
    if law == "complementarity":
        assert all(check.passed for check in solution.certificate), solution.certificate


@pytest.mark.parametrize("linear", ["direct", "amg"])
def test_unloading_a_body_that_contact_alone_holds(linear: str) -> None:
    """A block under a force that goes back to nothing, and stays there: rounding lets nothing go."""
    rest = abut.Amplitude(((0.0, 0.0), (0.25, 1.0), (0.5, 0.0), (0.75, 0.0), (1.0, 2.0)))
    mesh = join(
        {
            "lower": box((0, 1), (0, 1), (0, 1), (3, 3, 2), "hex8"),
            "upper": box((0.2, 0.8), (0.2, 0.8), (1, 1.5), (4, 3, 2), "hex8"),
        }
    )
    model = abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(1000.0, 0.3)) for body in mesh.bodies],
        [abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", x=0, y=0)],
        [abut.Force("upper.top", (0.0, 0.0, -1.0), amplitude=rest)],
        [abut.Contact(contactor="upper.bottom", target="lower.top")],
        solve=abut.SolveOptions(steps=8, linear=linear),
    )
    solution = abut.solve(model)
    assert solution.converged
    for step in solution.steps:
        assert step.contacts[0].force[2] == pytest.approx(rest(step.factor), rel=1e-7, abs=1e-7)


def test_histories_side_by_side() -> None:
    """Without contact all is linear: the sum of what each history does alone, at unequal times."""
    mesh = single(rectangle((0, 2), (0, 1), (4, 2), "quad8"))
    held = [abut.Support("body.left", x=0), abut.Support("body.bottom", y=0)]
    early, late = abut.Amplitude(((0.0, 0.0), (0.3, 2.0))), abut.Amplitude(((0.3, 0.0), (1.0, -1.0)))
    loads = [
        abut.Traction("body.top", (3.0, 0.0)),
        abut.Pressure("body.top", 2.0, amplitude=early),
        abut.Temperature("body", 10.0, amplitude=late),
        abut.Gravity((0.0, -9.81), amplitude=early),
    ]
    moved = abut.Support("body.right", x=0.001, amplitude=late)
    solid = [abut.Solid("body", replace(STEEL, density=1e-3))]
    times = (0.15, 0.4, 1.0)
    model = abut.Model(mesh, solid, [*held, moved], loads, plane="strain", solve=abut.SolveOptions(times=times))
    alone = []
    for i in range(5):
        own = replace(
            model,
            loads=[replace(load, amplitude=None) for j, load in enumerate(loads) if i == j],
            supports=[*held, replace(moved, x=0.001 if i == 4 else 0.0, amplitude=None)],
            solve=abut.SolveOptions(),
        )
        alone.append(abut.solve(own).steps[-1])
    for step in abut.solve(model).steps:
        t = step.factor
        factor = [t, early(t), late(t), early(t), late(t)]
        for name in ("displacement", "stress", "reaction", "load"):
            expected = sum(f * getattr(one, name) for f, one in zip(factor, alone))
            assert np.abs(getattr(step, name) - expected).max() < 1e-9 * np.abs(expected).max(), name


def test_press_fit_in_steps() -> None:
    """Lame: a solid shaft of radius a in a ring up to b, both of one modulus E: p = E d (b^2 - a^2) / (2 a b^2) for the
    radial interference d (plane stress); it grows linearly with d over the steps."""
    a, b, height, interference = 1.0, 2.0, 0.25, 1e-3
    mesh = join(
        {
            "shaft": rectangle((0, a), (0, height), (6, 2), "quad8"),
            "hub": rectangle((a, b), (0, height), (16, 2), "quad8"),
        }
    )
    pressed = abut.Contact(
        contactor="shaft.right", target="hub.left", offset=-interference, amplitude=abut.Amplitude(((0, 0), (1, 1)))
    )
    model = abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(YOUNG, 0.0)) for body in mesh.bodies],
        [abut.Support(f"{body}.bottom", y=0) for body in mesh.bodies],
        contacts=[pressed],
        plane="axisymmetric",
        solve=abut.SolveOptions(steps=4),
    )
    exact = YOUNG * interference * (b**2 - a**2) / (2 * a * b**2)
    steps = abut.solve(model).steps
    for step in steps:
        assert step.contacts[0].max_pressure / exact == pytest.approx(step.factor, rel=1e-4)  # error of the mesh
        ratio = step.contacts[0].max_pressure / steps[-1].contacts[0].max_pressure
        assert ratio == pytest.approx(step.factor, rel=1e-9)
    whole = abut.solve(replace(model, contacts=[replace(pressed, amplitude=None)])).steps
    for step in whole:  # without an amplitude it is there in full from the start
        assert step.contacts[0].max_pressure == pytest.approx(steps[-1].contacts[0].max_pressure, rel=1e-9)


JOB = """
schema = 1
[mesh.bodies.body]
kind = "rectangle"
x = [0, 1]
y = [0, 1]
cells = [4, 2]
cell = "quad4"
[model]
plane = "stress"
[materials.steel]
kind = "linear-elastic"
young = 200e3
poisson = 0.3
expansion = 1.2e-5
[[solids]]
body = "body"
material = "steel"
[[supports]]
on = "body.left"
x = 0
[[supports]]
on = "body.right"
x = 0
[[supports]]
on = "body.bottom"
y = 0
[[loads]]
kind = "temperature"
on = "body"
value = 30
amplitude = {amplitude}
[[loads]]
kind = "nodal-force"
on = "body.right"
value = [1, 0]
amplitude = [[0, 0]]
[solve]
times = [0.25, 1]
"""


def test_job_with_histories(tmp_path: Path) -> None:
    job = tmp_path / "job.toml"
    job.write_text(JOB.format(amplitude="[[0, 0], [0.5, 1.0], [1.0, 0.2]]"))
    steps = abut.solve(load_job(job).model).steps
    assert [step.factor for step in steps] == [0.25, 1.0]
    for step, factor in zip(steps, (0.5, 0.2)):
        assert np.abs(step.stress[:, 0] / (-YOUNG * ALPHA * 30.0 * factor) - 1.0).max() < EXACT


@pytest.mark.parametrize(
    ("amplitude", "message"),
    [
        ("[[0.5, 0], [0, 1]]", r"loads\[0\].amplitude: times must increase"),
        ("[[0, 1, 2]]", r"loads\[0\].amplitude\[0\]"),
        ("3", r"loads\[0\].amplitude"),
    ],
)
def test_bad_amplitude_in_a_job(tmp_path: Path, amplitude: str, message: str) -> None:
    job = tmp_path / "job.toml"
    job.write_text(JOB.format(amplitude=amplitude))
    with pytest.raises(InputError, match=message):
        load_job(job)
