"""*MPC of a deck: equal displacements as equations; nodes that stay on a line or in a plane and the mean rotation of nodes
as equations where displacements are small, else as what is gathered; two nodes at a distance as that."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from abut.io.deck.cards import Card, Line, key
from abut.io.deck.gathered import Gathered
from abut.io.deck.mesh_cards import MeshCards
from abut.io.deck.record import Equation

Vector = NDArray[np.float64]
Terms = dict[tuple[int, int], float]  # coefficient by node and direction 1..3
APART = 1e-6  # of the extent of its nodes: how far one may lie off the line or plane that it is to stay on
TINY = 1e-12  # a coefficient that is none
EQUAL = ("TIE", "PIN")
BEAM, DIST = "BEAM", "DIST"
BETWEEN_TWO = (BEAM, DIST)


def multipoint(card: Card, mesh: MeshCards, finite: bool) -> list[Equation]:
    """The equations of one *MPC. finite: NLGEOM, with which only equal displacements are any. Raises InputError for kinds
    that abut does not have."""
    result: list[Equation] = []
    for kind, lines in _groups(card):
        head = lines[0]
        if kind in EQUAL:
            result += _equal(head, mesh)
            continue
        if kind not in BETWEEN_TWO and kind not in _KINDS:
            raise head.error(
                f"type {kind or '(none)'} is not supported; TIE, PIN, BEAM, DIST, STRAIGHT, PLANE and MEANROT are; or "
                "write *EQUATION"
            )
        if finite or kind in BETWEEN_TWO:
            continue
        nodes, points = _members(lines, mesh)
        for terms in _KINDS[kind](head, nodes, points):
            kept = tuple((n, d, c) for (n, d), c in terms.items() if abs(c) > TINY)
            result.append(Equation(kept, head.place))
    return result


def gathered(card: Card, mesh: MeshCards, finite: bool) -> list[Gathered]:
    """What one *MPC binds by products of displacements. finite: NLGEOM, without which only BEAM and DIST are read so. Raises
    InputError for nodes that are not as the kind asks."""
    result: list[Gathered] = []
    for kind, lines in _groups(card):
        if kind not in BETWEEN_TWO and not (finite and kind in _KINDS):
            continue
        nodes, points = _members(lines, mesh)
        if kind == DIST:
            result.append(_at_most(lines[0], nodes, points))
            continue
        if kind == BEAM:
            if len(set(nodes)) != 2:
                raise lines[0].error(f"BEAM: expected two nodes, got {len(nodes)}")
            result.append(Gathered(kind, tuple(nodes), lines[0].place))
            continue
        tuple(_KINDS[kind](lines[0], nodes, points))  # which checks them
        if kind == "MEANROT":
            axis = tuple(float(x) for x in points[-1])
            result.append(Gathered(kind, tuple(nodes[:-1:3]), lines[0].place, axis, nodes[-1]))
        else:
            result.append(Gathered(kind, tuple(dict.fromkeys(nodes)), lines[0].place))
    return result


def _at_most(line: Line, nodes: list[int], x: Vector) -> Gathered:
    """Two nodes, each three times, that get no farther apart than the first coordinate of a last one."""
    if len(nodes) != 7 or len(set(nodes[:3])) > 1 or len(set(nodes[3:6])) > 1 or nodes[0] == nodes[3]:
        raise line.error("DIST: expected two nodes, each three times, and one whose first coordinate is the distance")
    most, apart = float(x[6, 0]), float(np.linalg.norm(x[3] - x[0]))
    if most < apart * (1.0 - APART):
        raise line.error(f"DIST: the nodes are {apart:.6g} apart already, and may not be more than {most:.6g}")
    return Gathered(DIST, (nodes[0], nodes[3]), line.place, pilot=nodes[6], limit=max(most - apart, 0.0))


def _members(lines: Sequence[Line], mesh: MeshCards) -> tuple[list[int], Vector]:
    """Nodes of a group of lines, and where they are."""
    nodes = [int(n) for k, line in enumerate(lines) for i in range(k == 0, len(line.fields)) if line.text(i)
             for n in mesh.existing(line, i, ordered=True)]  # fmt: skip
    return nodes, mesh.points[np.searchsorted(mesh.nodes, nodes)]


def _groups(card: Card) -> Iterator[tuple[str, list[Line]]]:
    """Kinds with their lines: a line that begins with a number or 0 goes on with the one before."""
    lines: list[Line] = []
    kind = ""
    for line in card.lines:
        if line.text(0).isdigit() and lines:
            lines.append(line)
            continue
        if lines:
            yield kind, lines
        kind, lines = key(line.text(0)), [line]
    if lines:
        yield kind, lines


def _equal(line: Line, mesh: MeshCards) -> list[Equation]:
    a, b = (mesh.existing(line, i, ordered=True) for i in (1, 2))
    if len(b) == 1:
        b = np.repeat(b, len(a))
    if len(a) != len(b):
        raise line.error(f"the two node sets have {len(a)} and {len(b)} nodes; they must have the same number")
    return [Equation(((int(n), d, 1.0), (int(m), d, -1.0)), line.place) for n, m in zip(a, b) for d in (1, 2, 3)]


def _straight(line: Line, nodes: list[int], x: Vector) -> Iterator[Terms]:
    """Every node after the first two stays on the line through these."""
    if len(nodes) < 3:
        raise line.error(f"STRAIGHT: expected three nodes or more, got {len(nodes)}")
    along = x[1] - x[0]
    share = (x - x[0]) @ along / (along @ along)
    _check(line, "line", x[0] + np.outer(share, along), x)
    for across in np.linalg.svd(along[None, :])[2][1:]:
        for node, s in zip(nodes[2:], share[2:]):
            yield _along(across, {node: 1.0, nodes[0]: s - 1.0, nodes[1]: -s})


def _plane(line: Line, nodes: list[int], x: Vector) -> Iterator[Terms]:
    """Every node stays in the plane through three of them, the first and two that span it well."""
    if len(nodes) < 4:
        raise line.error(f"PLANE: expected four nodes or more, got {len(nodes)}")
    order = list(range(len(nodes)))
    for k in (1, 2):
        from_first = x - x[order[0]]
        if k == 2:
            along = from_first[order[1]] / np.linalg.norm(from_first[order[1]])
            from_first = from_first - np.outer(from_first @ along, along)
        far = int(np.linalg.norm(from_first, axis=1).argmax())
        order.remove(far)
        order.insert(k, far)
    nodes, x = [nodes[i] for i in order], x[order]
    sides = np.stack([x[1] - x[0], x[2] - x[0]])
    normal = np.cross(*sides)
    if np.linalg.norm(normal) <= APART * np.ptp(x, axis=0).max() ** 2:
        raise line.error("PLANE: the nodes lie on one line; use STRAIGHT")
    shares = np.linalg.lstsq(sides.T, (x - x[0]).T, rcond=None)[0].T
    _check(line, "plane", x[0] + shares @ sides, x)
    normal /= np.linalg.norm(normal)
    for node, (s, t) in zip(nodes[3:], shares[3:]):
        yield _along(normal, {node: 1.0, nodes[0]: s + t - 1.0, nodes[1]: -s, nodes[2]: -t})


def _mean_rotation(line: Line, nodes: list[int], x: Vector) -> Iterator[Terms]:
    """The mean of the nodes' turns about an axis through their middle is direction 1 of the last node, whose coordinates are
    the direction of the axis. Nodes stand three times each."""
    if (
        len(nodes) < 7
        or any(len(set(nodes[i : i + 3])) > 1 for i in range(0, len(nodes) - 1, 3))
        or len(nodes) % 3 != 1
    ):
        raise line.error(
            "MEANROT: expected two nodes or more, each three times, and one whose coordinates are the axis"
        )
    turning, pilot, axis = nodes[:-1:3], nodes[-1], x[-1] / max(float(np.linalg.norm(x[-1])), 1e-300)
    arms = x[:-1:3] - x[:-1:3].mean(axis=0)
    arms -= np.outer(arms @ axis, axis)
    squares = (arms**2).sum(axis=1)
    if not np.linalg.norm(axis) or squares.min() <= APART**2 * squares.max():
        raise line.error("MEANROT: a node lies on the axis, or the axis has no direction; leave the node out")
    turns = np.cross(axis, arms) / squares[:, None] / len(turning)
    turns -= turns.mean(axis=0)  # of the displacements beyond their mean
    terms: Terms = {(pilot, 1): -1.0}
    for node, vector in zip(turning, turns):
        for k in range(3):
            terms[node, k + 1] = terms.get((node, k + 1), 0.0) + float(vector[k])
    yield dict(sorted(terms.items(), key=lambda term: term[0][0] == pilot))


def _check(line: Line, what: str, wanted: Vector, x: Vector) -> None:
    off = float(np.linalg.norm(wanted - x, axis=1).max())
    if off > APART * float(np.ptp(x, axis=0).max()):
        raise line.error(
            f"a node lies {off:.3g} off the {what} that it is to stay on; choose nodes that lie on one {what}"
        )


def _along(direction: Vector, shares: dict[int, float]) -> Terms:
    """Shares of the displacements of nodes along a direction."""
    return {(node, k + 1): share * float(direction[k]) for node, share in shares.items() for k in range(3)}


_KINDS: dict[str, Callable[[Line, list[int], Vector], Iterator[Terms]]] = {
    "STRAIGHT": _straight,
    "PLANE": _plane,
    "MEANROT": _mean_rotation,
}


def multipoint_notes(cards: Sequence[Card], finite: bool) -> list[str]:
    """Of equations that are not linear in other programs."""
    if finite:
        return []
    return [
        f"{line.place}: *MPC {key(line.text(0))}: linear in the displacements, however large; CalculiX iterates it"
        for card in cards
        if card.key == "MPC"
        for line in card.lines
        if key(line.text(0)) in (*_KINDS, *BETWEEN_TWO)
    ]
