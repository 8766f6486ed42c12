"""Linear solutions of a load step with friction: at most half as many more as without, and three."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

import abut
from abut.job import load_job
from models.search import ball, layer, line

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "bench" / "contact"))

import cases  # noqa: E402

MODELS: dict[str, Callable[[], abut.Model]] = {
    "tilted": lambda: cases.model("tilted-hex8", 3000),
    "hertz": lambda: cases.model("hertz-hex8", 8000),
    "ball": lambda: ball(96, cell="quad4"),
    "cylinder": lambda: line(10, "quad8"),
    "press fit": lambda: load_job(ROOT / "examples" / "two-rings" / "job.toml").model,
}


def solutions(model: abut.Model, friction: float, linear: str) -> int:
    """Of the worst step."""
    contacts = [replace(own, friction=friction) for own in model.contacts]
    solution = abut.solve(replace(model, contacts=contacts, solve=replace(model.solve, linear=linear)))
    assert solution.converged
    assert not any("going on" in note for note in solution.notes)
    return max(len(step.iterations) for step in solution.steps)


@pytest.mark.long
@pytest.mark.parametrize("linear", ["direct", "amg"])
@pytest.mark.parametrize("name", MODELS)
def test_counts(name: str, linear: str) -> None:
    model = MODELS[name]()
    assert solutions(model, 0.3, linear) <= 1.5 * solutions(model, 0.0, linear) + 3


def test_counts_of_a_layer_that_recedes() -> None:
    """Most of what touches at first opens: half spaces foresee it in one iteration after the other, and count as misleading
    only where they said otherwise than the laws."""
    model = layer(200, "quad4")
    assert solutions(model, 0.5, "direct") <= 1.5 * solutions(model, 0.0, "direct") + 3
