"""A model as a job file with its mesh beside it."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from abut.errors import InputError
from abut.expression import Expression, Expressions
from abut.io.atomic import write_text
from abut.job.load import Job
from abut.job.load_tables import LOADS
from abut.job.material_tables import MADE_OF, MATERIALS
from abut.job.parameters import field_names
from abut.job.result_fields import tables_of
from abut.job.schema import JobFile
from abut.job.times import with_shares, with_times
from abut.materials.material import Material
from abut.mesh.write import write_mesh
from abut.model import (
    Amplitude,
    BodyForce,
    Buckling,
    Contact,
    Frequencies,
    Harmonic,
    Integration,
    Load,
    Model,
    SolveOptions,
    Transient,
)
from abut.model.removal import as_given
from abut.model.response import Wanted
from abut.output.options import EVERYTHING, Output
from abut.types import Json

LOAD_KINDS = {record: kind for kind, record in LOADS.items()}
MODES = {"frequencies": Frequencies, "buckling": Buckling, "harmonic": Harmonic, "transient": Transient}
MATERIAL_KINDS = {record: kind for kind, record in MATERIALS.items()}


def write_job(path: Path, job: Job) -> list[Path]:
    """Write the job file ``path`` and its mesh, of the same name with the ending .vtu; return both.

    Raises InputError for what a job file cannot hold (functions of position) and where a file cannot be written."""
    mesh = path.with_suffix(".vtu")
    table = job_table(job.model, mesh.name, job.output, path.parent)
    JobFile.model_validate(with_shares(table), context=field_names(table))
    head = [f"# from {job.path.name}"]
    head += [f"# ignored: {what}" for what in job.ignored] + [f"# {note}" for note in job.notes]
    write_mesh(mesh, job.model.mesh)
    write_text(path, "\n".join(head) + "\n" + toml(table))
    return [path, mesh]


def job_table(model: Model, mesh: str, output: Output = EVERYTHING, folder: Path = Path()) -> Json:
    """The job file of a model as nested tables, with ``mesh`` the file of its mesh; folder: where it will lie."""
    materials: dict[Material, str] = {}
    for solid in model.solids:
        if type(solid.material) not in MATERIAL_KINDS:
            raise InputError(f"solid '{solid.body}': job files know materials of abut's own only, not one of yours")
        for material in (*_parts(solid.material), solid.material):
            materials.setdefault(material, f"material-{len(materials) + 1}")
    table: Json = {"schema": 1, "mesh": {"file": mesh}}
    if of_files := tables_of((*model.solids, *model.supports, *model.loads, *model.modes), folder):
        table["fields"] = of_files
    table["model"] = {"plane": model.plane} if model.plane is not None else {}
    if model.finite:
        table["model"]["kinematics"] = model.kinematics
    if not table["model"]:
        del table["model"]
    table["materials"] = {n: material_table(m) for m, n in materials.items()}
    for material, name in materials.items():
        if key := MADE_OF.get(type(material)):
            made_of = [materials[part] for part in _parts(material)]
            table["materials"][name][key] = made_of if key == "materials" else made_of[0]
    table["solids"] = [_plain(solid) | {"material": materials[solid.material]} for solid in model.solids]
    for name in (
        "supports",
        "loads",
        "contacts",
        "equations",
        "rigid",
        "rotations",
        "couplings",
        "connectors",
        "preloads",
        "springs",
        "holds",
        "removals",
        "penetrations",
        "probes",
    ):
        kinds: dict[str, Callable[[Any], Json]] = {"loads": _load, "contacts": _contact}
        of = kinds.get(name, _plain)
        records = [of(record) for record in getattr(model, name)]
        if records:
            table[name] = records
    for name, kind in MODES.items():
        wanted = [item for item in model.modes if isinstance(item, kind)]
        if len(wanted) > 1:
            raise InputError(
                f"a job file holds one table [{name}], and the model asks for {len(wanted)}; keep one of them"
            )
        if wanted:
            table[name] = _of_modes(wanted[0])
    options = _plain(model.solve)
    if options:
        table["solve"] = options
    table = with_times(table, model.solve.end)
    if written := _plain(output):
        table["output"] = written
    return table


def material_table(material: Material) -> Json:
    """One of abut's own materials as a table of a job file, those that it is made of aside."""
    return {"kind": MATERIAL_KINDS[type(material)], **_plain(material)}


