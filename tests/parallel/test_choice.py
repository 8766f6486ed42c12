"""The linear solver on several processes, by PETSc's options and by what the model has."""

from __future__ import annotations

from dataclasses import replace

import pytest

import abut
from abut.errors import InputError
from abut.parallel import linear
from models.friction import rubbed
from models.oracle import assembled


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_the_constraint_function_is_solved_by_factors(monkeypatch: pytest.MonkeyPatch, friction: float) -> None:
    """However large the model; where options ask for multigrid, one message says what to leave out."""
    model = rubbed(2)
    smooth = replace(model.contacts[0], law="constraint-function", friction=friction)
    problem = assembled(replace(model, contacts=[smooth]))
    monkeypatch.setattr(linear, "LARGE_ON_MANY", dict.fromkeys(linear.LARGE_ON_MANY, 1))
    monkeypatch.setattr(linear, "wants_factors", lambda: False)
    monkeypatch.setattr(linear, "wants_iterations", lambda: False)
    assert linear.choose(problem) == "direct"
    assert linear.choose(assembled(replace(model, contacts=[abut.Contact("upper.bottom", "lower.top")]))) == "amg"
    monkeypatch.setattr(linear, "wants_iterations", lambda: True)
    with pytest.raises(InputError, match=r"does not know the constraint function .* leave -ksp_type and -pc_type out"):
        linear.choose(problem)
