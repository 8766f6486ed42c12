"""Kinematics "small-strain", theory (D17): linear bodies, contact where they have moved to."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.analysis.run import Run
from abut.errors import InputError
from abut.mesh import make
from abut.solution.state import State
from models.sliding import FIRST, THEN, arched, finite, pressed_in_space, sharp, tangent_errors

SOFT = abut.LinearElastic(young=100.0, poisson=0.3)
CONFINED = 100.0 * (1.0 - 0.3) / (1.3 * 0.4)  # stress over strain of what cannot expand sideways
DEEP = 0.2


def confined(slide: float = 0.0, friction: float = 0.0, kinematics: str = "small-strain", **solid: float) -> abut.Model:
    """A block on a wider plate, both held sideways wherever they could bulge, pressed together by DEEP and slid along: in
    the block, of the plate's width or not, strain is one number."""
    mesh = make.join({
        "plate": make.rectangle([0, 4], [0, 1], cells=[9, 2], cell="quad4"),
        "block": make.rectangle([0.5, 1.5], [1, 2], cells=[4, 2], cell="quad4"),
    })  # fmt: skip
    sides = {"block": mesh.nodes_of("block")}
    mesh = replace(mesh, node_sets={**mesh.node_sets, "all": sides["block"], "ground": mesh.nodes_of("plate")})
    return abut.Model(
        mesh, [abut.Solid("plate", SOFT), abut.Solid("block", SOFT, **solid)],  # type: ignore[arg-type]
        [
            abut.Support("ground", x=0, y=0), abut.Support("block.top", y=-DEEP, amplitude=FIRST),
            abut.Support("all", x=slide, amplitude=THEN),
        ],
        contacts=[abut.Contact(contactor="block.bottom", target="plate.top", friction=friction)], plane="strain",
        kinematics=kinematics,
    )  # fmt: skip


@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_pressure_is_linear_in_the_strain_wherever_it_slides(friction: float) -> None:
    """A fifth of its height, then over six facets of the plate: p = M d / h exactly, which no finite strain has, and
    friction is all of mu p. To rounding of the elimination."""
    solution = abut.solve(confined(slide=2.5, friction=friction))
    assert solution.converged
    contact, force = solution.contacts[0], CONFINED * DEEP
    assert np.abs(np.nan_to_num(contact.pressure, nan=force) - force).max() < 1e-9 * force
    assert contact.force == pytest.approx([-friction * force, force], abs=1e-9 * force)
    assert {"strain", "rotation", "energy balance"} <= {check.name for check in solution.certificate}


def flat(dim: int, friction: float) -> abut.Model:
    """A block pressed on a plate by little and slid by several facets, across too in space."""
    if dim == 2:
        return replace(sharp(friction, 9), supports=shallow(sharp(friction, 9)))
    mesh = make.join({
        "lower": make.box([0, 2], [0, 1], [0, 0.8], cells=[7, 3, 2], cell="hex8"),
        "upper": make.box([0.3, 1.1], [0.2, 0.7], [0.8, 1.4], cells=[3, 2, 2], cell="hex8"),
    })  # fmt: skip
    return replace(pressed_in_space(friction), mesh=mesh, supports=shallow(pressed_in_space(friction)))


def shallow(model: abut.Model) -> list[abut.Support]:
    """Supports that press by a thousandth."""
    down = "yz"[model.dim - 2]
    return [replace(s, **{down: 1e-3 * getattr(s, down)}) if s.amplitude is FIRST else s for s in model.supports]


@pytest.mark.parametrize(
    ("dim", "friction"),
    [(2, 0.3), *(pytest.param(*case, marks=pytest.mark.long) for case in ((2, 0.0), (3, 0.0), (3, 0.3)))],
)
def test_small_strains_are_the_limit_of_finite_ones(dim: int, friction: float) -> None:
    """Slid by facets, strained by some 5e-5: what finite strains add is that share of the forces."""
    forces = [
        abut.solve(replace(flat(dim, friction), kinematics=k)).contacts[0].force for k in ("finite", "small-strain")
    ]
    assert np.abs(forces[0]).max() > 0.0
    assert np.abs(forces[1] - forces[0]).max() < 2e-4 * np.abs(forces[0]).max()


@pytest.mark.parametrize("kinematics", ["small", "finite"])
def test_tiny_loads(kinematics: str) -> None:
    """Without sliding all three kinematics are one theory under tiny loads, here 1e-6: to that and rounding of the gaps."""
    model = confined(friction=0.3)
    model = replace(
        model, contacts=[replace(c, pressure="P1") for c in model.contacts],
        supports=[replace(s, y=1e-6 * s.y) if s.y else s for s in model.supports],
    )  # fmt: skip
    forces = [abut.solve(replace(model, kinematics=k)).contacts[0].force for k in (kinematics, "small-strain")]
    assert np.abs(forces[1] - forces[0]).max() < 1e-6 * np.abs(forces[0]).max()


