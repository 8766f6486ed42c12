"""Uniform finite deformation: stretch and shear of every material, and a body that turns without stress."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic, lame
from abut.materials.hyperelastic import NeoHooke
from abut.mesh.make import box, join
from abut.model import Model, Rotation, Solid, SolveOptions, Support
from abut.model.conditions import support_along
from abut.solution import Solution

YOUNG, POISSON = 2.0, 0.3
STRETCH, SHEAR, ANGLE = 1.8, 0.9, 70.0
LAWS: Mapping[str, LinearElastic | NeoHooke] = {
    "linear": LinearElastic(YOUNG, POISSON),
    "square-log": NeoHooke(YOUNG, POISSON, volumetric="square-log"),
    "log-squared": NeoHooke(YOUNG, POISSON, volumetric="log-squared"),
    "isochoric": NeoHooke(YOUNG, POISSON, volumetric="isochoric"),
}
SOURCE = "Bonet and Wood 2008: Cauchy stress from the left Cauchy-Green tensor of a uniform deformation"
REASON = "the elements hold a uniform deformation exactly: rounding and the tolerance of Newton's method"
Array = NDArray[np.float64]


def cauchy(law: str, f: Array) -> Array:
    """Cauchy stress (3, 3) of a deformation gradient (3, 3), in terms of b = F F^T."""
    lambda_, mu = lame(LAWS["linear"], None)  # type: ignore[arg-type]
    b, j, one = f @ f.T, float(np.linalg.det(f)), np.eye(3)
    if law == "linear":
        e = 0.5 * (f.T @ f - one)
        return np.asarray(f @ (lambda_ * np.trace(e) * one + 2.0 * mu * e) @ f.T / j)
    if law == "isochoric":
        bulk = lambda_ + 2.0 * mu / 3.0
        return np.asarray(mu * j ** (-5.0 / 3.0) * (b - np.trace(b) / 3.0 * one) + bulk * (j - 1.0) * one)
    push = lambda_ * np.log(j) if law == "log-squared" else 0.5 * lambda_ * (j**2 - 1.0)
    return np.asarray((mu * (b - one) + push * one) / j)


def _block(law: str, supports: list[Support], level: int, steps: int) -> Model:
    mesh = join({"block": box((0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (1 + level,) * 3, "hex20")})
    return Model(mesh, [Solid("block", LAWS[law])], supports, kinematics="finite", solve=SolveOptions(steps=steps))


def _stretch(law: str) -> Benchmark:
    def lateral() -> float:
        return float(brentq(lambda t: cauchy(law, np.diag([STRETCH, t, t]))[1, 1], 0.3, 1.5, xtol=1e-15))

    def model(level: int) -> Model:
        constraints = [
            support_along(f"block.{on}", axis, 0.0) for on, axis in (("left", "x"), ("front", "y"), ("bottom", "z"))
        ]
        return _block(law, [*constraints, Support("block.right", x=STRETCH - 1.0)], level, 4)

    def measure(solution: Solution) -> dict[str, float]:
        far = solution.displacement[np.isclose(solution.model.mesh.points.sum(axis=1), 3.0)]
        return {
            "force": float(solution.steps[-1].reactions["block.right"][0]),
            "lateral stretch": 1.0 + float(far[0, 1]),
            "stress": float(solution.steps[-1].stress[:, 0].mean()),
        }

    stretch = lateral()
    stress = float(cauchy(law, np.diag([STRETCH, stretch, stretch]))[0, 0])
    return Benchmark(
        f"finite-stretch-{law}",
        f"block stretched to {STRETCH}, sides free, {law}",
        model,
        measure,
        {
            "force": Reference(stress * stretch**2, 1e-9, SOURCE, REASON),
            "lateral stretch": Reference(stretch, 1e-9, SOURCE, REASON),
            "stress": Reference(stress, 1e-9, SOURCE, REASON),
        },
    )


def _shear(law: str) -> Benchmark:
    def moved(component: Callable[[Array], Array]) -> list[Support]:
        return [Support(f"block.{side}", x=component, y=0.0, z=0.0) for side in
                ("left", "right", "front", "back", "bottom", "top")]  # fmt: skip

    def measure(solution: Solution) -> dict[str, float]:
        stress = solution.steps[-1].stress.mean(axis=0)
        return {"shear stress": float(stress[5]), "normal stress": float(stress[0]), "stress across": float(stress[2])}

    f = np.eye(3)
    f[0, 2] = SHEAR
    exact = cauchy(law, f)
    names = {"shear stress": exact[0, 2], "normal stress": exact[0, 0], "stress across": exact[2, 2]}
    return Benchmark(
        f"finite-shear-{law}",
        f"block sheared by {SHEAR}, {law}",
        lambda level: _block(law, moved(lambda x: SHEAR * x[:, 2]), level + 1, 1),
        measure,
        {name: Reference(float(value), 1e-9, SOURCE, REASON) for name, value in names.items()},
    )


def _turn() -> Benchmark:
    def model(level: int) -> Model:
        mesh = join({"block": box((0.0, 2.0), (0.0, 1.0), (0.0, 1.0), (2 + level, 1 + level, 1 + level), "hex8")})
        rotation = Rotation("block.left", np.deg2rad(ANGLE), (0.3, -0.2, 0.5), (1.0, 2.0, -1.0))
        return Model(
            mesh, [Solid("block", LAWS["square-log"])], kinematics="finite", rotations=[rotation],
            solve=SolveOptions(steps=4),
        )  # fmt: skip

    def measure(solution: Solution) -> dict[str, float]:
        start = solution.model.mesh.points
        moved = start + solution.displacement
        change = np.linalg.norm(moved - moved[0], axis=1) - np.linalg.norm(start - start[0], axis=1)
        return {
            "stress": float(np.abs(solution.steps[-1].stress).max()) / YOUNG,
            "distances": float(np.abs(change).max()),
        }

    zero = Reference(0.0, 1e-12, "a rigid motion strains nothing", "rounding of coordinates of size 2")
    return Benchmark(
        "finite-turn",
        f"a block carried round by one of its faces, {ANGLE:g} degrees about a skew axis",
        model,
        measure,
        {"stress": zero, "distances": zero},
    )


BENCHMARKS = (*(_stretch(law) for law in LAWS), *(_shear(law) for law in LAWS), _turn())
