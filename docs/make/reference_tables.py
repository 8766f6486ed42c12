"""Writes what pages of the documentation read off the code: keys of a job file (docs/job.md), kinds of bodies made by abut
(docs/meshes.md), public names (docs/api.md): python docs/make/reference_tables.py; --check compares only."""

from __future__ import annotations

import argparse
import inspect
import re
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any

import abut
from abut.job import json_schema
from abut.job.load import GENERATORS
from page import DOCS, read_marked, write_marked

SECTIONS = {  # how a top-level key appears in a file, by what it holds
    "object": "[{}]", "map": "[{}.NAME]", "array": "[[{}]]",
}  # fmt: skip
UNIT = re.compile(r"(.*) \[([^\]]+)\]$")
ARGUMENT = re.compile(r"^((?:[a-z_]\w*, )*[a-z_]\w*):\s+(.*)$")
SENTENCE = re.compile(r"(?<=[a-z0-9)`])[.:;] ")


def job_keys() -> list[str]:
    """Tables of all keys of a job file with type, default, unit and meaning, from the JSON Schema, as lines."""
    schema = json_schema()
    plain = {k: e for k, e in schema["properties"].items() if not _tables(e, schema)}
    lines = ["### At the top", "", *_table(plain, schema), ""]
    for key, entry in schema["properties"].items():
        for header, table in _tables(entry, schema, key):
            lines += _section(header, table, entry.get("description", ""), schema)
    return lines


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
            raise SystemExit(f"job file: no meaning of key {key!r}; add it to abut/job/key_descriptions.py")
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
        if inner.startswith("list"):
            return f"list of lists{inner.removeprefix('list')}"
        return f"list of {inner}{'' if ' or ' in inner else 's'}" if inner else "list"
    names = {"number": "number", "integer": "whole number", "string": "text", "boolean": "true, false"}
    return names.get(entry.get("type", ""), "table")


def generators() -> list[str]:
    """Each generator with its arguments, their defaults, and its docstring, as lines."""
    lines: list[str] = []
    for kind, make in GENERATORS.items():
        lines += [f"### `{kind}`", "", *_markdown(inspect.getdoc(make) or ""), ""]
        lines += ["| key | default |", "|---|---|"]
        for name, parameter in inspect.signature(make).parameters.items():
            default = parameter.default
            shown = "" if default is None else f"`{list(default) if isinstance(default, tuple) else default!r}`"
            lines.append(f"| `{name}` | {shown.replace(chr(39), chr(34))} |")
        lines.append("")
    return lines


def _markdown(docstring: str) -> list[str]:
    """A plain docstring: lines that begin with an argument stand in a list."""
    lines = []
    for line in docstring.replace("``", "`").splitlines():
        match = ARGUMENT.match(line)
        lines += ["", f"- `{match[1].replace(', ', '`, `')}`: {match[2]}"] if match else [line]
    return lines


def exports() -> list[str]:
    """A row for each public name of ``abut``, with the first sentence about it."""
    rows = ["| name | what it is |", "|---|---|"]
    for name in sorted(abut.__all__, key=str.lower):
        text = " ".join((inspect.getdoc(getattr(abut, name)) or "").split("\n\n")[0].split())
        first = SENTENCE.split(text, maxsplit=1)[0].rstrip(".").replace("``", "`").replace("|", "\\|")
        rows.append(f"| `{name}` | {first} |")
    return rows


TABLES: dict[str, tuple[Path, Callable[[], list[str]]]] = {
    "job-keys": (DOCS / "job.md", job_keys),
    "generators": (DOCS / "meshes.md", generators),
    "exports": (DOCS / "api.md", exports),
}


def stale() -> list[str]:
    """Those of the tables that are not what the code says."""
    return [name for name, (page, make) in TABLES.items() if read_marked(page, name) != text(make)]


def text(make: Callable[[], list[str]]) -> str:
    """Lines without blanks at their ends, and one empty line at the end."""
    return "\n".join(line.rstrip() for line in make()).strip() + "\n"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--check", action="store_true", help="change nothing; status 1 where a table is not as the code says"
    )
    if parser.parse_args().check:
        raise SystemExit(f"not as the code says: {', '.join(found)}" if (found := stale()) else 0)
    for name, (page, make) in TABLES.items():
        write_marked(page, name, text(make))


if __name__ == "__main__":
    main()
