"""What the site reads off the code: the keys of a job file, the generators of bodies, docstrings.

Directives: ``{job-keys}`` every table of the job file; ``{generators}`` the kinds of ``[mesh.bodies.NAME]``;
``{exports} MODULE ...`` the public names of ``abut`` that live in these modules. A public name in none of them, or a key
without a meaning, is a warning, and so stops a strict build.
"""

from __future__ import annotations

import importlib
import inspect
import re
from collections.abc import Iterable, Mapping
from typing import Any, ClassVar

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

import abut
from abut.job import json_schema
from abut.job.load import GENERATORS

LOG = logging.getLogger(__name__)
SECTIONS = {  # how a top-level key appears in a file, by what it holds
    "object": "[{}]", "map": "[{}.NAME]", "array": "[[{}]]",
}  # fmt: skip
UNIT = re.compile(r"(.*) \[([^\]]+)\]$")
ARGUMENT = re.compile(r"^((?:[a-z_]\w*, )*[a-z_]\w*):\s+(.*)$")

BETWEEN = re.compile(r"; (?=(?:[a-z_]\w*, )*[a-z_]\w*: )")
PROSE = ("Raises", "Surfaces", "For ", "Integrals", "The ", "Function")  # what follows the arguments


class JobKeys(SphinxDirective):
    """Tables of all keys of a job file with type, default, unit and meaning, from the JSON Schema."""

    def run(self) -> list[nodes.Node]:
        schema = json_schema()
        lines: list[str] = []
        plain = {k: e for k, e in schema["properties"].items() if not _tables(e, schema)}
        lines += ["### At the top", "", *_table(plain, schema), ""]
        for key, entry in schema["properties"].items():
            for header, table in _tables(entry, schema, key):
                lines += _section(header, table, entry.get("description", ""), schema)
        return self.parse_text_to_nodes("\n".join(lines), allow_section_headings=True)


def _section(header: str, table: Mapping[str, Any], meaning: str, schema: Mapping[str, Any]) -> Iterable[str]:
    """One table of the file and those within it."""
    inner = [(key, entry) for key, entry in table["properties"].items() if _tables(entry, schema)]
    kind = table["properties"].get("kind", {})
    meaning = kind["description"] if "kind = " in header else meaning  # of one load, not of all
    yield from (f"### `{header}`", "", f"{meaning[:1].upper()}{meaning[1:]}.", "")
    yield from (*_table(table["properties"], schema, table.get("required", ())), "")
    for key, entry in inner:
        name = header.strip("[]")
        for _, nested in _tables(entry, schema):
            style = "[{}.{}.NAME]" if "additionalProperties" in entry else "{}.{}"
            yield from _section(style.format(name, key), nested, entry.get("description", ""), schema)


def _resolve(entry: Mapping[str, Any], schema: Mapping[str, Any]) -> Mapping[str, Any]:
    while "$ref" in entry:
        entry = schema["$defs"][entry["$ref"].rsplit("/", 1)[1]]
    return entry


def _given(entry: Mapping[str, Any]) -> Mapping[str, Any]:
    """What an entry is where it is given: "or nothing" left out."""
    options = [option for option in entry.get("anyOf", ()) if option.get("type") != "null"]
    return options[0] if len(options) == 1 else entry


def _tables(entry: Mapping[str, Any], schema: Mapping[str, Any], key: str = "") -> list[tuple[str, Mapping[str, Any]]]:
    """The tables that an entry holds, each with the header that opens it in a file."""
    entry = _given(entry)
    style = "array" if "items" in entry else "map" if isinstance(entry.get("additionalProperties"), dict) else "object"
    held = entry.get("items") or entry.get("additionalProperties") or entry
    options = held.get("oneOf", [held]) if isinstance(held, dict) else []
    found = []
    for option in options:
        table = _resolve(option, schema)
        if table.get("type") == "object" and "properties" in table:
            header = SECTIONS[style].format(key)
            kind = table["properties"].get("kind", {})
            found.append((f'{header} kind = "{kind["const"]}"' if "oneOf" in held else header, table))
    return found


def _table(entries: Mapping[str, Any], schema: Mapping[str, Any], required: Iterable[str] = ("schema",)) -> list[str]:
    rows = ["| key | value | default | unit | meaning |", "|---|---|---|---|---|"]
    for key, entry in entries.items():
        text = entry.get("description", "")
        if not text:
            LOG.warning("job file: no meaning of key %r; add it to abut/job/key_descriptions.py", key)
        meaning, unit = match.groups() if (match := UNIT.match(text)) else (text, "")
        default = "**required**" if key in required else _default(entry)
        rows.append(f"| `{key}` | {_value(entry, schema)} | {default} | {unit} | {meaning} |")
    return rows


def _default(entry: Mapping[str, Any]) -> str:
    value = entry.get("default")
    return "" if value is None or isinstance(value, (dict, list)) or value == "" else f"`{value}`"


def _value(entry: Mapping[str, Any], schema: Mapping[str, Any]) -> str:
    """What may stand there, in words."""
    entry = _resolve(entry, schema)
    if "const" in entry:
        return f"`{entry['const']}`"
    if "enum" in entry:
        return ", ".join(f"`{value}`" for value in entry["enum"])
    options = entry.get("anyOf") or entry.get("oneOf")
    if options:
        return " or ".join(dict.fromkeys(_value(o, schema) for o in options if o.get("type") != "null"))
    if entry.get("type") == "array":
        inner = _value(entry["items"], schema) if isinstance(entry.get("items"), dict) else ""
        return f"list of {inner}{'' if ' or ' in inner else 's'}" if inner else "list"
    names = {"number": "number", "integer": "whole number", "string": "text", "boolean": "true, false"}
    return names.get(entry.get("type", ""), "table")


class Generators(SphinxDirective):
    """Each generator with its arguments, their defaults, and its docstring."""

    def run(self) -> list[nodes.Node]:
        lines: list[str] = []
        for kind, make in GENERATORS.items():
            lines += [f"### `{kind}`", "", *_markdown(inspect.getdoc(make) or ""), ""]
            lines += ["| key | default |", "|---|---|"]
            for name, parameter in inspect.signature(make).parameters.items():
                default = parameter.default
                shown = "" if default is None else f"`{list(default) if isinstance(default, tuple) else default!r}`"
                lines.append(f"| `{name}` | {shown.replace(chr(39), chr(34))} |")
            lines.append("")
        return self.parse_text_to_nodes("\n".join(lines), allow_section_headings=True)


def _markdown(docstring: str) -> list[str]:
    """A plain docstring: lines that begin with an argument stand in a list."""
    lines = []
    for line in docstring.replace("``", "`").splitlines():
        match = ARGUMENT.match(line)
        lines += ["", f"- `{match[1].replace(', ', '`, `')}`: {match[2]}"] if match else [line]
    return lines


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
            lines += ["   :members:", "```", ""] if what == "autoclass" else ["```", ""]
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
    app.add_directive("job-keys", JobKeys)
    app.add_directive("generators", Generators)
    app.add_directive("exports", Exports)
    app.connect("autodoc-process-docstring", as_list)
    app.connect("autodoc-process-signature", as_written)
    app.connect("doctree-read", keep_short_cells)
    app.connect("env-check-consistency", check_exports)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
