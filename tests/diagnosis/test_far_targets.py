"""Parts of the target's body that do not belong to the target are worth a warning only where they may touch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.diagnosis import check
from abut.mesh import make
from abut.mesh.exterior import exterior
from abut.mesh.mesh import CellBlock


def stepped(drop: int, gap: float = 0.0, down: float | None = None) -> abut.Model:
    """A block of 12 by 3 over a step: 6 wide at its height, and 6 wide ``drop`` below; only the upper level is the target.
    Cells of 2 (block) and 1 (step); the block is pressed down by a load, or moved ``down`` by supports."""
    cells, places = [], {}
    for i in range(12):
        for j in range(-6, 0 if i < 6 else -drop):
            corners = ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1))
            cells.append([places.setdefault(corner, len(places)) for corner in corners])
    upper = make.rectangle([0, 12], [gap, 3 + gap], cells=[6, 2], cell="quad4")
    block = CellBlock("quad4", np.array(cells, dtype=np.int32))
    step = abut.Mesh(np.array(list(places), dtype=float), (block,), {"step": np.arange(len(cells))})
    rows = exterior(step)
    middle = step.facets(rows).points[step.facets(rows).nodes[:, :2]].mean(axis=1)
    surfaces = {"level": rows[middle[:, 1] == 0.0], "bottom": rows[middle[:, 1] == -6.0]}
    mesh = make.join({"step": replace(step, surfaces=surfaces), "upper": upper})
    steel = abut.LinearElastic(210e3, 0.3)
    moved = [] if down is None else [abut.Support("upper.top", x=0, y=-down)]
    return abut.Model(
        mesh, plane="strain", solids=[abut.Solid(body, steel) for body in ("step", "upper")],
        supports=[abut.Support("step.bottom", x=0, y=0), abut.Support("upper.left", x=0), *moved],
        loads=[abut.Pressure("upper.top", 1.0)] if down is None else [],
        contacts=[abut.Contact(contactor="upper.bottom", target="step.level", name="c")],
    )  # fmt: skip


def too_small(model: abut.Model) -> list[str]:
    return [f.what for f in check(model).findings if "too small" in f.what]


@pytest.mark.parametrize("gap", [0.0, 0.5])
def test_a_level_far_below_is_not_missing_from_the_target(gap: float) -> None:
    """3 below, within the reach of two facets, but beyond half a facet from where the bodies touch first."""
    assert not too_small(stepped(3, gap))


def test_what_supports_move_bodies_to_is() -> None:
    """The lower level is reached by a motion of 3.1, not by one of 2.9."""
    assert not too_small(stepped(3, down=2.9))
    (what,) = too_small(stepped(3, down=3.1))
    assert what.startswith("target 'step.level' is too small: 50% of contactor 'upper.bottom'")
    assert "do not belong to it" in what


def test_a_level_as_high_as_the_target_is() -> None:
    """Nothing below: half of the contactor lies on what was not named."""
    model = stepped(0)
    half = model.mesh.surfaces["step.level"][:6]
    mesh = replace(model.mesh, surfaces={**model.mesh.surfaces, "step.level": half})
    (what,) = too_small(replace(model, mesh=mesh))
    assert "50% of contactor" in what
