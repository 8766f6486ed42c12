"""Pressures and stresses of triangles and tetrahedra of first order without the forces that their straight displacements
leave: a deferred correction, theory (Z11), (Z12)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.analysis.known_stress import mirrored
from abut.bodies.interpolated_samples import without_interpolation
from abut.bodies.interpolation import interpolation_forces
from abut.bodies.patch_fits import Fits, Sampling, fitted
from abut.bodies.recovery import in_cells
from abut.bodies.solids import TemperatureChange
from abut.bodies.stress import PointStress
from abut.contact.pressure_space import DUAL, DUAL_P1
from abut.nonlinear.again import Imposed
from abut.nonlinear.attempt import Attempt
from abut.problem.assembly import Assembled
from abut.problem.balance import Balance
from abut.problem.body_terms import heated
from abut.problem.pair import Pair
from abut.problem.problem import ContactProblem
from abut.problem.straight_cells import rounds
from abut.problem.terms import Motion
from abut.solution.state import State

SHARED = (DUAL, DUAL_P1)  # spaces: values of second order would sharpen what P1 oscillates by
NOTHING = 1e-10  # of the largest nodal force: stresses are constant or linear, and so exact

Solve = Callable[[Attempt, Imposed], Attempt]


@dataclass(frozen=True)
class Mended:
    """From what pressures and surface stresses of a step are shown. displacement: (n_points, dim), stress: at integration
    points; pressure: of each pair facet-wise coefficients (9 n_facets,), of the force of its multipliers, None where these
    stay; fits: to the stresses of the step as it was solved, of which no equation takes part."""

    displacement: NDArray[np.float64]
    stress: PointStress
    pressure: tuple[NDArray[np.float64] | None, ...]
    fits: Fits

    def near(self, cells: NDArray[np.bool_], temperature: TemperatureChange) -> PointStress:
        """The stress of displacements that ``cells`` (n_cells,) do not interpolate, by the fits; of others ``stress``."""
        mended = without_interpolation(self.fits, temperature, cells)
        return tuple(own + (new - old) for own, new, old in zip(self.stress, mended, self.fits.stress))


def is_mended(problem: ContactProblem) -> bool:
    """Whether there is anything: contact of bodies with such cells, linear materials, small displacements, no friction."""
    return problem.constant and not len(problem.springs) and rounds(problem.model, problem.pairs) > 0


def mended(assembled: Assembled, attempt: Attempt, solve: Solve) -> Mended | None:
    """solve: a step again under further forces; None where it does not converge with them."""
    problem, first = assembled.problem, attempt
    model, solids = problem.model, problem.model.deformable
    known = mirrored(model, solids.points, attempt.time, problem.pairs)
    motion, stress = _stresses(assembled, attempt.state)
    fits = own = fitted(Sampling.of(solids, solids.points, known), stress, known)
    for number in range(rounds(model, problem.pairs)):
        if number:
            fits = fitted(own.sampling, stress, known)
        force = interpolation_forces(solids, in_cells(fits), heated(model, assembled.loaded, motion)).ravel()
        if np.abs(force).max(initial=0.0) <= NOTHING * max(first.state.largest.force, 1e-300):
            break
        attempt = solve(first, Imposed(force))
        if not attempt.converged:
            return None
        motion, stress = _stresses(assembled, attempt.state)
    pressures = tuple(map(_of_resultant, _pressures(problem, attempt), _pressures(problem, first)))
    return Mended(motion.displacement.reshape(-1, model.dim), stress, pressures, own)


def _stresses(assembled: Assembled, state: State) -> tuple[Motion, PointStress]:
    problem, bodies = assembled.problem, assembled.bodies
    motion = problem.motion(state.time, problem.displacement(state))
    motion = replace(motion, history=state.history.of(bodies.name))
    return motion, bodies.stress(motion)


def _pressures(problem: ContactProblem, attempt: Attempt) -> list[tuple[Pair, NDArray[np.float64]]]:
    """Pairs as they were solved, with their multipliers."""
    balance = attempt.balance or Balance.of(problem.again(attempt.state, attempt.state), attempt.state)
    return list(zip(balance.pairs, balance.split(attempt.state.multipliers)))


def _of_resultant(
    one: tuple[Pair, NDArray[np.float64]], own: tuple[Pair, NDArray[np.float64]]
) -> NDArray[np.float64] | None:
    """Facet-wise coefficients of the pressure ``one``, in proportion, with the force of the multipliers."""
    pair, pressure = one
    if pair.two_way or pair.space.name not in SHARED:
        return None
    found, force = float(pressure @ pair.weight), float(own[1] @ own[0].weight)
    return np.asarray(pair.space.transfer @ pressure) * (force / found) if min(found, force) > 0.0 else None
