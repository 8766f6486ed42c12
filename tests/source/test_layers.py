"""How the code is built: no file imports itself by way of others, functions and files stay small enough to read."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

ROOT = Path(__file__).parents[2]
PYTHON = sorted((ROOT / "src" / "abut").rglob("*.py"))
CPP = sorted((ROOT / "cpp").glob("*.[ch]pp"))
LINES, PARAMETERS, FILE, FLOORS = 60, 8, 400, 7


def module(path: Path) -> str:
    parts = ["abut", *path.relative_to(ROOT / "src" / "abut").with_suffix("").parts]
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imported(source: str, known: set[str]) -> set[str]:
    """Modules among ``known`` that a file imports, in functions and for type checkers too. A package counts where names are
    taken from it."""
    result: set[str] = set()
    pending: list[ast.AST] = [ast.parse(source)]
    while pending:
        node = pending.pop()
        if isinstance(node, ast.Import):
            result |= {name.name for name in node.names}
        if isinstance(node, ast.ImportFrom) and node.module:
            whole = {f"{node.module}.{name.name}" for name in node.names}
            result |= {name if name in known else node.module for name in whole}
        pending += ast.iter_child_nodes(node)
    return result & known


def cycles(imports: dict[str, set[str]]) -> list[set[str]]:
    """Modules that import each other: strongly connected components of more than one."""
    names = sorted(imports)
    number = {name: i for i, name in enumerate(names)}
    pairs = np.array([(number[a], number[b]) for a in names for b in imports[a]]).reshape(-1, 2)
    graph = csr_matrix((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(names),) * 2)
    count, label = connected_components(graph, connection="strong")
    every = [{name for name, own in zip(names, label) if own == i} for i in range(count)]
    return [component for component in every if len(component) > 1]


def test_no_import_cycles() -> None:
    """Public names of the package itself are lazy: nothing inside may need them."""
    known = {module(path) for path in PYTHON}
    imports = {module(path): imported(path.read_text(encoding="utf-8"), known) for path in PYTHON}
    imports["abut"] = set()
    assert cycles(imports) == []


def test_cycles_are_found() -> None:
    """Through a function, a package, and what only type checkers see."""
    known = {"a", "b", "c.d", "c"}
    lazy = "def f():\n    from b import x\n"
    typing = "if TYPE_CHECKING:\n    from a import x\nelse:\n    import b\n"
    assert imported(lazy, known) == {"b"}
    assert imported(typing, known) == {"a", "b"}
    assert imported("from c import d, e", known) == {"c.d", "c"}
    assert cycles({"a": {"b"}, "b": {"c"}, "c": {"a"}, "c.d": {"c"}}) == [{"a", "b", "c"}]


def floors(imports: dict[str, set[str]], folder: str) -> dict[str, int]:
    """By file of a folder how many files of that folder stand on each other below it and with it."""
    own = {name: {other for other in others if other.startswith(folder)} for name, others in imports.items()}
    result: dict[str, int] = {}

    def floor(name: str) -> int:
        if name not in result:
            result[name] = 1 + max((floor(other) for other in own[name]), default=0)
        return result[name]

    for name in own:
        if name.startswith(folder):
            floor(name)
    return result


@pytest.mark.parametrize("folder", ["problem", "nonlinear"])
def test_floors_are_few(folder: str) -> None:
    """Whoever follows a call through a folder gets to its ground in seven files."""
    known = {module(path) for path in PYTHON}
    imports = {module(path): imported(path.read_text(encoding="utf-8"), known) for path in PYTHON}
    high = {name for name, floor in floors(imports, f"abut.{folder}.").items() if floor > FLOORS}
    assert not high


def test_floors_are_counted() -> None:
    """Within the folder alone, whatever imports it."""
    imports = {"a.x": {"a.y", "b"}, "a.y": {"a.z"}, "a.z": set(), "a.w": {"a.z"}, "b": set(), "c": {"a.x"}}
    assert floors(imports, "a.") == {"a.x": 3, "a.y": 2, "a.z": 1, "a.w": 2}


def of_python(source: str) -> Iterator[tuple[str, int, int]]:
    """Name, lines and parameters of each function; its docstring does not count, nor do ``self`` and ``cls``."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)):
            own = node.args
            names = [a.arg for a in (*own.posonlyargs, *own.args, *own.kwonlyargs, own.vararg, own.kwarg) if a]
            first = node.body[0]
            text = (
                isinstance(first, ast.Expr)
                and isinstance(first.value, ast.Constant)
                and isinstance(first.value.value, str)
            )
            said = (first.end_lineno or 0) - first.lineno + 1 if text else 0
            yield (
                node.name,
                (node.end_lineno or 0) - node.lineno + 1 - said,
                len(names) - (names[:1] in (["self"], ["cls"])),
            )


