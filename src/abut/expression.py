"""Numbers over position, written as text: "0.1 + 0.2*x"."""

from __future__ import annotations

import ast
import math
import warnings
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from functools import reduce

import numpy as np

from abut.errors import InputError, nearest
from abut.types import Array

AXES = ("x", "y", "z")
CONSTANTS = {"pi": math.pi}
FUNCTIONS: Mapping[str, Callable[[Array], Array]] = {
    "abs": np.abs, "sqrt": np.sqrt, "exp": np.exp, "log": np.log, "sin": np.sin, "cos": np.cos, "tan": np.tan,
    "asin": np.arcsin, "acos": np.arccos, "atan": np.arctan, "sinh": np.sinh, "cosh": np.cosh, "tanh": np.tanh,
}  # fmt: skip
OF_TWO: Mapping[str, Callable[[Array, Array], Array]] = {"min": np.minimum, "max": np.maximum, "atan2": np.arctan2}
OPERATORS: Mapping[type, Callable[[Array, Array], Array]] = {
    ast.Add: np.add, ast.Sub: np.subtract, ast.Mult: np.multiply, ast.Div: np.divide, ast.Pow: np.power,
    ast.Lt: np.less, ast.LtE: np.less_equal, ast.Gt: np.greater, ast.GtE: np.greater_equal,
    ast.And: np.logical_and, ast.Or: np.logical_or,
}  # fmt: skip
SIGNS: Mapping[type, Callable[[Array], Array]] = {ast.UAdd: np.positive, ast.USub: np.negative, ast.Not: np.logical_not}
LONGEST, DEEPEST = 2000, 60  # characters, and operations within each other


@dataclass(frozen=True)
class Expression:
    """A number at every point, written with x, y and z (the coordinates of the undeformed mesh; axisymmetric: x is the
    radius, y the axis), numbers, pi, + - * / **, comparisons with "and", "or", "not", "A if CONDITION else B", and the
    functions abs, sqrt, exp, log, sin, cos, tan, asin, acos, atan, atan2, sinh, cosh, tanh, min and max. Nothing else is
    evaluated. Raises InputError for anything else.

    >>> import numpy as np
    >>> from abut.expression import Expression
    >>> Expression("0.1 if x < 2 else 0.3")(np.array([[1.0, 0.0], [3.0, 0.0]]))
    array([0.1, 0.3])
    """

    text: str
    named: tuple[
        tuple[str, Callable[[Array], Array]], ...
    ] = ()  # functions of points whose values may stand in it by name

    def __post_init__(self) -> None:
        _check(_parsed(self.text), tuple(dict(self.named)))

    def __call__(self, points: Array) -> Array:
        """At points (n, dim): (n,). Raises InputError for z in two dimensions."""
        names = {name: np.float64(value) for name, value in CONSTANTS.items()} | dict(zip(AXES, points.T))
        used = _names(_parsed(self.text))
        names |= {name: function(points) for name, function in self.named if name in used}
        with np.errstate(all="ignore"):  # whoever asks refuses what is no number, and says where
            value = _value(_parsed(self.text), names)
        return np.array(np.broadcast_to(np.asarray(value, dtype=float), len(points)))


def mentions(text: str, names: Collection[str]) -> bool:
    """Whether an expression has one of some names in it; not where it is none."""
    try:
        return not _names(_parsed(text)).isdisjoint(names)
    except InputError:
        return False


def _names(tree: ast.expr) -> set[str]:
    return {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}


@dataclass(frozen=True)
class Expressions:
    """A vector at every point: an expression of each component."""

    components: tuple[Expression, ...]

    def __call__(self, points: Array) -> Array:
        """At points (n, dim): (n, components)."""
        return np.column_stack([component(points) for component in self.components])


def with_names(text: str, names: Mapping[str, float], fields: Collection[str] = ()) -> float | str:
    """An expression in which numbers have names: its value, or, where it depends on the position, the expression of x, y, z
    (and of ``fields``, names of functions of them) that is left. Raises InputError for what is no expression, names that are
    not known, and values that are no numbers.

    >>> with_names("2*r + 1", {"r": 0.5}), with_names("r*x", {"r": 0.5})
    (2.0, '0.5 * x')
    """
    tree = _parsed(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.Name) and node.id not in (*names, *AXES, *CONSTANTS, *FUNCTIONS, *OF_TWO, *fields):
            raise InputError(f"unknown name {node.id!r}{nearest(node.id, (*names, *AXES, *CONSTANTS, *fields))}")
    left = ast.fix_missing_locations(_Numbers(names).visit(tree))
    _check(left, fields)
    if not _names(left).isdisjoint((*AXES, *fields)):
        return ast.unparse(left)
    with np.errstate(all="ignore"):
        value = float(_value(left, {name: np.float64(value) for name, value in CONSTANTS.items()}))  # type: ignore[misc]
    if not math.isfinite(value):
        raise InputError(f"{text!r} is no finite number")
    return value


