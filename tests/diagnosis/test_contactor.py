"""Which side is the contactor: what `auto` chooses `check` has nothing against, and against the other way round it has."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.contact.contactor_choice import Side, choose, shows_nodes
from abut.diagnosis.contactor import sides
from abut.materials.softest import contact_modulus, softest
from abut.mesh.make import join, rectangle, ring
from models.assembly import ASSEMBLIES


def plates(cells: tuple[int, int], x: tuple[float, float] = (0.0, 10.0)) -> abut.Mesh:
    """Two plates on each other, facets as wide as ``cells`` make them; ``x``: of the upper one."""
    lower = rectangle(x=(0, 10), y=(0, 5), cells=(cells[0], 2), cell="quad8")
    return join({"a": lower, "b": rectangle(x=x, y=(5, 7), cells=(cells[1], 2), cell="quad4")})


def shaft(cells: tuple[int, int]) -> abut.Mesh:
    """A quarter of a shaft in its bush."""
    inner = ring(radii=(5, 10), cells=(2, cells[0]), cell="quad4")
    return join({"a": inner, "b": ring(radii=(10, 12), cells=(2, cells[1]), cell="quad4")})


def model(mesh: abut.Mesh, young: tuple[float, float], poisson: tuple[float, float] = (0.3, 0.3)) -> abut.Model:
    solids = [abut.Solid(body, abut.LinearElastic(e, nu)) for body, e, nu in zip("ab", young, poisson)]
    found = abut.find_contacts(mesh, solids)
    return abut.Model(abut.add_surfaces(mesh, found), solids, contacts=[own.contact() for own in found], plane="strain")


def swapped(one: abut.Model, contact: abut.Contact) -> tuple[abut.Model, abut.Contact]:
    other = contact.forced(contact.target, contact.contactor)
    return replace(one, contacts=[other if own is contact else own for own in one.contacts]), other


def advice(one: abut.Model, contact: abut.Contact) -> str:
    """What `check` says against the contactor; empty for nothing."""
    return "".join(f.line for f in sides(one, contact) if f.severity == "advice" and "swap" in f.cure)


def test_a_side_without_normals_is_the_target() -> None:
    """Pressure is integrated along the contactor's normals; but the other side must have displacements."""
    collapsed, sound = Side(1.0, 1.0, 1.0, normals=False), Side(10.0, 0.1, 1.0)
    assert choose(collapsed, sound).contactor == 1
    assert choose(sound, collapsed).contactor == 0
    assert choose(collapsed, replace(sound, modulus=np.inf)).contactor == 0


SAME = (210e3, 210e3)
CASES = {  # model, contactor, what speaks against the other way round ("": no clear rule)
    "alike": (model(plates((8, 8)), SAME), "a", ""),
    "hardly finer": (model(plates((8, 10)), SAME), "a", ""),
    "finer": (model(plates((8, 24)), SAME), "a", "finer"),
    "much finer on a plane": (model(plates((6, 40)), SAME), "a", "finer"),
    "finer in a curve": (model(shaft((8, 20)), SAME), "a", "finer"),
    "much finer in a curve": (model(shaft((4, 40)), SAME), "a", "finer"),
    "much finer round a curve": (model(shaft((40, 4)), SAME), "b", "finer"),
    "hardly softer": (model(plates((8, 8)), (210e3, 200e3)), "a", ""),
    "softer": (model(plates((8, 8)), (210e3, 70e3)), "b", "stiffer"),
    "softer by Poisson's ratio": (model(plates((8, 8)), SAME, (0.49, 0.0)), "b", "stiffer"),
    "softer and coarser": (model(plates((40, 8)), (210e3, 70e3)), "b", "stiffer"),
    "softer and coarser in a curve": (model(shaft((40, 8)), (210e3, 70e3)), "b", "stiffer"),
    "softer and much finer in a curve": (model(shaft((4, 40)), (210e3, 10.0)), "b", "stiffer"),
    "bare": (model(plates((2, 2), (4.5, 5.5)), SAME), "b", "coarser|opposite"),
    "softer but bare": (model(plates((2, 2), (4.5, 5.5)), (70e3, 210e3)), "b", "opposite"),
}


