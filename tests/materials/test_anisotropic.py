"""Materials with directions: off-axis moduli, cylindrical rings and tubes (Lekhnitskii), expansion, contact between them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.materials.directions import frames, turned
from abut.materials.places import Places
from abut.mesh.make import box, join, rectangle, ring
from abut.verify import material_tangent
from abut.verify.tangents import differences
from models.patch import two_blocks

PLY = {"young": (140e3, 10e3, 8e3), "poisson": (0.3, 0.25, 0.4), "shear": (5e3, 4e3, 3.4e3)}
ROUND = 1e-9  # what is left of displacements that cells can follow: rounding times the condition of the equations


def general() -> list[float]:
    """21 constants of a material without any symmetry: a random compliance of moduli about 1e3."""
    rng = np.random.default_rng(5)
    matrix = np.linalg.inv(np.eye(6) * 2e-3 + 4e-4 * (lambda a: a @ a.T)(rng.uniform(-1, 1, (6, 6))))
    return [matrix[i, j] for j in range(6) for i in range(j + 1)]


def tilted(angle: float) -> abut.Axes:
    return abut.Axes(x=(np.cos(angle), np.sin(angle), 0.0), xy=(-np.sin(angle), np.cos(angle), 0.0))


def off_axis(angle: float) -> float:
    """Young's modulus of a ply under an angle to its first direction (Jones, Mechanics of Composite Materials)."""
    (a, b, _), nu, g = PLY["young"], PLY["poisson"][0], PLY["shear"][0]
    c, s = np.cos(angle), np.sin(angle)
    return 1.0 / (c**4 / a + s**4 / b + c**2 * s**2 * (1.0 / g - 2.0 * nu / a))


def tensor(strain: np.ndarray) -> np.ndarray:
    xx, yy, zz, xy, yz, zx = strain
    return np.array([[xx, xy / 2, zx / 2], [xy / 2, yy, yz / 2], [zx / 2, yz / 2, zz]])


@pytest.mark.parametrize("plane", [None, "stress"])
@pytest.mark.parametrize("angle", [0.0, 0.3, 1.0, np.pi / 2])
def test_off_axis_modulus(plane: str | None, angle: float) -> None:
    """A ply pulled under an angle: strain by E_x(theta); a tilted ply also shears."""
    stress = 70.0
    axes = tilted(angle) if plane is None else abut.Axes(x=(np.cos(angle), np.sin(angle)))
    law = abut.Orthotropic(**PLY, axes=axes)
    mesh = (
        box((0, 2), (0, 1), (0, 0.5), (3, 2, 2), "hex8")
        if plane is None
        else rectangle((0, 2), (0, 1), (3, 2), "quad4")
    )
    mesh = join({"ply": mesh})
    corner = int(np.flatnonzero((np.abs(mesh.points) < 1e-12).all(axis=1))[0])
    held = [abut.Support("ply.left", x=0.0)]
    if plane is None:
        held.append(abut.Support("ply.bottom", z=0.0))
    terms = (abut.Term(corner, "y", 1.0),)
    solution = abut.solve(
        abut.Model(
            mesh,
            [abut.Solid("ply", law)],
            held,
            [abut.Traction("ply.right", (stress, 0.0, 0.0)[: mesh.dim])],
            equations=[abut.Equation(terms, 0.0)],
            plane=plane,
        )
    )
    along = solution.displacement[np.abs(mesh.points[:, 0] - 2.0) < 1e-12, 0] / 2.0
    assert along == pytest.approx(stress / off_axis(angle), rel=ROUND)
    assert solution.steps[-1].stress[:, 0] == pytest.approx(stress, rel=ROUND)
    assert solution.steps[-1].stress[:, 1:] == pytest.approx(0.0, abs=ROUND * stress)


