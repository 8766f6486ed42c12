"""No module needs another one that needs it, not for type checkers either: what is imported under TYPE_CHECKING counts."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

SOURCE = Path(__file__).parents[2] / "src"
OPEN = {"abut.problem.body_rows", "abut.problem.constraints", "abut.problem.rigid_bodies", "abut.problem.rigid_modes"}


def modules(source: Path) -> dict[str, Path]:
    found = {".".join(path.relative_to(source).with_suffix("").parts): path for path in source.rglob("*.py")}
    return {name.removesuffix(".__init__"): path for name, path in found.items()}


def imported(tree: ast.Module) -> Iterator[str]:
    """What a module imports when it is, or under a condition; what functions import when they are called is left out."""
    for top in tree.body:
        for node in [top, *(top.body if isinstance(top, ast.If) else [])]:
            if isinstance(node, ast.Import):
                yield from (name.name for name in node.names)
            elif isinstance(node, ast.ImportFrom) and node.module:
                yield from (f"{node.module}.{name.name}" for name in node.names)
                yield node.module


def circles(source: Path) -> set[str]:
    """Modules that import themselves by way of others. The package itself, which names what is public, is left out."""
    known = modules(source)
    known.pop("abut", None)
    needs = {}
    for name, path in known.items():
        named = [other for other in imported(ast.parse(path.read_text(encoding="utf-8"))) if other in known]
        deepest = {other for other in named if not any(more.startswith(f"{other}.") for more in named)}
        needs[name] = deepest - {name}
    reached = {name: set(others) for name, others in needs.items()}
    changed = True
    while changed:
        changed = False
        for others in reached.values():
            more = set().union(*(needs[other] for other in others)) - others if others else set()
            if more:
                others |= more
                changed = True
    return {name for name, others in reached.items() if name in others}


def test_there_are_none() -> None:
    """But for one of old (``OPEN``), between supports and rigid bodies."""
    assert circles(SOURCE) <= OPEN


def test_hidden_ones_are_found(tmp_path: Path) -> None:
    for name, text in {
        "one": "from two import f\n",
        "two": "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from three import T\n",
        "three": "import one\n",
        "four": "import one\ndef f():\n    import five\n",
        "five": "import four\n",
    }.items():
        (tmp_path / f"{name}.py").write_text(text)
    assert circles(tmp_path) == {"one", "two", "three"}
