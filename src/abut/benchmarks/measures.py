"""Quantities that several benchmarks measure."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from abut.fields import Field
from abut.solution import ContactResult, Solution

Where = Callable[[NDArray[np.float64]], NDArray[np.bool_]]  # points (n, dim) -> (n,)


def contact_points(contact: ContactResult) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Nodes of all covered contactor facets (n, dim), facet by facet, and the pressure there (n,)."""
    used = (contact.contactor.nodes >= 0) & contact.covered[:, None]
    return contact.contactor.points[contact.contactor.nodes[used]], contact.pressure[used]


def pressure_error(solution: Solution, exact: Field, where: Where | None = None) -> float:
    """Largest difference from ``exact(points)`` at the contactor's nodes (those for which ``where`` is true)."""
    x, p = contact_points(solution.contacts[0])
    inside = np.ones(len(x), dtype=bool) if where is None else where(x)
    return float(np.abs(p - exact(x))[inside].max())


def displacement_error(solution: Solution, exact: Field) -> float:
    """Largest nodal difference from ``exact(points)``, over the largest exact displacement."""
    wanted = exact(solution.model.mesh.points)
    return float(np.abs(solution.displacement - wanted).max() / np.abs(wanted).max())
