"""Problems with known pressure between bodies of any two moduli and meshes, either side of which may be the contactor."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

import abut
from abut.mesh.make import box, half_disc, join, rectangle, ring
from abut.mesh.make.block import SOLID_CELLS, grid
from abut.solution import ContactResult

sys.path.insert(0, str(Path(__file__).parents[2] / "tests"))
from models import pressure as hertz

Array = NDArray[np.float64]
NU, SOFT = 0.3, 1e3
INSIDE = 0.9  # of the half width or radius of contact, where pressures are compared
PUNCHED = 0.8  # of a flat punch's half width: at its edge the pressure has no limit


@dataclass(frozen=True)
class Case:
    """kind: of the problem; cells: of both sides; ratio: of moduli, first side over second; sizes: facets of both sides over
    the same length; model: without roles; error: of a solution's pressures at all nodes that count, over the largest."""

    kind: str
    cells: tuple[str, str]
    ratio: float
    sizes: tuple[int, int]
    model: Callable[[], abut.Model]
    error: Callable[[abut.Solution], float]

    def forced(self, contactor: int) -> abut.Model:
        """The model with the side ``contactor`` (0 or 1 of those named) for the contactor."""
        model = self.model()
        (contact,) = model.contacts
        sides = contact.named
        return replace(model, contacts=[contact.forced(sides[contactor], sides[1 - contactor])])


def young(ratio: float) -> tuple[float, float]:
    """Young's moduli of both sides, the softer one's always the same."""
    return SOFT * max(ratio, 1.0), SOFT * max(1.0 / ratio, 1.0)


def _solids(ratio: float, bodies: tuple[str, str], nu: float = NU) -> list[abut.Solid]:
    return [abut.Solid(body, abut.LinearElastic(e, nu)) for body, e in zip(bodies, young(ratio))]


def _reported(contact: ContactResult) -> tuple[Array, Array]:
    """Points of the contactor (n, dim) that face the target, mid-nodes included, and the reported pressure there."""
    used = (contact.contactor.nodes >= 0) & contact.covered[:, None]
    return contact.contactor.points[contact.contactor.nodes[used]], contact.pressure[used]


def _modulus(ratio: float) -> float:
    return 1.0 / ((1.0 - NU**2) * sum(1.0 / e for e in young(ratio)))


HALF, ROUND, ACROSS = 6.0, 200.0, 8.0  # half width of contact, radius, length over which facets are counted


def line(cells: tuple[str, str], ratio: float, sizes: tuple[int, int]) -> Case:
    """A cylinder pressed on a block, plane strain; the load is such that a = 6."""
    load = 0.25 * np.pi * HALF**2 * _modulus(ratio) / ROUND

    def model() -> abut.Model:
        cylinder = half_disc(ROUND, (0.0, ROUND), fine=ACROSS, cells=sizes[0], cell=cells[0])
        zones = {"x": [-ACROSS, ACROSS], "y": [-ACROSS, 0.0]}
        block = rectangle((-2 * ROUND, 2 * ROUND), (-4 * ROUND, 0.0), (2 * sizes[1], sizes[1]), cells[1], zones)
        return abut.Model(
            join({"cylinder": cylinder, "block": block}),
            _solids(ratio, ("cylinder", "block")),
            [abut.Support("block.bottom", x=0, y=0), abut.Support("cylinder.axis", x=0)],
            [abut.Force("cylinder.flat", (0.0, -load))],
            [abut.Contact("cylinder.round", "block.top")],
            plane="strain",
        )

    def error(solution: abut.Solution) -> float:
        x, p = _reported(solution.contacts[0])
        peak = 2.0 * load / (np.pi * HALF)
        exact = peak * np.sqrt(np.maximum(1.0 - (x[:, 0] / HALF) ** 2, 0.0))
        return float(np.abs(p - exact)[np.abs(x[:, 0]) < INSIDE * HALF].max() / peak)

    return Case("line", cells, ratio, sizes, model, error)


OUTSIDE, GROWTH = 6, 1.25  # cells across outside of the fine part; growth of those away from the surface


def _away(first: float, depth: float) -> Array:
    """Grid lines from 0 to ``depth``, the first cell about as high as given."""
    n = max(round(np.log1p(depth / first * (GROWTH - 1.0)) / np.log(GROWTH)), 2)
    steps = GROWTH ** np.arange(n)
    return np.concatenate([[0.0], np.cumsum(steps) * (depth / steps.sum())])


def ball(cells: tuple[str, str], ratio: float, sizes: tuple[int, int]) -> Case:
    """A quarter of a ball of radius 1 on a block; contact to a radius of about .05; facets over .08."""
    width, fine = hertz.WIDTH, hertz.FINE

    def part(cell: str, n: int, shape: Callable[[Array], Array] | None) -> abut.Mesh:
        across, up = hertz._lines(n, fine, OUTSIDE), _away(fine / n, width)
        return grid([across, across, up if shape else -up[::-1]], cell, shape)

    def round_off(x: Array) -> Array:
        rise = 1.0 - np.sqrt(1.0 - x[:, 0] ** 2 - x[:, 1] ** 2)
        return np.column_stack([x[:, :2], rise + x[:, 2] * (width - rise) / width])

    def model() -> abut.Model:
        parts = {"ball": part(cells[0], sizes[0], round_off), "block": part(cells[1], sizes[1], None)}
        held = [abut.Support(f"{body}.{side}", **{axis: 0.0})
                for body in parts for side, axis in (("left", "x"), ("front", "y"))]  # fmt: skip
        return abut.Model(
            join(parts),
            _solids(ratio, ("ball", "block")),
            [*held, abut.Support("block.bottom", z=0.0), abut.Support("ball.top", z=-hertz.PRESSED)],
            contacts=[abut.Contact("ball.bottom", "block.top")],
        )

    def error(solution: abut.Solution) -> float:
        x, p = _reported(solution.contacts[0])
        force = 4.0 * abs(float(solution.contacts[0].force[2]))
        radius = float(np.cbrt(0.75 * force / _modulus(ratio)))
        peak, r = 1.5 * force / (np.pi * radius**2), np.linalg.norm(x[:, :2], axis=1)
        exact = peak * np.sqrt(np.maximum(1.0 - (r / radius) ** 2, 0.0))
        return float(np.abs(p - exact)[r < INSIDE * radius].max() / peak)

    return Case("ball", cells, ratio, sizes, model, error)


