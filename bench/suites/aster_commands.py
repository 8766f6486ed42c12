"""code_aster's command files, read without running them: calls with their keywords, literals, arithmetic.

A command file is a Python program. What is read here are assignments and calls of commands whose arguments are literals,
names that were assigned before, arithmetic of these, and _F(...). Loops, conditions and functions are not.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from foreign_mesh import NotReadable

OPERATORS = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv, ast.Pow: operator.pow,
    ast.USub: operator.neg, ast.UAdd: operator.pos,
}  # fmt: skip
FUNCTIONS = {name: getattr(math, name) for name in ("sqrt", "sin", "cos", "tan", "atan", "atan2", "exp", "log", "pi")}
NAMES: dict[str, Any] = {"pi": math.pi, "None": None, "True": True, "False": False}


# Commands that look at results, of which none is read inside loops
LOOKING = {
    "TEST_RESU", "TEST_TABLE", "TEST_FONCTION", "IMPR_RESU", "IMPR_TABLE", "IMPR_FONCTION", "POST_RELEVE_T", "RECU_FONCTION",
    "CALC_TABLE", "CREA_TABLE", "CREA_CHAMP", "CALC_CHAMP", "MACR_LIGN_COUPE", "DETRUIRE", "RECU_TABLE", "POST_ERREUR",
    "CALC_FONCTION",
}  # fmt: skip


@dataclass(eq=False)
class Command:
    """A call. name: of the command; into: the variable it is assigned to; keywords: by name, values as Python has them,
    commands where the variable of one stands, ``Unknown`` where nothing is known of it."""

    name: str
    into: str
    line: int
    keywords: dict[str, Any] = field(default_factory=dict)

    def __getitem__(self, key: str) -> Any:
        return self.keywords[key]

    def get(self, key: str, default: Any = None) -> Any:
        """Of a keyword."""
        return self.keywords.get(key, default)


@dataclass(frozen=True)
class Unknown:
    """What could not be read, and why."""

    why: str


def commands(text: str) -> list[Command]:
    """All of a file, in order. Raises NotReadable for loops and conditions, which may hide any of them."""
    try:
        tree = ast.parse(text)
    except SyntaxError as error:
        raise NotReadable(f"no Python: {error}") from None
    known, found = dict(NAMES), list[Command]()
    for statement in tree.body:
        if isinstance(statement, ast.Import | ast.ImportFrom | ast.FunctionDef | ast.Pass | ast.Delete | ast.Assert):
            continue
        if isinstance(statement, ast.For | ast.If) and _after(statement):
            continue
        if isinstance(statement, ast.Expr | ast.Assign):
            _statement(statement, known, found)
        else:
            raise NotReadable(f"line {statement.lineno}: {type(statement).__name__.lower()}, which is not run here")
    return found


def _statement(statement: ast.Expr | ast.Assign, known: dict[str, Any], found: list[Command]) -> None:
    targets = statement.targets if isinstance(statement, ast.Assign) else []
    name = targets[0].id if len(targets) == 1 and isinstance(targets[0], ast.Name) else ""
    if _is_command(statement.value):
        assert isinstance(statement.value, ast.Call)
        keywords = {k.arg: value(k.value, known) for k in statement.value.keywords if k.arg is not None}
        made: Any = Command(_called(statement.value), name, statement.lineno, keywords)
        found.append(made)
    else:
        made = value(statement.value, known)
    if name:
        known[name] = made
    elif len(targets) == 1 and isinstance(targets[0], ast.Tuple | ast.List):
        for part in targets[0].elts:
            if isinstance(part, ast.Name):
                known[part.id] = Unknown("unpacked")


def _after(statement: ast.For | ast.If) -> bool:
    """Whether a loop or condition has no other commands than those that look at results."""
    names = {_called(node) for node in ast.walk(statement) if _is_command(node)}
    return names <= LOOKING


def _called(node: ast.Call) -> str:
    return node.func.id if isinstance(node.func, ast.Name) else ""


def _is_command(node: ast.AST) -> bool:
    return isinstance(node, ast.Call) and _called(node).isupper() and _called(node) != "_F"


def value(node: ast.AST, known: Mapping[str, Any]) -> Any:
    """Of an expression."""
    if isinstance(node, ast.Constant):
        return node.value
    if isinstance(node, ast.Name):
        return known.get(node.id, Unknown(node.id))
    if isinstance(node, ast.Tuple | ast.List):
        return [value(part, known) for part in node.elts]
    if isinstance(node, ast.UnaryOp | ast.BinOp) and type(node.op) in OPERATORS:
        parts = [node.operand] if isinstance(node, ast.UnaryOp) else [node.left, node.right]
        values = [value(part, known) for part in parts]
        if any(isinstance(v, Unknown | Command) for v in values):
            return Unknown(ast.unparse(node))
        try:
            return OPERATORS[type(node.op)](*values)
        except (TypeError, ValueError, ArithmeticError):
            return Unknown(ast.unparse(node))
    if isinstance(node, ast.Call) and _called(node) == "_F":
        return {k.arg: value(k.value, known) for k in node.keywords if k.arg is not None}
    if isinstance(node, ast.Call) and _called(node) in FUNCTIONS:
        values = [value(part, known) for part in node.args]
        if not any(isinstance(v, Unknown | Command) for v in values):
            return FUNCTIONS[_called(node)](*values)
    return Unknown(ast.unparse(node)[:40])


def several(given: Any) -> list[Any]:
    """What may be one or a list, as a list."""
    if given is None:
        return []
    return list(given) if isinstance(given, list | tuple) else [given]


def entries(keywords: Mapping[str, Any] | Command, name: str) -> Iterator[dict[str, Any]]:
    """The _F(...) of a keyword."""
    for entry in several(keywords.get(name)):
        if not isinstance(entry, dict):
            raise NotReadable(f"{name}: {entry.why if isinstance(entry, Unknown) else entry!r} is not read here")
        yield entry
