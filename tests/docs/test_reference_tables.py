"""Keys of job files, bodies made by abut and public names on the pages are what the code has."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "docs" / "make"))

import reference_tables as tables  # noqa: E402
from page import read_marked, write_marked  # noqa: E402


def test_pages_are_as_the_code_says() -> None:
    """Else: python docs/make/reference_tables.py."""
    assert tables.stale() == []


@pytest.mark.parametrize("name", tables.TABLES)
def test_a_changed_page_is_noticed(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page, make = tables.TABLES[name]
    copy = tmp_path / page.name
    copy.write_text(page.read_text(encoding="utf-8"), encoding="utf-8")
    write_marked(copy, name, read_marked(page, name).replace("|", "/", 1))
    monkeypatch.setitem(tables.TABLES, name, (copy, make))
    assert tables.stale() == [name]


def test_nothing_is_in_the_built_site_only() -> None:
    """Tables that a directive writes are not there for who reads the page in the repository."""
    for page in (ROOT / "docs").rglob("*.md"):
        text = page.read_text(encoding="utf-8")
        assert "```{job-keys}" not in text
        assert "```{generators}" not in text
    assert "`[[supports]]`" in read_marked(ROOT / "docs" / "job.md", "job-keys")