@pytest.mark.parametrize("finite", [False, True])
def test_tangent(finite: bool) -> None:
    """Against central differences, with heat, in axes that differ from point to point; symmetric."""
    rng, law = (
        np.random.default_rng(1),
        abut.Anisotropic(general(), axes=abut.Axes("cylindrical"), expansion=(1e-3, 2e-3, -1e-3)),
    )
    here = law.at(Places(rng.uniform(-1, 1, (7, 3)), rng.uniform(-20, 50, 7)))
    strain, none = rng.uniform(-0.1, 0.1, (7, 6)), np.zeros((7, 0))
    told = here.evaluate_finite if finite else here.evaluate
    tangent = told(strain, none)[1]
    assert np.abs(tangent - differences(lambda e: told(e, none)[0], strain)).max() < 1e-7 * np.abs(tangent).max()
    assert tangent == pytest.approx(np.swapaxes(tangent, 1, 2), abs=1e-9 * np.abs(tangent).max())


def test_energy_does_not_turn() -> None:
    """Turning strains and directions together leaves the energy; the rotation of strains agrees with R e R^T."""
    rng = np.random.default_rng(2)
    strain = rng.uniform(-1, 1, 6)
    axes = abut.Axes(x=(1.0, 0.4, -0.3), xy=(0.2, 1.0, 0.6))
    frame = frames(axes, np.zeros((1, 3)))
    local = turned(frame)[0] @ strain
    assert tensor(local) == pytest.approx(frame[0] @ tensor(strain) @ frame[0].T, abs=1e-14)
    here, there = abut.Anisotropic(general()), abut.Anisotropic(general(), axes=axes)
    one = local @ here.evaluate(local[None], here.initial(1))[0][0]
    assert strain @ there.evaluate(strain[None], there.initial(1))[0][0] == pytest.approx(one, rel=1e-12)


def test_orthotropic_by_21_constants() -> None:
    """The same material given either way; isotropic constants give linear elasticity."""
    law = abut.Orthotropic(**PLY)
    order = [0, 1, 2, 3, 5, 4]
    matrix = law.stiffness[np.ix_(order, order)]
    whole = abut.Anisotropic([matrix[i, j] for j in range(6) for i in range(j + 1)])
    assert whole.stiffness == pytest.approx(law.stiffness, rel=1e-14)
    same = abut.Orthotropic([200.0] * 3, [0.3] * 3, [200.0 / 2.6] * 3)
    strain = np.random.default_rng(3).uniform(-1, 1, (4, 6))
    steel = abut.LinearElastic(200.0, 0.3)
    none = steel.initial(4)
    assert same.evaluate(strain, none)[0] == pytest.approx(steel.evaluate(strain, none)[0], rel=1e-12)
    assert material_tangent(law, strain) < 1e-7


@pytest.mark.parametrize("cells", [("hex8", "hex20"), ("hex20", "tet10")])
def test_contact_patch(cells: tuple[str, str]) -> None:
    """Two blocks without any material symmetry under uniform pressure: every displacement and pressure exact."""
    pressure = 2.0
    mesh = two_blocks(*cells, ((2, 2, 2), (3, 3, 2)))
    laws = {
        "lower": abut.Anisotropic(general(), axes=abut.Axes(x=(1.0, 0.5, 0.2), xy=(0.0, 1.0, 0.7))),
        "upper": abut.Orthotropic(
            [900.0, 400.0, 2000.0], [0.3, 0.2, 0.1], [300.0, 250.0, 400.0], axes=abut.Axes(x=(1, 1, 1))
        ),
    }
    slopes = {}
    for body, law in laws.items():
        compliance = np.linalg.inv(law.evaluate(np.zeros((1, 6)), law.initial(1))[1][0])
        xx, yy, zz, xy, yz, zx = -pressure * compliance[:, 2]
        slopes[body] = np.array([[xx, xy, zx], [0.0, yy, yz], [0.0, 0.0, zz]])  # leaves the interface level

    def moved(body: str, x: np.ndarray) -> np.ndarray:
        return x @ slopes[body].T + (body == "upper") * np.array([0, 0, slopes["lower"][2, 2] - slopes["upper"][2, 2]])

    def along(body: str, axis: int):  # type: ignore[no-untyped-def]
        return lambda x: moved(body, x)[:, axis]

    supports = [
        abut.Support("lower.bottom", x=along("lower", 0), y=along("lower", 1), z=0.0),
        abut.Support("upper.top", x=along("upper", 0), y=along("upper", 1)),
    ]
    solution = abut.solve(
        abut.Model(
            mesh,
            [abut.Solid(body, law) for body, law in laws.items()],
            supports,
            [abut.Pressure("upper.top", pressure)],
            [abut.Contact("lower.top", "upper.bottom")],
        )
    )
    for body in laws:
        nodes = np.unique(np.concatenate([n.ravel() for _, n, _ in mesh.cells_of(body)]))
        exact = moved(body, mesh.points[nodes])
        assert np.abs(solution.displacement[nodes] - exact).max() < ROUND * np.abs(exact).max()
    told = solution.contacts[0].pressure
    assert told[np.isfinite(told)] == pytest.approx(pressure, rel=ROUND)


