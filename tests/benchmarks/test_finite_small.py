"""Examples of small displacements with finite kinematics and tiny loads: the same pressures, at rest and carried about."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import abut
from abut.job.load import load_job

EXAMPLES = Path(__file__).parents[2] / "examples"
COARSE = {
    "two-blocks/job": [("[6, 6, 6]", "[3, 3, 2]"), ("[5, 5, 4]", "[2, 2, 2]")],
    "pushed-block/job": [
        ("[32, 8]", "[12, 3]"), ("[22, 10]", "[8, 4]"),
        # The plate, the coarser side now, has nodes under the block's edges: slides of 1e-8 would cover slivers of its next
        # facets, whose pressure functions the undeformed mesh does not have.
        ('surfaces = ["block.bottom", "plate.top"]', 'contactor = "block.bottom"\ntarget = "plate.top"'),
        ("0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0", "0.5, 1.0"),
    ],
    "hertz-line/quad4": [],
    "hertz-line/quad8": [("cells = 12", "cells = 4"), ("[24, 12]", "[8, 4]")],
    "hertz-sphere/job": [("cells = 16", "cells = 3")],
    "twisted-hub/job": [
        ("[1, 32, 10]", "[1, 32, 4]"), ("[2, 32, 6]", "[1, 32, 2]"),
        ("0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0", "0.5, 1.0"),
    ],
    "two-rings/job": [],
    "pin-lug/job": [('"pin-lug.msh"', f'"{(EXAMPLES / "pin-lug" / "pin-lug.msh").as_posix()}"')],
}  # fmt: skip
TINY = 1e-6  # of the loads: what is of second order in the displacements is about as much of the pressures
SAME = 2e-6
# gaps are known to rounding of the coordinates: the loads under which that does not count
ROUNDED = {"pin-lug/job": 1e-5, "two-rings/job": 1e-3, "twisted-hub/job": 1e-5}

# Small displacements have the normals between both sides, (R2), large ones those of the contactor, which under a load are
# the same, but not on the facet or two of round bodies that a tiny one presses together: by this angle over one of them, the
# share in (R2) * size / radius. Pressures differ by half of its square (4.9e-6, 1.1e-6 with 4, 8 cells; 2.5e-4, 8.9e-5
# with 3, 5).
LEANS = {"hertz-line/quad8": 0.25 * 2.0 / 50.0, "hertz-sphere/job": 0.5 * 1.1 / 3.0 / 8.0}

# without multipliers: rounding shakes those of the pin three times as much; nodes without a target follow others or have
# none
REPORTED = {"pin-lug/job", "two-rings/job"}


def example(name: str, folder: Path) -> abut.Model:
    """An example with a coarse mesh and tiny loads, both kinds of Hertz's with the complementarity law."""
    tiny = ROUNDED.get(name, TINY)
    text = (EXAMPLES / f"{name}.toml").read_text()
    for fine, coarse in COARSE[name]:
        assert fine in text
        text = text.replace(fine, coarse)
    (folder / "job.toml").write_text(text)
    model = load_job(folder / "job.toml").model
    supports = [replace(s, **{axis: getattr(s, axis) * tiny for axis in _axes(s)}) for s in model.supports]
    loads = [replace(load, value=(tiny * np.array(load.value)).tolist()) for load in model.loads]
    contacts = [replace(contact, law="complementarity", offset=tiny * contact.offset) for contact in model.contacts]
    rigid = [replace(body, rz=tiny * float(body.rz)) for body in model.rigid]
    return replace(model, supports=supports, loads=loads, contacts=contacts, rigid=rigid)


def _axes(support: abut.Support) -> list[str]:
    return [axis for axis in "xyz" if isinstance(getattr(support, axis), int | float)]


def with_pressure(model: abut.Model, pressure: str, kinematics: str, **contact: Any) -> abut.Model:
    contacts = [replace(c, pressure=pressure, **contact) for c in model.contacts]
    return replace(model, contacts=contacts, kinematics=kinematics)


def differences(small: abut.Model, large: abut.Model, reported: bool = False) -> float:
    """Of pressures and tractions over the largest pressure. reported: without multipliers."""
    results = [abut.solve(model).contacts[0] for model in (small, large)]
    top = np.nanmax(np.abs(results[0].multiplier))
    here, there = (8 * r.contactor.cells + r.contactor.local for r in results)  # small: facets that see the target
    order = np.argsort(there)
    rows = order[np.searchsorted(there, here, sorter=order)]
    assert np.array_equal(there[rows], here)
    assert not np.nan_to_num(np.delete(results[1].pressure, rows, axis=0)).any()
    pressures = [(results[0].pressure, results[1].pressure[rows])]
    if not reported:
        pressures.append((results[0].multiplier, results[1].multiplier[rows]))
    wrong = [np.nanmax(np.abs(one - other)) for one, other in pressures]
    if results[0].friction is not None and results[1].friction is not None:
        sizes = [np.linalg.norm(r.friction.traction, axis=-1) for r in results]
        wrong.append(np.nanmax(np.abs(sizes[0] - sizes[1])))
    return float(max(wrong) / top)


CASES = [
    ("two-blocks/job", "P1", {}), ("two-blocks/job", "dual", {"friction": 0.3}), ("pushed-block/job", "dual", {}),
    ("pushed-block/job", "P1", {"friction": 0.0}), ("hertz-line/quad4", "P1", {}), ("hertz-line/quad8", "P2", {}),
    ("hertz-line/quad8", "dual", {}), ("two-rings/job", "P2", {}),
    *((name, "dual-P1", {}) for name in COARSE if name not in ("pin-lug/job", "two-rings/job")),
    pytest.param("pin-lug/job", "dual-P1", {}, marks=pytest.mark.exhaustive),
]  # fmt: skip


@pytest.mark.long
@pytest.mark.parametrize(("name", "pressure", "contact"), CASES)
def test_same_pressures(name: str, pressure: str, contact: dict[str, Any], tmp_path: Path) -> None:
    model = example(name, tmp_path)
    small, large = (with_pressure(model, pressure, k, **contact) for k in ("small", "finite"))
    assert differences(small, large, reported=name in REPORTED) < SAME + LEANS.get(name, 0.0) ** 2 / 2.0


@pytest.mark.long
@pytest.mark.parametrize(("pressure", "friction", "angle"), [("P1", 0.0, 70.0), ("dual", 0.3, -40.0)])
def test_rigid_motions_change_nothing(pressure: str, friction: float, angle: float, tmp_path: Path) -> None:
    """Both blocks, held at a side each, pressed by a load that follows, and turned about a skew axis far away at once."""
    model = example("two-blocks/job", tmp_path)
    held, times = ("lower.bottom", "upper.right"), abut.SolveOptions(times=(0.25, 0.5, 0.75, 1.0))
    model = replace(
        with_pressure(model, pressure, "small", friction=friction), loads=[abut.Pressure("upper.top", 210e3 * TINY)],
        supports=[abut.Support(name, x=0.0, y=0.0, z=0.0) for name in held], solve=times,
    )  # fmt: skip
    turns = [
        abut.Rotation(name, angle=float(np.deg2rad(angle)), centre=(30.0, -10.0, 5.0), axis=(0.3, -0.8, 0.5))
        for name in held
    ]
    moved = replace(model, kinematics="finite", supports=[], rotations=turns)
    assert differences(model, moved) < SAME
