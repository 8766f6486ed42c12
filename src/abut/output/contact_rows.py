"""Values of a contact at the end of a step for summary.json and history.csv."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from abut.contact.sides import listed
from abut.io.names import file_labels
from abut.solution import ContactResult, FrictionResult, Step
from abut.types import Json

# Columns of history.csv after the force; those of ``more_columns`` come last.
ENERGIES = ("loads", "supports", "contact", "stored", "friction", "plastic", "dashpots", "stepping")
OF_CONTACT = ("max_pressure", "area", "max_penetration", "active")


def contact_labels(step: Step) -> list[str]:
    """What the names of the files of each contact begin with."""
    return [f"contact_{label}" for label in file_labels([contact.name for contact in step.contacts])]


def contact_summary(contact: ContactResult) -> Json:
    """The entry of a contact in summary.json; None where a number does not exist."""
    pressure = contact.statistics
    return {
        "name": contact.name,
        "named": [list(listed(side)) for side in contact.named],
        "contactor": contact.contactor.name,
        "target": contact.target.name,
        "force": contact.force.tolist(),
        "force_by_area": contact.force_by_area,
        "max_pressure": number(contact.max_pressure),
        "area": contact.area,
        "max_penetration": contact.max_penetration,
        "active": contact.active,
        "multipliers": contact.multipliers,
        "removed": contact.removed,
        "segments": contact.segments,
        "covered_share": contact.covered_share,
        "max_pressure_at": vector(pressure.place),
        "max_pressure_partly_covered": number(pressure.partly_covered),
        "mean_pressure": number(pressure.mean),
        "pressure_percentile_95": number(pressure.percentile_95),
        "loaded_area": number(pressure.area),
        "centre_of_pressure": vector(contact.resultant.centre),
        "moment": vector(contact.resultant.moment),
        "target_forces": {body: vector(force) for body, force in contact.body_forces.items()},
        **({} if contact.friction is None else {"friction": _friction(contact.friction)}),
    }


def _friction(friction: FrictionResult) -> Json:
    return {
        "coefficient": number(friction.coefficient) if math.isfinite(friction.coefficient) else "rough",
        "sticking_area": friction.sticking_area,
        "slipping_area": friction.slipping_area,
        "force": vector(friction.force),
        "force_by_area": friction.force_by_area,
        "force_limit": number(friction.force_limit),
        "largest_share": number(friction.largest_share),
        "max_traction": friction.max_traction,
        "max_slip": friction.max_slip,
        "max_total_slip": friction.max_total_slip,
        "work": friction.work,
        "total_work": friction.total_work,
    }


def energy_summary(step: Step) -> Json:
    """Where the energy of a step with friction or finite kinematics comes from and goes to."""
    energy = step.energy
    if energy is None:
        return {}
    elastic = (
        {} if energy.elastic is None else {name: number(getattr(energy, name)) for name in ("stabilisation", "elastic")}
    )
    return {"energy": {name: number(getattr(energy, name)) for name in (*ENERGIES, "error")} | elastic}


def energy_columns(finite: bool) -> list[str]:
    """Their names in history.csv."""
    return [f"energy_{name}" for name in (*ENERGIES, *(["stabilisation", "elastic"] if finite else []))]


def energy_row(step: Step) -> dict[str, float]:
    """A step's energies by these names, empty where there are none."""
    energy = step.energy
    if energy is None:
        return {}
    names = energy_columns(energy.elastic is not None)
    return {name: float(getattr(energy, name.removeprefix("energy_"))) for name in names}


def number(value: float) -> float | None:
    """A number, or None where there is none."""
    return float(value) if math.isfinite(value) else None


def vector(values: NDArray[np.float64]) -> list[float] | None:
    """Components, or None where there are none."""
    return values.tolist() if np.isfinite(values).all() else None


def more_columns(dim: int) -> list[str]:
    """Names of the last columns of history.csv, dim being 2 or 3."""
    axes, turns = "xyz"[:dim], "z" if dim == 2 else "xyz"
    return [
        *(f"max_pressure_{a}" for a in axes),
        "max_pressure_partly_covered",
        "mean_pressure",
        "pressure_percentile_95",
        "loaded_area",
        *(f"centre_{a}" for a in axes),
        *(f"contact_moment_{a}" for a in turns),
        "force_by_area",
    ]


def friction_columns(dim: int) -> list[str]:
    """Names of the very last columns of history.csv, where a contact has friction."""
    return [
        "sticking_area",
        "slipping_area",
        "friction_work",
        "total_friction_work",
        *(f"friction_force_{a}" for a in "xyz"[:dim]),
        "friction_force_by_area",
        "friction_force_limit",
        "largest_friction_share",
        "max_traction",
        "max_slip",
        "max_total_slip",
    ]


def more_values(contact: ContactResult) -> dict[str, float]:
    """Their values by name, nan where there is no number: readers of the columns before them take it for one."""
    s, r = contact.statistics, contact.resultant
    values = (*s.place, s.partly_covered, s.mean, s.percentile_95, s.area, *r.centre, *r.moment, contact.force_by_area)
    result = dict(zip(more_columns(contact.contactor.dim), map(float, values)))
    if contact.friction is not None:
        friction = contact.friction
        areas, work = (friction.sticking_area, friction.slipping_area), (friction.work, friction.total_work)
        forces = (*friction.force, friction.force_by_area, friction.force_limit, friction.largest_share)
        largest = (friction.max_traction, friction.max_slip, friction.max_total_slip)
        result |= dict(zip(friction_columns(contact.contactor.dim), map(float, (*areas, *work, *forces, *largest))))
    return result
