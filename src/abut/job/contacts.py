"""Contacts of a job file: surfaces and bodies by name, pairs found (auto = true), and found surfaces by their name
("auto:a-b")."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from abut.contact.overclosure import PressureOverclosure
from abut.contact.sides import Names, bodies_of, listed
from abut.detection import AUTO, BodyPair, FoundContact, add_surfaces, every_pair, find_contacts
from abut.errors import InputError, nearest
from abut.job.schema import ContactTable, OverclosureTable
from abut.job.values import values
from abut.mesh.mesh import Mesh
from abut.model import Contact, Integration, Solid

SIDES = ("surfaces", "contactor", "target")
FINDING = ("auto", "bodies", "reach")  # keys that say what to look for; the others are the contact's own
Key = tuple[float | None, tuple[str, ...] | None]


@dataclass(frozen=True)
class Resolved:
    """The mesh with the surfaces that had to be found, all contacts, the number of the entry that each comes from, and what
    was found and chosen, in words."""

    mesh: Mesh
    contacts: tuple[Contact, ...]
    entries: tuple[int, ...]
    notes: tuple[str, ...]


def resolve_contacts(
    tables: Sequence[ContactTable], mesh: Mesh, solids: Sequence[Solid], finite: bool = False
) -> Resolved:
    """All contacts of a job. finite: bodies may move anywhere and fold, so that auto = true takes every two of them.

    Pairs of bodies that an entry names by its surfaces, or that an earlier entry with auto = true has found, are left out
    of what a later one finds. Raises InputError for keys that do not go together and for pairs that do not exist.
    """
    finder = _Finder(mesh, solids)
    for i, table in enumerate(tables):
        _check(table, f"contacts[{i}]")
    named = [() if table.auto else finder.named(table, f"contacts[{i}]") for i, table in enumerate(tables)]
    used: dict[str, FoundContact] = {found.contactor: found for each in named for found in each}
    mesh = add_surfaces(mesh, list(used.values()))
    coupled = {pair for table in tables if not table.auto for pair in _bodies(mesh, table)}
    contacts: list[tuple[int, Contact]] = []
    notes: list[str] = []
    for i, table in enumerate(tables):
        options = values(table, f"contacts[{i}]", (*FINDING, *SIDES, "integration", "law"))
        options["law"] = table.law
        if isinstance(table.law, OverclosureTable):
            options["law"] = PressureOverclosure(tuple((over, pressure) for over, pressure in table.law.points))
        options["integration"] = Integration(**table.integration.model_dump())
        if not table.auto:
            contacts.append((i, _named(table, options)))
            continue
        if finite and table.kind != "tied":
            every = _anywhere(table, f"contacts[{i}]", mesh, solids, coupled)
            name = options.pop("name")
            contacts += [(i, pair.contact(name, **options)) for pair in every]
            notes += [pair.note for pair in every if pair.note]
            coupled |= {frozenset(pair.bodies) for pair in every}
            continue
        found = [f for f in finder.find(table) if frozenset(f.bodies) not in coupled]
        if not found:
            raise InputError(
                f"contacts[{i}]: auto: no two bodies face each other within reach (other than those of other entries); give "
                "a larger reach, or name the surfaces"
            )
        coupled |= {frozenset(f.bodies) for f in found}
        mesh = add_surfaces(mesh, found)
        first = options.pop("name")
        for f in found:
            each = f.contact(**options)
            contacts.append((i, f.contact(name=f"{first}-{each.name}", **options) if first else each))
        notes += [f.note for f in found]
    return Resolved(mesh, tuple(c for _, c in contacts), tuple(i for i, _ in contacts), tuple(notes))


def _named(table: ContactTable, options: dict[str, Any]) -> Contact:
    """The contact of an entry that names its sides."""
    if table.surfaces:
        first, second = table.surfaces
        return Contact(first, second, **options)
    return Contact(contactor=table.contactor, target=table.target, **options)


def _anywhere(
    table: ContactTable, where: str, mesh: Mesh, solids: Sequence[Solid], coupled: set[frozenset[str]]
) -> list[BodyPair]:
    """Pairs of bodies that no other entry couples."""
    if table.reach is not None:
        raise InputError(
            f'{where}.reach: with kinematics = "finite" bodies may meet however far apart they begin: leave it out'
        )
    every = [pair for pair in every_pair(mesh, solids, table.bodies) if frozenset(pair.bodies) not in coupled]
    if not every:
        raise InputError(f"{where}: auto: other entries couple every two bodies already; take it out")
    return every


class _Finder:
    """Looks once for each reach and choice of bodies."""

    def __init__(self, mesh: Mesh, solids: Sequence[Solid]) -> None:
        self._mesh, self._solids = mesh, solids
        self._known: dict[Key, tuple[FoundContact, ...]] = {}

    def find(self, table: ContactTable) -> tuple[FoundContact, ...]:
        key: Key = (table.reach, None if table.bodies is None else tuple(table.bodies))
        if key not in self._known:
            self._known[key] = find_contacts(self._mesh, self._solids, reach=table.reach, bodies=table.bodies)
        return self._known[key]

    def named(self, table: ContactTable, where: str) -> tuple[FoundContact, ...]:
        """The found pair that an entry names by its surfaces, if it does."""
        names = [(place, name) for place, side in _places(table) for name in _found(side)]
        names = [(place, name) for place, name in names if name not in self._mesh.surfaces]
        if not names:
            return ()
        pairs = self.find(table)
        known = [name for found in pairs for name in (found.contactor, found.target)]
        for place, name in names:
            if name not in known:
                raise InputError(f"{where}.{place}: no two surfaces found as {name!r}{nearest(name, known)}")
        return tuple(found for found in pairs if {found.contactor, found.target} & {name for _, name in names})


def _places(table: ContactTable) -> list[tuple[str, Names]]:
    """The sides that an entry names, each with its key."""
    if table.surfaces:
        return [(f"surfaces[{number}]", side) for number, side in enumerate(table.surfaces)]
    return [(key, getattr(table, key)) for key in SIDES[1:] if getattr(table, key)]


def _check(table: ContactTable, where: str) -> None:
    given = [key for key in SIDES if getattr(table, key)]
    if table.auto:
        if given:
            raise InputError(f"{where}.{given[0]}: auto = true finds both surfaces; leave {given[0]} or auto out")
        return
    if "surfaces" in given and len(given) > 1:
        raise InputError(
            f"{where}.{given[1]}: surfaces leaves the choice of the contactor to abut, contactor and target force it: leave "
            f"{' and '.join(given[1:])} out, or surfaces"
        )
    if "surfaces" in given and len(table.surfaces) != len(("contactor", "target")):
        raise InputError(
            f"{where}.surfaces: expected two entries, each a surface or body or a list of them, got {len(table.surfaces)}"
            + ('; several on one side are a list: [["a", "b"], "c"]' if len(table.surfaces) > 1 else "")
        )
    if any(not side for side in table.surfaces):
        raise InputError(f"{where}.surfaces: expected the names of surfaces or bodies, got an empty one")
    for side in SIDES[1:]:
        if given and "surfaces" not in given and side not in given:
            raise InputError(f"{where}.{side}: missing; give it, or surfaces = [...] alone, and abut chooses")
    if not given:
        raise InputError(f"{where}.surfaces: missing; name both surfaces, or give auto = true")
    if (table.bodies, table.reach) != (None, None) and not any(_found(side) for _, side in _places(table)):
        raise InputError(
            f"{where}: bodies and reach are for auto = true and surfaces named '{AUTO}...'; leave them out"
        )


def _found(side: Names) -> list[str]:
    """The names of found surfaces among those of a side."""
    return [name for name in listed(side) if name.startswith(AUTO)]


def _bodies(mesh: Mesh, table: ContactTable) -> set[frozenset[str]]:
    """Pairs of bodies that an entry couples; none where it names unknown ones, which the model will refuse."""
    sides = [side for _, side in _places(table)]
    if not all(name in mesh.surfaces or name in mesh.bodies for side in sides for name in listed(side)):
        return set()
    bodies, other = (bodies_of(mesh, side) for side in sides)
    return {frozenset({a, b}) for a in bodies for b in other}
