"""Gaps that ``adjust`` takes as none, at large sliding: a clearance that each function of the contactor keeps."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from abut.cells import MAX_FACET_NODES
from abut.contact.clearance import partly_adjusted
from abut.contact.coupling import Coupling, CouplingOptions, GapSamples, couple
from abut.contact.function_places import at_samples
from abut.contact.geometry import nodal_normals
from abut.contact.pressure_space import PressureSpace
from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.problem.dual_functions import Mixture, mixed_part
from abut.problem.pair import Pair

BARELY = 0.01  # share of a function that must be covered for it to carry a pressure


def taken_off(pair: Pair, reach: float) -> NDArray[np.float64]:
    """What ``adjust`` adds to the mean gap of each function from the outset on, (n_functions,) lengths: theory (G16). Zero
    where hardly any target is opposite at the outset.

    pair: as from ``finite_pair``, undeformed; reach: how far apart the surfaces may lie, a length. Raises InputError for a
    surface in contact with itself."""
    contact, contactor, target = pair.contact, pair.contactor, pair.target
    if not contact.adjust:
        return np.zeros(len(pair.space))
    if len(np.intersect1d(contactor.node_ids, target.node_ids)):
        raise InputError(
            f"contact '{contact.name}': adjust: contactor and target have points in common, which would be adjusted to "
            "themselves; leave adjust out, or name the surfaces that face each other"
        )
    rule, across = contact.integration, None if pair.moving is None else pair.moving.contactor
    options = CouplingOptions(rule.rule, rule.points, reach, keep_gap_samples=True)
    plain, closed = (
        couple(contactor, target, pair.coupling.degree, replace(options, adjust=size), across=across)
        for size in (0.0, contact.adjust)
    )
    normals = nodal_normals(contactor, across)
    adjusted = partly_adjusted(contactor, target, closed, contact.adjust, reach, lambda: plain, normals)
    mixed = pair if pair.space.ordinary else mixed_part(pair, Mixture.of(contactor, plain, None))
    functions = mixed.space.transfer.T
    weight, moved = functions @ plain.weight, functions @ (adjusted.gap - plain.gap)
    seen = weight >= BARELY * pair.weight[pair.normal]
    return np.where(seen, moved / np.where(seen, weight, 1.0), 0.0)


def with_adjusted(
    space: PressureSpace, contactor: Surface, seen: Coupling, adjusted: NDArray[np.float64]
) -> GapSamples | None:
    """The gap samples of a coupling with what ``taken_off`` gives between the functions' places, (n_functions,) lengths."""
    at = seen.gap_samples
    if at is None:
        return None
    of_facets = np.asarray(space.plain @ adjusted).reshape(-1, MAX_FACET_NODES)[at.facet]
    return replace(at, gap=at.gap + (at_samples(contactor, seen.degree, at) * of_facets).sum(axis=1))
