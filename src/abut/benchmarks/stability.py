"""Inf-sup constants of two unit squares: the stable pairs, and those that fail."""

from __future__ import annotations

from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.mesh.make import join, rectangle
from abut.model import Contact, Model, Solid, Support
from abut.verify import InfSup, inf_sup

SOURCE = "inf-sup constant in the trace norm over 4 to 32 elements, far sides clamped"
ROUNDED = "the reference is rounded to two or three digits"
HALF_DIGIT = "half a unit of the last printed digit plus 2 %"
UNFELT = "rounding: a pressure that no displacement feels"


def _squares(cell: str, pressure: str, n: int, share: float, method: str) -> Model:
    parts = {
        "lower": rectangle(cells=(n, n), cell=cell),
        "upper": rectangle(y=(1.0, 2.0), cells=(int(n * share), int(n * share)), cell=cell),
    }
    return Model(
        join(parts),
        [Solid(body, LinearElastic(1.0, 0.3)) for body in parts],
        [Support("lower.bottom", x=0, y=0), Support("upper.top", x=0, y=0)],
        contacts=[Contact(contactor="lower.top", target="upper.bottom", pressure=pressure, method=method)],
        plane="strain",
    )


def _measure(result: InfSup) -> dict[str, float]:
    return {"beta": result.levels[-1].trace}


def _pair(
    name: str, cell: str, pressure: str, beta: Reference, n: int = 16, share: float = 1.0,
    method: str = "segment-to-segment",
) -> Benchmark:  # fmt: skip
    return Benchmark(
        f"infsup-{name}",
        f"inf-sup constant, {cell} with {'nodal forces' if 'node' in method else pressure}, {name.split('-', 1)[1]}",
        lambda level: _squares(cell, pressure, n * 2**level, share, method),
        _measure,
        {"beta": beta},
        solve=inf_sup,
    )


def _published(beta: float, tolerance: float = 0.02, reason: str = ROUNDED) -> Reference:
    return Reference(beta, tolerance, SOURCE, reason)


NO_CONSTANT = _published(0.0, 1e-6, UNFELT)
BENCHMARKS = (
    _pair("q1-matching", "quad4", "P1", _published(1.14)),
    _pair("q1-half", "quad4", "P1", _published(0.805), share=0.5),
    _pair("q1-three-quarters", "quad4", "P1", _published(0.815), share=0.75),
    _pair("q2-matching", "quad9", "P2", _published(1.14)),
    _pair("q2-half", "quad9", "P2", _published(0.82), share=0.5),
    _pair("q2-three-quarters", "quad9", "P2", _published(0.81), share=0.75),
    _pair("q1-p0-failing", "quad4", "P0", _published(0.10, 0.07, HALF_DIGIT), n=32),
    _pair("q2-p1d-failing", "quad9", "P1-discontinuous", _published(0.08, 0.0825, HALF_DIGIT), n=32),
    _pair("q1-p1d-failing", "quad4", "P1-discontinuous", NO_CONSTANT),
    _pair("q2-p2d-failing", "quad9", "P2-discontinuous", NO_CONSTANT),
    _pair("q1-two-pass-failing", "quad4", "auto", NO_CONSTANT, share=0.75, method="node-to-segment-two-pass"),
)
