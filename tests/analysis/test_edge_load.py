"""Edges of the contactor that press on a face: the certificate's line "contactor's edges"."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.analysis.edge_load import edge_load
from abut.diagnosis.cures import cures
from abut.mesh.make import box, join, rectangle
from abut.problem.constraints import supports
from abut.problem.contact_pairs import pair
from abut.solution import Check


def tilted(
    degrees: float, sides: tuple[str, str] = ("skin", "plate.top"), plate: tuple[float, float, int] = (-2.0, 2.0, 16)
) -> abut.Model:
    """A square, turned about its lower right corner (0, 0), pressed on a plate with that corner; plate: from, to,
    and in how many cells."""
    block = rectangle((-1, 0), (0, 1), (4, 4), "quad4")
    c, s = np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))
    block = replace(block, points=block.points @ np.array([[c, -s], [s, c]]))
    mesh = join({"block": block, "plate": rectangle(plate[:2], (-1, 0), (plate[2], 4), "quad4")})
    skin = np.concatenate([mesh.surfaces["block.bottom"], mesh.surfaces["block.right"]])
    mesh = replace(mesh, surfaces={**mesh.surfaces, "skin": skin})
    steel = abut.LinearElastic(1000.0, 0.3)
    return abut.Model(
        mesh,
        [abut.Solid(body, steel) for body in mesh.bodies],
        [abut.Support("plate.bottom", x=0, y=0), abut.Support("block.top", x=0, y=-0.1)],
        contacts=[abut.Contact(contactor=sides[0], target=sides[1])],
        plane="strain",
        kinematics="finite",
    )


def line(solution: abut.Solution) -> Check:
    return next(check for check in solution.certificate if check.name == "contactor's edges")


def test_an_edge_as_contactor_fails() -> None:
    """It pushes along the normal of its own face, 30 degrees off, and the cure is the other side as contactor: its normal is
    that of the plate."""
    solution = abut.solve(tilted(30.0))
    check = line(solution)
    assert check.value == pytest.approx(0.5, abs=0.05)  # sine of 30 degrees
    assert not check.passed
    (text,) = [text for failed, text in cures(solution) if failed.name == check.name]
    assert text.startswith("swap the sides (contactor = ")
    tangential, normal = np.abs(solution.contacts[0].force)
    assert tangential / normal > 0.2  # without friction it should be none

    other = abut.solve(tilted(30.0, ("plate.top", "skin")))
    assert line(other).value == 0.0
    tangential, normal = np.abs(other.contacts[0].force)
    assert tangential / normal < 1e-6


def test_an_edge_of_the_target_does_not_count() -> None:
    """Though the contactor has one beside it: a plate of one facet that ends a little way behind the corner, under an even
    pressure. On a long plate, as contactor, its corner does not either: at small displacements it pushes square to the
    plate, but for what normals turn by towards the next facet."""
    cases = (("plate.top", "skin"), (-0.1, 0.01, 1)), (("skin", "plate.top"), (-2.0, 2.0, 16))
    found = []
    for sides, plate in cases:
        model = tilted(30.0, sides, plate)
        own = pair(model, model.contacts[0], supports(model))
        bottom = own.contactor.points[own.contactor.nodes[:, 1], 0] <= 0.0  # the face at 30 degrees
        ones = np.where((own.contactor.nodes >= 0) & (bottom | (sides[0] == "plate.top"))[:, None], 1.0, np.nan)
        found.append(edge_load(own, np.nan_to_num(ones).ravel(), ones))
    assert found[0] == 0.0
    assert found[1] < 0.1 * 0.5  # sine of 30 degrees, along the face's own normal


@pytest.mark.parametrize("degrees", [0.0, 5.0])
def test_faces_that_lie_on_each_other_or_almost(degrees: float) -> None:
    assert line(abut.solve(tilted(degrees))).value <= np.sin(np.deg2rad(5.0)) + 0.01


def test_a_target_without_normals() -> None:
    """A hexahedron collapsed at an edge, beside the contact: there is no value, and that is said."""
    upper = box((0.2, 1.5), (0.2, 0.8), (1, 2), (2, 2, 1), "hex8")
    mesh = join({"lower": box((0, 2), (0, 1), (0, 1), (2, 1, 1), "hex8"), "upper": upper})
    points = mesh.points.copy()
    points[(points == [2.0, 0.0, 1.0]).all(axis=1)] = [2.0, 1.0, 1.0]
    model = abut.Model(
        replace(mesh, points=points),
        [abut.Solid(body, abut.LinearElastic(1000.0, 0.3)) for body in mesh.bodies],
        [abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", x=0, y=0, z=-0.01)],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top")],
    )
    check = line(abut.solve(model))
    assert check.verdict == "none"
    assert check.unknown == "the target has points without a normal"
