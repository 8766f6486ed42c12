"""Sharp edges that press on a face: the force, its direction, which side carries it, and what the certificate says."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.contact.contactor_choice import Side, choose
from abut.diagnosis.cures import cure
from abut.mesh.make import join, rectangle

STEEL = abut.LinearElastic(210e3, 0.3)
AT, LIFT = 9.0, 0.05


def timoshenko(at: float) -> float:
    """Force that bends a cantilever of height 1 by ``LIFT``, plane strain."""
    bending = at**3 / (3.0 * 210e3 / (1.0 - 0.3**2) / 12.0)
    return LIFT / (bending + at / (5.0 / 6.0 * 210e3 / 2.6))


def leaning(lean: float, beside: float, cell: str = "quad8", n: int = 4, **sides: str) -> abut.Model:
    """A cantilever on a block whose top falls away from its left corner by ``lean`` degrees; the corner lies ``beside`` a
    node of the beam. sides: contactor and target, left to abut where left out, the beam named first if anything leans."""
    block = rectangle((0, 1), (0, 1), (n, n), cell)
    x = block.points.copy()
    x[:, 1] -= x[:, 1] * np.tan(np.deg2rad(lean)) * x[:, 0]
    mesh = join(
        {
            "beam": rectangle((0, 10), (0, 1), (10 * n, n), cell),
            "block": replace(block, points=x + np.array([AT + beside, -1.0])),
        }
    )
    contact = abut.Contact(**sides) if sides else abut.Contact(*("beam.bottom", "block.top")[:: 1 if lean else -1])
    held = [abut.Support("beam.left", x=0, y=0), abut.Support("block.bottom", x=0, y=LIFT)]
    return abut.Model(mesh, [abut.Solid(b, STEEL) for b in mesh.bodies], held, contacts=[contact], plane="strain")


def square_on_corner(n: int) -> abut.Model:
    """A square that stands on its corner on a block, between nodes, pushed down."""
    square = rectangle((0, 1), (0, 1), (n, n), "quad4")
    turn = np.sqrt(0.5) * np.array([[1.0, 1.0], [-1.0, 1.0]])
    mesh = join(
        {
            "square": replace(square, points=square.points @ turn),
            "block": rectangle((-1, 1), (-1, 0), (2 * n, n), "quad4"),
        }
    )
    faces = {"square.faces": np.concatenate([mesh.surfaces["square.bottom"], mesh.surfaces["square.left"]])}
    mesh = replace(mesh, surfaces={**mesh.surfaces, **faces})
    held = [abut.Support("block.bottom", x=0, y=0), abut.Support("square.top", x=0, y=-0.01)]
    solids = [abut.Solid(body, abut.LinearElastic(1000.0, 0.3)) for body in mesh.bodies]
    return abut.Model(mesh, solids, held, contacts=[abut.Contact("block.top", "square.faces")], plane="strain")


def line(solution: abut.Solution, name: str) -> abut.Check:
    return next(check for check in solution.certificate if check.name == name)


@pytest.mark.parametrize("lean", [0.0, 5.0, 20.0, 45.0])
@pytest.mark.parametrize("beside", [0.0, 0.03, 0.11])
def test_a_leaning_edge_bends_a_beam_by_beam_theory(lean: float, beside: float) -> None:
    """Wherever the edge lies between nodes, and however its face leans: what is left is how both sides give way at the edge,
    and the clamp."""
    solution = abut.solve(leaning(lean, beside))
    own = solution.contacts[0]
    assert own.contactor.name == "block.top"
    assert abs(own.force[1]) == pytest.approx(timoshenko(AT + beside), rel=0.025)
    assert abs(own.force[0]) < 5e-3 * abs(own.force[1])  # no friction, and the beam is flat: square to it
    assert not {check.name for check in solution.certificate if not check.passed} - {
        "stress error"
    }  # of cells at the edge
    assert line(solution, "sharp edge").warns
    assert "resolution" in {check.name for check in solution.certificate if check.unknown}
    assert "round the edge" in cure(line(solution, "sharp edge"), solution)


def test_the_face_as_contactor_is_told() -> None:
    """Its gap is closed in the mean over facets, on which it opens to both sides: off by more than a fifth."""
    solution = abut.solve(leaning(20.0, 0.11, contactor="beam.bottom", target="block.top"))
    assert abs(abs(solution.contacts[0].force[1]) / timoshenko(AT + 0.11) - 1.0) > 0.2
    edge = line(solution, "sharp edge")
    assert not edge.passed
    assert "'block.top'" in edge.meaning
    assert "swap the sides" in cure(edge, solution)
    assert "swap the sides" in cure(line(solution, "overlap"), solution)


def test_what_the_mesh_decides_at_an_edge_fails() -> None:
    """Between stout bodies what gives way at the edge is most of it: the line foresees more than the next mesh changes."""
    coarse, fine = (abut.solve(square_on_corner(n)) for n in (8, 16))
    change = abs(coarse.contacts[0].force[1] / fine.contacts[0].force[1] - 1.0)
    edge = line(coarse, "sharp edge")
    assert not edge.passed
    assert edge.value > change > 0.1
    assert line(fine, "sharp edge").value < edge.value


def test_stiff_edges_on_soft_faces_leave_these_the_contactor() -> None:
    edge = Side(2.5, 1.0, 1.0, edge=True)
    assert choose(Side(1.0, 2.0, 1.0), edge).rule == "edge"
    assert choose(Side(1.0, 2.0, 1.0), edge).contactor == 1
    assert choose(Side(0.5, 2.0, 1.0), edge).rule == "softer"
    assert choose(Side(1.0, 2.0, 1.0, edge=True), edge).rule == "softer"
