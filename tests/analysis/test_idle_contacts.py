"""Contacts that carry nothing are told, and fail where they were meant to."""

from __future__ import annotations

from dataclasses import replace

import pytest

import abut
from abut.diagnosis.cures import cure
from models.certificate import fit
from models.certificate_odd import moved, tower


def verdicts(solution: abut.Solution) -> dict[str, str]:
    return {check.contact: check.verdict for check in solution.certificate if check.name == "carries"}


def test_bodies_that_never_meet_are_a_warning() -> None:
    """A true outcome, and hardly what a run is for."""
    solution = abut.solve(moved(0.005))
    assert list(verdicts(solution).values()) == ["warn"]
    (line,) = (check for check in solution.certificate if check.name == "carries")
    assert "0.005 apart" in line.meaning
    assert len(cure(line, solution)) > 20


def test_beside_others_that_carry_it_is_said() -> None:
    both = tower(0.0)
    solution = abut.solve(replace(both, supports=[*both.supports, abut.Support("b2.top", y=0.01)]))
    assert verdicts(solution) == {"b": "pass"}


def test_a_fit_that_carries_nothing_fails() -> None:
    """Sides that stay apart by a little less than their interference: something (bulges of facets, a wrong sign) undid
    it."""
    held = moved(0.0, gap=0.03)
    contacts = [replace(held.contacts[0], offset=-0.02)]
    solution = abut.solve(replace(held, contacts=contacts))
    assert list(verdicts(solution).values()) == ["FAIL"]
    far = moved(0.0, gap=0.05)
    solution = abut.solve(replace(far, contacts=contacts))
    assert list(verdicts(solution).values()) == ["warn"]  # the mesh leaves more than twice the interference


@pytest.mark.parametrize("interference", [0.02, 1e-3])
def test_fits_that_carry_have_no_such_line(interference: float) -> None:
    assert verdicts(abut.solve(fit((24, 24), "quad4", interference))) == {}
