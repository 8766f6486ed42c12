"""Fits of second order to the gaps of dual functions at large sliding, theory (G15)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from tests.models.sheets import chain, sheet, turn

from abut.contact.bulge import with_bulge
from abut.contact.clearance import of_corners
from abut.contact.coupling import CouplingOptions, couple, surface_degree
from abut.contact.geometry import smoothing
from abut.mesh.surface import Surface
from abut.problem.gap_fit import MovedSides, Sight, fit_change

OPTIONS = CouplingOptions(reach=1.0)
CASES = {
    "plane": (
        chain("line3", 3, lambda s: [2.0 * s, 0.0 * s]),
        turn(chain("line3", 4, lambda s: [2.0 * s, 0.1 + 0.2 * s**2])),
    ),
    "space": (
        sheet("tri6", 2, lambda s, t: [s, t, 0.02 * s**2 - 0.05 * s * t], 0.0, 1),
        turn(sheet("quad8", 3, lambda s, t: [s, t, 0.1 + 0.1 * s**2 + 0.05 * t**2], 0.0, 1)),
    ),
    "bulging line": (
        with_bulge(chain("line2", 3, lambda s: [2.0 * s, 0.1 * s**2])),
        with_bulge(turn(chain("line2", 4, lambda s: [2.0 * s, 0.3 + 0.2 * s**2]))),
    ),
    "bulging sheet": (
        with_bulge(sheet("tri3", 3, lambda s, t: [s, t, 0.02 * s**2 - 0.05 * t**2], 0.0, 1)),
        with_bulge(turn(sheet("quad4", 4, lambda s, t: [s, t, 0.1 + 0.1 * s**2 + 0.05 * t**2], 0.0, 1))),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_at_the_outset_that_of_small_displacements(name: str) -> None:
    contactor, target = CASES[name]
    plain, fitted = (
        couple(contactor, target, 1, OPTIONS),
        couple(contactor, target, surface_degree(contactor), replace(OPTIONS, keep_gap_samples=True, keep_points=True)),
    )
    expected = of_corners(contactor, target, fitted).gap - plain.gap
    assert np.abs(expected).max() > 1e-5
    assert np.abs(_change(contactor, target, contactor, target) - expected).max() < 1e-13


@pytest.mark.parametrize("name", CASES)
def test_rigid_motions_change_nothing(name: str) -> None:
    contactor, target = CASES[name]
    at_rest = _change(contactor, target, contactor, target)
    assert np.abs(at_rest).max() > 1e-5
    rotation = Rotation.from_rotvec([0.3, 0.5, -0.7]).as_matrix() if contactor.dim == 3 else _plane(0.7)
    moved = [replace(side, points=side.points @ rotation.T + 3.0) for side in (contactor, target)]
    assert np.abs(_change(contactor, target, *moved) - at_rest).max() < 1e-9  # 3D: facets are cut to 1e-10


def _plane(angle: float) -> np.ndarray:
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def _change(contactor: Surface, target: Surface, contactor_now: Surface, target_now: Surface) -> np.ndarray:
    across = smoothing(contactor)
    sight = Sight.of(contactor_now, target_now, OPTIONS, across)
    return fit_change(MovedSides(contactor, target, contactor_now, target_now), sight, across, np.ones(len(contactor)))
