"""Long tests end in time: series of random models and fine meshes come last, and what ABUT_LONG_TESTS_UNTIL leaves no time
for is skipped, and says so."""

import os
import time

import pytest


def pytest_runtest_setup(item: pytest.Item) -> None:
    until = float(os.environ.get("ABUT_LONG_TESTS_UNTIL", "inf"))  # seconds since 1970, as `date +%s` prints
    if time.time() > until and any(item.get_closest_marker(name) for name in ("long", "exhaustive")):
        pytest.skip("no time is left for long tests (ABUT_LONG_TESTS_UNTIL)")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    items.sort(key=lambda item: item.get_closest_marker("exhaustive") is not None)
