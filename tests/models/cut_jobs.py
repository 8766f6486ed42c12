"""A job cut in two at the end of a step: the first part as a job of its own, the second one that starts from its results."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import abut
from abut.model.conditions import History
from abut.output.restart import description, save_step
from abut.output.start import load_start

ACTING = ("supports", "loads", "contacts", "rigid", "rotations", "couplings", "preloads", "connectors")


def first_part(model: abut.Model, share: float) -> abut.Model:
    """What a model does up to a share of its time, over all of its own; preloads that are locked then are not yet."""
    changed: dict[str, Any] = {name: [_sooner(record, share) for record in getattr(model, name)] for name in ACTING}
    times = tuple(time / share for time in model.solve.ends if time <= share)
    return replace(model, solve=replace(model.solve, steps="auto", times=times), **changed)


def _sooner(record: Any, share: float) -> Any:
    new: dict[str, Any] = {}
    for name in ("amplitude", "friction_amplitude"):
        if hasattr(record, name):
            history = getattr(record, name)
            new[name] = history if name != "amplitude" and history is None else _part(history, share)
    if getattr(record, "amplitudes", None):
        new["amplitudes"] = {name: _part(history, share) for name, history in record.amplitudes.items()}
    if getattr(record, "lock", None) is not None:
        new["lock"] = record.lock / share if record.lock < share else None
    if getattr(record, "until", None) is not None:
        new["until"] = record.until / share if record.until < share else None
        new["released"] = None if record.released is None or record.until >= share else record.released / share
    return replace(record, **new)


def _part(history: History, share: float) -> abut.Amplitude:
    if history is None:
        return abut.Amplitude(((0.0, 0.0), (1.0, share)))
    inside = [(time / share, factor) for time, factor in history.points if time < share]
    return abut.Amplitude((*inside, (1.0, history(share))))


def whole_and_cut(
    model: abut.Model, share: float, folder: Path, first: abut.Model | None = None
) -> tuple[abut.Solution, abut.Solution]:
    """A model solved in one job and in two; first: the job of the first part, where that is not just the model's own."""
    before = first_part(model, share) if first is None else first
    said, own = description(before), list[float]()
    abut.solve(before, on_step=lambda _, saved: save_step(folder, said, saved))
    begun = load_start(folder, model, share)
    cut = abut.solve(model, resume=begun, on_step=lambda _, saved: own.append(saved.state.time))
    assert begun
    assert min(own) > share
    return abut.solve(model), cut


def assert_alike(whole: abut.Solution, cut: abut.Solution, near: float) -> None:
    """At the end of each step of the same time: displacements, turns, stresses, pressures, forces; near: share of the
    largest of their kind in the run."""
    assert whole.converged
    assert cut.converged
    others = {round(step.factor, 9): step for step in cut.steps}
    far = max(float(np.abs(step.displacement).max()) for step in whole.steps)
    stress = max(float(np.abs(step.stress).max()) for step in whole.steps)
    stress = max(
        stress, *(float(np.nanmax(np.abs(c.pressure), initial=0.0)) for s in whole.steps for c in s.contacts), 1e-6
    )
    force = max(max(step.largest_force for step in whole.steps), 1e-6)
    for step in whole.steps:
        other = others[round(step.factor, 9)]
        pairs = [(other.displacement, step.displacement, far), (other.stress, step.stress, stress)]
        pairs += [(other.reactions[name], reaction, force) for name, reaction in step.reactions.items()]
        for one, again in zip(step.contacts, other.contacts):
            pairs += [(again.force, one.force, force), (again.pressure, one.pressure, stress)]
        for name, bolt in step.preloads.items():
            again = other.preloads[name]
            pairs += [(again.tension, bolt.tension, force), (again.shortening, bolt.shortening, far)]
        for name, body in step.rigid.items():
            again = other.rigid[name]
            pairs += [(again.displacement, body.displacement, far), (again.rotation, body.rotation, 1.0)]
        for name, joint in step.connectors.items():
            again = other.connectors[name]
            pairs.append((again.force, joint.force, force))
            pairs += [(again.motion[motion], value, max(far, 1.0)) for motion, value in joint.motion.items()]
        for found, wanted, size in pairs:
            np.testing.assert_allclose(found, wanted, rtol=0.0, atol=near * size)
