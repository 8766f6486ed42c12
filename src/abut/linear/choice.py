"""Which linear solver serves a system: elimination, direct solution of the saddle, or multigrid with Krylov iterations."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut.cells import CELLS
from abut.errors import InputError
from abut.linear.direct import solver_name
from abut.linear.iterative import Count, iterate
from abut.linear.multigrid import Hierarchy, hierarchy
from abut.linear.schur_preconditioner import foresight, half_spaces, interfaces
from abut.linear.static_condensation import condense
from abut.mesh.mesh import Mesh
from abut.problem.contact_pairs import Pair
from abut.problem.system import Outcome, System

LARGE = {1: 30_000, 2: 40_000}  # free displacements in 3D, by degree of the cells, from where on multigrid wins


SECONDS = {"direct": {2: 1.0, 3: 8.0}, "amg": {2: 0.7, 3: 1.0}}  # to set up 100 000 displacements on one core, by dim
GROWTH = {"direct": {2: 1.5, 3: 1.7}, "amg": {2: 1.0, 3: 1.0}}  # powers of the size that fit 10 000 to 150 000


def expected_seconds(linear: str, n_free: int, dim: int) -> float:
    """How long ``prepare`` will take, roughly: measured once on one core and scaled by theory with the size."""
    return float(SECONDS[linear][dim] * (n_free / 1e5) ** GROWTH[linear][dim])


@dataclass(frozen=True)
class Prepared:
    """system: with its linear solver; finish: what a step's outcome still needs, at its histories' weights; renew: the same
    for a system with another interface over the same stiffness; name: for the summary; note: for the log; count: linear
    iterations of an iterative solver."""

    system: System
    finish: Callable[[Outcome, NDArray[np.float64]], Outcome]
    renew: Callable[[System], Prepared]
    name: str
    note: str
    count: Count | None = None


def choose(linear: str, system: System, mesh: Mesh, coupled: bool) -> str:
    """ "direct" or "amg" for what the user asked for; "auto" goes by size, and by what multigrid can do.

    coupled: free displacements belong to several points at once. Raises InputError where "amg" cannot do that."""
    return chosen(linear, len(system.load), system.pairs, mesh, coupled)


def chosen(
    linear: str, n_free: int, pairs: Sequence[Pair], mesh: Mesh, coupled: bool, sizes: Mapping[int, int] = LARGE
) -> str:
    """The same from the number of free displacements and the contact pairs; sizes: from where on multigrid wins."""
    if linear == "amg" and coupled:
        raise InputError(
            'solve.linear: "amg" takes the unknowns point by point, but equations or components left free of a rigid body '
            'couple points; choose "direct" or "auto"'
        )
    if linear != "auto":
        return linear
    degree = max(CELLS[block.kind].degree for block in mesh.blocks)
    large = mesh.dim == 3 and n_free >= sizes[degree]
    able = not coupled and find_spec("pyamg") is not None and not any(pair.redundant for pair in pairs)
    return "amg" if large and able else "direct"


def prepare(
    linear: str,
    system: System,
    free: Any,
    near_null: NDArray[np.float64],
    loose: NDArray[np.float64],
    points: NDArray[np.float64],
) -> Prepared:
    """Set a linear solver up.

    linear: "direct" or "amg"; free: (dim n_points, n_free) change of variables; near_null: (dim n_points, m) motions that
    strain bodies least; loose: (n_free, k) those that supports leave free; points: (n_points, dim).
    Raises InputError where the solver is not installed or cannot serve the system.
    """
    if linear == "amg":
        return _iterative(system, hierarchy(system.stiffness, free, near_null, points), loose, Count())
    return _direct(system, loose)


def _iterative(system: System, levels: Hierarchy, loose: NDArray[np.float64], count: Count) -> Prepared:
    return Prepared(
        iterate(system, levels, loose, count), lambda outcome, _: outcome,
        lambda other: _iterative(other, levels, loose, count), "multigrid (PyAMG)", levels.summary, count,
    )  # fmt: skip


def _direct(system: System, loose: NDArray[np.float64]) -> Prepared:
    pairs = system.pairs
    predict = foresight(lambda: half_spaces(interfaces(pairs)), np.asarray(system.operator @ loose))
    system = replace(system, predict=predict)
    condensed = condense(system, loose)
    name = f"direct ({solver_name()})"

    def renew(other: System) -> Prepared:
        return _direct(other, loose)

    if condensed is None:
        return Prepared(system, lambda outcome, _: outcome, renew, name, f"direct solver {solver_name()}")

    def finish(outcome: Outcome, weights: NDArray[np.float64]) -> Outcome:
        return replace(outcome, unknowns=condensed.expand(outcome.unknowns, weights, outcome.laws))

    note = f"direct solver {solver_name()}; all displacements eliminated but {len(condensed.kept)}, the rest is dense"
    return Prepared(condensed.system, finish, renew, name, note)
