"""Places that a model names: surfaces and node sets must have something in them, lists must be lists."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.mesh import make

STEEL = abut.LinearElastic(young=1000.0, poisson=0.3)
BLOCKS = make.join(
    {
        "lower": make.rectangle([0.0, 1.0], [0.0, 1.0], cells=[1, 1]),
        "upper": make.rectangle([0.0, 1.0], [1.0, 2.0], cells=[1, 1]),
    }
)
HOLLOW = replace(
    BLOCKS,
    surfaces={**BLOCKS.surfaces, "nothing": np.empty((0, 2), np.int64)},
    node_sets={**BLOCKS.node_sets, "nobody": np.empty(0, np.int64)},
)


def model(**entries: Any) -> abut.Model:
    return abut.Model(
        **{
            "mesh": HOLLOW,
            "plane": "strain",
            "solids": [abut.Solid("lower", STEEL), abut.Solid("upper", STEEL)],
            "supports": [abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0, y=-0.1)],
            "contacts": [abut.Contact("upper.bottom", "lower.top")],
            **entries,
        }
    )


@pytest.mark.parametrize(
    ("entries", "where"),
    [
        ({"contacts": [abut.Contact("nothing", "lower.top")]}, r"contacts\[0\]: surface 'nothing' has no facets"),
        ({"contacts": [abut.Contact(contactor="upper.bottom", target="nothing")]}, r"contacts\[0\]: surface 'nothing'"),
        ({"contacts": [abut.Contact("upper.bottom", "nothing", kind="tied")]}, r"contacts\[0\]: surface 'nothing'"),
        ({"supports": [abut.Support("nothing", x=0)]}, r"supports\[0\].on: surface 'nothing' has no facets"),
        ({"supports": [abut.Support("nobody", x=0)]}, r"supports\[0\].on: node set 'nobody' has no nodes"),
        ({"loads": [abut.Pressure("nothing", 1.0)]}, r"loads\[0\].on: surface 'nothing' has no facets"),
        (
            {"contacts": abut.Contact("upper.bottom", "lower.top")},
            "contacts: expected a list of records, .* got Contact",
        ),
        ({"solids": {"lower": STEEL, "upper": STEEL}}, "solids: expected a list of records, .* got dict"),
    ],
)
def test_what_would_be_lost_is_refused(entries: dict[str, Any], where: str) -> None:
    """A support or load on nothing acted on nothing in silence, a contact with it ended in an error of NumPy."""
    with pytest.raises(InputError, match=where):
        model(**entries)


def test_places_that_nothing_names_may_be_empty() -> None:
    assert abut.solve(model()).converged


@pytest.mark.parametrize("function", [abut.solve, abut.check])
def test_a_mesh_is_no_model(function: Any) -> None:
    with pytest.raises(InputError, match=r"expected a model \(abut.Model\), got Mesh"):
        function(HOLLOW)
