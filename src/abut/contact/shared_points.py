"""Points of a contactor where several contacts meet, or several targets of one: only one pressure has a function of its own
there.

A point has one displacement along its normal. Two functions at it, each over a part of its facets, constrain it twice, and
if the targets are rigid, or much stiffer, the pressures are not unique."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations, combinations_with_replacement

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.cells import MAX_FACET_NODES
from abut.contact.coupling import Coupling
from abut.contact.geometry import CREASE, full_moments, side_normals
from abut.contact.pressure_space import PressureSpace
from abut.mesh.surface import Surface
from abut.types import Sparse

EVEN = 1e-3  # weights that differ by less are equal: those of curved facets of one size
TWICE = 1e-3  # covered share over 1 from which on two targets lie over each other, not beside each other


@dataclass(frozen=True)
class Functions:
    """The functions of a pressure, all at points. node, part, weight: (n,); normal: (n, dim); neighbours: (n, n) sparse,
    those with a facet in common; facet: (m,) numbers of the contactor's facets in the mesh, nodes: (m, 9) theirs,
    covered: (m,) share."""

    node: NDArray[np.int64]
    part: NDArray[np.int64]
    weight: NDArray[np.float64]
    normal: NDArray[np.float64]
    neighbours: Sparse
    facet: NDArray[np.int64]
    nodes: NDArray[np.int32]
    covered: NDArray[np.float64]


def functions(space: PressureSpace, contactor: Surface, coupling: Coupling) -> Functions:
    """Of a space all of whose functions sit at points."""
    _, normals = side_normals(contactor)
    uses = abs(space.plain).tocoo()
    facet = uses.row // MAX_FACET_NODES
    by_facet = sp.csr_matrix((np.ones(uses.nnz), (facet, uses.col)), shape=(len(contactor), len(space)))
    number = 8 * contactor.cells + contactor.local  # no cell has more than 8 facets
    share = coupling.covered / np.maximum(full_moments(contactor, 0)[:, 0], 1e-300)
    part = np.zeros(len(space), dtype=np.int64)
    if contactor.parts is not None:
        part[uses.col] = contactor.parts[facet]
    return Functions(
        space.node,
        part,
        space.weight,
        normals[space.side],
        (by_facet.T @ by_facet).tocsr(),
        number,
        contactor.nodes,
        share,
    )


def one_each(
    contacts: Sequence[Functions | None], at_once: Callable[[int, int], bool] = lambda i, j: True
) -> list[NDArray[np.bool_] | None]:
    """Which functions of each contact stay, (n,) bool, None for all; theory (P16). Those that go follow a neighbour.

    Of two at one point with one normal, whose targets lie side by side, the one of more weight stays, of equals the first.
    Where targets lie one behind the other both stay: at most one of them closes. So they do of two contacts of which never
    both act: at_once says of two, by number, whether they do."""
    lost = [np.zeros(0 if functions is None else len(functions.node), dtype=bool) for functions in contacts]
    rivals: list[tuple[int, int, int, int]] = []
    given = [(i, functions) for i, functions in enumerate(contacts) if functions is not None]
    for (i, a), (j, b) in combinations_with_replacement(given, 2):
        if i != j and not at_once(i, j):
            continue
        for k, m in _side_by_side(a, b) if i != j else _twice(a):
            first = a.weight[k] >= b.weight[m] * (1.0 - EVEN)
            lost[j if first else i][m if first else k] = True
            rivals.append((i, k, j, m))
    for i, functions in enumerate(contacts):
        for k in _alone(functions, lost[i]) if functions is not None else ():
            lost[i][k] = False
            for j, m in _rivals_of(rivals, i, k):
                other = contacts[j]
                lost[j][m] = other is not None and bool((~lost[j][_beside(other, m)]).any())
    return [~functions if functions.any() else None for functions in lost]


def _side_by_side(a: Functions, b: Functions) -> list[tuple[int, int]]:
    """Functions of two contacts at the same points, with one normal, whose targets do not lie over each other."""
    common = np.intersect1d(a.node, b.node)
    if not len(common):
        return []
    facets, of_a, of_b = np.intersect1d(a.facet, b.facet, return_indices=True)
    layered = of_a[a.covered[of_a] + b.covered[of_b] > 1.0 + TWICE] if len(facets) else of_a
    common = np.setdiff1d(common, a.nodes[layered])
    result = []
    mine, theirs = (np.flatnonzero(np.isin(functions.node, common)) for functions in (a, b))
    by_node: dict[int, list[int]] = {}
    for m in theirs.tolist():
        by_node.setdefault(int(b.node[m]), []).append(m)
    for k in mine.tolist():
        result += [(k, m) for m in by_node[int(a.node[k])] if a.normal[k] @ b.normal[m] > CREASE]
    return result


def _twice(functions: Functions) -> list[tuple[int, int]]:
    """Functions of one contact at the same points with one normal, towards different parts of the target."""
    order = np.lexsort((functions.part, functions.node))
    groups = np.split(order, np.flatnonzero(np.diff(functions.node[order])) + 1) if len(order) else []
    return [
        (k, m)
        for group in groups
        for k, m in combinations(group.tolist(), 2)
        if functions.normal[k] @ functions.normal[m] > CREASE
    ]


def _beside(functions: Functions, k: int) -> NDArray[np.int64]:
    near = functions.neighbours.indices[functions.neighbours.indptr[k] : functions.neighbours.indptr[k + 1]]
    return np.asarray(near[near != k])


def _alone(functions: Functions, lost: NDArray[np.bool_]) -> list[int]:
    """Functions that would go without one to follow, the heaviest of each neighbourhood."""
    kept, result = ~lost, []
    for k in np.flatnonzero(lost)[np.argsort(-functions.weight[lost], kind="stable")].tolist():
        if not kept[_beside(functions, k)].any():
            kept[k] = True
            result.append(k)
    return result


def _rivals_of(rivals: Sequence[tuple[int, int, int, int]], contact: int, function: int) -> list[tuple[int, int]]:
    """The functions (contact, number) at the place of another one."""
    key = (contact, function)
    return [(j, m) for i, k, j, m in rivals if (i, k) == key] + [(i, k) for i, k, j, m in rivals if (j, m) == key]