@pytest.mark.parametrize("name", CASES)
def test_check_and_auto_agree(name: str) -> None:
    one, body, against = CASES[name]
    (contact,) = one.contacts
    assert contact.name.startswith(body)
    assert advice(one, contact) == ""
    said = advice(*swapped(one, contact))
    assert any(word in said for word in against.split("|")) if against else said == ""


@pytest.mark.long
@pytest.mark.parametrize("name", ASSEMBLIES)
def test_check_and_auto_agree_on_assemblies(name: str) -> None:
    """Wherever `auto` chose for a reason that is no trace, `check` tells when the sides are swapped."""
    pytest.importorskip("gmsh")
    assembly = ASSEMBLIES[name]()
    one = assembly.model()
    assert [advice(one, contact) for contact in one.contacts] == [""] * len(one.contacts)
    for found, contact in zip(assembly.found(), one.contacts):
        if found.reason == "softer":
            assert "stiffer" in advice(*swapped(one, contact))


SIDE = Side(modulus=1.0, size=1.0, covered=1.0)


@pytest.mark.parametrize(
    ("change", "other", "chosen", "rule"),
    [
        ({}, {}, 0, "alike"),
        ({"modulus": np.inf}, {"size": 0.1, "covered": 0.1}, 1, "rigid"),
        ({"modulus": 1.2}, {}, 1, "softer"),
        ({"modulus": 1.2}, {"covered": 0.5}, 0, "covered"),
        ({"modulus": 1.2, "covered": 0.5}, {"covered": 0.5}, 1, "softer"),  # both are: softness decides
        ({"size": 1.05}, {}, 0, "coarser"),
        ({"size": 1.05, "covered": 0.8}, {}, 1, "covered"),
        ({"size": 1.5, "covered": 0.8}, {}, 0, "coarser"),
        ({"size": 1.0 / 40.0}, {}, 1, "coarser"),
        ({"size": 1.0 / 40.0}, {"modulus": 1.2}, 1, "coarser"),  # the softer one, but finer by far
        ({"size": 1.0 / 40.0}, {"modulus": 3.0}, 1, "coarser"),
        ({"size": 1.0 / 40.0}, {"modulus": 4.0}, 0, "softer"),
        ({"size": 1.0 / 40.0}, {"modulus": 1.2, "covered": 0.5}, 0, "softer"),
        ({"size": 0.8}, {"modulus": 1.2}, 0, "softer"),
    ],
)
def test_rule(change: dict[str, float], other: dict[str, float], chosen: int, rule: str) -> None:
    """The same for both orders of the sides, but where they are alike."""
    one, two = replace(SIDE, **change), replace(SIDE, **other)
    choice, back = choose(one, two), choose(two, one)
    assert (choice.contactor, choice.rule) == (chosen, rule)
    assert rule == "alike" or (back.contactor, back.rule, back.clear) == (1 - chosen, rule, choice.clear)


def test_much_softer_tetrahedra_as_target() -> None:
    """Looked at where the target is softer by far and of tetrahedra, whatever the sizes; never on the side that the rule
    takes."""
    stiff, soft = replace(SIDE, modulus=1e3, size=2.0), replace(SIDE, tetrahedra=True)
    assert shows_nodes(stiff, soft)
    assert not shows_nodes(soft, stiff)
    assert not shows_nodes(stiff, SIDE)
    assert not shows_nodes(replace(SIDE, modulus=2.0), soft)


def test_softest_body_of_a_side() -> None:
    """By (1 - nu^2) / E; a body without a material is rigid and does not count."""
    mesh = plates((4, 4))
    every = np.arange(mesh.n_cells)
    soft, stiff = abut.LinearElastic(100.0, 0.0), abut.LinearElastic(95.0, 0.4)
    assert softest(mesh, {"a": stiff, "b": soft}, every) is soft
    assert softest(mesh, {"a": stiff}, every) is stiff
    assert softest(mesh, {"a": stiff}, mesh.bodies["b"]) is None
    assert contact_modulus(None) == np.inf
    assert contact_modulus(stiff) == pytest.approx(95.0 / 0.84, rel=1e-15)
