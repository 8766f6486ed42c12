"""Toothed bodies: what is seen through a tooth is no overlap in `check`, and no contact in a run."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.diagnosis import check
from abut.mesh.exterior import exterior
from abut.mesh.mesh import CellBlock

TEETH, PITCH, BACK, HIGH = 10, 6, 2, 4
GAP = 6e-4


def rack(first: int) -> tuple[np.ndarray, np.ndarray]:
    """Unit squares: a back BACK high with teeth 2 wide and HIGH high that begin at ``first`` of each pitch."""
    places: dict[tuple[int, int], int] = {}
    cells = []
    for i in range(TEETH * PITCH):
        for j in range(-BACK, HIGH if first <= i % PITCH < first + 2 else 0):
            corners = ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))
            cells.append([places.setdefault(corner, len(places)) for corner in corners])
    return np.array(list(places), dtype=float), np.array(cells, dtype=np.int32)


def racks() -> abut.Model:
    """Flanks GAP apart; the contactor's first left flank has no tooth before it, only the far flank of the next one, two
    teeth of 2 behind it."""
    (x, lower), (y, upper) = rack(1), rack(3)
    y = np.column_stack([y[:, 0] + GAP, HIGH + 0.5 - y[:, 1]])
    cells = np.concatenate([lower, upper[:, ::-1] + len(x)]).astype(np.int32)
    bodies = {"lower": np.arange(len(lower)), "upper": np.arange(len(lower), len(cells))}
    mesh = abut.Mesh(np.concatenate([x, y]), (CellBlock("quad4", cells),), bodies)
    rows = exterior(mesh)
    facets = mesh.facets(rows)
    middle = facets.points[facets.nodes[:, :2]].mean(axis=1)
    low, inside = np.isin(rows[:, 0], bodies["lower"]), np.abs(middle[:, 0] - 30.0) < 29.9
    surfaces = {
        "lower.teeth": rows[low & inside & (middle[:, 1] > -1)], "upper.teeth": rows[~low & inside & (middle[:, 1] < 5)],
        "lower.bottom": rows[low & (middle[:, 1] < -1.99)], "upper.top": rows[~low & (middle[:, 1] > 6.4)],
    }  # fmt: skip
    material = abut.LinearElastic(1000.0, 0.3)
    return abut.Model(
        replace(mesh, surfaces=surfaces), plane="strain",
        solids=[abut.Solid(body, material) for body in bodies],
        supports=[abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=-0.01, y=0)],
        contacts=[abut.Contact("lower.teeth", "upper.teeth", name="teeth")],
    )  # fmt: skip


def test_flanks_behind_a_tooth_are_no_overlap() -> None:
    found = [f.what for f in check(racks()).findings if f.where == "contact 'teeth'"]
    assert not [what for what in found if "overlap" in what]
    assert any(what.startswith("gap 0.0006 to") for what in found)


def test_flanks_behind_a_tooth_do_not_touch() -> None:
    """Displacements are small: with both kinematics the upper teeth push the lower ones by the same force along x alone."""
    small, finite = (
        abut.solve(replace(racks(), kinematics=kinematics)).contacts[0].force for kinematics in ("small", "finite")
    )
    assert small[0] == pytest.approx(finite[0], rel=1e-3)
    assert abs(small[1]) < 1e-9 * abs(small[0])
