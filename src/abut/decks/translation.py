"""From an Abaqus or CalculiX deck to a model."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

import numpy as np

from abut.contact.overclosure import PressureOverclosure
from abut.contact.sides import bodies_of, find_sides
from abut.decks.adjusting import adjusted
from abut.decks.body_loads import body_loads
from abut.decks.clearance import bilateral_note, gap_options
from abut.decks.couplings import beside_notes, couplings, held_by, reference_loads, reference_nodes, unlisted_notes
from abut.decks.elastic import elastic_law
from abut.decks.element_notes import element_notes
from abut.decks.expanded import expanded
from abut.decks.friction import friction_options, path_notes
from abut.decks.gathered import connectors
from abut.decks.holds import holds
from abut.decks.initial_stress import stress_before
from abut.decks.large import finite_notes, is_finite, load_steps, plastic_steps, unsupported, yields
from abut.decks.metal import metal_law
from abut.decks.modes import loading_notes, modes, with_stiff_beams
from abut.decks.nodal import equations, forces, supports, thin_supports
from abut.decks.output import output_options, tables, with_tables
from abut.decks.overclosure import overclosure_notes, own_laws, softened
from abut.decks.passing import in_span, passing_notes, removals
from abut.decks.plane import plane_of, thickness
from abut.decks.plane_solids import plane_notes
from abut.decks.points import with_points
from abut.decks.response import responses, without_shaking
from abut.decks.rigid import join, rigid_bodies, with_parts_coupled
from abut.decks.rubber import of_rubber, rubber_notes
from abut.decks.springs import spring_notes, springs
from abut.decks.submodels import with_submodels
from abut.decks.temperatures import history, temperatures
from abut.decks.tied_nodes import SAME_WAY, looks, with_ties_by_node
from abut.detection import add_surfaces, find_contacts
from abut.errors import InputError
from abut.io.deck import read_deck
from abut.io.deck.elements import BEAMS, FACES, SHELLS
from abut.io.deck.groups import Groups, Piece, pieces
from abut.io.deck.nodal_constraints import bonds
from abut.io.deck.pretension import cut
from abut.io.deck.reasons import DeckError, Reasons
from abut.io.deck.record import Deck, GeneralContact, Numbers, Pair, Step
from abut.io.deck.ties import near, tie_notes
from abut.io.deck.time_histories import Course, courses, period, times, zero
from abut.materials.material import Material
from abut.mesh.check import check_mesh
from abut.mesh.mesh import Mesh
from abut.mesh.read import build
from abut.model import (
    Connector,
    Contact,
    Coupling,
    Equation,
    Hold,
    Load,
    Model,
    Pressure,
    Rigid,
    Solid,
    SolveOptions,
    Spring,
    Support,
)
from abut.model.response import Wanted
from abut.output.options import Output

AXES = "xyz"


@dataclass(frozen=True)
class Translation:
    """A model, what was put in place of something else (notes), what the user left out; output: result files."""

    model: Model
    notes: tuple[str, ...]
    ignored: tuple[str, ...]
    own_laws: Mapping[str, PressureOverclosure] = field(default_factory=dict)
    output: Output = field(default_factory=Output)


def load_deck(path: Path, ignore: Collection[str] = (), soft: bool = False) -> Translation:
    """Read a deck as a model. ``ignore``: cards and parameters to leave out although they change the result; ``soft``:
    contact with the deck's own pressures over overclosure, not exact.

    Raises InputError with card, file, line and cure for what abut does not do."""
    deck = read_deck(path, ignore)
    try:
        return translate(with_submodels(deck), soft)
    except DeckError:
        raise
    except InputError as error:
        if str(error).startswith(str(path)):
            raise
        raise InputError(f"{path}: {error}") from None


def translate(deck: Deck, soft: bool = False) -> Translation:
    """The model of a deck, one time axis over all its steps. Raises InputError for what a model cannot hold."""
    deck = with_points(deck)
    _check_something_is_there(deck)
    reasons = Reasons()
    for error in unsupported(deck):
        reasons.add(error)
    plane = plane_of(deck)
    deck, notes = _made_solid(with_stiff_beams(deck), soft)
    deck, alone, shaken = _parted(deck)
    made = pieces(deck)
    deck = with_ties_by_node(with_parts_coupled(deck, made, notes), notes)
    groups = Groups(deck)
    every, stiff = join(deck, made)
    parts = {groups.body(piece.name, piece.elements): piece for piece in every}
    moving = [name for body in stiff for name, piece in parts.items() if piece is body]
    hard = np.concatenate([np.empty(0, np.int64), *(piece.elements for piece in stiff)])
    contacts: list[Contact] = []
    for pair in deck.pairs:
        with reasons.gathered():
            contacts.append(in_span(deck, pair, _contact(deck, groups, pair, hard, notes)))
    solids = _solids(deck, {name: piece for name, piece in parts.items() if name not in moving}, plane, reasons)
    rigid, bound = _referenced(deck, groups, {name: parts[name] for name in moving}, plane, reasons)
    notes += [*_idle(deck, groups), *unlisted_notes(deck), *beside_notes(deck)]
    references = dict(zip([*moving, *(coupling.name for coupling in bound)], reference_nodes(deck)))
    modulus = max((solid.material.modulus for solid in solids), default=1.0)
    prescribed = _prescribed(deck, groups, parts, plane, references, modulus, notes, reasons)
    asked = tables(deck, groups, notes)
    every_load = partial(_response_loads, groups=groups, parts=parts, plane=plane, references=references)
    shaking = partial(responses, deck, alone, shaken, 2 if plane else 3, every_load)
    vibrations = _vibrations(deck, groups, [contact.name for contact in contacts], shaking, reasons)
    reasons.tell()
    mesh = build(Mesh, groups.raw(), deck.path)
    notes += mesh.notes
    mesh, contacts = adjusted(mesh, deck, groups, contacts, notes)
    mesh = _told_thin(mesh, parts)
    for contact, pair in zip(contacts, deck.pairs):
        with reasons.gathered():
            _check_sides(mesh, contact, pair)
    reasons.tell()
    if deck.general is not None:
        mesh, found = _general(deck, deck.general, mesh, solids, contacts, notes)
        contacts += found
    laws = own_laws(deck, contacts)
    contacts = softened(contacts, laws) if soft else contacts
    finite = is_finite(deck)
    notes += [] if finite else path_notes(contacts)
    model = Model(
        mesh, solids=solids, contacts=contacts, rigid=rigid, couplings=held_by(deck, bound, prescribed.names), plane=plane,
        **{name: value for name, value in vars(prescribed).items() if name != "names"},
        kinematics="finite" if finite else "small", modes=vibrations, removals=tuple(removals(deck, parts)),
        solve=replace(_steps(deck, finite), end=period(deck)), times_in_shares=True,
    )  # fmt: skip
    model, output = with_tables(model, deck, asked, notes), output_options(model, deck, notes)
    return Translation(model, tuple(notes), deck.ignored, laws, output)


def _told_thin(mesh: Mesh, parts: Mapping[str, Piece]) -> Mesh:
    """With the names of its shells and beams. Raises InputError for a mesh that is not sound."""
    check_mesh(mesh)
    shells, beams = (tuple(n for n, piece in parts.items() if set(piece.codes) <= codes) for codes in (SHELLS, BEAMS))
    return replace(mesh, shells=shells, beams=beams)


def _made_solid(deck: Deck, soft: bool) -> tuple[Deck, list[str]]:
    """A deck with solids in place of shells and beams, cut where bolts are tightened, and what there is to tell of it."""
    notes = [f"{block.code}: {block.type.instead}" for block in deck.blocks if block.type.instead]
    notes += [*element_notes(deck), *loading_notes(deck)]
    notes += plane_notes(deck)
    deck = cut(expanded(deck, is_finite(deck)))
    notes = [*deck.notes, *notes, *overclosure_notes(deck, soft), *finite_notes(deck), *spring_notes(deck)]
    return deck, [*notes, *passing_notes(deck), *rubber_notes(deck)]


def _parted(deck: Deck) -> tuple[Deck, tuple[Deck, ...], tuple[Step, ...]]:
    """Without steps that shake, those with their loads alone, and these steps."""
    still, alone = without_shaking(deck)
    return still, alone, deck.steps[len(still.steps) :]


def _response_loads(
    deck: Deck, groups: Groups, parts: dict[str, Piece], plane: str | None, references: dict[str, tuple[int, int]]
) -> list[Load]:
    """All loads of a deck."""
    thick = thickness(deck, plane, [])
    bound = bonds(deck, groups, plane)
    at_nodes = [*forces(bound, groups, plane, thick), *reference_loads(deck, references, plane, thick)]
    return [*at_nodes, *_pressures(deck, groups), *body_loads(deck, parts, plane)]


def _vibrations(
    deck: Deck, groups: Groups, contacts: Sequence[str], shaken: Callable[[], Sequence[Wanted]], reasons: Reasons
) -> tuple[Wanted, ...]:
    """Modes, and what is made of them."""
    result: tuple[Wanted, ...] = ()
    if len(contacts) < len(deck.pairs):  # some are refused
        return result
    with reasons.gathered():
        result = (*modes(deck, groups, contacts), *shaken())
    return result


def _check_something_is_there(deck: Deck) -> None:
    if not deck.steps:
        raise InputError("no *STEP with *STATIC in the deck, or none left; abut solves these")
    if not deck.blocks:
        raise InputError("the deck has no *ELEMENT cards of solids, shells, beams or springs; add a body")


def _steps(deck: Deck, finite: bool) -> SolveOptions:
    return load_steps(deck) if finite else plastic_steps(deck) if yields(deck) else _options(deck)


def _referenced(
    deck: Deck, groups: Groups, moving: Mapping[str, Piece], plane: str | None, reasons: Reasons
) -> tuple[list[Rigid], list[Coupling]]:
    """Rigid bodies, ``moving`` by their names, and couplings."""
    rigid: list[Rigid] = []
    bound: list[Coupling] = []
    with reasons.gathered():
        rigid = rigid_bodies(deck, moving, plane)
    with reasons.gathered():
        bound = couplings(deck, groups, plane)
    return rigid, bound


@dataclass(frozen=True)
class _Prescribed:
    """What acts on the bodies of a deck; names: of the supports of nodes of shells, beams and trusses."""

    supports: list[Support]
    equations: list[Equation]
    loads: list[Load]
    springs: list[Spring]
    holds: list[Hold]
    names: dict[int, tuple[str, ...]]
    connectors: list[Connector]


def _prescribed(
    deck: Deck, groups: Groups, parts: dict[str, Piece], plane: str | None, references: dict[str, tuple[int, int]],
    modulus: float, notes: list[str], reasons: Reasons,
) -> _Prescribed:  # fmt: skip
    """Supports, equations and loads; ``notes`` and ``reasons`` get what there is to say."""
    thick = 1.0
    with reasons.gathered():
        thick = thickness(deck, plane, notes)
    result = _Prescribed([], [], [], [], [], {}, [])
    with reasons.gathered():
        result.springs.extend(springs(deck, groups, plane, thick, modulus))
    with reasons.gathered():
        result.connectors.extend(connectors(deck, groups, plane, thick))
    with reasons.gathered():
        bound = bonds(deck, groups, plane)
        result.supports.extend(supports(bound, groups))
        result.holds.extend(holds(bound, groups))
        result.names.update(thin_supports(bound, groups, len(result.supports)))
        result.equations.extend(equations(bound, groups, result.names))
        result.loads.extend(forces(bound, groups, plane, thick))
    with reasons.gathered():
        result.loads.extend(reference_loads(deck, references, plane, thick))
    for others in (_pressures(deck, groups), body_loads(deck, parts, plane), temperatures(deck, groups)):
        with reasons.gathered():
            result.loads.extend(others)
    return result


def _idle(deck: Deck, groups: Groups) -> list[str]:
    """Supports that hold nothing: nodes that do not exist, or that nothing is made of; cards without effect."""
    made = {*groups.used.tolist(), *deck.thin}
    made |= {n for e in deck.equations for n, _, _ in e.terms} | {found.pilot for found in deck.gathered}
    made |= deck.references.union(*(spring.ends.ravel().tolist() for spring in deck.springs))
    given = set(deck.nodes.tolist())
    notes: dict[str, None] = {}
    for value in (*deck.fixed, *(v for s in deck.steps for v in s.values)):
        if value.kind == "boundary" and made.isdisjoint(value.numbers.tolist()):
            node = int(value.numbers[0])
            what = "belongs to no element and no equation" if node in given else "does not exist"
            notes[f"{value.place}: *BOUNDARY: node {node} {what}: the line holds nothing"] = None
        elif value.kind == "boundary" and value.value != 0.0 and (lost := {*value.numbers.tolist()} - made):
            more = f" and {len(lost) - 1} more" if len(lost) > 1 else ""
            notes[f"{value.place}: *BOUNDARY: node {min(lost)}{more} belong to no element: nothing follows there"] = (
                None
            )
    return [*notes, *([f"cards without effect on the result: {', '.join(deck.quiet)}"] if deck.quiet else [])]


def _solids(deck: Deck, parts: Mapping[str, Piece], plane: str | None, reasons: Reasons) -> list[Solid]:
    result: list[Solid] = []
    for name, piece in parts.items():
        with reasons.gathered():
            result.append(_solid(deck, name, piece, plane))
    return result


def _solid(deck: Deck, name: str, piece: Piece, plane: str | None) -> Solid:
    material = piece.section.material
    rest = material.density, material.expansion.rows[0][1][0]
    law: Material
    try:
        if material.rubber is not None:
            law = of_rubber(material.rubber, rest)
        elif material.hardening:
            law = metal_law(deck, piece)
        else:
            law = elastic_law(deck, piece, 3 if plane is None else 2)
    except InputError as error:
        raise DeckError(material.place, f"*MATERIAL '{material.name}': {error}") from None
    return Solid(name, law, integration=piece.integration, initial_stress=stress_before(deck, piece, plane))


def _contact(deck: Deck, groups: Groups, pair: Pair, hard: Numbers, notes: list[str]) -> Contact:
    """Of a tie the slave is the contactor, as the deck says, unless it is rigid, as elements in ``hard`` are: what the slave
    leaves out stays free. Of contact abut chooses."""
    slave, master = groups.surface(pair.slave), groups.surface(pair.master)
    for name, side in ((slave, pair.slave), (master, pair.master)):
        if deck.surfaces[side].nodes is not None:
            notes.append(f"contact '{pair.name}': '{name}' is the faces that the nodes of *SURFACE '{side}' make up")
    if pair.is_tie:
        found = near(deck, groups, pair)
        notes += tie_notes(deck, groups, pair, found)
        slave = groups.facets(found.rows, f"{pair.slave}-near") if found.left else slave
    if pair.tied:
        if np.isin(groups.rows(pair.slave)[:, 0], hard).all():
            slave, master = master, slave
            notes.append(f"contact '{pair.name}': the master is the contactor, as the slave is rigid")
        return Contact(contactor=slave, target=master, name=pair.name, kind="tied")
    adjust = float(np.ptp(deck.points, axis=0).max()) if pair.clearance is not None else 0.0  # every gap
    gap = gap_options(deck, groups, pair, notes)
    if pair.bilateral:
        notes.append(bilateral_note(deck, groups, pair))
        return Contact(slave, master, name=pair.name, kind="bilateral", adjust=adjust, **gap)
    rub = friction_options(deck, pair.friction)
    return Contact(slave, master, name=pair.name, adjust=adjust, **gap, **rub)


def _general(
    deck: Deck, general: GeneralContact, mesh: Mesh, solids: list[Solid], contacts: list[Contact], notes: list[str]
) -> tuple[Mesh, list[Contact]]:
    """Pairs of bodies that face each other and that no *CONTACT PAIR or *TIE names; the mesh with their surfaces."""
    named = [{body for side in c.named for body in bodies_of(mesh, side)} for c in contacts]
    found = [f for f in find_contacts(mesh, solids) if set(f.bodies) not in named]
    if not found and not contacts:
        raise DeckError(
            general.place,
            "*CONTACT INCLUSIONS: no two bodies face each other within half a facet; name their surfaces "
            "in *CONTACT PAIR",
        )
    notes += [f"general contact: {f.note}" for f in found]
    options = {"kind": "tied"} if general.tied else friction_options(deck, general.friction)
    return add_surfaces(mesh, found), [f.contact(**options) for f in found]


def _check_sides(mesh: Mesh, contact: Contact, pair: Pair) -> None:
    """Raise InputError for flat surfaces that look the same way, which happens where meshes overlap."""
    first, second = contact.named
    if first == second:
        return
    a, b = (looks(side) for side in find_sides(mesh, first, second))
    if a @ b > SAME_WAY:
        raise DeckError(
            pair.place,
            f"*CONTACT PAIR: '{pair.slave}' and '{pair.master}' look the same way: their bodies overlap; abut "
            "needs surfaces that face each other: choose other faces, or join the meshes",
        )


def _pressures(deck: Deck, groups: Groups) -> Iterator[Load]:
    alike: dict[Course, list[tuple[int, int]]] = {}
    kinds = {int(e): block.type.kind for block in deck.blocks for e in block.ids}
    for (element, face), course in courses(deck, "pressure").items():
        if not zero(course):
            number = int(element)
            alike.setdefault(course, []).append((number, FACES[kinds[number]][int(face) - 1]))
    for i, (course, rows) in enumerate(alike.items(), start=1):
        yield Pressure(groups.facets(np.array(rows, np.int64), f"pressure-{i}"), *history(course))


def _options(deck: Deck) -> SolveOptions:
    """Load steps at the ends of the deck's steps and the corners of its amplitudes."""
    ends = times(deck)
    if np.allclose(ends, np.arange(1, len(ends) + 1) / len(ends), rtol=0.0, atol=1e-12):
        return SolveOptions(steps=len(ends))
    return SolveOptions(times=ends)
