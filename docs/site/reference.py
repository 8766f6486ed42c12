"""What the site reads off the code: docstrings.

Directive: ``{exports} MODULE ...`` the public names of ``abut`` that live in these modules. A public name in none of them is
a warning, and so stops a strict build.
"""

from __future__ import annotations

import importlib
import inspect
import re
from typing import Any, ClassVar

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

import abut

LOG = logging.getLogger(__name__)
ARGUMENT = re.compile(r"^((?:[a-z_]\w*, )*[a-z_]\w*):\s+(.*)$")

BETWEEN = re.compile(r"; (?=(?:[a-z_]\w*, )*[a-z_]\w*: )")
PROSE = ("Raises", "Surfaces", "For ", "Integrals", "The ", "Function")  # what follows the arguments


class Exports(SphinxDirective):
    """Public names of ``abut`` that live in the modules given, by autodoc."""

    has_content = False
    required_arguments = 1
    final_argument_whitespace = True
    shown: ClassVar[set[str]] = set()

    def run(self) -> list[nodes.Node]:
        lines: list[str] = []
        items = {name: getattr(abut, name) for name in abut.__all__}
        places = {
            name: (place, item.__module__, _line(item))
            for name, item in items.items()
            for place, module in enumerate(self.arguments[0].split())
            if f"{item.__module__}.".startswith(f"{module}.")
        }
        for name in sorted(places, key=lambda n: places[n]):
            item = items[name]
            self.shown.add(name)
            what = "autoexception" if inspect.isclass(item) and issubclass(item, Exception) else (
                "autoclass" if inspect.isclass(item) else "autofunction")  # fmt: skip
            lines += ["```{eval-rst}", f".. {what}:: abut.{name}"]
            lines += ["   :members:", "   :inherited-members:", "```", ""] if what == "autoclass" else ["```", ""]
        return self.parse_text_to_nodes("\n".join(lines))


def _line(item: Any) -> int:
    return inspect.getsourcelines(item)[1]


def check_exports(app: Sphinx, env: Any) -> None:
    """After reading: nothing public was left out."""
    if Exports.shown:
        for name in sorted(set(abut.__all__) - Exports.shown):
            home = getattr(importlib.import_module("abut"), name).__module__
            LOG.warning("abut.%s (%s) is on no page: add its module to docs/api.md", name, home)


def as_list(app: Any, what: str, name: str, item: Any, options: Any, lines: list[str]) -> None:
    """Docstrings are plain text: "young: Young's modulus; poisson: ..." become a list of names and meanings."""
    result: list[str] = []
    text: list[str] = []  # of the arguments being read

    def close() -> None:
        for part in BETWEEN.split(" ".join(text)) if text else ():
            names, _, meaning = part.partition(":")
            result.extend([", ".join(f"``{n}``" for n in names.split(", ")), f"    {meaning.strip().rstrip(';')}", ""])
        text.clear()

    for line in lines:
        if ARGUMENT.match(line):
            result += [] if text else [""]
            text.append(line.rstrip().rstrip(";") + ";")
        elif text and line.strip() and not line.startswith(PROSE):
            text[-1] = f"{text[-1].rstrip(';')} {line.strip().rstrip(';')};"
        else:
            close()
            result.append(line)
    close()
    lines[:] = result


def as_written(app: Any, what: str, name: str, item: Any, *_: Any) -> tuple[str, str] | None:
    """Signatures with their annotations as the code has them; arrays are just arrays, their shapes are in the text."""
    if what not in ("class", "function", "method"):
        return None
    signature = inspect.signature(item)
    parameters = []
    for parameter in signature.parameters.values():
        annotation, default = parameter.annotation, parameter.default
        text = parameter.name
        if isinstance(annotation, str):
            text += f": {_plain_type(annotation)}"
        if default is not parameter.empty:
            text += " = ..." if repr(default).startswith("<") else f" = {default!r}"
        star = parameter.kind is parameter.KEYWORD_ONLY and not any(p.startswith("*") for p in parameters)
        parameters += ["*", text] if star else [text]
    returned = signature.return_annotation
    shown = _plain_type(returned) if isinstance(returned, str) and what != "class" else ""
    return f"({', '.join(parameters)})", shown


def _plain_type(annotation: str) -> str:
    return re.sub(r"NDArray\[[\w.]+\]", "array", annotation).strip("'\"")


def keep_short_cells(app: Sphinx, doctree: nodes.document) -> None:
    """Numbers such as 1e-10 must not be broken at the hyphen."""
    for entry in doctree.findall(nodes.entry):
        if len(entry.astext()) < 10:
            entry["classes"].append("short")


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_directive("exports", Exports)
    app.connect("autodoc-process-docstring", as_list)
    app.connect("autodoc-process-signature", as_written)
    app.connect("doctree-read", keep_short_cells)
    app.connect("env-check-consistency", check_exports)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
