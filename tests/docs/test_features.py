"""Every table of a job file has keys in the schema, closed forms, a page with a picture, is known to check and report."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "docs" / "make"))

import features  # noqa: E402
from page import read_table  # noqa: E402

ELSEWHERE = {("steps", "closed forms")}  # names of times: the page says which test compares them


@pytest.fixture(scope="module")
def rows() -> list[dict[str, str]]:
    return [dict(zip(features.HEADER, features.row(name))) for name in features.names()]


def test_page_is_as_the_code_says(rows: list[dict[str, str]]) -> None:
    """Else: python docs/make/features.py."""
    assert read_table(features.PAGE, "features") == rows


def test_nothing_is_missing(rows: list[dict[str, str]]) -> None:
    missing = {(row["table"].strip("`"), column) for row in rows for column, cell in row.items() if cell in ("", "0")}
    assert missing == ELSEWHERE


def test_what_is_not_there_is_noticed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """A table without a benchmark, pages and an entry of the report has empty cells."""
    monkeypatch.setattr(features, "models", dict)
    monkeypatch.setattr(features, "DOCS", tmp_path)
    for page in ("job.md", "probes.md"):
        (tmp_path / page).write_text("# A page\n\n```toml\n[[other]]\n```\n")
    row = dict(zip(features.HEADER, features.row("springs")))
    assert [column for column, cell in row.items() if not cell] == ["closed forms", "page", "picture", "report"]
