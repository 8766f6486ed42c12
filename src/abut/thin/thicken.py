"""Surface and line meshes made solid, with what is said of their nodes: by what decks do with shells and beams, so that
both mean the same."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.cells import CELLS
from abut.decks.couplings import couplings, held_by, reference_loads, reference_nodes
from abut.decks.expanded import thickened
from abut.decks.nodal import equations, forces
from abut.decks.nodal import supports as supports_of
from abut.errors import InputError, nearest
from abut.fields import evaluate
from abut.io.deck.groups import Groups
from abut.io.deck.nodal_constraints import Bonds, bonds
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Block, Deck
from abut.io.raw import RawMesh
from abut.mesh.check import check_mesh
from abut.mesh.mesh import Mesh
from abut.mesh.read import build, read_raw
from abut.thin.as_deck import PLACE, Value, as_deck, prescribed
from abut.thin.quadratic import Sorted, sort
from abut.thin.records import MOTIONS, Beam, MidForce, MidSupport, Shell, Thick, Thin, bodies_of
from abut.thin.sides import sides

Numbers = NDArray[np.int64]


def thicken(
    path: str | Path,
    sections: Mapping[str, Thin],
    supports: Sequence[MidSupport] = (),
    loads: Sequence[MidForce] = (),
    finite: bool = False,
) -> Thick:
    """Read a mesh file and make surfaces and lines in it solid.

    Parameters
    ----------
    path : str or Path
        Mesh file, as for ``Mesh.read``; solids may stand beside.
    sections : mapping of str to Shell or Beam
        Of groups of surface cells and of lines.
    supports, loads : sequences of MidSupport and of MidForce
        What is prescribed at nodes of these.
    finite : bool
        Whether displacements may be large.

    Returns
    -------
    Thick
        Mesh and conditions, for ``Model``; give the bodies ``integration="reduced"``.

    Raises
    ------
    InputError
        With place and remedy, for whatever does not fit together.

    Examples
    --------
    >>> import abut
    >>> thick = abut.thicken(
    ...     "bracket.msh", {"sheet": abut.Shell(2.0)}, [abut.MidSupport("wall", x=0, y=0, z=0, rx=0, ry=0, rz=0)]
    ... )  # doctest: +SKIP
    >>> steel = abut.LinearElastic(210e3, 0.3)
    >>> model = abut.Model(
    ...     thick.mesh, [abut.Solid("sheet", steel, integration="reduced")], supports=thick.supports,
    ...     equations=thick.equations, loads=thick.loads, couplings=thick.couplings,
    ... )  # doctest: +SKIP
    """
    made = checks.mapping(sections, "sections", "sections")
    checks.records(made.values(), "sections", (Shell, Beam))
    held, pushed = checks.records(supports, "supports", (MidSupport,)), checks.records(loads, "loads", (MidForce,))
    return made_solid(read_raw(checks.path(path, "thicken: path")), str(path), made, held, pushed, finite)


def made_solid(
    raw: RawMesh, where: str, sections: Mapping[str, Thin], held: Sequence[MidSupport] = (), pushed: Sequence[MidForce] = (),
    finite: bool = False, numbers: tuple[Sequence[int], Sequence[int]] | None = None,
) -> Thick:  # fmt: skip
    """The same of a mesh that is read. where: what messages call it; numbers: of the supports and loads there."""
    parts = sort(raw, sections, where)
    at, to = numbers or (range(len(held)), range(len(pushed)))
    supporting = [(f"supports[{i}]", entry) for i, entry in zip(at, held)]
    loading = [(f"loads[{i}]", entry) for i, entry in zip(to, pushed)]
    if finite:
        _check_finite(supporting, loading, parts)
    deck = as_deck(parts, sections, where)
    values = [
        *(value for place, entry in supporting for value in _supported(parts, entry, place)),
        *(value for place, entry in loading for value in _loaded(parts, entry, place)),
    ]
    try:
        middles = np.arange(len(deck.nodes) - len(parts.ends), len(deck.nodes)) + 1
        deck = thickened(prescribed(deck, values), middles, parts.ends + 1, finite, rigid=False)
        groups = _groups(deck, parts, sections)
        bound = bonds(deck, groups, None)
        joined = couplings(deck, groups, None)
        names = dict(zip([coupling.name for coupling in joined], reference_nodes(deck)))
        given = (*forces(bound, groups, None, 1.0), *reference_loads(deck, names, None, 1.0))
        told = _names(groups, bound, parts, held)
        joined = held_by(deck, joined, told)
        holding, bonded = tuple(supports_of(bound, groups)), tuple(equations(bound, groups, told))
    except DeckError as error:
        raise InputError(f"{where}: {error.text}" if error.place == PLACE else f"{error}") from None
    solid = groups.raw()
    mesh = build(Mesh, RawMesh(solid.points, {**parts.others, **solid.groups}, raw.notes), where)
    check_mesh(mesh)
    shells = tuple(n for name, part in sections.items() if isinstance(part, Shell) for n in bodies_of(name, part))
    beams = tuple(name for name, section in sections.items() if isinstance(section, Beam))
    return Thick(replace(mesh, shells=shells, beams=beams), holding, bonded, given, tuple(joined))


def _groups(deck: Deck, parts: Sorted, sections: Mapping[str, Thin]) -> Groups:
    """Bodies, faces and node sets by name."""
    groups = Groups(deck)
    for name in parts.others:
        groups.free_name(name)
    blocks: dict[str, Block] = {}
    upper = [number for stack in deck.layers.values() for number in stack[1:]]
    for block in (block for block in deck.blocks if not np.isin(block.ids, upper).any()):
        first = blocks.get(block.code)
        blocks[block.code] = replace(first, ids=np.concatenate([first.ids, block.ids])) if first else block
    ids = {s.name: s.elements for s in deck.sections}
    for name, section in sections.items():
        for body in bodies_of(name, section):
            groups.body(body, ids[body])
    whole = {name: ids[bodies_of(name, section)[0]] for name, section in sections.items()}
    for name, rows in sides(parts, sections, blocks, whole, deck.layers).items():
        groups.new_surface(rows, name)
    for name in parts.on:
        nodes = np.intersect1d(deck.node_sets[name], groups.used)
        if len(nodes):
            groups.new_node_set(nodes, name)
    return groups


def _names(groups: Groups, bound: Bonds, parts: Sorted, held: Sequence[MidSupport]) -> dict[int, tuple[str, ...]]:
    """Of each node that is held the groups that supports are on; that of a shell of layers as a set of nodes."""
    result: dict[int, tuple[str, ...]] = {}
    for on in dict.fromkeys(entry.on for entry in held):
        nodes = [n for n in _nodes(parts, on, "supports").tolist() if n in bound.held]
        if nodes and on not in groups:
            groups.new_node_set(np.unique([n for node in nodes for n in bound.held[node].nodes]), on)
        result |= {node: (*result.get(node, ()), on) for node in nodes}
    return result


def _nodes(parts: Sorted, on: str, where: str) -> Numbers:
    """Node numbers of a group. Raises InputError for an unknown one."""
    known = {**parts.bodies, **parts.on}
    if on not in known:
        raise InputError(f"{where}.on: no group of nodes of shells and beams named {on!r}{nearest(on, known)}")
    return np.unique(np.concatenate([cells.ravel() for cells in known[on].values()])) + 1


def _supported(parts: Sorted, entry: MidSupport, where: str) -> list[Value]:
    """Kind, nodes, directions, value and history of what is prescribed."""
    nodes, result = _nodes(parts, entry.on, where), list[Value]()
    for name, value in entry.given.items():
        direction = (MOTIONS.index(name) + 1,)
        if not callable(value):
            result.append(("boundary", nodes, direction, float(value), entry.amplitude))
            continue
        each = evaluate(value, parts.points[nodes - 1], f"{where}.{name}")
        result += [
            ("boundary", np.array([n]), direction, float(v), entry.amplitude) for n, v in zip(nodes.tolist(), each)
        ]
    return result


def _loaded(parts: Sorted, entry: MidForce, where: str) -> list[Value]:
    nodes = _nodes(parts, entry.on, where)
    return [
        ("force", nodes, (k,), float(value), entry.amplitude)
        for k, value in enumerate((*entry.value, *entry.moment), start=1)
        if value
    ]


def _check_finite(
    supporting: Sequence[tuple[str, MidSupport]], loading: Sequence[tuple[str, MidForce]], parts: Sorted
) -> None:
    """Raise InputError for moments, and turns other than zero, where large turns would bend the normals of shells."""
    if all(CELLS[kind].dim == 1 for cells in parts.bodies.values() for kind in cells):
        return
    turned = [
        f"{where}.{name}" for where, entry in supporting for name in MOTIONS[3:] if entry.given.get(name, 0.0) != 0.0
    ]
    turned += [f"{where}.moment" for where, load in loading if any(load.moment)]
    if turned:
        raise InputError(
            f'{turned[0]}: turns other than zero, and moments, at nodes of shells need kinematics = "small"; else couple '
            "the nodes of the edge ([[couplings]]) and move or load that"
        )