def lekhnitskii(r: np.ndarray, k: float, inner: float, outer: float, pressure: float) -> tuple[np.ndarray, np.ndarray]:
    """Radial and hoop stress of a ring under pressure inside, k^2 hoop over radial stiffness (Lekhnitskii, Anisotropic
    Plates, section 26)."""
    c = inner / outer
    size = pressure * c ** (k + 1) / (1.0 - c ** (2 * k))
    one, two = (r / outer) ** (k - 1), (outer / r) ** (k + 1)
    return size * (one - two), size * k * (one + two)


@pytest.mark.parametrize("model", ["stress", "strain", "axisymmetric"])
def test_ring_under_pressure(model: str) -> None:
    """Radial displacement and stresses of a cylindrically orthotropic ring and a tube held along its axis. Cells of second
    order, 12 through the wall: displacements err by h^4, some 1e-5."""
    inner, outer, pressure = 1.0, 2.0, 3.0
    young, poisson, shear = (50.0, 200.0, 90.0), (0.1, 0.15, 0.3), (40.0, 30.0, 35.0)  # radial, hoop, along the axis
    if model == "axisymmetric":  # radial, along the axis, hoop
        law = abut.Orthotropic(
            (50.0, 90.0, 200.0), (0.15, 0.1, 0.3 * 90.0 / 200.0), (30.0, 40.0, 35.0), expansion=(0.0, 0.0, 0.0)
        )
        mesh = join({"ring": rectangle((inner, outer), (0.0, 0.3), (12, 2), "quad8")})
        held = [abut.Support(f"ring.{side}", y=0.0) for side in ("bottom", "top")]
        load = abut.Pressure("ring.left", pressure)
    else:
        law = abut.Orthotropic(young, poisson, shear, axes=abut.Axes("cylindrical"))
        mesh = join({"ring": ring((inner, outer), (0, 90), cells=(12, 12))})
        held = [abut.Support("ring.start", y=0.0), abut.Support("ring.end", x=0.0)]
        load = abut.Pressure("ring.inner", pressure)
    stiff = np.linalg.inv(abut.Orthotropic(young, poisson, shear).stiffness)
    if model != "stress":  # no strain along the axis
        stiff = stiff - np.outer(stiff[:, 2], stiff[2]) / stiff[2, 2]
    k = float(np.sqrt(stiff[0, 0] / stiff[1, 1]))
    solution = abut.solve(abut.Model(mesh, [abut.Solid("ring", law)], held, [load], plane=model))
    r = mesh.points[:, 0] if model == "axisymmetric" else np.linalg.norm(mesh.points, axis=1)
    radial, hoop = lekhnitskii(r, k, inner, outer, pressure)
    exact = r * (stiff[1, 0] * radial + stiff[1, 1] * hoop)
    u = solution.displacement
    told = u[:, 0] if model == "axisymmetric" else (u * mesh.points).sum(axis=1) / r
    assert told == pytest.approx(exact, rel=3e-5)
    if model == "axisymmetric":
        assert solution.steps[-1].stress[:, 2] == pytest.approx(hoop, rel=5e-3)
        assert solution.steps[-1].stress[:, 0] == pytest.approx(radial, abs=5e-3 * pressure)


