"""Load factors of bolts in closed form: springs in a row and side by side."""

from __future__ import annotations

import json
from dataclasses import replace

import pytest

import abut
from abut.benchmarks.preloads import sleeve
from abut.mesh.make import join, rectangle
from abut.solution.load_factor import factor_line

EXACT = 1e-5  # a locked section gives a millionth, which the difference of tensions shows five times as large
LATE = abut.Amplitude(((0.5, 0.0), (1.0, 1.0)))
EARLY = abut.Amplitude(((0.0, 0.0), (0.5, 1.0)))


@pytest.mark.parametrize(("apart", "gain"), [(6000.0, 1200.0), (-6000.0, -1200.0), (13000.0, 3000.0)])
def test_a_bolt_in_a_sleeve(apart, gain):
    """k_bolt / (k_bolt + k_sleeve) = 0.2 up to 12 500 N, where the sleeve lets go; the bolt carries all from there on."""
    solution = abut.solve(sleeve("small", apart=apart))
    factor = abut.load_factors(solution)["bolt"]
    assert factor.value == pytest.approx(gain / abs(apart), rel=EXACT)
    assert factor.tension == pytest.approx(gain, rel=EXACT)
    assert factor.load == pytest.approx(abs(apart), rel=1e-9)


def bolts(**more):
    """Strips 1, 2 and 7 wide, 10 long, under a rigid head that does not turn: two bolts and what they clamp."""
    at = {"thin": (0.0, 1.0), "thick": (2.0, 4.0), "clamped": (5.0, 12.0)}
    parts = {name: rectangle(x, (0.0, 10.0), (1, 5), "quad4") for name, x in at.items()}
    kinds = {"thin": "bilateral", "thick": "bilateral", "clamped": "contact"}
    contacts = [abut.Contact(f"{name}.top", "head.bottom", name, kind=kind) for name, kind in kinds.items()]
    given = {
        "supports": [abut.Support(f"{name}.bottom", x=0, y=0) for name in at],
        "loads": [abut.Force("head", (0.0, 2.0), LATE)],
        "preloads": [abut.Preload("thin", "thin", force=5.0, amplitude=EARLY, lock=0.5),
                     abut.Preload("thick", "thick", shortening=0.03, amplitude=EARLY)],
    }  # fmt: skip
    return abut.Model(
        join({**parts, "head": rectangle((0.0, 12.0), (10.0, 11.0), (1, 1))}),
        [abut.Solid(name, abut.LinearElastic(1000.0, 0.0)) for name in at],
        contacts=contacts,
        plane="stress",
        rigid=[abut.Rigid("head", x=0, rz=0)],
        **{**given, **more},
    )


def test_each_bolt_has_its_share(tmp_path):
    """Of strips side by side, in proportion to their widths; in the files too."""
    solution = abut.solve(bolts())
    factors = abut.load_factors(solution)
    assert {name: factor.value for name, factor in factors.items()} == pytest.approx(
        {"thin": 0.1, "thick": 0.2}, rel=EXACT
    )
    assert abut.load_factors(solution, 0)["thin"].why.startswith("nothing follows")
    abut.write(solution, tmp_path)
    written = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))["load_factors"]
    assert written["thick"]["value"] == factors["thick"].value
    assert "change of loads along it" in (tmp_path / "report.html").read_text(encoding="utf-8")
    assert factor_line("thin", factors["thin"]).startswith("load factor of 'thin': 0.1 (")


MOVED = [abut.Support("thin.bottom", x=0, y=0), abut.Support("thick.bottom", x=0, y=0),
         abut.Support("clamped.bottom", x=0, y=-1e-4, amplitude=LATE)]  # fmt: skip
OPEN = [abut.Preload("thin", "thin", force=5.0, amplitude=EARLY)]


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"loads": []}, "no resultant along it"),
        ({"loads": [abut.Force("head", (2.0, 0.0), LATE)]}, "no resultant along it"),
        ({"loads": [abut.Temperature("thin", 5.0, LATE)]}, "temperatures change"),
        ({"supports": MOVED}, "'clamped.bottom' is moved"),
        ({"preloads": OPEN}, "prescribed to the end"),
        ({"preloads": [replace(OPEN[0], amplitude=None)]}, "prescribed to the end"),
        ({"preloads": [abut.Preload("thin", "thin", shortening=0.03)]}, "nothing follows"),
    ],
)
def test_why_there_is_none(changed, words):
    factor = abut.load_factors(abut.solve(bolts(**changed)))["thin"]
    assert factor.value is None
    assert words in factor.why
    assert factor_line("thin", factor) == f"load factor of 'thin': none, {factor.why}"