HEADER = re.compile(r"([~\w]+)\s*\(((?:[^()]|\([^()]*\))*)\)\s*(?:const|noexcept|override|->[^{;]*|:[^{;]*|\s)*$")
NO_FUNCTION = {"if", "for", "while", "switch", "catch", "return"}


def of_cpp(source: str) -> Iterator[tuple[str, int, int]]:
    """The same of C++: what stands before a brace and ends in parentheses is a function's head."""
    text = re.sub(r"//[^\n]*|/\*.*?\*/", lambda m: re.sub(r"[^\n]", " ", m.group()), source, flags=re.DOTALL)
    text = re.sub(r'"(?:\\.|[^"\\\n])*"', lambda m: " " * len(m.group()), text)
    open_: list[tuple[str, int, int] | None] = []
    since = 0
    for at, letter in enumerate(text):
        if letter == "{":
            head = HEADER.search(text[since:at])
            name = head.group(1) if head else ""
            if head and name not in NO_FUNCTION:
                open_.append((name, since + head.start(), parameters(head.group(2))))
            else:
                open_.append(None)
        elif letter == "}" and open_:
            own = open_.pop()
            if own:
                yield own[0], text.count("\n", own[1], at) + 1, own[2]
        if letter in "{};":
            since = at + 1


def parameters(text: str) -> int:
    """How many a C++ list holds: commas outside of brackets, and one."""
    depth, count = 0, 1 if text.strip() else 0
    for letter in text:
        depth += (letter in "<([{") - (letter in ">)]}")
        count += letter == "," and depth == 0
    return count


FUNCTIONS = [(p, f"{p.relative_to(ROOT / 'src' / 'abut')}", of_python) for p in PYTHON]
FUNCTIONS += [(p, f"cpp/{p.name}", of_cpp) for p in CPP if not p.name.startswith("bind")]


def test_functions_are_small() -> None:
    """At most 60 lines and 8 parameters; the bindings, which name every argument, aside."""
    large = {
        f"{where} {name}"
        for path, where, functions in FUNCTIONS
        for name, lines, count in functions(path.read_text(encoding="utf-8"))
        if lines > LINES or count > PARAMETERS
    }
    assert not large


@pytest.mark.parametrize("path", [*PYTHON, *CPP], ids=lambda path: path.name)
def test_files_are_small(path: Path) -> None:
    assert len(path.read_text(encoding="utf-8").splitlines()) <= FILE


def test_functions_of_cpp_are_found() -> None:
    """Members, templates, constructors with initialisers; no branches, no classes."""
    source = """
namespace abut {
template <class T> struct Tree {
    Tree(int n, std::array<T, 3> x) : n_(n) {
        if (n > 0) {
        }
    }
    int size() const { return n_; }
};
// void no(int a) {
inline std::vector<int> f(std::map<int, int> a, double b = g(1, 2)) {
    for (int i = 0; i < 3; ++i) {
    }
    return {};
}
}
"""
    assert set(of_cpp(source)) == {("Tree", 4, 2), ("size", 1, 0), ("f", 5, 2)}


NUMBERED = re.compile(r"(//|%)\s*[\w.]*\bdim\b|\bdim \* [^#]*[+]|\* [\w.]*\bdim [+]")


def test_unknowns_are_numbered_in_one_file() -> None:
    """By ``abut.dofs`` alone."""
    assert NUMBERED.search("rows = (dim * nodes[:, None] + np.arange(dim)).ravel()")
    assert NUMBERED.search("point = rows // self.mesh.dim")
    found = [path.name for path in PYTHON if any(NUMBERED.search(line) for line in path.read_text().splitlines())]
    assert found == []
