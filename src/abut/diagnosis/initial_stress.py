"""Stress that bodies have before anything moves, as `abut check` tells it."""

from __future__ import annotations

from abut.diagnosis.finding import Finding, from_error
from abut.errors import InputError
from abut.materials.prestressed import NAMES, Prestressed
from abut.model import Model


def initial_stress(model: Model) -> list[Finding]:
    """A line for each body that has one: its components that are not zero, at the nodes of the body; or why it has no
    value there."""
    found = []
    for solid in model.solids:
        law = solid.law
        if not isinstance(law, Prestressed):
            continue
        try:
            held = law.held(model.mesh.points[model.mesh.nodes_of(solid.body)])
        except InputError as error:
            found.append(from_error(error, f"body '{solid.body}'"))
            continue
        ends = zip(NAMES[model.dim], held.min(axis=0), held.max(axis=0))
        parts = [f"{name} {_between(low, high)}" for name, low, high in ends if low or high]
        found.append(Finding("info", f"body '{solid.body}'", f"initial stress {', '.join(parts) or 'zero'}"))
    return found


def _between(low: float, high: float) -> str:
    return f"{low:.6g}" if low == high else f"{low:.6g} to {high:.6g}"
