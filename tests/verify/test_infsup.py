"""The numerical inf-sup test: constants of stable and failing pairs, its two ways of solving."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.errors import InputError
from abut.mesh.make import box, join, rectangle
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface
from abut.verify import InfSup, inf_sup, infsup
from abut.verify.trace import TraceSpace, trace_space
from models.patch import ROTATION

ELEMENTS = (4, 8, 16, 32)
TARGET = {
    "matching": (1, 1),
    "half": (1, 2),
    "three quarters": (3, 4),
}  # elements of the target for each of the contactor
ITERATION = 1e-5  # of beta: tolerance 1e-3 of eigenvectors, squared in eigenvalues, with room for clusters of them


def squares(cell: str, n: int, target: str, **contact: object) -> abut.Model:
    """Two unit squares with the far sides clamped; n x n cells on the contactor's side."""
    times, over = TARGET[target]
    m = n * times // over
    return held(
        join({"lower": rectangle((0, 1), (0, 1), (n, n), cell), "upper": rectangle((0, 1), (1, 2), (m, m), cell)}),
        **contact,
    )


def cubes(cell: str, n: int, m: int, **contact: object) -> abut.Model:
    """Two unit cubes, n x n facets on m x m; cells twice as high as wide keep 3D quick."""
    lower, upper = ((k, k, k // 2) for k in (n, m))
    return held(
        join({"lower": box((0, 1), (0, 1), (0, 1), lower, cell), "upper": box((0, 1), (0, 1), (1, 2), upper, cell)}),
        **contact,
    )


def held(mesh: Mesh, **contact: object) -> abut.Model:
    fixed = dict.fromkeys("xyz"[: mesh.dim], 0.0)
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(1.0, 0.3)) for body in mesh.bodies],
        [abut.Support("lower.bottom", **fixed), abut.Support("upper.top", **fixed)],
        contacts=[abut.Contact(contactor="lower.top", target="upper.bottom", **contact)],
        plane="strain" if mesh.dim == 2 else None,
    )


def trend(cell: str, target: str, elements: Sequence[int] = ELEMENTS, **contact: object) -> InfSup:
    return inf_sup([squares(cell, n, target, **contact) for n in elements])


# Printed constants are rounded: half a unit of their last digit, and 2 % for the choice of the trace space.
def near(printed: float, digit: float) -> object:
    return pytest.approx(printed, abs=0.5 * digit + 0.02 * printed)


@pytest.mark.parametrize(
    ("cell", "target", "printed", "digit"),
    [
        ("quad4", "matching", 1.14, 0.01),
        ("quad4", "half", 0.805, 0.005),
        ("quad4", "three quarters", 0.815, 0.005),
        ("quad9", "matching", 1.14, 0.01),
        ("quad9", "half", 0.82, 0.01),
        ("quad9", "three quarters", 0.81, 0.01),
    ],
)
def test_stable_pairs(cell: str, target: str, printed: float, digit: float) -> None:
    """Continuous pressure of the displacement's order: one constant for all meshes."""
    result = trend(cell, target, pressure="P2" if cell == "quad9" else "P1")
    assert [level.trace for level in result.levels] == [near(printed, digit)] * len(ELEMENTS)
    assert abs(result.rate) < 0.01
    assert result.stable
    assert result.verdict.startswith("stable: beta = ")
    assert [level.size for level in result.levels] == pytest.approx([1 / n for n in ELEMENTS])
    assert not any(level.spurious for level in result.levels)


@pytest.mark.parametrize(
    ("cell", "pressure", "coarse", "fine"),
    [("quad4", "P0", 0.75, 0.10), ("quad9", "P1-discontinuous", 0.61, 0.08)],
)
def test_failing_pairs(cell: str, pressure: str, coarse: float, fine: float) -> None:
    """One multiplier for each displacement: the alternating pressure does ever less work, beta falls like h."""
    result = trend(cell, "matching", pressure=pressure)
    assert result.levels[0].trace == near(coarse, 0.01)
    assert result.levels[-1].trace == near(fine, 0.01)
    assert result.rate == pytest.approx(1.0, abs=0.1)
    assert not result.stable
    assert result.verdict.startswith("fails: beta falls with the mesh")


def test_weak_without_a_trend() -> None:
    """A single fine mesh of a failing pair: no trend is known, but the constant is below that of every stable pair."""
    result = inf_sup(squares("quad4", 32, "matching", pressure="P0"))
    assert result.rate is None
    assert not result.stable
    assert result.verdict.startswith("weak")


