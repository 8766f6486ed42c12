"""Which side of which contact a probe lies on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.model import Model
from abut.model.probe import ON_CONTACTS, Probe
from abut.probing.closest_points import feet

CONTACTOR, TARGET = "contactor", "target"
NOWHERE, TOUCHES, LIES = 0, 1, 2  # how much of a probe is on a surface: nothing, a point of it, or a part of it


@dataclass(frozen=True)
class Side:
    """contact: number in the model; role: "contactor" or "target"; on: NOWHERE, TOUCHES or LIES."""

    contact: int
    role: str
    on: int


def choose(model: Model, probe: Probe, points: NDArray[np.float64]) -> Side | None:
    """The side of a contact whose pressure a probe with ``points`` (n, dim) reads, None where it asks for none or, with
    nothing asked for, lies on none.

    Of several contacts that which the probe lies on, then one that it touches, then the model's only one; of both sides of
    a contact the contactor, unless the probe is on the target alone. Raises InputError where more than one is left."""
    where = f"probe '{probe.name}'"
    asked = probe.contact is not None or bool(set(probe.of or ()) & set(ON_CONTACTS))
    if not model.contacts or (probe.of is not None and not asked):
        return None
    sides = [_better(model, probe, number, points) for number in range(len(model.contacts))]
    chosen = [s for s in sides if s is not None and probe.contact in (None, model.contacts[s.contact].name)]
    if asked and not chosen:
        raise InputError(
            f"{where}: body '{probe.body}' has no surface of a contact; leave body out, or pressure and gap"
        )
    most = max((side.on for side in chosen), default=NOWHERE)
    if not asked and most < LIES:
        return None
    left = [side for side in chosen if side.on == most]
    if probe.on is not None and most == NOWHERE:
        raise InputError(f"{where}: no node of '{probe.on}' is on a surface of {_names(model, left)}; name another set")
    if len(left) > 1:
        names = _names(model, left)
        how = "lies on the surfaces" if most else "is on none of the surfaces"
        raise InputError(f'{where}: it {how} of {names}; choose with contact = "..."')
    return left[0]


def _names(model: Model, sides: list[Side]) -> str:
    names = [f"'{model.contacts[side.contact].name}'" for side in sides]
    return ("contact " if len(names) == 1 else "contacts ") + " and ".join(names)


def _better(model: Model, probe: Probe, number: int, points: NDArray[np.float64]) -> Side | None:
    """The side of a contact that more of the probe is on, of those that belong to the probe's body."""
    sides = []
    for role in (CONTACTOR, TARGET):
        surface = model.sides(model.contacts[number])[role == TARGET]
        if probe.body is None or np.isin(surface.cells, model.mesh.bodies[probe.body]).any():
            sides.append(Side(number, role, _how_much(model, probe, surface, points)))
    return max(sides, key=lambda side: side.on, default=None)


def _how_much(model: Model, probe: Probe, surface: Surface, points: NDArray[np.float64]) -> int:
    """How much of a probe is on a surface: of sets and surfaces a facet, of lines two points."""
    mesh = model.mesh
    if probe.on in mesh.surfaces:
        rows = {(int(c), int(f)) for c, f in mesh.surfaces[str(probe.on)]}
        if any((int(c), int(f)) in rows for c, f in zip(surface.cells, surface.local)):
            return LIES
    if probe.on is not None:
        nodes = mesh.nodes_of(probe.on)
        among = np.isin(surface.nodes, nodes) & (surface.nodes >= 0)
        whole = (among | (surface.nodes < 0)).all(axis=1)
        if probe.on in mesh.node_sets and (whole.any() or set(nodes.tolist()) <= set(surface.node_ids.tolist())):
            return LIES
        return TOUCHES if among.any() else NOWHERE
    count = int(feet(surface, points).touching.sum())
    return LIES if count >= min(2, len(points)) else TOUCHES if count else NOWHERE
