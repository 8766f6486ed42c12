"""Problems with known answers: one record each, used by ``abut verify``, the tests and the documentation alike."""

from __future__ import annotations

from abut.benchmarks import (
    beam,
    contrast,
    convergence,
    finite_beams,
    finite_capstan,
    finite_contact,
    finite_contact_3d,
    finite_edges,
    finite_gears,
    finite_rubber,
    finite_stacks,
    finite_uniform,
    finite_wires,
    fits,
    friction,
    friction_balls,
    friction_statics,
    hertz,
    holds,
    incompressible,
    layers,
    loads,
    local_axes,
    onset,
    patch,
    penetration,
    plastic,
    preloads,
    punches,
    removals,
    stability,
    subsurface,
)
from abut.benchmarks.record import Benchmark, Outcome, Reference, run

__all__ = ["BENCHMARKS", "Benchmark", "Outcome", "Reference", "run"]

BENCHMARKS: dict[str, Benchmark] = {
    b.name: b
    for b in (
        *patch.BENCHMARKS,
        *hertz.BENCHMARKS,
        *subsurface.BENCHMARKS,
        *fits.BENCHMARKS,
        *punches.BENCHMARKS,
        *contrast.BENCHMARKS,
        *friction.BENCHMARKS,
        *friction_balls.BENCHMARKS,
        *friction_statics.BENCHMARKS,
        *beam.BENCHMARKS,
        *stability.BENCHMARKS,
        *convergence.BENCHMARKS,
        *finite_uniform.BENCHMARKS,
        *finite_beams.BENCHMARKS,
        *finite_rubber.BENCHMARKS,
        *finite_contact.BENCHMARKS,
        *finite_contact_3d.BENCHMARKS,
        *finite_gears.BENCHMARKS,
        *finite_wires.BENCHMARKS,
        *finite_capstan.BENCHMARKS,
        *plastic.BENCHMARKS,
        *onset.BENCHMARKS,
        *incompressible.BENCHMARKS,
        *layers.BENCHMARKS,
        *finite_edges.BENCHMARKS,
        *finite_stacks.BENCHMARKS,
        *preloads.BENCHMARKS,
        *loads.BENCHMARKS,
        *local_axes.BENCHMARKS,
        *holds.BENCHMARKS,
        *removals.BENCHMARKS,
        *penetration.BENCHMARKS,
    )
}
