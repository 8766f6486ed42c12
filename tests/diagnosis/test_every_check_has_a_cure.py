"""Lines of the certificate about the whole model: each that may fail says what to do."""

from __future__ import annotations

import ast
from pathlib import Path

import abut
from abut.diagnosis.cures import MODEL

SPECIAL = {"locking"}  # has words of its own by material


def names() -> set[str]:
    """Names of the checks without a contact that the source makes: Check("", NAME, ...)."""
    found = set()
    for path in Path(abut.__file__).parent.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if not (isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Check"):
                continue
            first = [part.value for part in node.args[:2] if isinstance(part, ast.Constant)]
            if len(first) == 2 and first[0] == "":
                found.add(first[1])
    return found


def test_every_check_has_a_cure() -> None:
    assert "model balance" in names()
    assert names() - SPECIAL <= set(MODEL)
