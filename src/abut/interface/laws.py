"""Contact laws: residual and derivatives from gap and pressure; Newton does the rest.

Each law states its residual r(u, p) with p the pressure coefficients of one pair; the solver finds
K u - B^T p = f together with r = 0. Signs: gap >= 0 open, pressure >= 0 compressive.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray


@dataclass(frozen=True)
class Linearisation:
    """residual: (n,); active: (n,) bool; by_displacement (n, n_u) and by_pressure (n, n): sparse derivatives.

    ``symmetric``: by_displacement is minus the active rows of the operator and the inactive pressures are decoupled, so
    that the solver may use a symmetric factorisation.
    """

    residual: NDArray[np.float64]
    active: NDArray[np.bool_]
    by_displacement: Any
    by_pressure: Any
    symmetric: bool


def linearise_active(
    operator: Any,
    gap: NDArray[np.float64],
    pressure: NDArray[np.float64],
    active: NDArray[np.bool_],
    scale: NDArray[np.float64],
) -> Linearisation:
    """Complementarity with a given active set: weighted gap = 0 where active, pressure = 0 elsewhere.

    gap: (n,) weighted gap int H_k g; scale: (n,) gap per pressure, which gives both rows the same unit.
    The semi-smooth Newton derivative of min(gap, scale * pressure) is just this (Hintermueller, Ito and Kunisch 2002).
    """
    on = active.astype(float)
    rows = operator.copy()
    rows.data = rows.data * np.repeat(-on, np.diff(rows.indptr))
    n = len(active)
    diagonal = sp.csr_matrix((-(1.0 - on) * scale, np.arange(n), np.arange(n + 1)), shape=(n, n))
    return Linearisation(np.where(active, -gap, -scale * pressure), active, rows, diagonal, True)


def constraint_function(
    gap: NDArray[np.float64], pressure: NDArray[np.float64], epsilon: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """w(g, l) = (g + l)/2 - sqrt(((g - l)/2)^2 + eps) and its derivatives by g and by l (paper, section 3).

    w = 0 means g l = eps with g, l > 0; eps -> 0 gives min(g, l). Both arguments in the same unit.
    """
    half = 0.5 * (gap - pressure)
    root = np.sqrt(half * half + epsilon)
    slope = half / root
    # min + a term that stays accurate where |half| >> sqrt(eps) and the difference would cancel
    value = np.minimum(gap, pressure) - epsilon / (root + np.abs(half))
    return value, 0.5 * (1.0 - slope), 0.5 * (1.0 + slope)


def linearise_constraint_function(
    test: Any,
    weight: NDArray[np.float64],
    gap_operator: Any,
    gap: NDArray[np.float64],
    pressure: NDArray[np.float64],
    stiffness: float,
    epsilon: float,
) -> Linearisation:
    """int H_k w(c g, l) = 0, with w evaluated at the integration points (paper, eq. 21).

    test: (n_points, n) values of the pressure functions at the integration points; weight, gap, pressure: (n_points,);
    gap_operator: (n_points, n_u); stiffness c: pressure per length, puts the gap on the scale of the pressure.
    """
    value, by_gap, by_pressure = constraint_function(stiffness * gap, pressure, epsilon)
    weighted = (test.T @ sp.diags(weight)).tocsr()
    return Linearisation(
        residual=weighted @ value,
        active=np.asarray(weighted @ (pressure > stiffness * gap).astype(float)) > 0.0,
        by_displacement=(weighted @ sp.diags(stiffness * by_gap) @ gap_operator).tocsr(),
        by_pressure=(weighted @ sp.diags(by_pressure) @ test).tocsr(),
        symmetric=False,
    )
