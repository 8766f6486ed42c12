"""Sections of solids, shells and beams: thickness, material and its directions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from abut.errors import nearest
from abut.io.deck.beam_forms import form_of
from abut.io.deck.cards import Card, Line, as_float, of
from abut.io.deck.distributions import axes_by_elements
from abut.io.deck.elastic_cards import orientation
from abut.io.deck.mesh_cards import MeshCards
from abut.io.deck.reasons import DeckError, Place, Reasons
from abut.io.deck.record import NO_CONSTANTS, Expansion, Layer, Material, Orientation, Section


def sections(
    cards: Sequence[Card], mesh: MeshCards, known: Mapping[str, Material] | None, reasons: Reasons
) -> tuple[Section, ...]:
    """Sections of solids, shells and beams, without materials where ``known`` is None; later ones override earlier ones for
    elements that stand in both, as in Abaqus and CalculiX."""
    result: list[Section] = []
    axes = {name.upper(): card for card in of(cards, "ORIENTATION") if (name := card.get("NAME"))}
    for card in (card for card in cards if card.key in _SECTIONS):
        with reasons.gathered():
            for elements, here in axes_by_elements(card, cards, mesh, axes):
                section = _SECTIONS[card.key](card, mesh, known, here)
                section = section if elements is None else replace(section, elements=elements)
                result = [replace(s, elements=np.setdiff1d(s.elements, section.elements)) for s in result]
                result.append(section)
    left = tuple(s for s in result if len(s.elements))
    for section in (s for s in left if not all(layer.thickness for layer in s.layers)):
        reasons.add(DeckError(section.place, "*SHELL SECTION: thickness of the layer: expected a number > 0, got 0"))
    return left


def _section(card: Card, mesh: MeshCards, known: Mapping[str, Material] | None, axes: Mapping[str, Card]) -> Section:
    if card.has("NODAL THICKNESS"):
        return _of_elements(card, mesh, known, axes, 0.0)
    thickness = card.lines[0].number(0, "thickness", 1.0) if card.lines else 1.0
    if not thickness > 0.0:
        raise card.lines[0].error(f"thickness: expected a number > 0, got {thickness:g}")
    return _of_elements(card, mesh, known, axes, thickness)


def section_of(card: Card, mesh: MeshCards, known: Mapping[str, Material]) -> Section:
    """One *CHANGE SOLID SECTION. Raises InputError."""
    return _of_elements(card, mesh, known, {}, 1.0)


def _shell_section(
    card: Card, mesh: MeshCards, known: Mapping[str, Material] | None, axes: Mapping[str, Card]
) -> Section:
    """One *SHELL SECTION or *MEMBRANE SECTION. Raises InputError for a thickness or layers that are none."""
    thickness = 0.0
    layers = _layers(card, known, axes) if card.has("COMPOSITE") else ()
    if layers:
        thickness = sum(layer.thickness for layer in layers)
    elif not card.has("NODAL THICKNESS"):
        line = card.first("thickness")
        thickness = line.number(0, "thickness")
        if not thickness > 0.0:
            raise line.error(f"thickness: expected a number > 0, got {thickness:g}")
    sides = {"SPOS": 0.5, "SNEG": -0.5}
    text = (card.get("OFFSET") or "0").upper()
    offset = sides.get(text, as_float(text))
    if offset is None:
        raise card.error(f"OFFSET={text}: expected a number (over the thickness), SPOS or SNEG")
    return replace(_of_elements(card, mesh, known, axes, thickness, layers), offset=offset)


def _layers(card: Card, known: Mapping[str, Material] | None, axes: Mapping[str, Card]) -> tuple[Layer, ...]:
    """Of *SHELL SECTION, COMPOSITE: thickness, what is not read, material and orientation of each. Raises InputError."""
    for name in ("MATERIAL", "NODAL THICKNESS"):
        if card.has(name):
            raise card.error(f"COMPOSITE and {name}: layers have a material and a thickness each; take {name} out")
    card.first("thickness of a layer")
    result = []
    for line in card.lines:
        thickness, fields = line.number(0, "thickness of the layer"), [*line.fields, "", "", ""]
        if not thickness >= 0.0:
            raise line.error(f"thickness of the layer: expected a number > 0, got {thickness:g}")
        if not fields[2]:
            raise line.error("the layer has no material; write thickness, , material, orientation")
        material = _material(line, fields[2], known, card.place)
        directions = fields[3] or card.get("ORIENTATION")
        if directions and as_float(directions) is not None:
            raise line.error(f"{directions}: an angle is not supported; give the name of an *ORIENTATION")
        result.append(Layer(thickness, material, _oriented(line, directions, material, axes)))
    return tuple(result)


def _beam_section(
    card: Card, mesh: MeshCards, known: Mapping[str, Material] | None, axes: Mapping[str, Card]
) -> Section:
    """One *BEAM SECTION or *BEAM GENERAL SECTION. Raises InputError for what is no such section."""
    form, widths, walls = form_of(card)
    axis = (0.0, 0.0, -1.0)
    if len(card.lines) > 1 and any(card.lines[1].fields):
        x, y, z = (card.lines[1].number(i, "component of the first direction", 0.0) for i in range(3))
        if x == y == z == 0.0:
            raise card.lines[1].error("the first direction has no length; give three components")
        axis = (x, y, z)
    offsets = []
    for name in ("OFFSET1", "OFFSET2"):
        value = as_float(card.get(name) or "0")
        if value is None:
            raise card.error(f"{name}={card.get(name)}: expected a number (over the width)")
        offsets.append(value)
    section = _of_elements(card, mesh, known, axes, 0.0)
    return replace(
        section,
        nodal=card.has("NODAL THICKNESS"),
        widths=widths,
        axis=axis,
        offsets=(offsets[0], offsets[1]),
        form=form,
        walls=walls,
    )


def _of_elements(
    card: Card, mesh: MeshCards, known: Mapping[str, Material] | None, axes: Mapping[str, Card], thickness: float,
    layers: tuple[Layer, ...] = (),
) -> Section:  # fmt: skip
    name = card.need("ELSET")
    material = "" if layers else card.need("MATERIAL")
    if name.upper() not in mesh.element_sets.sets:
        raise card.unknown(f"no element set named {name!r}{mesh.element_sets.like(name)}")
    properties = layers[0].material if layers else _material(card, material, known, card.place)
    elements, spelled = mesh.element_sets.sets[name.upper()], mesh.element_sets.spelled[name.upper()]
    directions = None if layers else _oriented(card, card.get("ORIENTATION"), properties, axes)
    return Section(spelled, elements, properties, thickness, card.place, directions, layers=layers)


def _material(at: Card | Line, name: str, known: Mapping[str, Material] | None, place: Place) -> Material:
    if known is None:
        return Material(name, NO_CONSTANTS, 0.0, Expansion(), place)
    if name.upper() not in known:
        raise at.unknown(f"no material named {name!r}{nearest(name, [m.name for m in known.values()])}")
    return known[name.upper()]


def _oriented(at: Card | Line, name: str | None, material: Material, known: Mapping[str, Card]) -> Orientation | None:
    """Of a section, where its material has directions."""
    if name is None or not material.directed:
        return None
    if name.upper() not in known:
        raise at.unknown(f"no orientation named {name!r}{nearest(name.upper(), known)}")
    return orientation(known[name.upper()])


_SECTIONS = {
    "SOLIDSECTION": _section,
    "SHELLSECTION": _shell_section,
    "MEMBRANESECTION": _shell_section,
    "USERSECTION": _shell_section,
    "BEAMSECTION": _beam_section,
    "BEAMGENERALSECTION": _beam_section,
}
