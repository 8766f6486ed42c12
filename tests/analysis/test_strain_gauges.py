"""Equations for the stress along a surface from its own strain: theory (Z9)."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.analysis.strain_gauges import gauges
from abut.bodies.solids import Solids
from abut.bodies.stress import point_stress
from abut.cells import CELLS
from abut.mesh.make import box, rectangle

NU = 0.3


@pytest.mark.parametrize("plane", ["strain", "stress", "axisymmetric", None])
@pytest.mark.parametrize("simplex", [False, True])
def test_wrong_strains_across_do_not_count(plane: str | None, simplex: bool) -> None:
    """Strains along the top are those of its nodes: it is moved up by any heights that are the same all over, so that the
    cells' stresses are wrong by what these strain them, and the gauges, told the true pressure, say Hooke's law for the
    strain along the surface: sigma_aa = E / (1 - nu^2) (e_aa + nu e_bb) + k sigma_nn."""
    kind = {False: ("quad4", "hex8"), True: ("tri3", "tet4")}[simplex][plane is None]
    mesh = box((0, 2), (0, 2), (0, 2), (2, 2, 2), kind) if plane is None else rectangle((1, 3), (0, 2), (2, 2), kind)
    mesh = replace(mesh, axisymmetric=plane == "axisymmetric")
    young, up = 10.0, mesh.dim - 1
    solids = Solids(mesh, dict.fromkeys(mesh.bodies, abut.LinearElastic(young, NU)), plane if mesh.dim == 2 else None)
    moved = mesh.points * np.array([0.01, 0.0, 0.0][: mesh.dim])
    moved[:, up] += 0.1 * (mesh.points[:, up] > 1.5)
    top = mesh.surface("top")
    traction = np.zeros((len(top), mesh.dim))
    traction[:, up] = -3.0
    found = gauges(solids, top, point_stress(solids, moved), np.ones(len(top), dtype=bool), traction)
    hoop = 0.01 if plane == "axisymmetric" else 0.0  # u = 0.01 r
    plate, back = young / (1 - NU**2), NU / (1 - NU) * -3.0
    exact = np.zeros(6)
    exact[0], exact[2 - (mesh.dim == 3)] = plate * (0.01 + NU * hoop) + back, plate * (hoop + NU * 0.01) + back
    if plane == "stress":
        exact[[0, 2]] = young * 0.01 + NU * -3.0, 0.0
    told = (found.coefficients * exact[: found.coefficients.shape[1]]).sum(axis=1)
    assert found.value == pytest.approx(told, abs=1e-12)
    assert len(found.value) == len(top) * {"stress": 1, "strain": 2, "axisymmetric": 2, None: 3}[plane]
    assert CELLS[kind].degree == 1


def test_only_where_it_holds() -> None:
    """Cells of second order, and facets whose traction is not known, have none."""
    for kind, known in (("quad8", True), ("quad4", False)):
        mesh = rectangle((0, 1), (0, 1), (2, 2), kind)
        solids = Solids(mesh, dict.fromkeys(mesh.bodies, abut.LinearElastic(1.0, NU)), "strain")
        top = mesh.surface("top")
        found = gauges(
            solids, top, point_stress(solids, 0.01 * mesh.points), np.full(len(top), known), np.zeros((2, 2))
        )
        assert len(found.value) == 0
