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


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("*PLASTIC", "*PLASTIC, HARDENING=JOHNSONCOOK", "HARDENING=JOHNSONCOOK is not supported"),
        ("250., 0.", "250., 0.01", "the first row must have 0"),
        ("450., 0.1", "150., 0.1", "softens"),
        ("450., 0.1", "450., 0.1, 300.", "depend on temperature"),
        ("450., 0.1", "450., 0.1\n*CYCLIC HARDENING\n1., 0.", "go together"),
        ("*PLASTIC\n", "*CYCLIC HARDENING\n", "no \\*PLASTIC"),
        ("*PLASTIC\n250., 0.\n", "*PLASTIC, HARDENING=KINEMATIC\n250., 0.\n300., 0.05\n", "more than two rows"),
    ],
)
def test_refused(tmp_path, old, new, words):
    (tmp_path / "deck.inp").write_text(BAR.replace(old, new, 1))
    with pytest.raises(abut.InputError, match=words):
        load_job(tmp_path / "deck.inp")
