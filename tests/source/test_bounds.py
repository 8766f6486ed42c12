"""Bounds of the packages that abut needs: `make lowest` runs the tests with the lowest, `make test` with the newest."""

from __future__ import annotations

import importlib.metadata

import pytest

import lowest


def numbers(version: str) -> tuple[int, ...]:
    return tuple(int(part) for part in version.split(".") if part.isdigit())


def test_every_dependency_has_a_lowest_version() -> None:
    found = lowest.read()
    assert {"numpy", "scipy", "pydantic", "pyamg", "rich", "vtk", "pypardiso"} <= set(found)
    with pytest.raises(ValueError, match="as name>=version"):
        lowest.bounds({"dependencies": ["numpy"]})


def test_what_is_installed_is_not_below() -> None:
    for name, least in lowest.read().items():
        try:
            version = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:  # of another Python or machine
            continue
        assert numbers(version) >= numbers(least), name