@pytest.mark.parametrize(
    ("cell", "target", "contact", "spurious"),
    [
        ("quad4", "matching", {"pressure": "P1-discontinuous"}, lambda n: n - 1),  # 2 n against n + 1 displacements
        ("quad4", "half", {"pressure": "P1-discontinuous"}, lambda n: n - 1),
        ("quad9", "matching", {"pressure": "P2-discontinuous"}, lambda n: n - 1),  # 3 n against 2 n + 1
        ("quad9", "half", {"pressure": "P2-discontinuous"}, lambda n: n - 1),
        ("quad4", "matching", {"method": "node-to-segment-two-pass"}, lambda n: n + 1),  # every node twice
        ("quad4", "half", {"method": "node-to-segment-two-pass"}, lambda n: n // 2 + 1),  # every target node
        ("quad9", "matching", {"method": "node-to-segment-two-pass"}, lambda n: 2 * n + 1),
    ],
)
def test_spurious_modes(cell: str, target: str, contact: dict, spurious: object) -> None:
    """More multipliers than normal displacements of the interface: counting gives how many pressures go unfelt."""
    result = trend(cell, target, (4, 8, 16), **contact)
    assert [level.spurious for level in result.levels] == [spurious(n) for n in (4, 8, 16)]
    assert max(level.trace for level in result.levels) < 1e-6
    assert max(level.mesh for level in result.levels) < 1e-6
    assert not result.stable
    assert result.verdict == f"fails: {spurious(16)} spurious pressure modes"


@pytest.mark.parametrize("cell", ["quad4", "quad9"])
def test_one_pass_of_nodes_is_not_unstable(cell: str) -> None:
    """One pass of node-to-segment fails the patch test, not the inf-sup test (no fall with the mesh)."""
    result = trend(cell, "half", (4, 8, 16), method="node-to-segment")
    assert not result.levels[-1].spurious
    assert abs(result.rate) < infsup.FALLING


@pytest.mark.parametrize(
    ("cell", "pressure", "stable", "levels"),
    [
        ("hex8", "auto", True, ((4, 2), (8, 4))),
        ("tet4", "auto", True, ((4, 2), (8, 4))),
        ("hex20", "auto", True, ((4, 2), (8, 4))),
        pytest.param("tet10", "auto", True, ((4, 2), (8, 4)), marks=pytest.mark.long),
        ("hex8", "P0", False, ((4, 4), (8, 8))),
    ],
)
def test_in_3d(cell: str, pressure: str, stable: bool, levels: Sequence[tuple[int, int]]) -> None:
    """Cells keep their shape from level to level; the constants are those of 2D in kind, smaller in number."""
    result = inf_sup([cubes(cell, n, m, pressure=pressure) for n, m in levels])
    assert result.stable == stable
    assert (result.rate < 0.1) if stable else (result.rate > 0.9)


@pytest.fixture
def no_dense(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    monkeypatch.setattr(infsup, "DENSE", 0)
    return monkeypatch


def dense_on_coarse_traces(model: abut.Model, monkeypatch: pytest.MonkeyPatch) -> infsup.InfSupLevel:
    """The dense way with the trace space that the iterative one uses: facets undivided."""

    def coarse(
        surface: Surface,
        degree: int,
        share: NDArray[np.float64],
        divisions: int,
        length: float,
        covered: NDArray[np.float64] | None,
    ) -> TraceSpace:
        return trace_space(surface, degree, share, divisions // 2, length, covered)

    with monkeypatch.context() as patched:
        patched.setattr(infsup, "DENSE", 10**6)
        patched.setattr(infsup, "trace_space", coarse)
        return inf_sup(model).levels[0]


MODELS = {
    "Q1/P1": lambda: squares("quad4", 16, "three quarters"),
    "Q2/P2": lambda: squares("quad9", 8, "three quarters"),
    "Q1/P0": lambda: squares("quad4", 16, "matching", pressure="P0"),
    "Q2/P2-discontinuous": lambda: squares(
        "quad9", 4, "three quarters", pressure="P2-discontinuous"
    ),  # almost spurious
    "hex8/P1": lambda: cubes("hex8", 6, 4),
    "hex20/P2": lambda: cubes("hex20", 4, 2),
}


@pytest.mark.parametrize("name", MODELS)
def test_iterative_equals_dense(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two ways to the same eigenvalues: of h M the same to 1e-6 (there the shift is known exactly). The trace norm is
    first compared on one trace space, to the 1e-3 of its rational approximation in beta^2; against the finer space of
    the dense way, a dual norm over fewer functions is smaller, so that beta comes out larger: by a few per cent for
    pressures that are continuous."""
    model = MODELS[name]()
    dense = inf_sup(model).levels[0]
    same = dense_on_coarse_traces(model, monkeypatch)
    monkeypatch.setattr(infsup, "DENSE", 0)
    iterative = inf_sup(model).levels[0]
    assert iterative.mesh == pytest.approx(dense.mesh, rel=1e-6)
    assert iterative.trace == pytest.approx(same.trace, rel=5e-4)
    assert iterative.trace > dense.trace * (1.0 - 5e-4)
    if "discontinuous" not in name:
        assert iterative.trace < 1.05 * dense.trace
    assert iterative.spurious == dense.spurious == 0
    assert (iterative.multipliers, iterative.space, iterative.size) == (dense.multipliers, dense.space, dense.size)


@pytest.mark.parametrize(
    ("cell", "contact"),
    [
        ("quad4", {"pressure": "P1-discontinuous"}),
        ("quad9", {"pressure": "P2-discontinuous"}),
        ("quad4", {"method": "node-to-segment-two-pass"}),
    ],
)
def test_iterative_finds_spurious_modes(cell: str, contact: dict, no_dense: pytest.MonkeyPatch) -> None:
    result = inf_sup(squares(cell, 8, "matching", **contact))
    assert result.levels[0].spurious > 0
    assert max(result.levels[0].mesh, result.levels[0].trace) < 1e-6
    assert not result.stable
    assert "spurious" in result.verdict


def scaled(model: abut.Model, factor: float, turn: NDArray[np.float64] | None = None) -> abut.Model:
    points = model.mesh.points * factor
    return replace(model, mesh=replace(model.mesh, points=points if turn is None else points @ turn.T))


@pytest.mark.parametrize("factor", [1e-3, 25.4, 1e6])
@pytest.mark.parametrize("build", [lambda: squares("quad4", 8, "three quarters"), lambda: cubes("hex8", 4, 2)])
def test_the_unit_of_length_does_not_matter(build: object, factor: float) -> None:
    """The H1 and H^-1/2 norms add lengths to their slopes, so that by themselves they depend on the unit: lengths count in
    units of the contactor, and the verdict on a model in metres is that on the same model in millimetres."""
    model = build()
    before, after = inf_sup(model), inf_sup(scaled(model, factor))
    assert after.levels[0].mesh == pytest.approx(before.levels[0].mesh, rel=1e-9)
    assert after.levels[0].trace == pytest.approx(before.levels[0].trace, rel=1e-9)
    assert after.levels[0].size == pytest.approx(factor * before.levels[0].size)
    assert after.verdict == before.verdict


def test_bodies_large_against_the_contactor(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without that unit: scaling by s multiplies B S^-1 B^T and h M alike but for the part int u v of S. A body clamped
    on one side at distance s satisfies int u^2 <= (2 s / pi)^2 int |grad u|^2, so beta^2 lies between its limit for s -> 0
    and that over 1 + (2 s / pi)^2, and falls with s."""
    monkeypatch.setattr(infsup, "_length", lambda surface: 1.0)
    model = squares("quad4", 8, "three quarters")
    small, *betas = [inf_sup(scaled(model, s)).levels[0].mesh for s in (1e-4, 1e-3, 0.5, 1.0, 4.0)]
    assert betas[0] == pytest.approx(small, rel=1e-6)
    assert (np.diff(betas) < 0.0).all()
    for s, beta in zip((0.5, 1.0, 4.0), betas[1:]):
        assert small**2 / (1.0 + (2.0 * s / np.pi) ** 2) < beta**2 < small**2


def test_rotation_does_not_matter_in_3d() -> None:
    model = cubes("hex8", 6, 4)
    before, after = inf_sup(model).levels[0], inf_sup(scaled(model, 1.0, ROTATION)).levels[0]
    assert (after.mesh, after.trace) == pytest.approx((before.mesh, before.trace), rel=1e-8)


def test_axisymmetric_pairs() -> None:
    """2 pi r weighs all norms alike: continuous P1 is stable there too, P0 on matching meshes falls."""
    for pressure, stable in (("P1", True), ("P0", False)):
        models = []
        for n in (4, 8, 16):
            model = replace(squares("quad4", n, "matching", pressure=pressure), plane="axisymmetric")
            models.append(model)
        assert inf_sup(models).stable == stable


def test_pressure_norm_of_a_covered_half() -> None:
    """Where the target covers half of the contactor, only that half counts: the constant stays that of a whole one."""
    lower = rectangle((0, 2), (0, 1), (16, 8), "quad4")
    upper = rectangle((0, 1), (1, 2), (6, 6), "quad4")
    result = inf_sup(held(join({"lower": lower, "upper": upper})))
    assert result.stable
    assert result.levels[0].multipliers < 11


def test_bad_input() -> None:
    model = squares("quad4", 4, "matching")
    every = [abut.Support(f"{body}.{side}", x=0, y=0) for body in ("lower", "upper") for side in ("top", "bottom")]
    coarse = join(
        {"lower": rectangle(cells=(1, 1), cell="quad4"), "upper": rectangle(y=(1, 2), cells=(1, 1), cell="quad4")}
    )
    bad = {
        "no contact; add one": replace(model, contacts=[]),
        "is tied; the test is for the normal pressure": replace(
            model, contacts=[replace(model.contacts[0], kind="tied")]
        ),
        "hold every displacement .* leave some free": replace(held(coarse), supports=every),
    }
    for message, wrong in bad.items():
        with pytest.raises(InputError, match=message):
            inf_sup(wrong)
    named = replace(model, contacts=[replace(model.contacts[0], name="joint")])
    with pytest.raises(InputError, match="no contact named 'jiont'; did you mean 'joint'"):
        inf_sup(named, "jiont")
    assert inf_sup(named, "joint").levels[0].contact == "joint"
    with pytest.raises(InputError, match="no model given"):
        inf_sup([])
    rigid = [abut.Support(f"{body}.{side}", x=0, y=0) for body, side in (("lower", "top"), ("upper", "bottom"))]
    with pytest.raises(InputError, match=r"no pressure of contact .* let its bodies deform"):
        inf_sup(replace(model, supports=rigid))
