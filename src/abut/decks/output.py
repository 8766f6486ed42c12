"""What a deck asks to be printed or written, as probes and output options of a model, and what is not done, in words."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from abut.errors import InputError
from abut.io.deck.groups import Groups
from abut.io.deck.output_cards import Request
from abut.io.deck.record import Deck, Numbers
from abut.io.deck.time_histories import ends
from abut.model import Model, Probe
from abut.model.probe import QUANTITIES, YIELDED
from abut.model.step_choice import StepChoice
from abut.model.step_ends import SAME
from abut.output.options import CONTACT, FRD, MATERIAL, USUAL, VTU, Output
from abut.probing import find_place

NODES, ELEMENTS, CONTACTS = "node", "element", "contact"
IN_TABLES = {  # by what the first characters of a label may be: a quantity of probes
    NODES: {"U": "displacement", "RF": "reaction"},
    ELEMENTS: {
        "S": "stress", "MISES": "von-mises", "SP": "principal-stress", "PEEQ": "equivalent-plastic-strain",
        "PE": "plastic-strain",
    },
    CONTACTS: {
        "CSTR": "pressure", "CSTRESS": "pressure", "CPRESS": "pressure", "CDIS": "gap", "CDISP": "gap", "COPEN": "gap",
    },
}  # fmt: skip
IN_FILES = {  # fields of result files
    NODES: {"U": "displacement"},
    ELEMENTS: {
        "S": "stress", "MISES": "von-mises", "SP": "principal-stress", "PHS": "principal-stress", "PEEQ": MATERIAL,
        "PE": MATERIAL, "SDV": MATERIAL, "ERR": "stress-error", "ZZS": "stress",
    },
    CONTACTS: dict.fromkeys(("CSTR", "CSTRESS", "CPRESS", "CDIS", "CDISP", "COPEN", "CSHEAR", "CSLIP"), CONTACT),
}  # fmt: skip


@dataclass(frozen=True)
class Asked:
    """A table that a deck asks for: ``on`` a node set or, of contacts, everywhere ("")."""

    request: Request
    on: str
    of: tuple[str, ...]


def tables(deck: Deck, groups: Groups, notes: list[str]) -> list[Asked]:
    """The tables that a deck asks for; ``groups`` gets the node sets that these need, ``notes`` what is not written."""
    result = []
    for request in deck.requests:
        if not request.table:
            continue
        of = _quantities(request, IN_TABLES, notes)
        if not any(section.material.hardening for section in deck.sections):
            of = tuple(name for name in of if name not in YIELDED)
        on = ""
        if request.kind != CONTACTS:
            nodes = np.intersect1d(_nodes(deck, request), groups.used)
            if not len(nodes):
                notes.append(f"{request.place}: {request.title}: no set {request.of!r} with nodes: nothing is written")
                continue
            on = groups.node_set(nodes, f"{request.of}-{request.kind}s")
        if request.local:
            notes.append(f"{request.place}: {request.title}, GLOBAL=NO: written along the global axes")
        if of:
            result.append(Asked(request, on, of))
    if any(asked.request.kind == ELEMENTS for asked in result):
        notes.append("*EL PRINT: stresses and strains at nodes (recovered from those at integration points)")
    return result


def with_tables(model: Model, deck: Deck, asked: Sequence[Asked], notes: list[str]) -> Model:
    """The model with a probe for each table."""
    probes: list[Probe] = []
    for item in asked:
        steps = _steps(model, deck, [item.request], notes)
        for name, on, contact in _places(model, item):
            merged = next((p for p in probes if (p.on, p.contact, p.steps) == (on, contact, steps)), None)
            of = tuple(dict.fromkeys([*item.of, *((merged.of or ()) if merged else ())]))
            taken = [probe.name for probe in probes]
            free = next(n for n in (name, *(f"{name} {i}" for i in range(2, len(taken) + 3))) if n not in taken)
            probe = Probe(merged.name if merged else free, on=on, of=of, contact=contact, steps=steps)
            try:
                find_place(model, probe)
            except InputError as error:
                notes.append(f"{item.request.place}: {item.request.title}: {error}; nothing is written")
                continue
            probes = [probe if other is merged else other for other in probes] if merged else [*probes, probe]
    return replace(model, probes=probes) if probes else model


def output_options(model: Model, deck: Deck, notes: list[str]) -> Output:
    """Result files: the usual ones, with what a deck asks for beyond, ``fields.frd`` where it asks for CalculiX's."""
    files = [request for request in deck.requests if not request.table]
    if not files:
        return Output()
    fields = [*USUAL]
    for request in files:
        if request.of:
            notes.append(f"{request.place}: {request.title}: of all bodies, not of '{request.of}' alone")
        fields += [name for name in _quantities(request, IN_FILES, notes) if name not in fields]
    formats = (VTU, FRD) if any(request.frd for request in files) else (VTU,)
    return Output(_steps(model, deck, files, notes), tuple(fields), formats)


