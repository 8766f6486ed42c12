"""Probes of plastic strains: a bar pulled beyond yield, whose strains are known."""

from __future__ import annotations

import pytest

import abut
from abut.errors import InputError
from abut.mesh.make import box, join
from abut.report.probes import charts, probe_table

YOUNG, YIELD, HARDENING, STRETCH = 200.0, 0.2, 20.0, 0.01
STEEL = abut.Plastic(YOUNG, 0.3, yield_stress=YIELD, hardening=HARDENING)


def bar(material: object, *probes: abut.Probe) -> abut.Solution:
    mesh = join({"bar": box((0, 2), (0, 1), (0, 1), (2, 1, 1), "hex8")})
    held = [abut.Support("bar.left", x=0), abut.Support("bar.front", y=0), abut.Support("bar.bottom", z=0)]
    held.append(abut.Support("bar.right", x=2.0 * STRETCH))
    solids = [abut.Solid("bar", material)]  # type: ignore[arg-type]
    return abut.solve(abut.Model(mesh, solids, held, probes=probes, solve=abut.SolveOptions(steps=2)))


def test_bar() -> None:
    """Plastic strain (E e - Y) / (E + H) along the bar and minus half of it across; all of it by default."""
    line = abut.Probe("line", line=((0.1, 0.5, 0.5), (1.9, 0.5, 0.5)), points=3)
    point = abut.Probe("point", at=(1.0, 0.2, 0.3), of=("equivalent-plastic-strain",))
    solution = bar(STEEL, line, point)
    known = (YOUNG * STRETCH - YIELD) / (YOUNG + HARDENING)
    values = solution.probes[0].values
    for row in values["plastic_strain"]:
        assert row == pytest.approx([known, -known / 2, -known / 2, 0, 0, 0], abs=1e-12)
    assert values["equivalent_plastic_strain"] == pytest.approx(known, rel=1e-9)
    assert list(solution.probes[1].values) == ["equivalent_plastic_strain"]
    assert solution.probes[1].values["equivalent_plastic_strain"] == pytest.approx(known, rel=1e-9)
    assert any("plastic strain [1]" in chart.title for chart in charts(solution))
    assert "equivalent plastic strain [1]" in probe_table(solution)["head"]  # type: ignore[index]


def test_nothing_yields() -> None:
    """Left out, elastic bodies have none; asked for, it is an error."""
    assert (
        "plastic_strain" not in bar(abut.LinearElastic(YOUNG, 0.3), abut.Probe("p", at=(1, 0.5, 0.5))).probes[0].values
    )
    with pytest.raises(InputError, match="no body of the model may yield; take plastic-strain out"):
        bar(abut.LinearElastic(YOUNG, 0.3), abut.Probe("p", at=(1, 0.5, 0.5), of=("plastic-strain",)))
