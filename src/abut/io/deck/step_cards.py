"""Steps, supports, loads, temperatures and amplitudes of a deck."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from abut.errors import nearest
from abut.io.deck.cards import Card, Line, as_float, as_integer, key
from abut.io.deck.mesh_cards import MeshCards, face_number
from abut.io.deck.reasons import Reasons
from abut.io.deck.record import Amplitude, Increments, Prescribed, Step
from abut.io.deck.supported import STEP_PROCEDURES

NAMED_SUPPORTS = {
    "ENCASTRE": (1, 2, 3, 4, 5, 6),
    "PINNED": (1, 2, 3),
    "XSYMM": (1, 5, 6),
    "YSYMM": (2, 4, 6),
    "ZSYMM": (3, 4, 5),
    "XASYMM": (2, 3, 4),
    "YASYMM": (1, 3, 5),
    "ZASYMM": (1, 2, 6),
}
KIND = {
    "BOUNDARY": "boundary",
    "CLOAD": "force",
    "DLOAD": "pressure",
    "DSLOAD": "pressure",
    "TEMPERATURE": "temperature",
}


def split_steps(cards: Sequence[Card], reasons: Reasons) -> tuple[list[Card], list[list[Card]]]:
    """Cards outside the steps, and those of each step; ``reasons`` gets where *STEP and *END STEP do not match."""
    outside: list[Card] = []
    steps: list[list[Card]] = []
    opened: Card | None = None
    for card in cards:
        if card.key == "STEP":
            if opened is not None:
                reasons.add(card.error(f"the step begun at {opened.place} has no *END STEP; add it"))
            opened = card
            steps.append([card])
        elif card.key == "ENDSTEP":
            if opened is None:
                reasons.add(card.error("no *STEP before it; add one"))
            opened = None
        elif opened is None:
            outside.append(card)
        else:
            steps[-1].append(card)
    if opened is not None:
        reasons.add(opened.error("the step has no *END STEP; add it"))
    return outside, steps


def amplitudes(cards: Sequence[Card], reasons: Reasons) -> dict[str, Amplitude]:
    """Amplitudes by name in capitals."""
    result = {}
    for card in cards:
        if card.key == "AMPLITUDE":
            with reasons.gathered(defines=True):
                result[card.need("NAME").upper()] = _amplitude(card)
    for card in cards:
        if card.has("TIME DELAY") and (known := result.get((card.get("AMPLITUDE") or "").upper())) is not None:
            with reasons.gathered():
                result[later(card)] = _delayed(known, card)
    return result


def later(card: Card) -> str:
    """The name of the amplitude that a card goes by, one with the TIME DELAY of the card where it has one."""
    name = (card.get("AMPLITUDE") or "").upper()
    return f" {name} later by {card.get('TIME DELAY')}" if card.has("TIME DELAY") else name  # blank: no name of a deck


def _delayed(amplitude: Amplitude, card: Card) -> Amplitude:
    delay = as_float(card.get("TIME DELAY") or "")
    if delay is None:
        raise card.error(f"TIMEDELAY: expected a time, got {card.get('TIME DELAY')!r}")
    return replace(amplitude, points=tuple((time + delay, factor) for time, factor in amplitude.points))


def _amplitude(card: Card) -> Amplitude:
    for parameter, wanted in (("DEFINITION", "TABULAR"), ("VALUE", "RELATIVE")):
        if key(card.get(parameter, wanted) or "") != wanted:
            raise card.error(f"{parameter}={card.get(parameter)} is not supported; give a table of times and factors")
    numbers = [
        line.number(i, "time" if i % 2 == 0 else "factor")
        for line in card.lines
        for i in range(len(line.fields) - (line.fields[-1] == ""))
    ]
    if not numbers or len(numbers) % 2:
        raise card.error("expected pairs of time and factor")
    points = tuple(zip(numbers[::2], numbers[1::2]))
    if any(b[0] <= a[0] for a, b in pairwise(points)):
        raise card.error("times must increase from pair to pair")
    return Amplitude(points, key(card.get("TIME", "") or "") == "TOTALTIME")


def steps(
    groups: Sequence[Sequence[Card]], mesh: MeshCards, known: Mapping[str, Amplitude], reasons: Reasons
) -> tuple[Step, ...]:
    """The steps; ``reasons`` gets those without procedure."""
    result = []
    total, finite = 0.0, False
    for number, group in enumerate(groups, start=1):
        period, increments, begin = 1.0, Increments(1.0, math.inf, False), total
        with reasons.gathered():
            period, increments = _times(group)
            begin = _total(group, total, period)
        values: list[Prescribed] = []
        new = set()
        for card in group:
            if card.key in KIND:
                with reasons.gathered():
                    values += prescribed(card, mesh, known)
                    operation = key(card.get("OP", "MOD") or "")
                    if operation not in ("NEW", "MOD"):
                        raise card.error(f"OP={operation}: expected NEW or MOD")
                    if operation == "NEW":
                        new.add(KIND[card.key])
        first = group[0]
        if first.has("NLGEOM"):  # holds until it is NO
            finite = key(first.get("NLGEOM") or "") != "NO"
        result.append(Step(number, period, tuple(values), frozenset(new), first.place, increments, finite, begin))
        total = begin + period
    return tuple(result)


def _total(group: Sequence[Card], before: float, period: float) -> float:
    """The total time at the beginning of a step, ``before`` at the end of the one before. TIME RESET has the step end at
    that time, as in CalculiX."""
    procedure = next(card for card in group if card.key in STEP_PROCEDURES)
    if procedure.has("TOTAL TIME AT START"):
        given = as_float(procedure.need("TOTAL TIME AT START"))
        if given is None:
            raise procedure.error(f"TOTALTIMEATSTART: expected a time, got {procedure.get('TOTAL TIME AT START')!r}")
        return given
    return before - period if procedure.has("TIME RESET") else before


def _times(group: Sequence[Card]) -> tuple[float, Increments]:
    """Period and increments of a step; 0 stands for what is left out."""
    procedure = next((card for card in group if card.key in STEP_PROCEDURES), None)
    if procedure is None:
        raise group[0].error("the step has no procedure; abut solves *STATIC steps")
    fixed, stabilized = procedure.has("DIRECT"), procedure.has("STABILIZE")
    if not procedure.lines:
        return 1.0, Increments(1.0, math.inf, fixed, stabilized)
    line, values = procedure.lines[0], []
    for i, what in enumerate(("first increment", "period", "smallest increment", "largest increment")):
        value = line.number(i, what, 0.0)
        if value < 0.0:
            raise line.error(f"{what}: expected a number > 0, got {value:g}")
        values.append(value)
    first, period, _, longest = values
    period = period or 1.0
    return period, Increments(min(first or period, period), longest or math.inf, fixed, stabilized)


def prescribed(card: Card, mesh: MeshCards, known: Mapping[str, Amplitude]) -> list[Prescribed]:
    """The values of one *BOUNDARY, *CLOAD, *DLOAD, *DSLOAD or *TEMPERATURE."""
    amplitude = (card.get("AMPLITUDE") or "").upper()
    if amplitude and amplitude not in known:
        raise card.unknown(f"no *AMPLITUDE named {card.get('AMPLITUDE')!r}{nearest(amplitude, known)}")
    if card.has("TIME DELAY") and not amplitude:
        raise card.error("TIMEDELAY goes with AMPLITUDE; give one, or take TIME DELAY out")
    case = card.get("LOAD CASE", "1")
    if case not in ("1", "2"):
        raise card.error(f"LOADCASE={case}: expected 1 (real part) or 2 (imaginary part)")
    if key(card.get("TYPE", "DISPLACEMENT") or "") != "DISPLACEMENT":
        raise card.error(f"TYPE={card.get('TYPE')}: only displacements can be prescribed in statics")
    amplitude = later(card)
    read = _between_planes if card.has("LINTEMP") else _LINES[card.key]
    found = [value for line in card.lines for value in read(line, amplitude, mesh)]
    found = [replace(value, imaginary=True) for value in found] if case == "2" else found
    if card.has("SUBMODEL") or card.has("STEP"):
        return _of_global(card, found)
    if not card.has("FIXED"):
        return found
    if amplitude or any(value.value for value in found):
        raise card.error("FIXED: nodes that are held where they are have neither a displacement nor an amplitude")
    return [replace(value, frozen=True) for value in found]


def _of_global(card: Card, values: Sequence[Prescribed]) -> list[Prescribed]:
    """Supports that take their displacements from a step of the global model."""
    if not (card.has("SUBMODEL") and card.has("STEP")) or card.has("AMPLITUDE") or card.has("FIXED"):
        raise card.error("SUBMODEL and STEP go together, and with neither AMPLITUDE nor FIXED; write them so")
    step = as_integer(card.need("STEP"))
    if step is None or step < 1:
        raise card.error(f"STEP={card.get('STEP')}: expected the number of a step, from 1")
    if any(line.text(3) for line in card.lines):
        raise card.error("SUBMODEL: displacements come from the result file; take their values out")
    return [replace(value, step=step) for value in values]


def _boundary(line: Line, amplitude: str, mesh: MeshCards) -> list[Prescribed]:
    nodes = mesh.node_sets.resolve(line, 0, "node")
    if not len(nodes):
        raise line.unknown(f"node set '{line.text(0)}' is empty")
    name = line.text(1).upper()
    if name in NAMED_SUPPORTS:
        return [Prescribed("boundary", nodes, NAMED_SUPPORTS[name], 0.0, amplitude, line.place)]
    thermal = {line.text(1), line.text(2)} & {"0", "11"}
    if thermal:
        raise line.error(
            f"direction {min(thermal)} (temperature) belongs to heat transfer, which abut does not solve; give "
            "temperatures by *TEMPERATURE"
        )
    first = line.integer(1, "first direction")
    last = line.integer(2, "last direction", first)
    if not first <= last <= 6:
        raise line.error(f"directions {first} to {last}: expected numbers from 1 to 6, in order")
    value = line.number(3, "displacement", 0.0)
    return [Prescribed("boundary", nodes, tuple(range(first, last + 1)), value, amplitude, line.place)]


def _force(line: Line, amplitude: str, mesh: MeshCards) -> list[Prescribed]:
    direction = line.integer(1, "direction")
    if direction > 6:
        raise line.error(f"direction {direction}: expected 1 to 3 (forces) or 4 to 6 (moments)")
    nodes = mesh.existing(line, 0)
    return [Prescribed("force", nodes, (direction,), line.number(2, "force"), amplitude, line.place)]


def _distributed(line: Line, amplitude: str, mesh: MeshCards) -> list[Prescribed]:
    label, value = line.text(1).upper(), line.number(2, "magnitude")
    elements = mesh.element_sets.resolve(line, 0, "element") if line.text(0) else np.array(sorted(mesh.kinds), np.int64)
    for number in elements.tolist():
        if number not in mesh.kinds:
            raise line.unknown(f"element {number} does not exist")
    if label.endswith("NP"):
        raise line.error(
            f"{label} takes the pressure from a node of a network, which abut does not solve; give it as a number, with "
            f"{label[:-2]}"
        )
    if label == "GRAV":
        x, y, z = (line.number(i, "direction", 0.0) for i in (3, 4, 5))
        size = float(np.sqrt(x * x + y * y + z * z))
        if size == 0.0:
            raise line.error("the direction of gravity is missing; write set, GRAV, value, x, y, z")
        vector = (x / size, y / size, z / size)
        return [Prescribed("gravity", elements, (0,), value, amplitude, line.place, vector)]
    if label == "CENTRIF":
        if value < 0.0:
            raise line.error(f"the square of the angular speed: expected a number >= 0, got {value:g}")
        at = tuple(line.number(i, "point of the axis", 0.0) for i in (3, 4, 5))
        axis = tuple(line.number(i, "direction of the axis", 0.0) for i in (6, 7, 8))
        if not any(axis):
            raise line.error(
                "the direction of the axis is missing; write set, CENTRIF, square of the speed, point, direction"
            )
        return [Prescribed("centrifugal", elements, (0,), value, amplitude, line.place, (*at, *axis))]
    if label == "P" and all(number in mesh.shells for number in elements.tolist()):
        label = "P1"  # on the negative side, so that it pushes along the normal
    if not label.startswith("P") or label == "P":
        raise line.error(f"load {label!r} is not supported; P1, P2, ... (pressure on a face), GRAV and CENTRIF are")
    kinds = {mesh.kinds[number] for number in elements.tolist()}
    face = face_number(line, label, "P", kinds)
    return [Prescribed("pressure", elements, (face,), value, amplitude, line.place)]


def _on_surface(line: Line, amplitude: str, mesh: MeshCards) -> list[Prescribed]:
    name, label = line.text(0), line.text(1).upper()
    if name.upper() not in mesh.surfaces:
        raise line.unknown(f"no surface named {name!r}{nearest(name, [s.name for s in mesh.surfaces.values()])}")
    if label != "P":
        raise line.error(f"load {label!r} is not supported; P (pressure) is")
    surface = mesh.surfaces[name.upper()]
    if surface.nodes is not None or any(face == 0 for _, face in surface.faces):
        raise line.error(f"surface '{name}' must list faces of elements (S1, S2, ...) to carry a pressure")
    if surface.empty:
        raise line.unknown(f"surface '{name}' is empty")
    value = line.number(2, "pressure")
    return [Prescribed("pressure", ids, (face,), value, amplitude, line.place) for ids, face in surface.faces]


def _temperature(line: Line, amplitude: str, mesh: MeshCards) -> list[Prescribed]:
    nodes = mesh.existing(line, 0)
    slope = (line.number(2, "gradient through the thickness", 0.0), 0.0, 0.0)
    return [Prescribed("temperature", nodes, (0,), line.number(1, "temperature"), amplitude, line.place, slope)]


def _between_planes(line: Line, amplitude: str, mesh: MeshCards) -> list[Prescribed]:
    """Temperatures that change evenly from one plane to another: their normal, and of each its distance from the origin and
    its temperature. Nodes that are not between them keep theirs."""
    normal = np.array([line.number(i, "normal of the planes") for i in range(3)])
    one, other = ((line.number(i, "distance of a plane"), line.number(i + 1, "temperature of a plane")) for i in (3, 5))
    if not normal.any() or one[0] == other[0]:
        raise line.error(
            "expected a normal and two planes that lie apart: x, y, z, distance, temperature, distance, temperature"
        )
    at = mesh.points @ (normal / np.linalg.norm(normal))
    inside = (at >= min(one[0], other[0])) & (at <= max(one[0], other[0]))
    warm = one[1] + (at - one[0]) * (other[1] - one[1]) / (other[0] - one[0])
    return [
        Prescribed("temperature", mesh.nodes[inside & (warm == degrees)], (0,), float(degrees), amplitude, line.place)
        for degrees in np.unique(warm[inside])
    ]


_LINES: Mapping[str, Callable[[Line, str, MeshCards], list[Prescribed]]] = {
    "BOUNDARY": _boundary,
    "CLOAD": _force,
    "DLOAD": _distributed,
    "DSLOAD": _on_surface,
    "TEMPERATURE": _temperature,
}