@pytest.mark.parametrize("friction", [0.0, 0.3])
def test_tangent_is_the_derivative(friction: float) -> None:
    """As with finite strains: contact is exactly differentiated, bodies are linear."""
    model = replace(arched(friction), kinematics="small-strain", loads=[abut.Pressure("upper.left", 1.0)])
    assert max(tangent_errors(finite(model), 5e-3)) < 1e-8


def test_heat() -> None:
    """Thermal strains are those of linear bodies: p = M (d / h + a T (1 + nu) / (1 - nu)), held sideways."""
    solid = {"temperature": 50.0, "material": replace(SOFT, expansion=1e-3)}
    model = confined()
    model = replace(model, solids=[model.solids[0], abut.Solid("block", **solid)])  # type: ignore[arg-type]
    force = CONFINED * (DEEP + 0.05 * 1.3 / 0.7)
    solution = abut.solve(model)
    assert solution.contacts[0].force[1] == pytest.approx(force, rel=1e-9)
    energy = next(check for check in solution.certificate if check.name == "energy balance")
    assert energy.passed


def test_a_material_of_ones_own() -> None:
    """Any law for small strains goes, its history with it: a linear one in Python gives the same."""

    class Own:
        constant, density, expansion = False, 0.0, 0.0
        modulus, poisson = SOFT.young, SOFT.poisson

        def initial(self, n: int) -> np.ndarray:
            return SOFT.initial(n)

        def evaluate(self, strain: np.ndarray, history: np.ndarray) -> object:
            return SOFT.evaluate(strain, history)

    model = replace(arched(0.3, slide=0.1), kinematics="small-strain")
    own = replace(model, solids=[abut.Solid(s.body, Own()) for s in model.solids])  # type: ignore[arg-type]
    one, other = abut.solve(model), abut.solve(own)
    assert other.contacts[0].force == pytest.approx(one.contacts[0].force, rel=1e-7)
    assert [s.energy.stored for s in other.steps if s.energy] == pytest.approx(
        [s.energy.stored for s in one.steps if s.energy], rel=1e-6, abs=1e-9
    )


def test_restart_goes_on_as_the_whole_run() -> None:
    """From the fifth step on: the same last state."""
    model, saved = replace(arched(0.3, slide=0.1), kinematics="small-strain"), []
    whole = abut.solve(model, on_step=lambda _, state: saved.append(state))
    again = Run.of(model, lambda *_: None, lambda *_: None, None, saved[:5])
    state = again.restore(saved[:5])
    assert isinstance(state, State)
    again.march(state, saved[:5])
    assert again.steps[-1].displacement == pytest.approx(whole.displacement, abs=1e-11)
    assert [len(step.iterations) for step in again.steps] == [len(step.iterations) for step in whole.steps]


def test_rigid_bodies_turn_by_any_angle() -> None:
    """A rigid roller on a block, turned by a quarter: it sinks in as before, and its turn is no turn that
    is taken for small."""
    mesh = make.join({"block": make.rectangle([-2, 2], [-1, 0], cells=[16, 4]), "cam": sector(1.0)})
    model = abut.Model(
        mesh, [abut.Solid("block", SOFT)], [abut.Support("block.bottom", x=0, y=0)],
        rigid=[abut.Rigid("cam", reference=(0.0, 1.0), x=0.0, y=-0.02, rz=np.pi / 2)], plane="strain",
        contacts=[abut.Contact(contactor="block.top", target="cam.outer")], kinematics="small-strain",
    )  # fmt: skip
    turned, upright = abut.solve(model), abut.solve(replace(model, rigid=[replace(model.rigid[0], rz=0.0)]))
    assert turned.contacts[0].force[1] == pytest.approx(upright.contacts[0].force[1], rel=1e-3)
    assert next(check for check in turned.certificate if check.name == "rotation").value < 0.02


def sector(radius: float) -> abut.Mesh:
    """Of a roller about (0, radius): its lower left."""
    return make.ring((0.5 * radius, radius), (-210.0, -60.0), (0.0, radius), (1, 80), "quad4")


def test_what_it_does_not_know() -> None:
    """Rubber at small strains; the cure of sliding names this kinematics."""
    model = confined()
    rubber = [abut.Solid("plate", SOFT), abut.Solid("block", abut.NeoHooke(100.0, 0.3))]
    with pytest.raises(InputError, match="finite strains"):
        replace(model, solids=rubber)
    with pytest.raises(InputError, match="small-strain"):
        replace(model, kinematics="smal-strain")
