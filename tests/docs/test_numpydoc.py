"""Docstrings of what is public: every parameter, what comes back, what is raised, in numpydoc's form."""

from __future__ import annotations

import inspect
import re

import pytest

import abut
from abut.errors import AbutError

EVERY = {name: getattr(abut, name) for name in abut.__all__}
DESCRIBED = [name for name, item in EVERY.items() if not (inspect.isclass(item) and issubclass(item, AbutError))]
SECTION = re.compile(r"^([A-Z][a-z]+)\n-+\n(.*?)(?=^[A-Z][a-z]+\n-+\n|\Z)", re.MULTILINE | re.DOTALL)
ENTRY = re.compile(r"^([a-z_, ]+) : (.+)$", re.MULTILINE)


def sections(item: object) -> dict[str, str]:
    return dict(SECTION.findall(inspect.getdoc(item) or ""))


@pytest.mark.parametrize("name", DESCRIBED)
def test_every_parameter_is_described(name: str) -> None:
    """In the order of the signature, each with its type."""
    found = [
        part.strip() for names, _ in ENTRY.findall(sections(EVERY[name])["Parameters"]) for part in names.split(",")
    ]
    assert found == list(inspect.signature(EVERY[name]).parameters)


@pytest.mark.parametrize("name", [name for name in DESCRIBED if inspect.isfunction(EVERY[name])])
def test_functions_say_what_they_return(name: str) -> None:
    assert sections(EVERY[name])["Returns"].strip()


@pytest.mark.parametrize("name", DESCRIBED)
def test_what_refuses_input_says_so(name: str) -> None:
    item = EVERY[name]
    checks_itself = hasattr(item, "__post_init__")
    if checks_itself or (inspect.isfunction(item) and "raise InputError" in inspect.getsource(item)):
        assert "InputError" in sections(item).get("Raises", ""), name


def test_summaries_are_one_sentence() -> None:
    for name in DESCRIBED:
        first = (inspect.getdoc(EVERY[name]) or "").split("\n\n")[0]
        assert first.endswith("."), name
        assert len(first) < 240, name
