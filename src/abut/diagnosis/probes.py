"""Checks of probes: those outside the model, and choices made for the others."""

from __future__ import annotations

from abut.diagnosis.finding import Finding, from_error
from abut.errors import InputError
from abut.model import Model
from abut.probing import boxes, find_place


def probes(model: Model) -> list[Finding]:
    """Each probe whose place is not on the model is an error; what was chosen for the others is told."""
    findings: list[Finding] = []
    around = boxes(model.mesh) if model.probes else ()
    for number, probe in enumerate(model.probes):
        where = f"probes[{number}]"
        try:
            place = find_place(model, probe, around)
        except InputError as error:
            findings.append(from_error(error, where))
        else:
            findings += [Finding("info", where, note) for note in place.notes]
    return findings
