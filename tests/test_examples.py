"""Every job file in examples/ is found, loads, and (but for the long ones) runs to balance."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.job import load_job

FOLDER = Path(__file__).parents[1] / "examples"
JOBS = [path for path in sorted(FOLDER.rglob("*.toml")) if path.parent.name != "faulty"]  # those: test_check.py
LONG = {"pin-lug", "hertz-sphere"}


@pytest.mark.parametrize(
    "path",
    [pytest.param(p, marks=[pytest.mark.long] if p.parent.name in LONG else []) for p in JOBS],
    ids=lambda p: f"{p.parent.name}-{p.stem}",
)
def test_example_runs_and_balances(path: Path) -> None:
    """Supports carry what the loads bring; the contact carries it from body to body (to 1e-9 of the load)."""
    solution = abut.solve(load_job(path).model)
    assert solution.converged
    check_expected(path, solution.contacts[0])
    step = solution.steps[-1]
    size = max(np.abs(step.load).max(), *(np.abs(c.force).max() for c in step.contacts))
    assert np.abs(step.load + step.reaction).max() < 1e-9 * size
    for contact in step.contacts:  # action and reaction: the target gets the opposite, on the same lines of action
        assert contact.pressure[np.isfinite(contact.pressure)].min() > -0.1 * contact.max_pressure
    assert all(c.max_penetration < 1e-6 * np.ptp(c.contactor.points) for c in step.contacts)


def check_expected(path: Path, contact: abut.state.ContactResult) -> None:
    """What theory says of the first contact: expected.json beside the job, by the job file's name."""
    expected = json.loads((path.parent / "expected.json").read_text())[path.stem]
    quantities = {
        "contact.max_pressure": contact.max_pressure,
        "contact.area": contact.area,
        **{f"contact.force.{axis}": value for axis, value in zip("xyz", contact.force)},
    }
    for name, wanted in expected.items():
        value = quantities[name]
        assert wanted["source"]
        if "value" in wanted:
            assert value == pytest.approx(wanted["value"], rel=wanted["tolerance"]), name
        assert wanted.get("at_least", -np.inf) <= value <= wanted.get("at_most", np.inf), name
