"""The text of a job with every pair that auto = true has found written out."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

from abut.contact.sides import listed
from abut.detection import AUTO
from abut.errors import InputError
from abut.io.atomic import write_text
from abut.job.load import Job, load_job
from abut.model import Contact
from abut.types import Json

HEADER = re.compile(r"^\s*\[\[?([^\[\],]+)\]\]?\s*(#.*)?$")


def write_pairs(job: Job, path: Path) -> None:
    """Write the job to ``path`` with an entry for each found pair, which gives the same run. Names of found surfaces mean
    the same facets as long as mesh, reach and bodies stay.

    Raises InputError where nothing is found by itself, where entries are not written as [[contacts]], and where a mesh
    file named relative to the job would be another one at ``path``.
    """
    try:
        data = tomllib.loads(job.text)
    except tomllib.TOMLDecodeError:
        raise InputError(f"{job.path}: --write-pairs: only job files (TOML) can be written out") from None
    entries = data.get("contacts", [])
    if not any(entry.get("auto") for entry in entries):
        raise InputError(f"{job.path}: --write-pairs: no [[contacts]] has auto = true: there is nothing to write out")
    mesh_file = data["mesh"].get("file")
    if (
        mesh_file is not None
        and not Path(mesh_file).is_absolute()
        and path.resolve().parent != job.path.resolve().parent
    ):
        raise InputError(
            f"--write-pairs: {path}: write it beside {job.path}, where mesh.file = {mesh_file!r} can be found"
        )
    pieces, number = _pieces(job.text), -1
    if sum(name == "contacts" for name, _ in pieces) != len(entries):
        raise InputError(f"{job.path}: --write-pairs: write each contact as a table [[contacts]] of its own first")
    text: list[str] = []
    for name, piece in pieces:
        number += name == "contacts"
        if not (name == "contacts" or name.startswith("contacts.")) or not entries[number].get("auto"):
            text.append(piece)
            continue
        if name == "contacts":
            text += [_entry(job, i, entries[number]) for i, each in enumerate(job.entries) if each == number]
        text.append(_trailing(piece))
    write_text(path, "".join(text))
    written = load_job(path)
    if written.model.contacts != job.model.contacts:
        raise InputError(f"--write-pairs: {path} does not give the same contacts; please report this")


def _pieces(text: str) -> list[tuple[str, str]]:
    """The text cut before each table header: name of the table ("" before the first) and text."""
    result: list[tuple[str, str]] = [("", "")]
    for line in text.splitlines(keepends=True):
        header = HEADER.match(line)
        if header:
            result.append((header.group(1).strip(), line))
        else:
            name, piece = result[-1]
            result[-1] = name, piece + line
    return result


def _trailing(piece: str) -> str:
    """Empty lines and comments at the end of a table: they speak of what follows."""
    lines = piece.splitlines(keepends=True)
    while lines and any(line.strip() and not line.lstrip().startswith("#") for line in lines):
        del lines[0]
    return "".join(lines)


def _entry(job: Job, number: int, table: Json) -> str:
    contact = job.model.contacts[number]
    keys: Json = {"name": contact.name}
    if contact.first:
        keys["surfaces"] = list(contact.named)
    else:
        keys |= {"contactor": contact.contactor, "target": contact.target}
    left = ("auto",) if _found(contact) else ("auto", "bodies")
    keys |= {key: value for key, value in table.items() if key not in (*left, *keys)}
    return "[[contacts]]\n" + "".join(f"{key} = {_value(value)}\n" for key, value in keys.items())


def _found(contact: Contact) -> bool:
    return any(name.startswith(AUTO) for name in listed(contact.contactor))


def _value(value: object) -> str:
    """A value as TOML; JSON's notation of text, numbers and lists is also TOML's."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {_value(each)}" for key, each in value.items()) + " }"
    return json.dumps(value, ensure_ascii=False)
