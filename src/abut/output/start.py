"""The steps of another job as the first ones of a job: its restart files, taken for the first part of the time."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from abut.errors import InputError
from abut.model import Model
from abut.output.restart import description, differences, listed, read_steps
from abut.solution import Saved

# what may differ: what acts, whose values the balance of every step taken over compares, and the ways of all over time
MAY_CHANGE = re.compile(
    r"(loads|supports|holds|modes)\b|.*\bamplitudes?\b|(rigid|couplings)\[\d+\]\.r?[xyz]$|rotations\[\d+\]\.angle$"
    r"|preloads\[\d+\]\.(force|shortening|lock)$|connectors\[\d+\]\.(motion|load)$|contacts\[\d+\]\.(since|until|released)$"
)
REFUSED = ("removals", "penetrations", "physics")


def load_start(directory: Path, model: Model, share: float) -> list[Saved]:
    """The steps that a run left in ``directory``, whose end is at ``share`` of the model's time, over 0 and below 1.

    They serve as ``resume`` of ``abut.solve``, which judges whether they are in balance under the model's own loads.
    Raises InputError where there are none, where they are of another mesh, other materials or other contacts, and where the
    model has what cannot be taken over."""
    if not 0.0 < share < 1.0:
        raise InputError("start.time: expected a time after the start and before the end of this job")
    for name in REFUSED:
        if getattr(model, name):
            raise InputError(
                f"start: steps of another job cannot be taken over where there are {name}; model both as one job"
            )
    if not all(isinstance(contact.law, str) for contact in model.contacts):
        raise InputError("start: steps of another job cannot be taken over where contacts have a law of their own")
    found = read_steps(directory)
    if not found:
        raise InputError(
            f"start.results: no restart files in {directory}; run that job with restart = true in its [output] first"
        )
    own = _kept(description(model))
    for _, before in found:
        if changes := differences(_kept(before), own):
            raise InputError(f"start.results: the steps in {directory} are of another model:{listed(changes)}\nonly what "
                             "acts (loads, supports, motions, holds) and when may differ")  # fmt: skip
    scale = share / found[-1][0].state.time
    return [_sooner(saved, scale) for saved, _ in found]


def _kept(leaves: Mapping[str, str]) -> dict[str, str]:
    return {name: value for name, value in leaves.items() if not MAY_CHANGE.match(name)}


def _sooner(saved: Saved, scale: float) -> Saved:
    """With all times in another measure."""
    parts = tuple(replace(part, state=replace(part.state, time=part.state.time * scale)) for part in saved.parts)
    return replace(saved, state=replace(saved.state, time=saved.state.time * scale), parts=parts, taken=True)
