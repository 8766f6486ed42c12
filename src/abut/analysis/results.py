"""Results of a step from its state: displacements, stresses, reactions, contact results."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from abut.analysis.certificate import NOTHING, certificate
from abut.analysis.faceting import free_axes
from abut.analysis.friction import friction_checks, friction_forces, friction_result
from abut.analysis.overlap import covered_elsewhere, overlaps
from abut.analysis.statistics import (
    forces_on_bodies,
    loaded_part,
    nodal_forces,
    nodal_parts,
    pressure_statistics,
    resultant,
)
from abut.contact.geometry import full_moments, nodal_normals
from abut.contact.nodal_recovery import (
    Averages,
    at_facet_nodes,
    averages,
    carry_to_target,
    corner_values,
    facet_node_values,
)
from abut.contact.symmetry_planes import evened
from abut.mesh.mesh import Mesh
from abut.model import METHODS
from abut.model.offset import offsets
from abut.nonlinear.load_step import Attempt
from abut.problem.assembly import Assembled
from abut.problem.contact_pairs import Pair
from abut.problem.linearised import Linearised
from abut.problem.problem import CONTACTS
from abut.problem.rigid_bodies import RigidBody
from abut.problem.terms import Motion
from abut.solution import ContactResult, RigidResult, Step
from abut.solution.state import OPEN

NO_STRAIN = 1e-12  # nodal forces over stiffness times displacement from which down they are rounding


def step_result(assembled: Assembled, attempt: Attempt, before: Sequence[Step]) -> Step:
    """Collect displacement, stress, reactions and contact results at the end of a load step, ``before`` being the others.

    Raises SingularModelError for displacements that no units explain."""
    bodies, loaded, state = assembled.bodies, assembled.loaded, attempt.state
    problem = assembled.problem.with_ordinary(attempt.inside) if attempt.inside.any() else assembled.problem
    model, held, springs = problem.model, problem.held, problem.springs
    displacement = springs.without_motions(problem.displacement(state))
    system = problem.linearise(state, state)
    dim, time, factors = model.dim, state.time, system.factors
    pressures = system.split(state.multipliers)
    contact_force = np.zeros_like(displacement)
    for pair, pressure in zip(system.pairs, pressures):
        contact_force += pair.rows.T @ pressure
    motion = Motion(time, displacement, state.history.of(bodies.name))
    internal = bodies.evaluate(motion, motion).force
    reaction = internal - loaded.forces @ factors - contact_force
    nodal = displacement.reshape(-1, dim)
    carried = reaction if held.links is None else reaction - held.links.forces(reaction)
    by_supports = carried.reshape(-1, dim)
    deepest = []
    for pair in system.pairs:
        constant, varying = offsets(model, pair.contact)
        deepest.append(overlaps(pair, nodal, constant + float(varying @ factors)))
    largest = [pair.space.transfer @ p[pair.normal] for pair, p in zip(system.pairs, pressures) if not pair.tied]
    beside = max(
        [float(np.abs(p).max(initial=0.0)) for p in largest] + _largest_pressures(len(system.pairs), before) + [0.0]
    )
    slips = state.history.of(CONTACTS)
    contacts = tuple(
        _contact(
            model.mesh,
            pair,
            pressure,
            gap,
            status,
            slips.get(pair.contact.name),
            attempt.iterations[-1].contact_residual,
            reference,
            depth,
            beside,
            free_axes(model, held, pair),
            elsewhere,
        )
        for pair, pressure, gap, status, reference, depth, elsewhere in zip(
            system.pairs,
            pressures,
            system.split(system.gap(state)),
            system.split(state.status),
            _largest_pressures(len(system.pairs), before),
            deepest,
            covered_elsewhere(system.pairs, pressures),
        )
    )
    cycling = {}
    for pair, own in zip(system.pairs, system.split(attempt.cycling)):
        if own.any():
            rows = np.unique(pair.transfer.tocsc()[:, own].tocoo().row // 9)
            cycling[pair.contact.name] = rows.astype(np.int64)
    return Step(
        number=attempt.number,
        factor=time,
        converged=attempt.converged,
        iterations=attempt.iterations,
        displacement=nodal,
        stress=bodies.stress(motion),
        reaction=reaction.reshape(-1, dim).sum(axis=0),
        reactions={
            on: by_supports[_with_bodies(model.mesh.nodes_of(on), held.bodies)].sum(axis=0)
            for on in {s.on: s for s in model.supports}
        },
        load=loaded.resultant @ factors,
        contacts=contacts,
        axisymmetric=model.mesh.axisymmetric,
        cycling=cycling,
        rigid={body.rigid.body: RigidResult(*body.motion(nodal), *body.resultant(by_supports)) for body in held.bodies},
        earlier=max((step.largest_force for step in before), default=0.0),
        internal=float(np.abs(internal).sum()),
        pressed=max(
            (float(np.abs(pair.rows.T @ p).sum()) / 2.0 for pair, p in zip(system.pairs, pressures)), default=0.0
        ),
        strain=max((pair.compliance * c.max_pressure / 4.0 for pair, c in zip(system.pairs, contacts)), default=0.0),
        rounding=_rounding(system, state.unknowns),
        spring=springs.force(state.unknowns) if len(springs) else None,
        strained=_strained(system, displacement, internal),
    )


def _strained(system: Linearised, displacement: NDArray[np.float64], internal: NDArray[np.float64]) -> bool:
    """Whether anything gives way: nodal forces of stresses (``internal``) are more than the rounding of rigid motions."""
    stiffest = float(system.stiffness.diagonal().max(initial=0.0))
    return bool(np.abs(internal).max(initial=0.0) > NO_STRAIN * stiffest * np.abs(displacement).max(initial=0.0))


def _rounding(system: Linearised, free: NDArray[np.float64]) -> float:
    """Force that free displacements (n_free,) in double precision leave open: eps sum K_ii |u_i|."""
    return float(np.finfo(float).eps * (system.stiffness.diagonal() @ np.abs(free)))


def _with_bodies(nodes: NDArray[np.int64], bodies: Sequence[RigidBody]) -> NDArray[np.int64]:
    """Nodes, and all of the rigid bodies they belong to: what holds one point of those holds the whole."""
    touched = [body.nodes for body in bodies if np.isin(nodes, body.nodes).any()]
    return np.unique(np.concatenate([nodes, *touched]))


def _largest_pressures(n_pairs: int, steps: Sequence[Step]) -> list[float]:
    """Of each pair, over some steps."""
    return [max((abs(step.contacts[i].max_pressure) for step in steps), default=0.0) for i in range(n_pairs)]


def _contact(
    mesh: Mesh,
    pair: Pair,
    multipliers: NDArray[np.float64],
    gap: NDArray[np.float64],
    status: NDArray[np.int8],
    slips: NDArray[np.float64] | None,
    residual: float,
    reference: float,
    overlap: NDArray[np.float64],
    beside: float,
    free: NDArray[np.bool_],
    elsewhere: NDArray[np.float64],
) -> ContactResult:
    dim = pair.contactor.dim
    coupling, degree = pair.coupling, pair.coupling.degree
    pressure, weight, active = multipliers, pair.weight, status != OPEN
    if not pair.tied:
        pressure, weight, gap, active = (of[pair.normal] for of in (multipliers, weight, gap, active))
    values = pair.traction(pressure) if pair.tied else pair.space.transfer @ pressure
    own, other = nodal_forces(coupling, values, dim)
    ids, target_ids = pair.contactor.node_ids, pair.target.node_ids
    if pair.frictional:
        own, other = friction_forces(pair, multipliers)
    if pair.tied:
        normal = _compression(pair, values)
        gaps = np.zeros_like(normal)
        area, depth = float(coupling.covered.sum()), 0.0
    else:
        normal = values
        gaps = pair.space.plain @ (gap / weight)
        area, depth = float(weight[active].sum()), float((-gap / weight).max(initial=0.0))
    covered = coupling.segments > 0
    raw = facet_node_values(pair.contactor, degree, normal)
    at = averages(pair.contactor, coupling) if pair.contact.method == METHODS[0] else None
    nodal = raw if at is None else at_facet_nodes(at.surface, _reported(pair, at, normal, bool(active.all())))
    share = np.where(np.isnan(raw), np.nan, 1.0) if at is None else at_facet_nodes(at.surface, at.share)
    nothing = NOTHING * max(reference, beside)  # what is left after unloading
    load, loaded = (nodal_parts(coupling, at, field) for field in (normal, loaded_part(pair, pressure, active, normal)))
    statistics = pressure_statistics(pair.contactor, nodal, load, loaded, share, nothing)
    amount = resultant(mesh.points[ids], own[ids], mesh.axisymmetric, bool(np.abs(values).max(initial=0.0) <= nothing))
    shown = corner_values(pair.contactor, nodal)
    if slips is None:
        slips = np.zeros((len(pair), 2))
    return ContactResult(
        name=pair.contact.name,
        contactor=pair.contactor,
        target=pair.target,
        force=amount.force,
        max_pressure=statistics.largest,
        area=area,
        max_penetration=max(depth, 0.0),
        active=int(active.sum()),
        multipliers=len(pair) if pair.tied else len(pair.space),
        removed=pair.space.removed,
        segments=int(coupling.segments.sum()),
        pressure=nodal,
        multiplier=raw,
        share=share,
        gap=np.where(covered[:, None], facet_node_values(pair.contactor, degree, gaps), np.nan),
        covered=covered,
        covered_share=float(coupling.covered.sum() / full_moments(pair.contactor, 0)[:, 0].sum()),
        target_pressure=carry_to_target(pair.contactor, pair.target, coupling.target_part, shown),
        checks=certificate(
            pair, values, nodal, max(depth, 0.0), residual, reference, overlap, share, beside, free, elsewhere
        )
        + friction_checks(pair, multipliers, status, slips, reference),
        statistics=statistics,
        resultant=amount,
        contactor_forces=own[ids],
        target_forces=other[target_ids],
        body_forces=forces_on_bodies(pair.target, mesh.bodies, other[target_ids]),
        friction=None if at is None else friction_result(pair, at, multipliers, status, slips),
    )


def _reported(pair: Pair, at: Averages, values: NDArray[np.float64], closed: bool) -> NDArray[np.float64]:
    """The pressure at the points of ``at.surface``, (n_points,): averages of facet-wise coefficients (``values``), by
    theory (P10); sharpened where ordinary continuous functions are in contact all over, theory (P12); else with those on
    planes of symmetry mended, theory (P14)."""
    average = at.of(values)
    if pair.tied or (closed and pair.space.continuous and pair.space.ordinary):
        sharp = at.sharpened(average, at.surface.points)
        if pair.tied or sharp.min() >= 0.0:
            return sharp
    return average if pair.planes is None else evened(pair.contactor, at, average, pair.planes)


def _compression(pair: Pair, traction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Normal part of the tie traction, facet-wise coefficients, compression positive."""
    normals = nodal_normals(pair.contactor).reshape(traction.shape)
    return np.asarray(-np.einsum("ka,ka->k", normals, traction))
