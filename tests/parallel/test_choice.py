"""The linear solver on several processes, by PETSc's options and by what the model has."""

from __future__ import annotations

from dataclasses import replace

import pytest

from abut.errors import InputError
from abut.parallel import linear
from abut.problem.problem import ContactProblem
from models.friction import rubbed
from models.oracle import assembled


def problem(friction: float, law: str) -> ContactProblem:
    model = rubbed(2)
    return assembled(replace(model, contacts=[replace(model.contacts[0], law=law, friction=friction)]))


@pytest.fixture(autouse=True)
def all_is_large(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without any options of PETSc."""
    monkeypatch.setattr(linear, "LARGE_ON_MANY", dict.fromkeys(linear.LARGE_ON_MANY, 1))
    monkeypatch.setattr(linear, "require_known", lambda: None)
    monkeypatch.setattr(linear, "wants_factors", lambda: False)
    monkeypatch.setattr(linear, "wants_iterations", lambda: False)


def test_the_constraint_function_with_friction_is_solved_by_factors(monkeypatch: pytest.MonkeyPatch) -> None:
    """However large the model; where options ask for multigrid, one message says what to leave out."""
    smooth = problem(0.3, "constraint-function")
    assert linear.choose(smooth) == "direct"
    monkeypatch.setattr(linear, "wants_iterations", lambda: True)
    with pytest.raises(InputError, match=r"the constraint function for it; .* leave -ksp_type and -pc_type out"):
        linear.choose(smooth)


@pytest.mark.parametrize(
    ("friction", "law"), [(0.0, "constraint-function"), (0.0, "complementarity"), (0.3, "complementarity")]
)
def test_all_else_is_for_multigrid(friction: float, law: str) -> None:
    assert linear.choose(problem(friction, law)) == "amg"
