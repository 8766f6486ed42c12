"""Deliberately broken couplings: each of them must turn the benchmarks red, or the benchmarks prove nothing.

The benchmarks of the patch test are exact to 1e-10, so that a coupling that is wrong by more shows; those with a gap are
there because in a patch test there is none. Not every benchmark sees every mistake: under uniform pressure the two functions
of a line share evenly what a whole facet gets, and where both halves are alike a scaled target only counts squared.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from abut.benchmarks import BENCHMARKS, run
from abut.contact import coupling
from abut.errors import AbutError

SUITE = (
    "patch-compressed",
    "patch-punch",
    "patch-quad4-quad8",
    "patch-hex8-hex20",
    "patch-tet4-hex8",
    "pin-80-degrees",
)
Raw = dict[str, Any]
Core = Callable[..., Raw]
PER_TARGET_FACET = ("kinds_t", "nodes_t", "order_t", "subdivide_t")  # arguments of the compiled core
HIDDEN = 9  # functions of a facet, padded

couple_surfaces: Core = coupling.couple_surfaces


def flip_normals(**arguments: Any) -> Raw:
    """The contactor looks into its own body."""
    return couple_surfaces(**arguments | {"normals": -arguments["normals"]})


def flip_forces(**arguments: Any) -> Raw:
    """The contact pulls where it should push."""
    raw = couple_surfaces(**arguments)
    for side in ("contactor", "target"):
        row, column, value = raw[side]
        raw[side] = row, column, -value
    return raw


def one_point(**arguments: Any) -> Raw:
    """One quadrature point on each segment."""
    orders = {name: np.ones_like(arguments[name]) for name in ("order_c", "order_t")}
    return couple_surfaces(**arguments | orders)


def with_one_target_facet(arguments: Raw, facet: int) -> Raw:
    """What one target facet alone contributes."""
    own = {name: np.ascontiguousarray(arguments[name][facet : facet + 1]) for name in PER_TARGET_FACET}
    return couple_surfaces(**arguments | own)


def drop_a_segment(**arguments: Any) -> Raw:
    """All that one contactor facet and one target facet share is left out, on both sides."""
    raw = couple_surfaces(**arguments)
    facet = int(np.flatnonzero(raw["segments"])[raw["segments"].astype(bool).sum() // 2])
    parts = (with_one_target_facet(arguments, t) for t in range(len(arguments["kinds_t"])))
    part = next(p for p in parts if p["segments"][facet])
    for name in ("gap", "weight", "mass", "covered", "segments"):
        raw[name][facet] -= part[name][facet]
    for side in ("contactor", "target"):
        own = part[side][0] // HIDDEN == facet
        row, column, value = (np.concatenate([whole, some[own]]) for whole, some in zip(raw[side], part[side]))
        value[len(raw[side][2]) :] *= -1.0
        raw[side] = row, column, value
    return raw


def swap_target_functions(**arguments: Any) -> Raw:
    """On every target facet the first two shape functions stand in each other's place."""
    raw = couple_surfaces(**arguments)
    nodes = arguments["nodes_t"]
    rows, columns, values = [], [], []
    for facet in range(len(nodes)):
        row, column, value = with_one_target_facet(arguments, facet)["target"]
        first, second = nodes[facet, :2]
        rows.append(row)
        columns.append(np.where(column == first, second, np.where(column == second, first, column)))
        values.append(value)
    raw["target"] = np.concatenate(rows), np.concatenate(columns), np.concatenate(values)
    return raw


def flip_gap(**arguments: Any) -> Raw:
    raw = couple_surfaces(**arguments)
    for name in ("gap", "point_gap", "gap_sample_gap"):
        if name in raw:
            raw[name] = -raw[name]
    return raw


def scale_target(**arguments: Any) -> Raw:
    """Action and reaction differ by a millionth."""
    raw = couple_surfaces(**arguments)
    row, column, value = raw["target"]
    raw["target"] = row, column, value * (1.0 + 1e-6)
    return raw


def shift_columns(**arguments: Any) -> Raw:
    """The target's forces stand at the neighbouring points of each facet: all functions moved by one place."""
    raw = couple_surfaces(**arguments)
    nodes = arguments["nodes_t"]
    rows, columns, values = [], [], []
    for facet in range(len(nodes)):
        row, column, value = with_one_target_facet(arguments, facet)["target"]
        own = nodes[facet][nodes[facet] >= 0]
        place = np.full(own.max() + 1, -1)
        place[own] = np.roll(own, 1)
        rows.append(row)
        columns.append(place[column])
        values.append(value)
    raw["target"] = np.concatenate(rows), np.concatenate(columns), np.concatenate(values)
    return raw


MUTATIONS = (
    *(flip_normals, flip_forces, one_point, drop_a_segment, swap_target_functions, shift_columns),
    *(flip_gap, scale_target),
)


def suite() -> dict[str, bool]:
    """Whether each benchmark of the suite passes; one that ends in an error does not."""
    verdicts = {}
    for name in SUITE:
        try:
            verdicts[name] = all(outcome.passed for outcome in run(BENCHMARKS[name], levels=1))
        except AbutError:
            verdicts[name] = False
    return verdicts


@pytest.mark.long
def test_the_unbroken_coupling_passes() -> None:
    assert all(suite().values())


def test_taking_apart_and_putting_together_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    """The mutations go through the target facet by facet: that alone gives the same coupling."""

    def apart(**arguments: Any) -> Raw:
        raw = couple_surfaces(**arguments)
        parts = [with_one_target_facet(arguments, t)["target"] for t in range(len(arguments["kinds_t"]))]
        raw["target"] = tuple(np.concatenate(columns) for columns in zip(*parts))
        return raw

    monkeypatch.setattr(coupling, "couple_surfaces", apart)
    assert all(suite().values())


@pytest.mark.long
@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda m: m.__name__)
def test_a_broken_coupling_is_found(mutation: Core, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(coupling, "couple_surfaces", mutation)
    verdicts = suite()
    assert not all(verdicts.values())
    if mutation is not flip_gap:  # there is no gap in a patch test; whatever else is wrong, one of them shows it
        assert not all(passed for name, passed in verdicts.items() if name.startswith("patch"))
