"""*PLASTIC: a bar pulled and let go as formulas have it, and what is refused."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.job.load import load_job

BAR = """*NODE
1, 0., 0., 0.
2, 1., 0., 0.
3, 1., 1., 0.
4, 0., 1., 0.
5, 0., 0., 1.
6, 1., 0., 1.
7, 1., 1., 1.
8, 0., 1., 1.
*ELEMENT, TYPE=C3D8, ELSET=BAR
1, 1, 2, 3, 4, 5, 6, 7, 8
*NSET, NSET=LOW
1, 2, 3, 4
*NSET, NSET=HIGH
5, 6, 7, 8
*MATERIAL, NAME=METAL
*ELASTIC
210000., 0.3
*PLASTIC
250., 0.
450., 0.1
*SOLID SECTION, ELSET=BAR, MATERIAL=METAL
*BOUNDARY
LOW, 3, 3
1, 1, 2
2, 2, 2
*STEP
*STATIC
*BOUNDARY
HIGH, 3, 3, 0.02
*END STEP
*STEP
*STATIC
*BOUNDARY
HIGH, 3, 3, 0.019
*END STEP
"""
E, SLOPE, MOST = 210e3, 2000.0, 0.02
FLOWED = (MOST - 250.0 / E) / (1.0 + SLOPE / E)  # plastic strain


def ends(tmp_path, text):
    """Force along the bar at the end of both steps."""
    (tmp_path / "deck.inp").write_text(text)
    solution = abut.solve(load_job(tmp_path / "deck.inp").model)
    half = next(step for step in solution.steps if abs(step.factor - 0.5) < 1e-9)
    return [float(step.stress[:, 2].mean()) for step in (half, solution.steps[-1])]


@pytest.mark.parametrize("hardening", ["", ", HARDENING=KINEMATIC", ", HARDENING=COMBINED"])
def test_bar(tmp_path, hardening):
    """Yield stress 250 and 2000 over the plastic strain, isotropic or as a back stress; then unloaded elastically."""
    text = BAR.replace("*PLASTIC", f"*PLASTIC{hardening}")
    if "COMBINED" in hardening:
        text = text.replace("450., 0.1", "450., 0.1\n*CYCLIC HARDENING\n250., 0.\n350., 0.1")
    slope = SLOPE + (1000.0 if "COMBINED" in hardening else 0.0)
    flowed = (MOST - 250.0 / E) / (1.0 + slope / E)
    full, less = ends(tmp_path, text)
    assert full == pytest.approx(250.0 + slope * flowed, rel=1e-9)
    assert less == pytest.approx(full - 0.001 * E, rel=1e-9)


def test_finite(tmp_path):
    """With NLGEOM the strain is logarithmic, and the stress that of the contracted section."""
    full, _ = ends(tmp_path, BAR.replace("*STEP", "*STEP, NLGEOM").replace("0.02", "0.2").replace("0.019", "0.199"))
    flowed = (np.log(1.2) - 250.0 / E) / (1.0 + SLOPE / E)
    tau = 250.0 + SLOPE * min(flowed, 0.1)  # the table ends at 0.1
    assert flowed > 0.1
    assert full == pytest.approx(tau / np.exp(0.4 * tau / E), rel=1e-6)


@pytest.mark.parametrize("hardening", ["", ", HARDENING=KINEMATIC", ", HARDENING=COMBINED"])
def test_over_temperature(tmp_path, hardening):
    """Held lengthwise and warmed from 20 to 220 degrees, then cooled: compressed beyond the yield stress of 220, torn."""
    text = BAR.replace("210000., 0.3", "210000., 0.3, 0.\n110000., 0.3, 400.").replace(
        "*PLASTIC", f"*PLASTIC{hardening}"
    )
    text = text.replace("450., 0.1", "450., 0.1, 0.\n150., 0., 400.\n250., 0.1, 400.").replace(
        "250., 0.\n", "250., 0., 0.\n"
    )
    if "COMBINED" in hardening:
        text = text.replace("250., 0.1, 400.", "250., 0.1, 400.\n*CYCLIC HARDENING\n250., 0., 0.\n150., 0., 400.")
    text = text.replace("*SOLID", "*EXPANSION, ZERO=20.\n2.E-5\n*SOLID")
    text = text.replace(
        "*BOUNDARY\nLOW", "*NSET, NSET=ALL\nLOW, HIGH\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20.\n*BOUNDARY\nLOW"
    )
    text = text.replace("3, 3, 0.02\n", "3, 3\n*TEMPERATURE\nALL, 220.\n").replace(
        "3, 3, 0.019\n", "3, 3\n*TEMPERATURE\nALL, 20.\n"
    )
    hot, cold = ends(tmp_path, text)
    young, start, slope = at(220.0)
    x = (2e-5 * 200.0 - start / young) / (1.0 + slope / young)
    assert hot == pytest.approx(-start - slope * x, rel=1e-9)
    young, start, slope = at(20.0)
    if hardening:  # the back stress -slope (x - y) of what is left after it flowed back by y, in tension
        torn = young * start / (young + slope)
    else:  # the yield stress has grown by both ways
        torn = young * (x - (young * x - start - slope * x) / (young + slope))
    assert cold == pytest.approx(torn, rel=1e-9)


def at(degrees):
    """Young's modulus, yield stress and hardening."""
    return [np.interp(degrees, [0.0, 400.0], x) for x in ([210e3, 110e3], [250.0, 150.0], [2e3, 1e3])]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("*PLASTIC", "*PLASTIC, HARDENING=JOHNSONCOOK", "HARDENING=JOHNSONCOOK is not supported"),
        ("250., 0.", "250., 0.01", "the first row must have 0"),
        ("450., 0.1", "150., 0.1", "softens"),
        ("450., 0.1", "450., 0.1, 300.", "the first row must have 0"),
        ("450., 0.1", "450., 0.1\n250., 0., -10.", "temperature: must grow"),
        ("450., 0.1", "450., 0.1\n*CYCLIC HARDENING\n1., 0.", "go together"),
        ("*PLASTIC\n", "*CYCLIC HARDENING\n", "no \\*PLASTIC"),
        ("*PLASTIC\n250., 0.\n", "*PLASTIC, HARDENING=KINEMATIC\n250., 0.\n300., 0.05\n", "more than two rows"),
    ],
)
def test_refused(tmp_path, old, new, words):
    (tmp_path / "deck.inp").write_text(BAR.replace(old, new, 1))
    with pytest.raises(abut.InputError, match=words):
        load_job(tmp_path / "deck.inp")
