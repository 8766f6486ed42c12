"""Finite kinematics divided among processes adds up to the whole; without any MPI."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from test_pieces import Team

import abut
from abut.bodies.inverted import Inverted
from abut.bodies.solids import TemperatureChange
from abut.contact.coupling import CouplingOptions
from abut.contact.coupling_tangent import ContactLoad, differentiated
from abut.contact.moving_normals import normal_pattern
from abut.mesh.make import box, join
from abut.parallel import part
from abut.parallel.backend import DistributedBodies
from abut.parallel.interface import differentiate
from abut.parallel.partition import pieces, point_owners
from abut.problem.backend import Serial, serial
from models.patch import two_blocks

TOLERANCE = 1e-13  # of the largest: sums in another order
HEATED = abut.NeoHooke(50.0, 0.4, expansion=1e-3)


def model() -> abut.Model:
    """Hexahedra with F-bar and wedges."""
    mesh = join({"a": box(cells=(2, 3, 2), cell="hex8"), "b": box(z=(1.0, 2.0), cells=(2, 2, 1), cell="wedge15")})
    solids = [abut.Solid("a", HEATED, integration="b-bar"), abut.Solid("b", abut.LinearElastic(10.0, 0.3))]
    return abut.Model(mesh, solids, [abut.Support("a.bottom", x=0.0, y=0.0, z=0.0)], kinematics="finite")


def dealt(model: abut.Model, size: int) -> DistributedBodies:
    """Its cells in any order; one process has none."""
    owner = np.random.default_rng(1).integers(0, size - 1, model.mesh.n_cells)
    points = point_owners(model.mesh, owner)
    team: Any = Team(size)
    bodies = DistributedBodies(model, team, owner, points, pieces(model.mesh, owner, size, points))
    return bodies.assembled()


def close(a: Any, b: Any) -> None:
    assert np.abs(a - b).max() <= TOLERANCE * np.abs(a).max()


def moved(model: abut.Model) -> tuple[np.ndarray, TemperatureChange]:
    random = np.random.default_rng(2)
    heat = TemperatureChange({"a": 3.0}, random.uniform(-5.0, 5.0, len(model.mesh.points)))
    return random.uniform(-0.03, 0.03, model.mesh.points.shape), heat


def test_forces_tangents_energies_and_stresses_add_up() -> None:
    whole, parts = serial(model()), dealt(model(), 4)
    u, heat = moved(whole.model)
    one, other = whole.deform(u, heat), parts.deform(u, heat)
    close(one.force, other.force)
    assert other.energy == pytest.approx(one.energy, rel=TOLERANCE)
    along = np.random.default_rng(3).random(u.size)
    assert isinstance(one.tangent, Serial)
    assert other.tangent is not None
    close(one.tangent.internal(along), other.tangent.internal(along))
    assert parts.deform(u, heat, tangent=False).tangent is None
    for stress, of_parts in zip(whole.stress(u, heat), parts.stress(u, heat), strict=True):
        close(stress, of_parts)


def test_cells_inside_out_are_named_as_by_one_process() -> None:
    """Returned by the process that has them, raised by the one that leads: no other is left waiting."""
    whole, parts = serial(model()), dealt(model(), 4)
    u, heat = moved(whole.model)
    u[whole.model.mesh.blocks[0].nodes[[5, 9], 0]] += 1.0
    with pytest.raises(Inverted) as expected:
        whole.deform(u, heat)
    with pytest.raises(Inverted) as found:
        parts.deform(u, heat)
    with pytest.raises(Inverted, match=f"cell {expected.value.cell} "):
        parts.stress(u, heat)
    assert str(found.value) == str(expected.value)


@pytest.mark.parametrize("size", [1, 3, 40])
@pytest.mark.parametrize("pair", [("hex8", "hex8"), ("tet10", "hex20"), ("quad8", "tri6")])
def test_contact_at_current_positions_adds_up(pair: tuple[str, str], size: int) -> None:
    """With pressures and tractions; forty processes have more than there are facets."""
    plane = pair[0] == "quad8"
    mesh = two_blocks(*pair, ((3, 2), (4, 3)) if plane else ((3, 2, 2), (2, 3, 2)))
    contactor, target = mesh.surface("lower.top"), mesh.surface("upper.bottom")
    random, n = np.random.default_rng(1), 9 * len(contactor)
    load = ContactLoad(random.random(n), None if plane else random.random((n, 3)), random.random(n) if plane else None)
    normals, options = normal_pattern(contactor).at(contactor), CouplingOptions(reach=1.0)
    whole = differentiated(contactor, target, 1, options, load, normals)
    team: Any = Team(size)
    parts = differentiate(team, contactor, target, 1, options, load, normals)
    for name in ("gap_value", "weight_value", "force"):
        close(getattr(whole, name), getattr(parts, name))
    for name in ("gap", "weight", "force_tangent"):
        close(getattr(whole, name).toarray(), getattr(parts, name).toarray())
    assert all(np.array_equal(a, b) for a, b in zip(whole.operators, parts.operators))


def test_a_part_without_cells() -> None:
    """It deforms into nothing, and its tangent can be multiplied."""
    parts = dealt(model(), 4)
    store = parts.team.stores[3]  # type: ignore[attr-defined]
    assert store["part"].mesh.n_cells == 0
    force, energy, _ = part.deform(store, 0, {}, np.zeros((0, 3)), np.zeros(0), {})
    assert (force.shape, energy) == ((0,), 0.0)
    assert part.product(store, 0, np.zeros(0)).shape == (0,)


def test_continuous_pressures_are_added_once() -> None:
    """Those of mixed tet10 cells, whose corners belong to several processes: forces, energies, stresses, tangents."""
    mesh = join({"a": box(cells=(2, 2, 2), cell="tet10"), "b": box(z=(1.0, 2.0), cells=(2, 1, 1), cell="hex8")})
    rubber = abut.MooneyRivlin(c10=0.3, c01=0.2, bulk=500.0, expansion=1e-3)
    solids = [abut.Solid("a", rubber, integration="mixed"), abut.Solid("b", HEATED)]
    held = [abut.Support("a.bottom", x=0.0, y=0.0, z=0.0)]
    for kinematics in ("finite", "small-strain"):
        if kinematics == "small-strain":
            solids = [abut.Solid(s.body, abut.LinearElastic(3.0, 0.49), integration=s.integration) for s in solids]
        one = abut.Model(mesh, solids, held, kinematics=kinematics)
        whole, parts = serial(one), dealt(one, 4)
        u, heat = moved(one)
        mine, theirs = whole.deform(u, heat), parts.deform(u, heat)
        close(mine.force, theirs.force)
        assert theirs.energy == pytest.approx(mine.energy, rel=TOLERANCE)
        for own, other in zip(whole.stress(u, heat), parts.stress(u, heat)):
            close(own, other)
        v = np.random.default_rng(5).normal(size=u.size)
        close(whole.internal(v), parts.internal(v))
        assert mine.tangent is not None
        assert theirs.tangent is not None
        close(mine.tangent.internal(v), theirs.tangent.internal(v))


def test_bodies_that_relax_add_up() -> None:
    """Every process knows the time since the history."""
    mesh = join({"a": box(cells=(2, 3, 2), cell="hex8")})
    law = abut.Viscoelastic(abut.Hencky(10.0, 0.3), [(0.5, 0.2, 2.0)])
    held = [abut.Support("a.bottom", x=0.0, y=0.0, z=0.0)]
    relaxing = abut.Model(mesh, [abut.Solid("a", law)], held, kinematics="finite")
    whole, parts = serial(relaxing), dealt(relaxing, 3)
    u, _ = moved(relaxing)
    late = TemperatureChange(elapsed=3.0)
    one, other = whole.deform(u, late), parts.deform(u, late)
    close(one.force, other.force)
    assert np.abs(one.force - whole.deform(u, TemperatureChange()).force).max() > 0.1 * np.abs(one.force).max()
    again, also = whole.deform(u, late, one.history), parts.deform(u, late, other.history)
    close(again.force, also.force)
    close(one.history["a"], other.history["a"])