def rings(cells: tuple[str, str], ratio: float, sizes: tuple[int, int]) -> Case:
    """Two quarter rings, R 1, 2, 3, interference .01, plane strain (Lame); facets over the quarter."""
    radii, interference = (1.0, 2.0, 3.0), 0.01

    def model() -> abut.Model:
        parts = {
            name: ring(radii=r, cells=(6, n), cell=cell)
            for name, r, n, cell in zip(("inner", "outer"), (radii[:2], radii[1:]), sizes, cells)
        }
        held = [abut.Support(f"{body}.{side}", normal=0) for body in parts for side in ("start", "end")]
        return abut.Model(
            join(parts),
            _solids(ratio, ("inner", "outer")),
            held,
            contacts=[abut.Contact("inner.outer", "outer.inner", offset=-interference)],
            plane="strain",
        )

    def error(solution: abut.Solution) -> float:
        _, p = _reported(solution.contacts[0])
        a, b, c = radii
        give = 0.0
        for e, sign, (low, high) in ((young(ratio)[0], -1.0, (a, b)), (young(ratio)[1], 1.0, (b, c))):
            strained, poisson = e / (1.0 - NU**2), NU / (1.0 - NU)
            give += b / strained * ((low**2 + high**2) / (high**2 - low**2) + sign * poisson)
        exact = interference / give
        return float(np.abs(p / exact - 1.0).max())

    return Case("rings", cells, ratio, sizes, model, error)


def punch(cells: tuple[str, str], ratio: float, sizes: tuple[int, int]) -> Case:
    """A flat punch with sharp edges, 1e4 times as stiff as the block (whatever ``ratio`` is): 1 / (pi (1 - x^2)^1/2)."""

    def model() -> abut.Model:
        n, m = sizes
        block = rectangle((-20, 20), (-20, 0), (m, max(m // 2, 1)), cells[1], fine={"x": [-1, 1], "y": [-1, 0]})
        return abut.Model(
            join({"punch": rectangle((-1, 1), (0, 1), (n, max(n // 2, 1)), cells[0]), "block": block}),
            _solids(1e4, ("punch", "block")),
            [abut.Support("block.bottom", x=0, y=0), abut.Support("punch.top", x=0)],
            [abut.Force("punch.top", (0.0, -1.0))],
            [abut.Contact("punch.bottom", "block.top")],
            plane="strain",
        )

    def error(solution: abut.Solution) -> float:
        x, p = _reported(solution.contacts[0])
        near = np.abs(x[:, 0]) < PUNCHED
        exact = 1.0 / (np.pi * np.sqrt(1.0 - x[near, 0] ** 2))
        return float((np.abs(p[near] - exact) / exact).max())

    return Case("punch", cells, 1e4, sizes, model, error)


def column(cells: tuple[str, str], ratio: float, sizes: tuple[int, int]) -> Case:
    """Two blocks of width 1, one on the other, bent and pressed: a linear pressure of .2 to 1.8, whatever the moduli
    (Poisson's ratio 0). Plane, or in 3D four facets deep for each ten across."""
    solid = cells[0] in SOLID_CELLS

    def part(n: int, cell: str, low: float) -> abut.Mesh:
        if solid:
            return box((0, 1), (0, 0.4), (low, low + 0.5), (n, max(2 * n // 5, 1), max(n // 2, 2)), cell)
        return rectangle((0, 1), (low, low + 0.5), (n, max(n // 2, 2)), cell)

    def exact(x: Array) -> Array:
        return 0.2 + 1.6 * x[:, 0]

    def model() -> abut.Model:
        mesh = join({"upper": part(sizes[0], cells[0], 0.5), "lower": part(sizes[1], cells[1], 0.0)})
        along = {"x": 0.0, "y": 0.0} if solid else {"x": 0.0}
        solids = _solids(ratio, ("upper", "lower"), 0.0)
        return abut.Model(
            mesh,
            solids,
            [abut.Support("lower.bottom", **along, **{"z" if solid else "y": 0.0}), abut.Support("upper.top", **along)],
            [abut.Pressure("upper.top", "0.2 + 1.6*x")],
            [abut.Contact("upper.bottom", "lower.top")],
            plane=None if solid else "strain",
        )

    def error(solution: abut.Solution) -> float:
        x, p = _reported(solution.contacts[0])
        return float(np.abs(p - exact(x))[np.abs(2.0 * x[:, 0] - 1.0) < INSIDE].max() / 1.8)

    return Case("column", cells, ratio, sizes, model, error)


KINDS = {"line": line, "ball": ball, "rings": rings, "punch": punch, "column": column}
