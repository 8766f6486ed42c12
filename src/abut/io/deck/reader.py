"""From the file to the record: ``read_deck``."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from abut.io.deck.assembly import without_parts
from abut.io.deck.beam_pretension import without_pulled_beams
from abut.io.deck.cards import Card, key, of, read_cards
from abut.io.deck.changed_sections import with_changed_sections
from abut.io.deck.contact_cards import general_contact, pairs
from abut.io.deck.coupling_cards import couplings
from abut.io.deck.friction_cards import friction_notes, without_tied_friction
from abut.io.deck.initial_conditions import initial_stress, initial_temperature
from abut.io.deck.interference_cards import Scene, opened, with_interferences
from abut.io.deck.mass_cards import with_weights
from abut.io.deck.mesh_cards import MeshCards, mesh_cards
from abut.io.deck.mode_cards import without_modes
from abut.io.deck.model_cards import (
    bound_together,
    cyclic_symmetry,
    equations,
    is_finite,
    materials,
    pretension_sections,
    rigid_bodies,
    transforms,
)
from abut.io.deck.multipoint_cards import multipoint_notes
from abut.io.deck.output_cards import requests
from abut.io.deck.reasons import DeckError, Reasons
from abut.io.deck.record import Amplitude, Deck, Material, Prescribed
from abut.io.deck.references import with_references
from abut.io.deck.removed_elements import absences, gone, without
from abut.io.deck.repeated import repeated_members, without_repeated
from abut.io.deck.section_cards import sections
from abut.io.deck.shell_cards import nodal_thickness, normals
from abut.io.deck.spring_cards import springs
from abut.io.deck.step_cards import KIND, amplitudes, prescribed, split_steps, steps
from abut.io.deck.submodel_cards import submodels
from abut.io.deck.supported import NEEDED, opens, sift
from abut.io.deck.user_materials import with_elastic_laws

ALONE = "shells and beams are read with the whole deck only; run the deck itself, or give job files a mesh of solids"
MESH = ("NODE", "ELEMENT", "NSET", "ELSET", "SURFACE", "SOLIDSECTION")


def read_deck(path: Path, ignore: Collection[str] = ()) -> Deck:
    """Read an Abaqus or CalculiX deck. ``ignore``: cards and parameters to leave out although they change the result.

    Raises InputError with card, file, line and cure for what abut does not honour and for what cannot be read."""
    notes: list[str] = []
    reasons = Reasons()
    every, modes = without_modes(with_elastic_laws(_cards(path, notes, reasons), notes), ignore)
    notes += modes.notes if modes is not None else ()
    sifted = sift(without_tied_friction(every, notes), reasons, ignore)
    if modes is not None and modes.shaking:
        _refuse_dashpots(every, ignore, reasons)
    if not sifted.plain:
        reasons.tell()
    cards = with_weights(without_repeated(sifted.cards, notes), modes is not None, reasons)
    outside, groups = split_steps(cards, reasons)
    mesh = mesh_cards(cards, notes, reasons)
    known = amplitudes(cards, reasons)
    pair_list = pairs(cards, mesh, reasons)
    made_of = materials(cards, reasons)
    general = general_contact(cards, reasons)
    fixed = _fixed(outside, mesh, known, notes, reasons)
    history, known = with_interferences(
        steps(groups, mesh, known, reasons), groups, Scene(mesh, pair_list, known), reasons
    )
    notes += [*friction_notes(cards), *multipoint_notes(cards, is_finite(cards)), *repeated_members(cards, mesh)]
    deck = Deck(
        path=str(path),
        nodes=mesh.nodes,
        points=mesh.points,
        blocks=mesh.blocks,
        node_sets=mesh.node_sets.by_name(),
        element_sets=mesh.element_sets.by_name(),
        surfaces={surface.name: surface for surface in mesh.surfaces.values()},
        sections=sections(cards, mesh, made_of, reasons),
        pairs=pair_list,
        general=general,
        equations=equations(cards, mesh, reasons),
        gathered=bound_together(cards, mesh, reasons),
        rigid=rigid_bodies(cards, mesh, reasons),
        transforms=transforms(cards, mesh, reasons),
        cyclic=cyclic_symmetry(cards, mesh, reasons),
        pretension=pretension_sections(cards, mesh, reasons),
        fixed=fixed,
        initial=initial_temperature(cards, mesh, reasons),
        stresses=initial_stress(cards, mesh, reasons),
        amplitudes=known,
        steps=history,
        notes=tuple(notes),
        quiet=sifted.quiet,
        small_sliding=any(card.key == "CONTACTPAIR" and card.has("SMALL SLIDING") for card in cards),
        ignored=sifted.ignored,
        couplings=couplings(cards, mesh, reasons),
        springs=springs(cards, mesh.numbers, reasons),
        thicknesses=nodal_thickness(cards, mesh, reasons),
        normals=normals(cards, mesh, reasons),
        requests=requests(sifted.requests),
        submodels=submodels(cards, mesh, Path(path).parent, reasons),
        modes=opened(modes, Scene(mesh, pair_list, known), reasons),
    )
    return with_references(without_pulled_beams(_changing(deck, groups, mesh, made_of, reasons)))


def _changing(
    deck: Deck, groups: Sequence[Sequence[Card]], mesh: MeshCards, known: Mapping[str, Material], reasons: Reasons
) -> Deck:
    """The deck with what goes, comes and changes between its steps. Raises InputError for all of ``reasons``."""
    away = absences(groups, mesh, reasons)
    reasons.tell()
    never = gone(away)
    passing = tuple(absence for absence in away if not np.isin(absence.elements, never).all())
    deck = with_changed_sections(replace(without(deck, never), absences=passing), groups, mesh, known, reasons)
    reasons.tell()
    return deck


def read_mesh_only(path: Path) -> Deck:
    """The nodes, elements, sets, surfaces and sections of a deck; all other cards are passed over.

    Raises InputError as ``read_deck`` does, for these cards only."""
    reasons = Reasons()
    notes: list[str] = []
    every = _cards(path, notes, reasons)
    sifted = sift([card for card in every if card.key in MESH or card.key in NEEDED], reasons)
    cards = without_repeated(sifted.cards, notes)
    mesh = mesh_cards(cards, notes, reasons)
    found = sections(cards, mesh, None, reasons)
    for block in mesh.blocks:
        if block.type.thin:
            reasons.add(DeckError(block.place, f"*ELEMENT: {block.code}: {ALONE}"))
    reasons.tell()
    inside = {(card.get("SURFACE") or "").upper() for card in every if card.key == "PRE-TENSIONSECTION"}
    return Deck(
        str(path), mesh.nodes, mesh.points, mesh.blocks, mesh.node_sets.by_name(), mesh.element_sets.by_name(),
        {surface.name: surface for name, surface in mesh.surfaces.items() if name not in inside},
        found,
        (), None, (), (), (), (), (), (), {}, {}, (), tuple(notes), (), (),
    )  # fmt: skip


def _cards(path: Path, notes: list[str], reasons: Reasons) -> tuple[Card, ...]:
    """All cards, those of parts written out."""
    return without_parts(read_cards(path, opens, reasons), notes, reasons)


def _refuse_dashpots(cards: Sequence[Card], ignore: Collection[str], reasons: Reasons) -> None:
    """Of what is shaken, the only steps in which they have an effect in CalculiX."""
    if "DASHPOT" not in {key(name.lstrip("*")) for name in ignore}:
        for card in of(cards, "DASHPOT"):
            reasons.add(card.refusal("vibrations have no dashpots; give *MODAL DAMPING", "DASHPOT"))


def _fixed(
    outside: Sequence[Card], mesh: MeshCards, known: Mapping[str, Amplitude], notes: list[str], reasons: Reasons
) -> tuple[Prescribed, ...]:
    """Supports outside the steps."""
    result = []
    for card in outside:
        if card.key not in KIND:
            continue
        with reasons.gathered():
            if card.key != "BOUNDARY":
                raise card.error("loads stand inside a step; move it between *STEP and *END STEP")
            for value in prescribed(card, mesh, known):
                if (
                    value.value != 0.0
                    and not value.amplitude
                    and not any("outside the steps" in note for note in notes)
                ):
                    notes.append(f"{value.place}: displacements given outside the steps grow in the first step")
                result.append(value)
    return tuple(result)