def test_tube_in_space() -> None:
    """The tube held along its axis as a quarter in 3D, its axis along y."""
    young, poisson, shear = (50.0, 200.0, 90.0), (0.1, 0.15, 0.3), (40.0, 30.0, 35.0)
    law = abut.Orthotropic(young, poisson, shear, axes=abut.Axes("cylindrical", axis=(0, 0, 1)))
    flat = box((1.0, 2.0), (0.0, 90.0), (0.0, 0.2), (6, 8, 1), "hex20")
    radius, turn = flat.points[:, 0], np.deg2rad(flat.points[:, 1])
    mesh = join(
        {
            "tube": replace(
                flat, points=np.column_stack([radius * np.cos(turn), radius * np.sin(turn), flat.points[:, 2]])
            )
        }
    )
    held = [abut.Support("tube.front", y=0.0), abut.Support("tube.back", x=0.0)]
    held += [abut.Support(f"tube.{side}", z=0.0) for side in ("bottom", "top")]
    solution = abut.solve(abut.Model(mesh, [abut.Solid("tube", law)], held, [abut.Pressure("tube.left", 3.0)]))
    stiff = np.linalg.inv(abut.Orthotropic(young, poisson, shear).stiffness)
    stiff = stiff - np.outer(stiff[:, 2], stiff[2]) / stiff[2, 2]
    r = np.linalg.norm(mesh.points[:, :2], axis=1)
    radial, hoop = lekhnitskii(r, float(np.sqrt(stiff[0, 0] / stiff[1, 1])), 1.0, 2.0, 3.0)
    told = (solution.displacement * mesh.points)[:, :2].sum(axis=1) / r
    assert told == pytest.approx(
        r * (stiff[1, 0] * radial + stiff[1, 1] * hoop), rel=3e-4
    )  # 6 cells: 16 times that of 12


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize("cell", ["hex8", "tet10"])
def test_free_expansion(kinematics: str, cell: str) -> None:
    """Heat strains each direction on its own and stresses nothing: displacements are those of the local directions."""
    axes = abut.Axes(x=(1.0, 0.5, 0.2), xy=(0.0, 1.0, 0.7))
    law = abut.Orthotropic(**PLY, axes=axes, expansion=(1e-4, -2e-4, 5e-4))
    mesh = join({"block": box(cells=(2, 2, 2), cell=cell)})
    frame = frames(axes, np.zeros((1, 3)))[0]
    slope = frame.T @ np.diag(100.0 * np.array([1e-4, -2e-4, 5e-4])) @ frame

    def part(axis: int):  # type: ignore[no-untyped-def]
        return lambda x: x @ slope[axis]

    model = abut.Model(
        mesh,
        [abut.Solid("block", law, temperature=100.0)],
        [abut.Support("block.bottom", x=part(0), y=part(1), z=part(2))],
        kinematics=kinematics,
    )
    solution = abut.solve(model)
    exact = mesh.points @ slope.T
    assert np.abs(solution.displacement - exact).max() < ROUND * np.abs(exact).max()
    assert np.abs(solution.steps[-1].stress).max() < ROUND * 140e3 * 0.05


