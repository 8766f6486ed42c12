"""Answers to loads that change quickly by superposition of modes, theory (J9) to (J11)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.bodies.mass import mass
from abut.errors import InputError
from abut.model import Harmonic, Model, Transient
from abut.model.response import Response
from abut.modes.frequencies import densities
from abut.modes.held import Held
from abut.modes.oscillators import Oscillators, shares
from abut.probing import Place
from abut.problem.constraints import Constraints
from abut.problem.loads import force_of
from abut.solution.modes import ModesResult
from abut.solution.responses import HARMONIC, TRANSIENT, Numbers, ResponseAt, ResponseResult

AT_ONCE = 1 << 22  # displacements that are looked through for the largest one
Vector = NDArray[np.float64]
Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class Shaken:
    """Forces and what they do at rest. modal: (n, k) of the modes by each of k kinds of force; rest: (dim n_points, k) what
    modes leave out of their static answer; share: of its energy, the largest of the k; NaN where there is no such answer."""

    modal: Vector
    rest: Vector
    share: float


def respond(
    model: Model, constraints: Constraints, held: Held, found: ModesResult, places: Sequence[Place], wanted: Response
) -> ResponseResult:
    """constraints, held: as those that the modes ``found`` were found with; places: of the model's probes.

    Raises InputError for states that are unstable, bodies that move freely without mass, and resonance without damping,
    SingularModelError."""
    if found.eigenvalues.min(initial=0.0) < 0.0:
        raise InputError(
            "response: the loaded state is unstable (a frequency is negative), and would not vibrate about it"
        )
    if held.loose and found.eigenvalues.all():
        raise InputError(
            "response: some body moves as a whole without resistance and without mass, as rigid bodies do; loads would move "
            "it infinitely fast: hold it, or give it a material with a density"
        )
    omega = np.sqrt(found.eigenvalues)
    modes = Oscillators(omega, shares(omega, _ratios(wanted), (wanted.rayleigh[0], wanted.rayleigh[1])))
    if isinstance(wanted, Harmonic):
        return _harmonic(model, constraints, held, found, places, wanted, modes)
    return _transient(model, constraints, held, found, places, wanted, modes)


def _ratios(wanted: Response) -> float | tuple[float, ...]:
    return wanted.damping if isinstance(wanted.damping, float) else tuple(wanted.damping)


def _harmonic(
    model: Model, constraints: Constraints, held: Held, found: ModesResult, places: Sequence[Place], wanted: Harmonic,
    modes: Oscillators,
) -> ResponseResult:  # fmt: skip
    natural = found.values
    at = np.union1d(wanted.at(natural), np.array(wanted.fields, float))
    undamped = natural[(modes.damping == 0.0) & (natural >= wanted.between[0]) & (natural <= wanted.last)]
    if len(undamped):
        raise InputError(
            f"harmonic: without damping the amplitude at {undamped[0]:.6g} cycles per time, a natural frequency, is "
            "infinite; give damping or rayleigh, or leave this frequency out of between"
        )
    real, ahead = (sum((force_of(model, load) for load in some), np.zeros(model.mesh.points.size))
                   for some in (wanted.loads, wanted.imaginary))  # fmt: skip
    shift = np.zeros(model.mesh.points.shape)
    if wanted.base is not None:
        if len(wanted.base) != model.dim:
            raise InputError(f"harmonic: base: expected {model.dim} numbers, got {len(wanted.base)}")
        shift[:] = wanted.base
    inertia = mass(model.mesh, densities(model)) @ shift.ravel()
    shaken = _shaken(constraints, held, found, np.column_stack([real, ahead, inertia]))
    angular = 2.0 * np.pi * at
    of_base = angular**2 - 1j * wanted.rayleigh[0] * angular
    factors = np.column_stack([np.ones(len(at)), np.full(len(at), 1j), of_base])
    coordinates = modes.amplitudes(angular) * (factors @ shaken.modal.T)
    last = Oscillators(modes.omega[-1:], modes.damping[-1:])
    beyond = (
        np.abs(last.omega**2 * last.amplitudes(angular)[:, 0] - 1.0).max() if angular[-1] < last.omega[0] else np.inf
    )
    moving = _Moving(model, found, at, coordinates, factors, shaken.rest, shift.ravel())
    return _result(HARMONIC, wanted, modes, places, moving, float(shaken.share * beyond))


def _transient(
    model: Model, constraints: Constraints, held: Held, found: ModesResult, places: Sequence[Place], wanted: Transient,
    modes: Oscillators,
) -> ResponseResult:  # fmt: skip
    histories = list(dict.fromkeys(load.amplitude for load in wanted.loads))
    forces = np.zeros((model.mesh.points.size, len(histories)))
    for load in wanted.loads:
        forces[:, histories.index(load.amplitude)] += force_of(model, load)
    shaken = _shaken(constraints, held, found, forces)
    corners = [wanted.period * time for each in histories if each is not None for time, _ in each.points]
    at = np.union1d(wanted.at(), np.array(wanted.fields, float))
    times = np.union1d(at, [time for time in corners if 0.0 < time < wanted.period])
    factors = np.column_stack(
        [np.ones(len(times)) if each is None else [each(time / wanted.period) for time in times] for each in histories]
    )
    kept = np.searchsorted(times, at)
    coordinates = modes.motion(times, factors @ shaken.modal.T)[kept]
    last = Oscillators(np.repeat(modes.omega[-1:], len(histories)), np.repeat(modes.damping[-1:], len(histories)))
    apart = np.abs(last.omega**2 * last.motion(times, factors) - factors).max(axis=0)
    beyond = float((apart / np.maximum(np.abs(factors).max(axis=0), 1e-300)).max())
    moving = _Moving(model, found, at, coordinates, factors[kept], shaken.rest, np.zeros(len(forces)))
    return _result(TRANSIENT, wanted, modes, places, moving, float(shaken.share * beyond))


def _shaken(constraints: Constraints, held: Held, found: ModesResult, forces: Vector) -> Shaken:
    """Of forces (dim n_points, k)."""
    shapes = found.shapes.reshape(len(found), -1)
    modal = np.asarray(shapes @ forces)
    if held.loose or not found.eigenvalues.all():
        return Shaken(modal, np.zeros(forces.shape), float("nan"))
    factors, free = held.by.factors(held.stiffness, held), constraints.free
    rest, share = np.zeros(forces.shape), 0.0
    for k in np.flatnonzero(forces.any(axis=0)):
        static = np.asarray(free @ factors.solve(np.asarray(free.T @ forces[:, k])))
        weights = modal[:, k] / found.eigenvalues
        rest[:, k] = static - shapes.T @ weights
        energy = float(forces[:, k] @ static)
        share = max(share, 1.0 - float(modal[:, k] @ weights) / energy) if energy > 0.0 else share
    return Shaken(modal, rest, share)


@dataclass(frozen=True)
class _Moving:
    """Displacements of all points at (m,) times or frequencies: coordinates (m, n) of modes, factors (m, k) of what these
    leave out, rest (dim n_points, k), and a shift (dim n_points,) of the base."""

    model: Model
    found: ModesResult
    at: Vector
    coordinates: Numbers
    factors: Numbers
    rest: Vector
    shift: Vector

    def of(self, rows: slice) -> Numbers:
        """(m, n_points, dim) at some of the times or frequencies."""
        shapes = self.found.shapes.reshape(len(self.found), -1)
        moved = self.coordinates[rows] @ shapes + self.factors[rows] @ self.rest.T + self.shift
        return np.asarray(moved.reshape(-1, *self.model.mesh.points.shape))


def _result(
    kind: str, wanted: Response, modes: Oscillators, places: Sequence[Place], moving: _Moving, left_out: float
) -> ResponseResult:
    at, model = moving.at, moving.model
    few = max(1, AT_ONCE // max(model.mesh.points.size, 1))
    largest, read = np.zeros(len(at)), [list[Numbers]() for _ in places]
    kept: list[Numbers] = []
    for first in range(0, len(at), few):
        rows = slice(first, first + few)
        moved = moving.of(rows)
        largest[rows] = largest_of_all_phases(moved).max(axis=1, initial=0.0)
        for place, values in zip(places, read):
            if place.weights is not None:
                values.append(np.stack([place.weights @ one for one in moved]))
        kept += list(moved[np.isin(at[rows], wanted.fields)])
    probes = tuple(
        ResponseAt(place.probe.name, place.points, place.nodes, np.concatenate(values))
        for place, values in zip(places, read)
        if values
    )
    fields = np.array(kept) if kept else np.zeros((0, *model.mesh.points.shape))
    return ResponseResult(
        kind,
        at,
        moving.coordinates,
        modes.damping,
        largest,
        probes,
        np.unique(np.array(wanted.fields, float)),
        fields,
        left_out,
    )


def largest_of_all_phases(vectors: Numbers) -> Vector:
    """(...,) the largest size in a period of vectors (..., dim) that go as exp(i omega t), or the size of real ones."""
    real, imaginary = vectors.real, vectors.imag
    a, b = (np.einsum("...i,...i->...", x, x) for x in (real, imaginary))
    both = np.einsum("...i,...i->...", real, imaginary)
    return np.asarray(np.sqrt(0.5 * (a + b) + np.hypot(0.5 * (a - b), both)))
