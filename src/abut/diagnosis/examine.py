"""check(model): all checks of a model that need no solution."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from abut import checks
from abut.analysis.modes import check_modes
from abut.diagnosis.constraints import constraints
from abut.diagnosis.contactor import sides
from abut.diagnosis.cost import cost
from abut.diagnosis.finding import Finding, Motion, Report, from_error, in_order
from abut.diagnosis.friction import friction
from abut.diagnosis.initial_stress import initial_stress
from abut.diagnosis.interface import MIXED, interface, not_facing
from abut.diagnosis.probes import probes
from abut.diagnosis.quality import quality, too_stiff
from abut.diagnosis.rigid_body_check import motions
from abut.diagnosis.tetrahedra import tetrahedra
from abut.diagnosis.units import units
from abut.errors import AbutError, InputError
from abut.mesh.exterior import exterior
from abut.model import Contact, Model
from abut.problem.assembly import connected
from abut.problem.constraints import Constraints, supports
from abut.problem.contact_pairs import pair
from abut.problem.finite_pairs import finite_pair
from abut.problem.pair import Pair
from abut.problem.penetrations import Penetrations


def check(model: Model) -> Report:
    """Examine a model without solving it. What depends on something that is itself in error is left out.

    Parameters
    ----------
    model : Model
        The model as ``solve`` takes it.

    Returns
    -------
    Report
        ``findings``, the gravest first, each with severity, place, what it is and how to correct it; ``motions`` that
        supports leave free; ``status``, the exit status of `abut check`: 0 without errors.

    Raises
    ------
    InputError
        What is no model.
    """
    checks.instance(model, Model, "check", "a model (abut.Model)")
    findings = [*quality(model.mesh), *probes(model), *too_stiff(model), *initial_stress(model)]
    doubts = units(model)
    shown: list[Motion] = []
    try:
        supported = supports(model)
    except AbutError as error:
        findings.append(from_error(error, "supports"))
        return Report(in_order([*findings, *doubts]))
    try:
        connected(model, supported)
    except AbutError as error:
        findings.append(from_error(error, "connectors"))
        return Report(in_order([*findings, *doubts]))
    built, about = _pairs(model, supported)
    findings += about
    try:
        about, shown = motions(model, supported, built)
        findings += about
    except InputError as error:  # loads that cannot be evaluated
        findings.append(from_error(error, "loads"))
    findings += friction(model, supported, built)
    findings += _refused(model, built)
    if len(built) == len(model.contacts):
        findings += cost(model, supported, built)
    if not any(MIXED in f.what for f in findings):  # one mistake, said once
        findings += doubts
    return Report(in_order(findings), tuple(shown))


def _refused(model: Model, built: Sequence[Pair]) -> list[Finding]:
    """What else a run would refuse: modes that cannot be found, fluids that come from nowhere."""
    found = []
    try:
        check_modes(model, team=False)
    except InputError as error:
        found.append(from_error(error, "modes"))
    try:
        if len(built) == len(model.contacts):
            Penetrations.of(model, built)
    except InputError as error:
        found.append(from_error(error, "penetrations"))
    return found


def _built(model: Model, contact: Contact, supported: Constraints) -> Pair:
    """The pair as a run builds it."""
    sliding = model.finite and contact.kind != "tied"
    return finite_pair(model, contact, supported) if sliding else pair(model, contact, supported)


def _why(model: Model, contact: Contact, supported: Constraints, error: AbutError) -> Finding:
    """Why a contact cannot be built: its friction, if it can without, else where its surfaces are."""
    try:
        _built(model, replace(contact, friction=0.0, friction_amplitude=None), supported)
    except AbutError:
        return not_facing(model, contact, error)
    return from_error(error, f"contact '{contact.name}'")


def _facing(model: Model, one: Pair) -> list[Finding]:
    """Of sides that do not face each other at the outset, which finite kinematics allows: units that do not match."""
    if one.coupling.covered.any():
        return []
    finding = not_facing(model, one.contact, InputError(""))
    return [finding] if MIXED in finding.what else []


def _pairs(model: Model, supported: Constraints) -> tuple[list[Pair], list[Finding]]:
    """The contact pairs that can be built, and findings on all of them."""
    built: list[Pair] = []
    findings: list[Finding] = []
    outside = exterior(model.mesh) if model.contacts else np.empty((0, 2), np.int64)
    for contact in model.contacts:
        try:
            one = _built(model, contact, supported)
        except AbutError as error:
            findings.append(_why(model, contact, supported, error))
            continue
        built.append(one)
        if contact.contactor != contact.target:  # a body that may come to touch itself
            findings += _facing(model, one) or [*interface(model, one, outside), *sides(model, contact)]
        if one.coupling.covered.any():
            findings += [*constraints(model, one, supported), *tetrahedra(model, one)]
    return built, findings
