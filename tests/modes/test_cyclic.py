"""Vibrations with nodal diameters, found on one sector, against those of the whole ring."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.mesh import make
from abut.mesh.mesh import Mesh

STEEL = abut.LinearElastic(210e3, 0.3, density=7.85e-9)
SECTORS = 6
SAME = 1e-7  # of a square of a frequency: the whole ring's Lanczos tolerance, 1e-10 of a Ritz value, and rounding


def ring(degrees: float, cells: int) -> Mesh:
    """An inner and an outer ring, or a part of them, one around the other, with unlike meshes along the axis."""
    parts = {}
    for name, radii, layers in (("inner", (1.0, 1.5), 1), ("outer", (1.5, 2.0), 2)):
        flat = make.box(radii, (0.0, degrees), (0.0, 0.6), (1, cells, layers), "hex8")
        r, turn = flat.points[:, 0], np.deg2rad(flat.points[:, 1])
        parts[name] = replace(flat, points=np.column_stack([r * np.cos(turn), r * np.sin(turn), flat.points[:, 2]]))
    return make.join(parts)


def model(degrees: float, cells: int, kinematics: str, wanted: abut.Frequencies, load: float) -> abut.Model:
    """Pressed from outside, held at its bore; the seam's sides are joined, turned by ``degrees``."""
    mesh = ring(degrees, cells)
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    sets = dict(mesh.node_sets)
    equations: list[abut.Equation] = []
    sides: list[int] = []
    for body in ("inner", "outer"):
        first, last = (mesh.nodes_of(f"{body}.{side}") for side in ("front", "back"))
        first, last = np.unique(first), np.unique(last)
        held = body == "inner"
        for node in last.tolist():
            near = np.linalg.norm(mesh.points[first] @ turn.T - mesh.points[node], axis=1)
            partner = int(first[near.argmin()])
            assert near.min() < 1e-9
            if held and np.linalg.norm(mesh.points[node][:2]) < 1.01:
                continue  # held at the bore
            sides.append(node)
            for k in range(3):
                terms = [abut.Term(node, "xyz"[k], 1.0)]
                terms += [abut.Term(partner, "xyz"[j], -turn[k, j]) for j in range(3) if abs(turn[k, j]) > 1e-15]
                equations.append(abut.Equation(terms))
    sets["last"] = np.array(sides)
    return abut.Model(
        replace(mesh, node_sets=sets), solids=[abut.Solid("inner", STEEL), abut.Solid("outer", STEEL)],
        supports=[abut.Support("inner.left", x=0, y=0, z=0)], equations=equations, kinematics=kinematics,
        contacts=[abut.Contact("outer.left", "inner.right", kind="tied")],
        loads=[abut.Pressure("outer.right", load)], modes=[wanted],
    )  # fmt: skip


@pytest.mark.parametrize(("kinematics", "load"), [("small", 0.0), ("small", 2000.0), ("finite", 2000.0)])
def test_all_diameters_make_up_the_whole_ring(kinematics: str, load: float) -> None:
    """Bloch's theorem: each vibration of the ring has a nodal diameter. Those of 1 and 2 come twice there, as here; that of
    half the sectors comes once there, and twice here."""
    count = 12
    whole = abut.solve(model(360.0, 3 * SECTORS, kinematics, abut.Frequencies(count), load)).modes[0]
    wanted = abut.Frequencies(count, diameters=range(4), sectors=SECTORS, side="last")
    parts = abut.solve(model(360.0 / SECTORS, 3, kinematics, wanted, load)).modes
    assert [part.diameter for part in parts] == [0, 1, 2, 3]
    assert all(part.missing == 0 and all(check.passed for check in part.certificate) for part in parts)
    for part in parts[1:]:
        np.testing.assert_allclose(part.eigenvalues[::2], part.eigenvalues[1::2], rtol=SAME)
    together = np.concatenate(
        [parts[0].eigenvalues, parts[1].eigenvalues, parts[2].eigenvalues, parts[3].eigenvalues[::2]]
    )
    np.testing.assert_allclose(np.sort(together)[:count], whole.eigenvalues, rtol=SAME)


def test_the_next_side_is_a_phase_behind() -> None:
    """Real and imaginary parts on the side are those of the other, turned by the sector and by the phase."""
    wanted = abut.Frequencies(4, diameters=(2,), sectors=SECTORS, side="last")
    asked = model(360.0 / SECTORS, 3, "small", wanted, 0.0)
    result = abut.solve(asked).modes[0]
    shape = result.shapes[0] + 1j * result.imaginary[0]
    for equation in asked.equations[::3]:
        node, partner = int(equation.terms[0].on), int(equation.terms[1].on)
        angle = 2.0 * np.pi / SECTORS
        turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
        np.testing.assert_allclose(
            shape[node], np.exp(2j * angle) * (turn @ shape[partner]), atol=1e-9 * np.abs(shape).max()
        )


@pytest.mark.parametrize(
    ("wanted", "said"),
    [
        ({"diameters": (1,)}, "nodal diameters need sectors"),
        ({"diameters": (4,), "sectors": 6, "side": "last"}, "expected whole numbers from 0 to 3"),
        ({"diameters": (1,), "sectors": 6, "side": "last", "complex": True}, "nodal diameter 0"),
    ],
)
def test_what_is_no_diameter_is_refused(wanted: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        abut.Frequencies(3, **wanted)  # type: ignore[arg-type]


@pytest.mark.parametrize(("side", "said"), [("lost", "no node set named 'lost'"), ("all", "no equation joins nodes")])
def test_a_side_that_joins_nothing_is_refused(side: str, said: str) -> None:
    wanted = abut.Frequencies(3, diameters=(1,), sectors=SECTORS, side=side)
    asked = model(360.0 / SECTORS, 2, "small", wanted, 0.0)
    every = {**asked.mesh.node_sets, "all": np.arange(len(asked.mesh.points))}
    with pytest.raises(InputError, match=said):
        abut.solve(replace(asked, mesh=replace(asked.mesh, node_sets=every)))
