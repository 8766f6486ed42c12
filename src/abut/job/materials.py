"""The materials of a job file, those made of others last."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from abut.errors import InputError, nearest
from abut.job.material_tables import MADE_OF, MATERIALS
from abut.job.values import values
from abut.materials.material import Material


def materials_of(tables: Mapping[str, Any], folder: Path) -> dict[str, Material]:
    """By name; folder: from which files count. Raises InputError for wrong values, and names of no other material."""
    plain = {name: table for name, table in tables.items() if MATERIALS[table.kind] not in MADE_OF}
    made = {name: _material(name, table, {}, folder) for name, table in plain.items()}
    return {name: made.get(name) or _material(name, table, made, folder) for name, table in tables.items()}


def _material(name: str, table: Any, others: Mapping[str, Material], folder: Path) -> Material:
    given, kind = values(table, f"materials.{name}"), MATERIALS[table.kind]
    key = MADE_OF.get(kind)
    if key is not None:
        asked = getattr(table, key)
        for i, other in enumerate([asked] if isinstance(asked, str) else asked):
            if other not in others:
                where = f"materials.{name}.{key}" + ("" if isinstance(asked, str) else f"[{i}]")
                raise InputError(f"{where}: no other material named {other!r}{nearest(other, others)}")
        given[key] = others[asked] if isinstance(asked, str) else tuple(others[other] for other in asked)
    if "library" in given and (folder / given["library"]).is_file():  # others are left to the system's search
        given["library"] = str((folder / given["library"]).resolve())
    del given["kind"]
    try:
        made: Material = kind(**given)
        return made
    except InputError as error:
        raise InputError(f"materials.{name}.{error}") from None
