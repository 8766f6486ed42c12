"""What results look at after large sliding: the multipliers that have a target opposite now."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.analysis.friction import touches_itself
from abut.contact.coupling import Coupling
from abut.contact.geometry import full_moments
from abut.contact.pressure_space import PressureSpace, only
from abut.contact.rim import rim_of_sides
from abut.contact.symmetry_planes import Planes
from abut.contact.tangential import SlipOperators, target_operators
from abut.problem.adjusted_gaps import BARELY
from abut.problem.balance import Balance
from abut.problem.contact_pairs import planes_of
from abut.problem.current import Current
from abut.problem.pair import Pair, Slip
from abut.problem.problem import ContactProblem
from abut.solution.state import State

Array = NDArray[np.float64]


def covered(
    problem: ContactProblem, balance: Balance, state: State, here: Array
) -> tuple[Balance, State, NDArray[np.bool_]]:
    """A problem at the end of a step and the state there, at displacements ``here`` (dim n_points,), without multipliers
    that nothing is opposite to, and which are left, (n,); weights are those of the part that is covered, planes of
    symmetry those where the contactor ends now."""
    pairs, keeps, gaps, contacts = [], [], [], {}
    parts = problem.kinematics, problem.pairs, balance.split(balance.gap)
    for pair, kind, whole, gap in zip(balance.pairs, *parts):
        keep, name = np.ones(len(pair), dtype=bool), pair.contact.name
        known = state.history.contact(name)
        if isinstance(kind, Current):
            undeformed = whole.weight[whole.normal]
            seen = kind.shown(here, points=pair.frictional and touches_itself(pair))
            # a step sees targets that have come from farther away: open gaps are shown as if the bodies had been at rest
            under = pair.space.transfer.T @ seen.weight >= BARELY * undeformed
            keep = pair.of_functions(under if under.any() else np.ones_like(under))
            gap = np.concatenate(
                [kind.gaps(pair.space, seen, problem.added(pair, state.time), known.fit), gap[pair.tangential]]
            )
            planes = _planes_now(problem, kind, pair)
            pair = replace(pair, coupling=replace(seen, points=None), slip=_seen_slip(pair, seen), planes=planes)
            pair = _of_covered(pair, keep, undeformed) if under.any() else pair
        pairs.append(pair)
        keeps.append(keep)
        gaps.append(gap[keep])
        contacts[name] = replace(known, slips=None if known.slips is None else known.slips[keep])
    keep = np.concatenate([np.zeros(0, bool), *keeps])
    smaller = replace(balance, pairs=pairs, gap=np.concatenate([np.zeros(0), *gaps]))
    history = replace(state.history, contacts=contacts)
    kept = replace(state, multipliers=state.multipliers[keep], status=state.status[keep], history=history)
    return smaller, kept, keep


def _planes_now(problem: ContactProblem, kind: Current, pair: Pair) -> Planes:
    """Of symmetry, at which a contactor ends now."""
    border = rim_of_sides(pair.contactor)
    return planes_of(problem.model, pair.contactor, border, kind.goes_on(pair, border), problem.constraints)


def whole_supports(problem: ContactProblem, pairs: Sequence[Pair], keep: NDArray[np.bool_]) -> list[Array | None]:
    """int H_k over all of the contactor where it is now, (n_functions,) of each pair, without what follows it; None of ties
    and where bodies are not looked at. pairs: as from ``covered``; keep: (n,) multipliers of the problem that are left."""
    return [
        (kind.pair.space.plain.T @ full_moments(pair.contactor, pair.coupling.degree).ravel())[own[kind.pair.normal]]
        if isinstance(kind, Current)
        else None
        for pair, kind, own in zip(pairs, problem.kinematics, problem.split(keep))
    ]


def _seen_slip(pair: Pair, seen: Coupling) -> Slip | None:
    """What makes tangential rows, of the points that are seen now: no couple, and the target's part where points of its are
    the contactor's too."""
    if pair.slip is None:
        return None
    none = SlipOperators((), None)
    return replace(pair.slip, operators=none if seen.points is None else target_operators(seen.points, pair.target))


def _of_covered(pair: Pair, keep: NDArray[np.bool_], undeformed: Array) -> Pair:
    """A pair without some multipliers, keep (n,), with the weights of what is covered now. undeformed: (n_functions,) those
    of the laws, theory (G3)."""
    ends = np.cumsum([len(part) for part in pair.components])[:-1]
    components = [
        _weighed(only(part, chosen), pair.coupling) for part, chosen in zip(pair.components, np.split(keep, ends))
    ]
    functions = keep[pair.normal]
    number = np.where(keep, np.cumsum(keep) - 1, -1)
    index = np.where(pair.index >= 0, number[np.maximum(pair.index, 0)], -1)[functions]
    weight = np.concatenate([part.weight for part in components])
    return replace(
        pair, space=replace(components[0], removed=pair.space.removed + int((~functions).sum())),
        components=tuple(components), index=index, rows=pair.rows[keep], operator=pair.operator[keep], gap=pair.gap[keep],
        scale=weight / pair.stiffness,
        carried=None if pair.carried is None else pair.carried[keep],
        slip=None
        if pair.slip is None
        else replace(
            pair.slip,
            tangents=pair.slip.tangents[functions],
            points=pair.slip.points[functions],
            normals=pair.slip.normals[functions],
            area=undeformed[functions],
        ),
        values=None
        if pair.values is None
        else replace(pair.values, coefficient=pair.values.coefficient[functions]),
    )  # fmt: skip


def _weighed(space: PressureSpace, coupling: Coupling) -> PressureSpace:
    return replace(space, weight=space.transfer.T @ coupling.weight)
