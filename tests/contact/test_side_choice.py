"""Contacts without roles: abut decides which side carries the pressure, and nothing else depends on it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.mesh.make import join, rectangle
from abut.model.side_choice import choices
from abut.output import restart

YOUNG = 1e3


def stacked(
    contact: abut.Contact, cells: tuple[int, int] = (8, 8), ratio: float = 1.0, **options: object
) -> abut.Model:
    """An upper block on a wider lower one, pressed down and pushed along; cells over 4, moduli lower over upper."""
    mesh = join({
        "upper": rectangle((1, 5), (2, 4), (cells[0], cells[0] // 2), "quad4"),
        "lower": rectangle((0, 6), (0, 2), (6 * cells[1] // 4, cells[1] // 2), "quad4"),
    })  # fmt: skip
    given = {
        "solids": [
            abut.Solid("upper", abut.LinearElastic(YOUNG, 0.3)),
            abut.Solid("lower", abut.LinearElastic(ratio * YOUNG, 0.3)),
        ],
        "supports": [abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0.002, y=-0.02)],
    }
    return abut.Model(mesh, **(given | options), contacts=[contact], plane="strain")  # type: ignore[arg-type]


BOTH = abut.Contact("upper.bottom", "lower.top")


@pytest.mark.parametrize(
    ("cells", "ratio", "contactor", "why"),
    [
        ((8, 8), 1.0, "upper.bottom", "first of two alike"),
        ((8, 16), 1.0, "upper.bottom", "coarser, facets of 0.5 against 0.25"),
        ((16, 8), 1.0, "lower.top", "coarser, facets of 0.5 against 0.25"),
        ((8, 16), 0.25, "lower.top", "softer, E/(1-nu^2) 275 against 1.1e+03"),
        ((16, 8), 4.0, "upper.bottom", "softer"),
        ((8, 16), 0.5, "upper.bottom", "coarser, facets of 0.5 against 0.25"),
        ((16, 8), 2.0, "lower.top", "coarser"),
        ((8, 16), 1.05, "upper.bottom", "coarser"),
    ],
)
def test_the_choice(cells: tuple[int, int], ratio: float, contactor: str, why: str) -> None:
    """The same for both orders of the names, but where the sides are alike; told in one line, in the notes of the run."""
    model = stacked(BOTH, cells, ratio)
    (contact,) = model.contacts
    assert contact.contactor == contactor
    assert contact.chosen.startswith(why)
    assert contact.name == "upper.bottom-lower.top"
    (back,) = stacked(abut.Contact("lower.top", "upper.bottom"), cells, ratio).contacts
    assert back.contactor == ("lower.top" if why.startswith("first") else contactor)
    (line,) = choices(model.contacts)
    assert line in abut.solve(model).notes
    assert repr(contactor) in line
    assert why in line


def test_a_side_that_cannot_move_is_never_the_contactor() -> None:
    """Rigid, or held by supports at all of its points, however soft or coarse."""
    held = [
        abut.Support("lower.bottom", x=0, y=0),
        abut.Support("upper.bottom", x=0),
        abut.Support("upper.bottom", y=-0.01),
    ]
    cases = {
        "held": stacked(BOTH, (4, 16), 10.0, supports=held),
        "rigid": stacked(
            BOTH, (4, 16), solids=[abut.Solid("lower", abut.LinearElastic(YOUNG, 0.3))],
            rigid=[abut.Rigid("upper", y=-0.01)], supports=[abut.Support("lower.bottom", x=0, y=0)],
        ),
    }  # fmt: skip
    for model in cases.values():
        assert model.contacts[0].contactor == "lower.top"
        assert "rigid, or held" in model.contacts[0].chosen
        assert abut.solve(model).converged


@pytest.mark.long
@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize("cells", [(8, 16), (16, 8)])
def test_results_do_not_depend_on_who_chose(cells: tuple[int, int], kinematics: str) -> None:
    """The same as with these sides by hand, but that resultants are those on the side named first, whichever carries the
    pressure."""
    keys = {"friction": 0.3, "offset": -0.001, "name": "pair"}
    chosen = stacked(abut.Contact("upper.bottom", "lower.top", **keys), cells, kinematics=kinematics)
    (contact,) = chosen.contacts
    forced = replace(chosen, contacts=[contact.forced(contact.contactor, contact.target)])
    one, two = (abut.solve(model) for model in (chosen, forced))
    sign = -1.0 if contact.turned else 1.0
    assert contact.turned == (cells == (16, 8))
    assert np.array_equal(one.displacement, two.displacement)
    own, other = one.contacts[0], two.contacts[0]
    assert own.force[1] > 0.0  # the upper block, named first, is pushed up
    assert np.array_equal(own.force, sign * other.force)
    assert np.array_equal(own.resultant.moment, sign * other.resultant.moment)
    assert own.friction is not None
    assert other.friction is not None
    assert np.array_equal(own.friction.force, sign * other.friction.force)
    assert list(own.body_forces) == ["lower"]  # of the side named second
    assert own.body_forces["lower"] == pytest.approx(-own.force, rel=1e-9)
    assert restart.description(chosen) == restart.description(forced)  # how the sides were named decides nothing


@pytest.mark.parametrize("cells", [(8, 16), (16, 8)])
@pytest.mark.parametrize("on", ["upper.bottom", "lower.top"])
def test_probes_read_on_either_side(cells: tuple[int, int], on: str) -> None:
    """Pressure and gap, whichever side has the gap; on the side named by hand as the target a gap is refused still."""
    probe = abut.Probe("p", on=on, of=["pressure", "gap"])
    solution = abut.solve(stacked(BOTH, cells, probes=[probe]))
    values = solution.probes[0].values
    inside = np.abs(solution.probes[0].points[:, 0] - 3.0) < 1.0
    assert (np.asarray(values["pressure"])[inside] > 0.0).all()
    assert np.abs(np.asarray(values["gap"])[inside]).max() < 1e-3
    (contact,) = stacked(BOTH, cells).contacts
    if contact.target == on:
        with pytest.raises(InputError, match="put it on the contactor"):
            abut.solve(stacked(contact.forced(contact.contactor, contact.target), cells, probes=[probe]))


def test_friction_that_varies_goes_with_the_side_named_first() -> None:
    """At large sliding its points carry the coefficient along; with small displacements both sides are in one place."""
    varying = abut.Contact("upper.bottom", "lower.top", friction="0.1 + 0.02*x")
    assert stacked(varying, (16, 8)).contacts[0].contactor == "lower.top"
    (contact,) = stacked(varying, (16, 8), kinematics="finite").contacts
    assert contact.contactor == "upper.bottom"
    assert "its friction varies" in contact.chosen
    with pytest.raises(InputError, match="named first, which is rigid: name the other one first"):
        stacked(
            varying, solids=[abut.Solid("lower", abut.LinearElastic(YOUNG, 0.3))], rigid=[abut.Rigid("upper", y=-0.01)],
            supports=[abut.Support("lower.bottom", x=0, y=0)], kinematics="finite",
        )  # fmt: skip


def test_lists_and_bodies() -> None:
    model = stacked(abut.Contact(["upper.bottom", "upper.left"], "lower"), (16, 8))
    assert (model.contacts[0].contactor, model.contacts[0].target) == ("lower", ("upper.bottom", "upper.left"))
    own = stacked(abut.Contact("upper", "upper"), kinematics="finite").contacts[0]
    assert own.contactor == own.target == "upper"
    assert choices([own]) == ()


def test_a_model_decides_anew_what_it_was_left() -> None:
    """Other materials, another choice; what was forced stays."""
    model = stacked(BOTH, (8, 16))
    softer = [abut.Solid("upper", abut.LinearElastic(YOUNG, 0.3)), abut.Solid("lower", abut.LinearElastic(1.0, 0.3))]
    assert replace(model, solids=softer).contacts[0].contactor == "lower.top"
    forced = replace(model, contacts=[BOTH.forced("upper.bottom", "lower.top")])
    assert replace(forced, solids=softer).contacts[0].contactor == "upper.bottom"


@pytest.mark.parametrize(
    "sides",
    [{}, {"first": "a"}, {"contactor": "a"}, {"first": "a", "second": "b", "contactor": "a"},
     {"first": "a", "target": "b"}, {"first": "a", "second": "b", "contactor": "b", "target": "a"}],
)  # fmt: skip
def test_mixtures_are_refused(sides: dict[str, str]) -> None:
    with pytest.raises(InputError, match="name two surfaces, of which abut chooses the contactor, or both"):
        abut.Contact(**sides)  # type: ignore[arg-type]


def test_a_built_contact_keeps_its_sides() -> None:
    """Other sides by ``dataclasses.replace`` would be overruled by the choice among those named: refused."""
    (contact,) = stacked(BOTH).contacts
    with pytest.raises(InputError, match=r'not "upper.left" and "lower.top"; .* forced\(contactor, target\)'):
        replace(contact, contactor="upper.left")
    assert replace(contact, name="other").contactor == contact.contactor
