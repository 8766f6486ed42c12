"""Contactors of several bodies that are glued to each other: one pressure along the seam."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.contact.glued_seams import one_place
from abut.mesh import make
from models.seams import hubs, lame

STEEL = abut.LinearElastic(210e3, 0.3)
Fields = tuple[np.ndarray, np.ndarray, abut.Solution]


def plane(split: bool, cell: str, apart: bool = False, **more: object) -> Fields:
    """A rounded punch on a block, or on two glued side by side: points of the contact and pressures. apart: a contact
    each."""
    parts = {
        name: make.rectangle(x, (-8, 0), cells=(20 * (2 - split), 24), cell=cell)
        for name, x in ({"left": (-6, 0), "right": (0, 6)} if split else {"block": (-6, 6)}).items()
    }
    blocks = list(parts)
    punch = make.rectangle((-5.987, 6.013), (0, 8), cells=(60, 24), cell=cell)
    x, y = punch.points.T
    parts["punch"] = replace(punch, points=np.stack([x, y + (1 - y / 8) * (x - 0.4) ** 2 / 200], axis=1))
    tops = [f"{b}.top" for b in blocks]
    contacts = [abut.Contact(contactor=t, target="punch.bottom") for t in (tops if apart else [tops])]
    if split:
        contacts.append(abut.Contact("left.right", "right.left", kind="tied"))
    return pressed(make.join(parts), blocks, contacts, {"x": 0.0, "y": -0.02}, plane="strain", **more)


def solid(split: bool, cell: str, along: tuple[int, int] = (7, 7), friction: float = 0.0, **more: object) -> Fields:
    """The same in space. along: cells of both blocks along the seam."""
    limits = {"left": (-2, 0), "right": (0, 2)} if split else {"block": (-2, 2)}
    parts = {
        name: make.box(x, (-1.5, 1.5), (-2, 0), cells=(9 * (2 - split), n, 4), cell=cell)
        for (name, x), n in zip(limits.items(), along)
    }
    blocks = list(parts)
    punch = make.box((-1.97, 2.03), (-1.5, 1.5), (0, 2), cells=(26, 20, 4), cell=cell)
    x, y, z = punch.points.T
    parts["punch"] = replace(
        punch, points=np.stack([x, y, z + (1 - z / 2) * ((x - 0.3) ** 2 + (y - 0.1) ** 2) / 60], axis=1)
    )
    contacts = [abut.Contact(contactor=[f"{b}.top" for b in blocks], target="punch.bottom", friction=friction)]
    if split:
        contacts.append(abut.Contact("left.right", "right.left", kind="tied"))
    move = {"x": 0.004 if friction else 0.0, "y": 0.0, "z": -0.03}
    return pressed(make.join(parts), blocks, contacts, move, **more)


def pressed(mesh: abut.Mesh, blocks: list[str], contacts: list, move: dict, **more: object) -> Fields:
    held = [abut.Support(f"{b}.bottom", **dict.fromkeys(move, 0.0)) for b in blocks]
    solids = [abut.Solid(body, STEEL) for body in mesh.bodies]
    solution = abut.solve(
        abut.Model(mesh, solids, [*held, abut.Support("punch.top", **move)], contacts=contacts, **more)
    )
    given = [c for c in solution.contacts if "punch" in c.name]
    points = np.concatenate([mesh.points[c.nodes] for c in given])
    return points, np.concatenate([c.nodal_pressure for c in given]), solution


def worst(two: Fields, one: Fields) -> tuple[float, float]:
    """Largest difference of the pressures over the largest, at the seam and elsewhere, at points that both have."""
    at, pressure, _ = two
    apart = np.linalg.norm(at[:, None] - one[0][None], axis=2)
    same = apart.argmin(axis=1)
    seam = np.abs(at[:, 0]) < 1e-9
    error = np.where(apart.min(axis=1) < 1e-9, np.abs(pressure - one[1][same]) / one[1].max(), 0.0)
    return float(error[seam].max()), float(error[~seam].max())


@pytest.mark.parametrize(("cell", "limit"), [("quad4", 1e-4), ("quad8", 0.02), ("tri3", 0.02)])
def test_two_blocks_glued_are_one(cell: str, limit: float) -> None:
    """On matching meshes a tie holds both sides as one body does, so that the pressures are that body's: with quad4, whose
    nodal averages do not ask what is beside; quad8 and tri3 take off what averaging does from one side at the seam."""
    two, one = plane(True, cell), plane(False, cell)
    assert max(worst(two, one)) < limit
    assert two[2].contacts[0].force[1] == pytest.approx(one[2].contacts[0].force[1], rel=1e-4)


@pytest.mark.parametrize(
    ("cell", "more", "limit"),
    [
        ("hex8", {}, 1e-3),
        ("hex8", {"friction": 0.3}, 1e-3),
        ("tet4", {"friction": 0.3}, 2e-3),
    ],
)
def test_seams_in_space(cell: str, more: dict, limit: float) -> None:
    """The same; without friction the stresses that mend pressures of tet4 would end at the seam."""
    assert max(worst(solid(True, cell, **more), solid(False, cell, **more))) < limit


def test_seams_at_large_displacements() -> None:
    """The same but for the normals of linear facets, which end at the seam."""
    assert max(worst(*(plane(split, "quad4", kinematics="finite") for split in (True, False)))) < 0.03


def test_seams_of_unlike_meshes() -> None:
    """Seven cells along the seam meet eleven: beside one block with eleven all over, at its points, no more at the seam than
    linear pressures between seven differ by."""
    seam, elsewhere = worst(solid(True, "hex8", (7, 11)), solid(False, "hex8", (11, 11)))
    assert elsewhere < 0.02
    assert seam < 0.05


def test_seams_on_a_curve() -> None:
    """Two hubs of hex8 glued end to end, 16 and 24 cells round, on a shaft ten times as stiff: Lame's pressure. Points of
    one side lie off the edges of the other by the sagitta of these, a twentieth of their length, and the tie's faces do not
    meet either (6 % there; 0 to 2.3 times the pressure where each side has its own)."""
    pressure = abut.solve(hubs((16, 24))).contacts[0].nodal_pressure
    assert np.abs(pressure / lame() - 1.0).max() < 0.07
    assert pressure.mean() == pytest.approx(lame(), rel=0.02)


def test_contacts_of_their_own_beside_a_seam() -> None:
    """One of the two keeps its function, (P16): 5 % of the largest pressure in place of 11."""
    assert worst(plane(True, "quad4", apart=True), plane(False, "quad4"))[0] < 0.06


def test_one_place() -> None:
    """Three corners that meet are one place, by way of each other; points beside are not."""
    points = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 0.0], [1.0, 1e-3], [0.0, 0.0]])
    glue = [(np.array([0, 1]), np.array([2, 3])), (np.array([4]), np.array([2, 1]))]
    assert one_place(points, glue).tolist() == [0, 1, 0, 3, 0]