def _parts(material: Material) -> Sequence[Material]:
    """Materials that one is made of."""
    key = MADE_OF.get(type(material))
    made_of = () if key is None else getattr(material, key)
    return tuple(made_of) if isinstance(made_of, Sequence) else (made_of,)


def _of_modes(wanted: Wanted) -> Json:
    """A table with a key at least: one without would not be written."""
    given = {"count": wanted.count} if isinstance(wanted, (Frequencies, Buckling)) else {}
    loads = {name: getattr(wanted, name) for name in ("loads", "imaginary") if getattr(wanted, name, ())}
    return {**given, **_plain(wanted), **{name: [_load(load) for load in each] for name, each in loads.items()}}


def _load(load: Load) -> Json:
    if isinstance(load, BodyForce):
        raise InputError("a job file holds no body force; use gravity")
    return {"kind": LOAD_KINDS[type(load)], **_plain(replace(load, amplitude=as_given(load.amplitude)))}


def _contact(contact: Contact) -> Json:
    """As the user named its sides; those that were found keep what was chosen."""
    table = _plain(contact)
    names: Json = {"name": table.pop("name")}
    for key in ("first", "second", "contactor", "target", "chosen"):
        table.pop(key, None)
    if contact.first:
        return {**names, "surfaces": _value(contact.named, "surfaces"), **table}
    return {
        **names,
        "contactor": _value(contact.contactor, "contactor"),
        "target": _value(contact.target, "target"),
        **table,
    }


def _plain(record: Any) -> Json:
    """A record as a table, without what has its default."""
    result = {}
    for item in fields(record):
        value = getattr(record, item.name)
        default = item.default_factory() if callable(item.default_factory) else item.default
        if value == default or value is None:
            continue
        result[item.name] = _value(value, item.name)
    return result


def _value(value: Any, name: str) -> Any:
    if isinstance(value, Expression):
        return value.text
    if isinstance(value, Expressions):
        return [component.text for component in value.components]
    if callable(value) and not isinstance(value, Amplitude):
        raise InputError(f"{name}: a job file holds numbers and expressions of position, not functions")
    if isinstance(value, Mapping):
        return {key: _value(each, name) for key, each in value.items()}
    if isinstance(value, Amplitude):
        return [list(point) for point in value.points]
    if isinstance(value, (Integration, SolveOptions)):
        return _plain(value)
    if isinstance(value, (list, tuple)):
        return [_value(item, name) for item in value]
    return value if isinstance(value, (str, int, float)) else _plain(value)


def toml(table: Mapping[str, object]) -> str:
    """Nested tables as TOML: scalars first, then tables, then arrays of tables."""
    lines: list[str] = []
    _tables(table, "", lines)
    return "\n".join(lines).lstrip("\n") + "\n"


def _tables(table: Mapping[str, Any], path: str, lines: list[str]) -> None:
    for key, value in table.items():
        if not isinstance(value, Mapping) and not _of_tables(value):
            lines.append(f"{_key(key)} = {_inline(value)}")
    for key, value in table.items():
        place = f"{path}.{_key(key)}" if path else _key(key)
        if isinstance(value, Mapping):
            if any(not isinstance(item, Mapping) for item in value.values()):
                lines += ["", f"[{place}]"]
            _tables(value, place, lines)
        elif _of_tables(value):
            for item in value:
                lines += ["", f"[[{place}]]", *(f"{_key(k)} = {_inline(v)}" for k, v in item.items())]


def _of_tables(value: object) -> bool:
    return isinstance(value, Sequence) and bool(value) and all(isinstance(item, Mapping) for item in value)


def _key(key: str) -> str:
    return key if re.fullmatch(r"[A-Za-z0-9_-]+", key) else json.dumps(key)


def _inline(value: Any) -> str:
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{_key(k)} = {_inline(v)}" for k, v in value.items()) + " }"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_inline, value)) + "]"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    return repr(value).lower() if isinstance(value, bool) else repr(value)
