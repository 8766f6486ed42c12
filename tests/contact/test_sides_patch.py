"""The patch test on assemblies: one contactor on two targets side by side, and through bodies that carry pressure on both
sides, contactor above and target below. A uniaxial stress is exact: tolerances as in test_patch.py."""

from __future__ import annotations

import itertools
from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.mesh.make import block, join
from models.patch import CELL_OF, POISSON, ROTATION, STRAIN, _perturb

PLANE = ("tri3", "tri6", "quad4", "quad8", "quad9")
EXACT = 1e-10
PART = 0.43  # of the width: where the second of two targets begins, within a facet of the contactor
WAYS = {
    "lists": [
        abut.Contact(contactor="under.top", target=["left.bottom", "right.bottom"]),
        abut.Contact(contactor=["left.top", "right.top"], target="over.bottom"),
    ],
    "bodies": [
        abut.Contact(contactor="under", target=["left", "right"]),
        abut.Contact(contactor=["left", "right"], target="over"),
    ],
    "one-contactor-in-two": [
        abut.Contact(contactor="under.top", target="left.bottom"),
        abut.Contact(contactor="under.top", target="right.bottom"),
        abut.Contact(contactor="over.bottom", target=["left.top", "right.top"]),
    ],
    "above-and-below": [
        abut.Contact(contactor="under.top", target="left.bottom"),
        abut.Contact(contactor="right", target="under"),
        abut.Contact(contactor="left.top", target="over.bottom"),
        abut.Contact(contactor="over.bottom", target="right.top"),
    ],
    "ties": [
        abut.Contact(contactor="under.top", target=["left.bottom", "right.bottom"], kind="tied"),
        abut.Contact(contactor="over.bottom", target=["left.top", "right.top"], kind="tied"),
    ],
}


def stack(kinds: tuple[str, str, str, str], dim: int, contacts: list[abut.Contact], distort: float) -> abut.Model:
    """Under, left and right on it, over: unit cubes' worth of blocks that do not match, pressed from above; in 3D turned."""
    rows = {
        "under": ((0, 1), (0, 1), (4, 3)), "left": ((0, PART), (1, 1.6), (2, 2)),
        "right": ((PART, 1), (1, 1.6), (3, 4)), "over": ((0, 1), (1.6, 2.2), (5, 2)),
    }  # fmt: skip
    parts = {}
    for seed, ((name, (x, z, n)), kind) in enumerate(zip(rows.items(), kinds)):
        low, high = np.array([x[0], 0.0, z[0]]), np.array([x[1], 1.0, z[1]])
        axes = [0, 1, 2] if dim == 3 else [0, 2]
        cells = tuple([n[0], n[1], 2][i] for i in range(dim)) if dim == 3 else (2 * n[0], 2)
        low, high = low[axes], high[axes]
        lines = [np.linspace(a, b, k + 1) for a, b, k in zip(low, high, cells)]
        parts[name] = block.grid(lines, kind, _perturb(distort, low, high, seed, cells))
    mesh = join(parts)
    if dim == 3:
        mesh = replace(mesh, points=mesh.points @ ROTATION.T)
    side = POISSON * (1.0 if dim == 3 else 1.0 + POISSON) * STRAIN
    supports = [abut.Support("under.bottom", normal=0.0), abut.Support("right.left", normal=-PART * side)]
    supports += [abut.Support(f"{body}.left", normal=0.0) for body in ("under", "left", "over")]
    if dim == 3:
        supports += [abut.Support(f"{body}.front", normal=0.0) for body in parts]
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(1.0, POISSON)) for body in parts],
        supports,
        [abut.Pressure("over.top", STRAIN)],
        contacts,
        plane="strain" if dim == 2 else None,
    )


def errors(built: abut.Model) -> tuple[float, float]:
    """Of pressures on covered facets, and of the displacement, relative."""
    solution = abut.solve(built)
    dim = built.dim
    turn = ROTATION if dim == 3 else np.eye(dim)
    x = built.mesh.points @ turn
    side, down = (POISSON, 1.0) if dim == 3 else (POISSON * (1 + POISSON), 1 - POISSON**2)
    exact = STRAIN * np.column_stack([side * x[:, :-1], -down * x[:, -1]]) @ turn.T
    pressure = max(float(np.nanmax(np.abs(c.pressure[c.covered] / STRAIN - 1.0))) for c in solution.contacts)
    return pressure, float(np.abs(solution.displacement - exact).max() / np.abs(exact).max())


def others(kinds: tuple[str, ...], contactor: str, target: str) -> tuple[str, str, str, str]:
    """Types of the four blocks: the contactor's, the target's and the next one's beside it."""
    return contactor, target, kinds[(kinds.index(target) + 1) % len(kinds)], contactor


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize(("contactor", "target"), list(itertools.product(PLANE, PLANE)))
def test_every_cell_pair_in_2d(contactor: str, target: str, way: str) -> None:
    assert max(errors(stack(others(PLANE, contactor, target), 2, WAYS[way], 0.2))) < EXACT


@pytest.mark.parametrize(("contactor", "target"), list(itertools.product(CELL_OF, CELL_OF)))
def test_every_facet_pair_in_3d(contactor: str, target: str) -> None:
    """All ways in turn: each with every type as contactor and as target."""
    kinds = tuple(CELL_OF)
    way = list(WAYS)[(kinds.index(contactor) + kinds.index(target)) % len(WAYS)]
    cells = [CELL_OF[kind] for kind in others(kinds, contactor, target)]
    assert max(errors(stack((cells[0], cells[1], cells[2], cells[3]), 3, WAYS[way], 0.15))) < EXACT


@pytest.mark.parametrize("kind", ["tet4", "tet10"])
def test_tetrahedra(kind: str) -> None:
    assert max(errors(stack((kind, kind, kind, kind), 3, WAYS["bodies"], 0.15))) < EXACT


@pytest.mark.parametrize("cell", ["quad4", "quad8", "hex8", "hex20"])
@pytest.mark.parametrize("part", [0.37, 0.5, 0.61, 0.66])
def test_one_contactor_on_two_rigid_plates(cell: str, part: float) -> None:
    """Both contacts have functions at points between the plates, which do not give way: too many by one, were each to keep
    its own. The rigid plates press the block evenly, p = E d / h."""
    make = abut.mesh.make.box if cell.startswith("hex") else abut.mesh.make.rectangle
    across = ((0, 1),) if cell.startswith("hex") else ()

    def plate(x: tuple[float, float], n: int) -> abut.Mesh:
        return make(x, *across, (1, 1.2), (n, *([3] if across else []), 1), cell)

    mesh = join(
        {"block": make((0, 1), *across, (0, 1), (4, *([2] if across else []), 2), cell),
         "left": plate((0, part), 2), "right": plate((part, 1), 3)}
    )  # fmt: skip
    down = {"z": -STRAIN, "rx": 0.0, "ry": 0.0, "y": 0.0} if across else {"y": -STRAIN}
    solution = abut.solve(
        abut.Model(
            mesh,
            [abut.Solid("block", abut.LinearElastic(1.0, 0.0))],
            [abut.Support("block.bottom", **{"x": 0.0, "y": 0.0, **({"z": 0.0} if across else {})})],
            contacts=[abut.Contact(contactor="block", target="left"), abut.Contact(contactor="block", target="right")],
            plane=None if across else "strain",
            rigid=[abut.Rigid(body, x=0.0, rz=0.0, **down) for body in ("left", "right")],
        )
    )
    for contact in solution.contacts:
        assert np.nanmax(np.abs(contact.pressure[contact.covered] / STRAIN - 1.0)) < EXACT