def _quantities(request: Request, known: dict[str, dict[str, str]], notes: list[str]) -> tuple[str, ...]:
    """Names for the labels of a request, in the order of ``QUANTITIES`` where they are such."""
    names: list[str] = []
    unknown: list[str] = []
    for label in request.labels:
        root = label.rstrip("0123456789") or label
        name = known[request.kind].get(root)
        (unknown if name is None else names).append(label if name is None else name)
    if unknown:
        cure = "; the forces of supports are in forces.csv" if not request.table and "RF" in unknown else ""
        notes.append(f"{request.place}: {request.title}: {', '.join(unknown)}: not written{cure}")
    order = {name: i for i, name in enumerate(QUANTITIES)}
    return tuple(sorted(dict.fromkeys(names), key=lambda name: order.get(name, len(order))))


def _nodes(deck: Deck, request: Request) -> Numbers:
    """Nodes of the set that a request names; of elements those that they have."""
    wanted = request.of.upper()
    if request.kind == NODES:
        return _named(deck.node_sets, wanted)
    elements = _named(deck.element_sets, wanted)
    nodes = [block.nodes[np.isin(block.ids, elements)].ravel() for block in deck.blocks]
    return np.unique(np.concatenate([np.empty(0, np.int64), *nodes]))


def _named(sets: Mapping[str, Numbers], wanted: str) -> Numbers:
    return next((numbers for name, numbers in sets.items() if name.upper() == wanted), np.empty(0, np.int64))


def _places(model: Model, asked: Asked) -> Iterable[tuple[str, str, str | None]]:
    """Name, node set or surface, and contact of each probe."""
    if asked.request.kind != CONTACTS:
        yield f"{asked.request.of} {asked.request.kind}s", asked.on, None
        return
    for contact in model.contacts:
        if contact.kind != "tied" and isinstance(contact.contactor, str):
            yield contact.name, contact.contactor, contact.name


def _steps(model: Model, deck: Deck, among: Sequence[Request], notes: list[str]) -> StepChoice:
    """Of the load steps those that any of some requests wants: in each step of a deck every n-th, and its last."""
    count, times = len(deck.steps), ends(deck)
    whole = [request for request in among if request.every == 1]
    if {step for r in whole for step in range(max(r.first, 1), (r.last or count) + 1)} == set(range(1, count + 1)):
        return "all"
    if model.finite and (model.contacts or model.solve.steps == "auto"):
        notes.append(
            f"{among[0].place}: {among[0].title}: FREQUENCY and the step are not honoured, as load steps are abut's own: "
            "written for every one"
        )
        return "all"
    wanted, number = set(), 0
    for step, end in enumerate(times, start=1):
        inside = [n for n, time in enumerate(model.ends, start=1) if n > number and time <= end + SAME]
        for request in among:
            if request.first <= step and (request.last is None or step <= request.last):
                wanted |= {n for i, n in enumerate(inside, start=1) if i % request.every == 0 or n == inside[-1]}
        number = inside[-1] if inside else number
    every = list(range(1, len(model.ends) + 1))
    return "all" if sorted(wanted) == every else sorted(wanted) or "last"