def test_heated_ring() -> None:
    """Expansion along the radius other than around it stresses a free ring: u = A r + B / r + (1 - nu) d T r ln(r) / 2, d
    the difference of both, in plane stress of otherwise isotropic material."""
    young, nu, degrees, radial, hoop = 200.0, 0.3, 50.0, 3e-4, 1e-4
    law = abut.Orthotropic(
        [young] * 3, [nu] * 3, [young / (2 + 2 * nu)] * 3, axes=abut.Axes("cylindrical"), expansion=(radial, hoop, 0.0)
    )
    mesh = join({"ring": ring((1.0, 2.0), (0, 90), cells=(12, 12))})
    held = [abut.Support("ring.start", y=0.0), abut.Support("ring.end", x=0.0)]
    solution = abut.solve(abut.Model(mesh, [abut.Solid("ring", law, temperature=degrees)], held, plane="stress"))
    beta = (1.0 - nu) * (radial - hoop) * degrees / 2.0

    def push(r: float) -> list[float]:  # radial stress (1 - nu^2) / E by A, B, and the rest
        own = beta * (np.log(r) + 1.0) - radial * degrees + nu * (beta * np.log(r) - hoop * degrees)
        return [1.0 + nu, (nu - 1.0) / r**2, own]

    rows = np.array([push(1.0), push(2.0)])
    a, b = np.linalg.solve(rows[:, :2], -rows[:, 2])
    r = np.linalg.norm(mesh.points, axis=1)
    told = (solution.displacement * mesh.points).sum(axis=1) / r
    assert told == pytest.approx(a * r + b / r + beta * r * np.log(r), rel=1e-5)


def test_finite_pull() -> None:
    """Pulled far along its second direction the block takes S22 = E2 (stretch^2 - 1) / 2 of its undeformed area."""
    stretch = 1.3
    law = abut.Orthotropic(**PLY, axes=abut.Axes(x=(0, 1, 0), xy=(1, 0, 0)))  # local 2 is x
    mesh = join({"bar": box((0, 2), (0, 1), (0, 1), (2, 1, 1), "hex8")})
    held = [abut.Support("bar.left", x=0), abut.Support("bar.front", y=0), abut.Support("bar.bottom", z=0)]
    held.append(abut.Support("bar.right", x=2.0 * (stretch - 1.0)))
    solution = abut.solve(abut.Model(mesh, [abut.Solid("bar", law)], held, kinematics="finite"))
    second = 10e3 * (stretch**2 - 1.0) / 2.0
    across = 1.0 + 2.0 * np.array([-0.3 / 140e3, -0.4 / 10e3]) * second  # squared stretches of local 1 and 3
    assert solution.steps[-1].stress[:, 0] == pytest.approx(stretch * second / np.sqrt(np.prod(across)), rel=1e-8)
    top = np.abs(mesh.points[:, 1] - 1.0) < 1e-9
    assert 1.0 + solution.displacement[top, 1] == pytest.approx(np.sqrt(across[0]), rel=1e-9)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"young": (1.0, 0.0, 1.0)}, "young: E2 must be > 0"),
        ({"shear": (1.0, 1.0, -2.0)}, "shear: G23 must be > 0"),
        ({"young": (1.0, 1.0)}, "young: expected three numbers"),
        ({"poisson": (0.3, 0.25, 1.2)}, "nu23 must lie within the square root of E2 / E3"),
        ({"young": (1.0, 1.0, 1.0), "poisson": (0.7, 0.7, 0.7)}, "1 - nu12 nu21"),
        ({"axes": "cylindrical"}, "axes: expected Axes"),
    ],
)
def test_refused(changed: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said.replace("(", r"\(")):
        abut.Orthotropic(**{**PLY, **changed})  # type: ignore[arg-type]


def test_refused_anisotropic() -> None:
    values = general()
    with pytest.raises(InputError, match="expected 21 numbers"):
        abut.Anisotropic(values[:-1])
    with pytest.raises(InputError, match="not positive definite"):
        abut.Anisotropic([*values[:2], -values[2], *values[3:]])
    mesh = join({"ring": rectangle((1.0, 2.0), (0.0, 0.3), (2, 2))})
    with pytest.raises(InputError, match="out of the plane"):
        abut.Model(mesh, [abut.Solid("ring", abut.Anisotropic(values))], plane="strain")
    around = abut.Orthotropic(**PLY, axes=abut.Axes("cylindrical"))
    with pytest.raises(InputError, match="the model is axisymmetric"):
        abut.Model(mesh, [abut.Solid("ring", around)], plane="axisymmetric")
