"""Names of solids in the text of a STEP file (ISO 10303-21)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from abut.errors import InputError

ENTITY = re.compile(rb"#(\d+)\s*=\s*([A-Z0-9_]+)\s*\((.*?)\)\s*;", re.DOTALL)
TEXT = re.compile(r"'((?:[^']|'')*)'")
WIDE, NARROW = re.compile(r"\\X2\\((?:[0-9A-F]{4})+)\\X0\\"), re.compile(r"\\X\\([0-9A-F]{2})")
KEPT = {
    "MANIFOLD_SOLID_BREP", "BREP_WITH_VOIDS", "CLOSED_SHELL", "ORIENTED_CLOSED_SHELL", "ADVANCED_BREP_SHAPE_REPRESENTATION",
    "SHAPE_REPRESENTATION_RELATIONSHIP", "SHAPE_DEFINITION_REPRESENTATION", "PRODUCT_DEFINITION_SHAPE",
    "PRODUCT_DEFINITION", "PRODUCT_DEFINITION_FORMATION", "PRODUCT_DEFINITION_FORMATION_WITH_SPECIFIED_SOURCE", "PRODUCT",
}  # fmt: skip
SOLIDS = ("MANIFOLD_SOLID_BREP", "BREP_WITH_VOIDS")
NAMELESS = ("Open CASCADE STEP translator", "NONE", "Solid")  # what programs write where there is no name


@dataclass(frozen=True)
class Entity:
    kind: str
    texts: tuple[str, ...]
    refers: tuple[int, ...]


def solid_names(path: Path) -> list[tuple[str, int]]:
    """Of each solid in its order in the file its name, "" where it has none, and its number of faces: the name of the
    product whose only shape it is, or else its own, which many programs write after the last feature ("Boss-Extrude1").
    Files of other formats have none."""
    if path.suffix.lower() not in (".step", ".stp"):
        return []
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot read {path}: {error.strerror}") from None
    entities = {}
    for number, kind, body in ENTITY.findall(data):
        if kind.decode() in KEPT:
            text = body.decode("utf-8", "replace")
            refers = tuple(int(ref) for ref in re.findall(r"#(\d+)", TEXT.sub("", text)))
            entities[int(number)] = Entity(kind.decode(), tuple(TEXT.findall(text)), refers)
    products = _products(entities)
    result = []
    for number, entity in sorted(entities.items()):
        if entity.kind in SOLIDS:
            names = (products.get(number, ""), *entity.texts[:1])
            name = next((text for text in map(decoded, names) if text and not text.startswith(NAMELESS)), "")
            result.append((name, _faces(entity, entities)))
    return result


def decoded(text: str) -> str:
    """A text of the file with its codes for other characters (ISO 10303-21, 6.4.3) as these."""
    text = WIDE.sub(lambda code: bytes.fromhex(code[1]).decode("utf-16-be", "replace"), text)
    text = NARROW.sub(lambda code: chr(int(code[1], 16)), text)
    return text.replace("''", "'").replace("\\\\", "\\")


def _faces(solid: Entity, entities: Mapping[int, Entity]) -> int:
    """The number of faces of all shells of a solid."""
    count = 0
    for ref in solid.refers:
        shell = entities.get(ref)
        if shell is not None and shell.kind == "ORIENTED_CLOSED_SHELL":
            shell = next((entities[i] for i in shell.refers if i in entities), None)
        count += len(shell.refers) if shell is not None else 0
    return count


def _products(entities: Mapping[int, Entity]) -> dict[int, str]:
    """The names of the products that solids are the only shape of."""
    linked: dict[int, list[int]] = {}  # representations that say the same
    for entity in entities.values():
        if entity.kind == "SHAPE_REPRESENTATION_RELATIONSHIP" and len(entity.refers) == 2:
            a, b = entity.refers
            linked.setdefault(a, []).append(b)
            linked.setdefault(b, []).append(a)
    result = {}
    for entity in entities.values():
        if entity.kind != "SHAPE_DEFINITION_REPRESENTATION" or len(entity.refers) != 2:
            continue
        name = _product(entity.refers[0], entities)
        for shape in (entity.refers[1], *linked.get(entity.refers[1], ())):
            items = entities[shape].refers if shape in entities else ()
            solids = [item for item in items if item in entities and entities[item].kind in SOLIDS]
            if len(solids) == 1:
                result[solids[0]] = name
    return result


def _product(number: int, entities: Mapping[int, Entity]) -> str:
    """The name of the product that a PRODUCT_DEFINITION_SHAPE is of."""
    for _ in range(4):  # shape, definition, formation, product
        entity = entities.get(number)
        if entity is None:
            return ""
        if entity.kind == "PRODUCT":
            return next((text for text in entity.texts[1::-1] if text), "")
        if not entity.refers:
            return ""
        number = entity.refers[0]
    return ""
