"""The examples in docstrings do what they say."""

from __future__ import annotations

import doctest
import importlib
import pkgutil

import pytest

import abut

APART = ("abut.cli.__main__", "abut.parallel.")  # run or start something when they are imported: the command line, MPI
WANTED = {
    "Contact",
    "Equation",
    "InputError",
    "LinearElastic",
    "Mesh",
    "Model",
    "Probe",
    "Rigid",
    "SolveOptions",
    "Support",
}
WANTED |= {"find_contacts", "solve", "to_pyvista", "write", "write_report"}


def find_examples() -> dict[str, doctest.DocTest]:
    """Every docstring with an example, by its full name."""
    modules = [info.name for info in pkgutil.walk_packages(abut.__path__, "abut.") if not info.name.startswith(APART)]
    finder = doctest.DocTestFinder()
    found = [test for name in modules for test in finder.find(importlib.import_module(name))]
    return {test.name: test for test in found if test.examples}


EXAMPLES = find_examples()


@pytest.mark.parametrize("name", sorted(EXAMPLES))
def test_an_example_does_what_it_says(name: str) -> None:
    if name.endswith(".to_pyvista"):
        pytest.importorskip("pyvista")
    said: list[str] = []
    doctest.DocTestRunner().run(EXAMPLES[name], out=said.append)
    assert not said, "".join(said)


def test_the_main_names_have_examples() -> None:
    assert set(abut.__all__) >= WANTED
    assert {name.rpartition(".")[2] for name in EXAMPLES} >= WANTED
