"""Assembly of the problem of a model; it serves all load steps."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.errors import InputError
from abut.model import Model
from abut.model.conditions import weights
from abut.model.rates import integration_of
from abut.problem.adjusted_gaps import taken_off
from abut.problem.backend import Backend
from abut.problem.body_terms import Bodies, DeadLoads, LinearBodies, SolidBodies
from abut.problem.changing_bodies import ChangingBodies
from abut.problem.clock import Clock
from abut.problem.connectors import Connectors
from abut.problem.constraints import Constraints, supports
from abut.problem.contact_pairs import pairs, reach_of
from abut.problem.current import Current
from abut.problem.dashpots import Dashpots
from abut.problem.discretised import stacked, unit_of
from abut.problem.finite_pairs import finite_pairs
from abut.problem.follower_loads import FollowerLoads
from abut.problem.free_modes import floats_of, free_mode_springs
from abut.problem.held_motions import HeldMotions, neutral_in
from abut.problem.holds import Holds
from abut.problem.idle_loads import idle_loads
from abut.problem.kinematics import Kinematics
from abut.problem.loads import Loads, followers, loads
from abut.problem.other_fields import other_fields
from abut.problem.pair import Pair
from abut.problem.penetrations import Penetrations
from abut.problem.preloads import LockedPreloads
from abut.problem.problem import ContactProblem
from abut.problem.reference import Reference
from abut.problem.released import Released
from abut.problem.restraint import Restraint, helped, require_balance, require_unmoved, restraint
from abut.problem.springs import Springs
from abut.problem.terms import Term
from abut.problem.turning_ties import current_tie
from abut.solution import Observer, Phase
from abut.types import Array


@dataclass(frozen=True)
class Assembled:
    """A problem, and what its results need beside it."""

    problem: ContactProblem
    bodies: Bodies
    loaded: Loads
    backend: Backend


def prescribed(model: Model) -> tuple[Constraints, Loads]:
    """What holds and what loads a model. Raises InputError and SingularModelError for what contradicts itself."""
    constraints = supports(model)
    return constraints.with_others(other_fields(model, constraints.free.shape[1])), loads(model)


def assemble(
    model: Model,
    constraints: Constraints,
    loaded: Loads,
    backend: Backend,
    observe: Observer,
    note: Callable[[str], None],
    clock: Clock,
) -> Assembled:
    """The problem of a model. Raises InputError and SingularModelError for one that cannot be solved."""
    reduced, sprung, damped = backend.reduce(constraints), Springs.of(model), Dashpots.of(model)
    if sprung is not None and sprung.constant:
        reduced = reduced + sprung.tangent(np.zeros(model.mesh.points.size)).reduce(constraints)
    clock.mark("assembly")
    observe(Phase("cutting and integrating the interface"))
    every = finite_pairs(model, constraints) if model.finite else pairs(model, constraints, backend.couple)
    _describe(every, model.finite, note)
    for idle in idle_loads(model):
        note(f"{idle.where}: {idle.what}, and does nothing there; {idle.cure}")
    clock.mark("interface")
    observe(Phase("checking for unconstrained rigid-body motions"))
    passing, ends = Holds.of(model), loaded.at_ends(model)
    restrained = helped(restraint(model.mesh, constraints, every), (sprung, damped, passing))
    restrained, joined = _joined(model, restrained, ends)
    neutral, settled = neutral_in(model, restrained, ends)
    rigid, resisted = restrained.rigid, restrained.everything
    springs = free_mode_springs(rigid, resisted, constraints, reduced, ends, neutral, settled, floats_of(model))
    held = HeldMotions.of(model, rigid, neutral, unit_of(reduced)) if model.finite else None
    for text in springs.notes:
        note(text)
    restrained, reduced = restrained.helped_by(springs.gram), springs.added_to(reduced)
    forces = [constraints.free.T @ force for force in ends]
    first = restrained.at(weights(model.histories, model.ends[0]))
    require_balance(first, forces[0], " in step 1" if len(forces) > 1 else "")
    require_unmoved(restrained, forces)
    _check_finite(reduced.diagonal(), loaded.forces)
    bodies = _bodies(model, loaded, backend)
    fluids = Penetrations.of(model, every)
    found = (sprung, damped, held, passing, fluids, joined, Released.of(model))
    beside = [*_beside(model, constraints, loaded), *(term for term in found if term)]
    own = _own(model, [term.name for term in (bodies, *beside)])
    beside += own
    affine = not (model.finite or model.physics or model.connectors) and _is_constant(model, [bodies, *beside])
    problem = ContactProblem(
        model=model,
        terms=(bodies, *beside),
        constraints=constraints,
        kinematics=[kinematics(pair, constraints, backend, model.finite) for pair in every],
        operator=stacked(every, reduced.shape[0]),
        restraint=restrained,
        springs=springs,
        stiffness=reduced if affine else None,
        motions=constraints.coordinates(restrained.free),
        unit=unit_of(reduced) if affine else 0.0,
        own=frozenset(term.name for term in own),
        integration=integration_of(model.physics),
    )
    _describe_cells(model, note)
    note(f"{reduced.shape[0]} free displacements, {sum(map(len, every))} multipliers")
    clock.mark("set-up")
    return Assembled(problem, bodies, loaded, backend)


def connected(model: Model, constraints: Constraints) -> Connectors | None:
    """The connectors of a model, None without. Raises InputError and SingularModelError for those that cannot be."""
    found = Connectors.of(model, constraints.bodies)
    if found is not None:
        found.require_independent(constraints, weights(model.histories, 0.0))
    return found


def _joined(model: Model, restrained: Restraint, ends: Sequence[Array]) -> tuple[Restraint, Connectors | None]:
    """With what connectors resist, and these; restrained: by all else. Raises SingularModelError where loads move them."""
    found = connected(model, restrained.constraints)
    if found is None:
        return restrained, None
    found, both = found.beside(restrained), helped(restrained, (found,))
    found.require_held(both, ends)
    return both, found


def _describe_cells(model: Model, note: Callable[[str], None]) -> None:
    """How they are integrated, where that was left to abut."""
    for solid in model.solids:
        if solid.integration == "auto" and (how := model.integration(solid)) != "full":
            note(f"body '{solid.body}': integration = \"{how}\", as cells that keep their volume would lock otherwise")


def _bodies(model: Model, loaded: Loads, backend: Backend) -> Bodies:
    if model.linear_bodies:
        return LinearBodies(backend, loaded, model.histories, model.temperatures)
    if model.removals:
        return ChangingBodies.of(model, loaded)
    return SolidBodies(model, loaded, backend)


def _is_constant(model: Model, terms: Sequence[Term]) -> bool:
    """Whether the stiffness is, and can be condensed: half a bolt that a force draws together, and contact alone holds,
    moves freely otherwise."""
    return all(term.constant for term in terms) and all(preload.force is None for preload in model.preloads)


def kinematics(pair: Pair, constraints: Constraints, backend: Backend, finite: bool) -> Kinematics:
    """How a pair is looked at; finite: where its bodies are, a pair as from ``finite_pairs``."""
    reach = reach_of(constraints, pair.contactor, pair.target)
    if not finite:
        return Reference(pair)
    if pair.tied:
        return current_tie(pair, reach)
    return Current(pair, backend.differentiate, taken_off(pair, reach) if pair.contact.adjust else None)


def _beside(model: Model, constraints: Constraints, loaded: Loads) -> list[Term]:
    """What takes part in the balance of forces beside bodies."""
    terms: list[Term] = [DeadLoads(loaded, model.histories)]
    if followers(model):
        terms.append(FollowerLoads(model, constraints.bodies))
    locked = LockedPreloads.of(model)
    return terms if locked is None else [*terms, locked]


def _own(model: Model, taken: Sequence[str]) -> list[Term]:
    """Terms of other physics. Raises InputError for a name that is taken, or has a dot, which histories are named with."""
    terms, names = list[Term](), list(taken)
    for i, item in enumerate(model.physics):
        for term in item.terms(model, model.dofs):
            if term.name in names or "." in term.name:
                raise InputError(
                    f"physics[{i}]: a term cannot be named '{term.name}'; give it another name, without dots"
                )
            names.append(term.name)
            terms.append(term)
    return terms


def _describe(pairs: Sequence[Pair], finite: bool, note: Callable[[str], None]) -> None:
    for p in pairs:
        facets = len(p.contactor)
        covered = int((p.coupling.segments > 0).sum())
        note(
            f"contact '{p.contact.name}': {p.coupling.segments.sum()} segments on {covered} of {facets} facets, "
            f"pressure {p.space.name}, {len(p)} multipliers, {p.space.removed} removed (no target opposite, or constrained)"
        )
        if p.repeated:
            note(
                f"contact '{p.contact.name}': equations or rigid bodies move points of its surfaces together; where its "
                f"pressure is one of many, {'a small one' if finite else 'the smallest'} is taken"
            )


def _check_finite(*numbers: NDArray[np.float64]) -> None:
    """Every number may be sound by itself, and still a product too large for a computer. No entry of a stiffness is larger
    than the largest on its diagonal."""
    if not all(np.isfinite(values).all() for values in numbers):
        raise InputError(
            "stiffnesses or forces are too large to compute with; check the units of materials, loads, mesh"
        )
