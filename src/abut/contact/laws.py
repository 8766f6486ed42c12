"""Contact laws: residual and derivatives from gap and pressure; Newton does the rest.

Each law states its residual r(u, p) with p the pressure coefficients of one pair; the solver finds
K u - B^T p = f, theory (F6), together with r = 0. Signs: gap >= 0 open, pressure >= 0 compressive, theory (F2).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

TENSION = 30.0  # how much more a point in tension counts than one in compression
TENSION_START = 1e-3  # of the largest pressure: tension below it counts less, lest Newton chases the last ripples


@dataclass(frozen=True)
class Linearisation:
    """A law near the present state, for one pair.

    residual: (n,); active: (n,) bool, multipliers in contact; by_gap: (n, n_gaps) sparse, derivative by the gaps that the
    law looks at; by_pressure: (n, n) sparse, derivative by the pressure coefficients.
    at_points: the gaps are those at the integration points, else the n weighted ones;
    ``decoupled``: (n,) bool, rows that hold nothing but their own pressure.
    """

    residual: NDArray[np.float64]
    active: NDArray[np.bool_]
    by_gap: Any
    by_pressure: Any
    at_points: bool
    decoupled: NDArray[np.bool_]


def linearise_active(
    gap: NDArray[np.float64], pressure: NDArray[np.float64], active: NDArray[np.bool_], scale: NDArray[np.float64]
) -> Linearisation:
    """Complementarity with a given active set: weighted gap = 0 where active, pressure = 0 elsewhere; theory (L3).

    gap: (n,) weighted gap int H_k g; scale: (n,) gap per pressure, theory (L2), which gives both rows the same unit.
    The semi-smooth Newton derivative of min(gap, scale * pressure), theory (L1), is just this (Hintermueller, Ito and
    Kunisch 2002).
    """
    on = active.astype(float)
    return Linearisation(
        residual=np.where(active, -gap, -scale * pressure),
        active=active,
        by_gap=sp.diags(-on, format="csr"),
        by_pressure=sp.diags((on - 1.0) * scale, format="csr"),
        at_points=False,
        decoupled=~active,
    )


def linearise_interior(
    gap: NDArray[np.float64], shift: NDArray[np.float64], softness: NDArray[np.float64], active: NDArray[np.bool_]
) -> Linearisation:
    """Contact made soft: gap + d gap + softness d pressure = shift, theory (V18).

    gap, shift: (n,) weighted gaps; softness: (n,) gap per pressure, positive, or zero where a gap is to close."""
    n = len(gap)
    return Linearisation(
        residual=shift - gap,
        active=active,
        by_gap=-sp.identity(n, format="csr"),
        by_pressure=sp.diags(-softness, format="csr"),
        at_points=False,
        decoupled=np.zeros(n, dtype=bool),
    )


def constraint_function(
    gap: NDArray[np.float64], pressure: NDArray[np.float64], epsilon: float
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """w(g, l) = (g + l)/2 - sqrt(((g - l)/2)^2 + eps) and its derivatives by g and by l (paper, section 3).

    w = 0 means g l = eps with g, l > 0; eps -> 0 gives min(g, l). Both arguments in the same unit.
    Function and derivatives: theory (L4), (L5).
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
    gap: NDArray[np.float64],
    coefficients: NDArray[np.float64],
    stiffness: NDArray[np.float64],
    epsilon: float,
    reference: float,
    tension: float = TENSION_START,
) -> Linearisation:
    """int H_k (w(c g, l) + TENSION t(l)) = 0, evaluated at the integration points: theory (L6) (paper, eq. 21).

    test: (n_points, n) values of the pressure functions at the integration points; weight, gap: (n_points,);
    coefficients: (n,) of the pressure l;
    stiffness c: (n_points,) pressure per length, puts the gap on the scale of the pressure;
    reference: the largest pressure, to which epsilon is relative; tension: share of it below which tension counts less.
    The second term, t(l) = min(l, 0) but for a smooth start, theory (L7), is not in the paper: behind the edge of
    contact w = l, and zero means against every H_k leave room for a pressure that swings about zero.
    """
    pressure = test @ coefficients
    value, by_gap, by_pressure = constraint_function(stiffness * gap, pressure, epsilon * reference**2)
    width = tension * reference
    pull = np.minimum(pressure, 0.0)
    value = value + TENSION * np.where(pull > -width, -0.5 * pull**2 / width, pull + 0.5 * width)
    by_pressure = by_pressure + TENSION * np.minimum(-pull / width, 1.0)
    weighted = (test.T @ sp.diags(weight)).tocsr()
    closed = (pressure > stiffness * gap) & (pressure > 0.0)
    return Linearisation(
        residual=weighted @ value,
        active=np.asarray(weighted @ (closed - 0.5)) > 0.0,
        by_gap=(weighted @ sp.diags(stiffness * by_gap)).tocsr(),
        by_pressure=(weighted @ sp.diags(by_pressure) @ test).tocsr(),
        at_points=True,
        decoupled=np.zeros(len(coefficients), dtype=bool),
    )