class _Numbers(ast.NodeTransformer):
    """Puts numbers in place of names; negative ones as operations, which keep their brackets in powers."""

    def __init__(self, names: Mapping[str, float]) -> None:
        self.names = names

    def visit_Name(self, node: ast.Name) -> ast.expr:
        if node.id not in self.names:
            return node
        value = self.names[node.id]
        size = ast.Constant(abs(value))
        return ast.UnaryOp(ast.USub(), size) if value < 0.0 else size


def _parsed(text: str) -> ast.expr:
    if len(text) > LONGEST:
        raise InputError(f"an expression of more than {LONGEST} characters; give a function in Python instead")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, MemoryError, RecursionError):
        raise InputError(f"cannot read {text!r} as an expression of x, y, z such as '0.1 + 0.2*x'") from None


def _check(tree: ast.expr, named: Collection[str] = ()) -> None:
    """Raises InputError for what an expression cannot hold."""
    level = [tree]
    for _ in range(DEEPEST):
        level = [part for node in level for part in _parts(node, named)]
        if not level:
            return
    raise InputError("too many operations within each other; give a function in Python instead")


def _parts(node: ast.expr, named: Collection[str] = ()) -> list[ast.expr]:
    """What a node is made of, if it is one that is known; ``named``: names beside those of coordinates and constants."""
    if isinstance(node, ast.Constant):
        _number(node)
        return []
    if isinstance(node, ast.Name):
        if node.id not in (*AXES, *CONSTANTS, *named):
            known = (*AXES, *CONSTANTS, *named, *FUNCTIONS, *OF_TWO)
            raise InputError(f"unknown name {node.id!r}{nearest(node.id, known)}")
        return []
    if isinstance(node, ast.UnaryOp) and type(node.op) in SIGNS:
        return [node.operand]
    if isinstance(node, ast.BinOp) and type(node.op) in OPERATORS:
        return [node.left, node.right]
    if isinstance(node, ast.BoolOp):
        return node.values
    if isinstance(node, ast.Compare) and all(type(op) in OPERATORS for op in node.ops):
        return [node.left, *node.comparators]
    if isinstance(node, ast.IfExp):
        return [node.test, node.body, node.orelse]
    if isinstance(node, ast.Call):
        return _arguments(node)
    hint = "; powers are written with **" if isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitXor) else ""
    raise InputError(f"{ast.unparse(node)!r} is not part of an expression{hint}")


def _arguments(node: ast.Call) -> list[ast.expr]:
    name = ast.unparse(node.func)
    if not isinstance(node.func, ast.Name) or name not in (*FUNCTIONS, *OF_TWO):
        raise InputError(f"unknown function {name!r}{nearest(name, (*FUNCTIONS, *OF_TWO))}")
    wrong = len(node.args) != 1 if name in FUNCTIONS else len(node.args) < 2 or (name == "atan2" and len(node.args) > 2)
    if node.keywords or wrong or any(isinstance(part, ast.Starred) for part in node.args):
        wanted = "one argument" if name in FUNCTIONS else "two arguments"
        raise InputError(f"{ast.unparse(node)!r}: {name} takes {wanted}{' or more' if name in ('min', 'max') else ''}")
    return node.args


def _number(node: ast.Constant) -> np.float64:
    if isinstance(node.value, bool) or not isinstance(node.value, (int, float)):
        raise InputError(f"{ast.unparse(node)} is not a number")
    try:
        return np.float64(node.value)
    except OverflowError:
        return np.float64(math.inf)


def _value(node: ast.expr, names: Mapping[str, Array]) -> Array:
    """The value of a tree that ``_check`` has let pass; conditions are 0 or 1."""
    if isinstance(node, ast.Constant):
        return _number(node)  # type: ignore[return-value]
    if isinstance(node, ast.Name):
        if node.id not in names:
            raise InputError("z: positions have x and y alone in two dimensions")
        return names[node.id]
    values = [_value(part, names) for part in _parts(node, names)]
    if isinstance(node, ast.UnaryOp):
        result = SIGNS[type(node.op)](values[0])
    elif isinstance(node, (ast.BinOp, ast.BoolOp)):
        result = reduce(OPERATORS[type(node.op)], values)
    elif isinstance(node, ast.Compare):
        pairs = zip(node.ops, values, values[1:])
        result = reduce(np.logical_and, [OPERATORS[type(op)](left, right) for op, left, right in pairs])
    elif isinstance(node, ast.IfExp):
        result = np.where(values[0], values[1], values[2])
    else:
        assert isinstance(node, ast.Call)
        name = ast.unparse(node.func)
        result = FUNCTIONS[name](values[0]) if name in FUNCTIONS else reduce(OF_TWO[name], values)
    return np.asarray(result, dtype=float)
