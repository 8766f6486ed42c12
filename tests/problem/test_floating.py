"""Bodies that nothing but contact holds: loose ones rest, held ones are held, and those that loads pull off are named."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.linear import static_condensation
from abut.mesh import make

STEEL = abut.LinearElastic(1000.0, 0.3)


def bearing(load: float) -> abut.Model:
    """Half of two rollers between plates, the second one smaller by 0.01: ``load`` presses the first one, nothing the
    other, which lies loose."""
    mesh = make.join(
        {
            "lower": make.rectangle(x=[-1, 4], y=[-0.5, 0], cells=[40, 2], cell="quad4"),
            "upper": make.rectangle(x=[-1, 4], y=[2, 2.5], cells=[38, 2], cell="quad4"),
            "roller": make.disc(radius=1.0, centre=[0, 1], cells=3, fine=0.3, cell="quad4"),
            "loose": make.disc(radius=0.99, centre=[2.6, 1.0], cells=3, fine=0.3, cell="quad4"),
        }
    )
    above = {}
    for name in ("roller", "loose"):
        rows = mesh.surfaces[f"{name}.round"]
        high = mesh.points[mesh.facets(rows).nodes[:, :2], 1].mean(axis=1) > 1.0
        above |= {f"{name}.above": rows[high], f"{name}.below": rows[~high]}
    return abut.Model(
        replace(mesh, surfaces={**mesh.surfaces, **above}),
        [abut.Solid(body, STEEL) for body in mesh.bodies],
        [
            abut.Support("lower.bottom", x=0, y=0),
            abut.Support("upper.left", x=0),
            abut.Support("roller.axis", x=0),
            abut.Support("loose.axis", x=0),
        ],
        [abut.Force("upper.top", (0.0, -load))],
        [
            abut.Contact(contactor=f"{name}.{side}", target=plate, name=f"{name} {side}")
            for name in ("roller", "loose")
            for side, plate in (("above", "upper.bottom"), ("below", "lower.top"))
        ],
        plane="strain",
    )


@pytest.mark.parametrize("path", ["condensed", "sparse", "amg"])
def test_a_loose_roller_rests(path: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """No pressure on it; it stays within its clearance and strains nowhere, and the others do as if it was not there."""
    if path == "sparse":
        monkeypatch.setattr(static_condensation, "LARGEST", 0)
    model = replace(bearing(1e-3), solve=abut.SolveOptions(linear="amg" if path == "amg" else "auto"))
    solution = abut.solve(model)
    assert solution.converged
    found = {contact.name: contact for contact in solution.contacts}
    assert found["roller below"].force[1] == pytest.approx(-found["roller above"].force[1], rel=1e-6)
    assert abs(found["roller above"].force[1]) == pytest.approx(1e-3, rel=1e-6)
    assert [found[f"loose {side}"].active for side in ("above", "below")] == [0, 0]
    own = solution.displacement[model.mesh.nodes_of("loose")]
    assert np.abs(own).max() < 0.02
    assert np.ptp(own, axis=0).max() < 1e-9  # as a whole


def test_a_second_load_presses_it() -> None:
    """Once the plates have come near enough, it carries a share."""
    solution = abut.solve(bearing(30.0))
    found = {contact.name: contact for contact in solution.contacts}
    share = found["loose below"].force[1]
    assert abs(share) > 0.1
    assert share == pytest.approx(-found["loose above"].force[1], rel=1e-9)
    assert found["roller below"].force[1] + share == pytest.approx(30.0, rel=1e-9)


def block(*loads: abut.Force) -> abut.Model:
    """A box on a plate, held against sliding and turning on the spot by a corner and an edge."""
    mesh = make.join(
        {
            "plate": make.box(x=[-1, 3], y=[-1, 3], z=[-1, 0], cells=[4, 4, 1]),
            "box": make.box(x=[0, 2], y=[0, 2], z=[0, 1], cells=[3, 3, 2]),
        }
    )
    own = mesh.nodes_of("box")
    sets = {
        name: own[np.abs(mesh.points[own] - at).max(axis=1) < 1e-9]
        for name, at in (("corner", (0, 0, 0)), ("other", (2, 0, 0)))
    }
    return abut.Model(
        replace(mesh, node_sets=sets),
        [abut.Solid("plate", STEEL), abut.Solid("box", STEEL)],
        [abut.Support("plate.bottom", x=0, y=0, z=0), abut.Support("corner", x=0, y=0), abut.Support("other", y=0)],
        loads,
        [abut.Contact(contactor="box.bottom", target="plate.top")],
    )


DOWN = abut.Force("box.top", (0.0, 0.0, -10.0))


@pytest.mark.parametrize("linear", ["direct", "amg"])
@pytest.mark.parametrize(
    ("lift", "motion"),
    [
        (abut.Force("box.top", (0.0, 0.0, 10.1)), "translate along z"),
        (abut.Force("box.right", (0.0, 0.0, 5.05)), "(translate|rotate)"),  # half the weight over the left edge
    ],
)
def test_what_loads_pull_off_is_named(lift: abut.Force, motion: str, linear: str) -> None:
    """By statics: a hundredth more than it takes to lift or to turn over is an error that says what goes where, a
    hundredth less converges."""
    model = replace(block(DOWN, lift), solve=abut.SolveOptions(linear=linear))
    with pytest.raises(
        abut.SingularModelError, match=rf"body 'box' is free to {motion}.*: the loads pull it off its contact"
    ):
        abut.solve(model)
    less = abut.Force(lift.on, tuple(v * 0.99 / 1.01 for v in lift.value))
    solution = abut.solve(replace(model, loads=[DOWN, less]))
    assert solution.converged
    assert solution.contacts[0].force[2] == pytest.approx(10.0 - less.value[2], rel=1e-6)
