"""Loads of a model: nodal forces and temperatures, one column for each of its histories."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut.bodies.assemble import thermal_load
from abut.bodies.bearing import bearing_load
from abut.bodies.loads import body_load, force_load, pressure_load, traction_load
from abut.bodies.solids import TemperatureChange
from abut.fields import evaluate
from abut.model import (
    BodyForce,
    Centrifugal,
    Force,
    Gravity,
    Load,
    Model,
    Moment,
    NodalForce,
    Pressure,
    Temperature,
    Traction,
)
from abut.model.conditions import weights
from abut.model.mirror_planes import at_ends
from abut.problem.joints import joint_loads
from abut.problem.rigid_bodies import RigidBody, rigid_bodies
from abut.problem.sections import preload_forces


@dataclass(frozen=True)
class Loads:
    """forces: (dim n_points, n_histories) nodal forces of loads and thermal strains; resultant: (dim, n_histories) of the
    loads; temperature: (n_points, n_histories) change at the nodes, without that of whole solids; following: (dim n_points,
    n_histories) of loads that follow the deformation and of connectors, before there is any, None where there are none."""

    forces: NDArray[np.float64]
    resultant: NDArray[np.float64]
    temperature: NDArray[np.float64]
    following: NDArray[np.float64] | None = None

    def at_ends(self, model: Model) -> list[NDArray[np.float64]]:
        """The nodal forces (dim n_points,) at the end of every load step, on undeformed bodies."""
        forces = self.forces if self.following is None else self.forces + self.following
        return [forces @ weights(model.histories, time) for time in model.ends]


def loads(model: Model) -> Loads:
    """Everything that loads a model, by history. Raises InputError for functions of position that do not return a finite
    value for each point."""
    applied, temperature = applied_load(model), nodal_temperature(model)
    resultant = applied.reshape(-1, model.dim, applied.shape[1]).sum(axis=0)
    strained = strain_load(model, temperature) if model.linear_bodies else 0.0  # others: with the stresses
    following = applied_load(model, True) if followers(model) else None
    if model.connectors:
        driving = joint_loads(model, rigid_bodies(model))
        following = driving if following is None else following + driving
    return Loads(applied + strained, resultant, temperature, following)


def followers(model: Model) -> list[Load]:
    """The loads of a model that follow the deformation: pressures, and those at references."""
    return [load for load in model.loads if _follows(model, load)]


def _follows(model: Model, load: Load) -> bool:
    return model.finite and (at_reference(model, load) or (isinstance(load, Pressure) and load.follows))


def at_reference(model: Model, load: Load) -> bool:
    """Whether a load acts at the reference of a rigid body or coupling."""
    return isinstance(load, Moment) or (isinstance(load, Force) and load.on not in model.mesh.surfaces)


def reference_body(model: Model, name: str) -> RigidBody:
    """The rigid body or coupling of a name."""
    return next(body for body in rigid_bodies(model) if body.name == name)


def applied_load(model: Model, following: bool = False) -> NDArray[np.float64]:
    """Nodal forces of all dead loads, or of those that follow the deformation, on undeformed bodies, (dim n_points,
    n_histories)."""
    histories = model.histories
    total = np.zeros((model.mesh.points.size, len(histories)))
    for load in model.loads:
        if not isinstance(load, Temperature) and _follows(model, load) == following:
            total[:, histories.index(load.amplitude)] += force_of(model, load)
    return total if following else total + preload_forces(model)


def nodal_temperature(model: Model) -> NDArray[np.float64]:
    """Change of temperature at the nodes, (n_points, n_histories)."""
    histories = model.histories
    total = np.zeros((len(model.mesh.points), len(histories)))
    for load in model.loads:
        if isinstance(load, Temperature):
            where = model.mesh.nodes_of(load.on)
            change = evaluate(load.value, model.mesh.points[where], f"temperature on '{load.on}': value")
            total[where, histories.index(load.amplitude)] += change
    return total


def strain_load(model: Model, temperature: NDArray[np.float64]) -> NDArray[np.float64]:
    """Nodal forces of thermal strains, (dim n_points, n_histories); whole solids are heated along the ramp."""
    uniform = [model.temperatures(1.0), *({} for _ in model.histories[1:])]
    return np.column_stack(
        [
            thermal_load(model.deformable, TemperatureChange(bodies, nodal))
            for bodies, nodal in zip(uniform, temperature.T)
        ]
    )


def _at_points(model: Model, load: Load) -> NDArray[np.float64]:
    """Of a load at a reference, on undeformed bodies."""
    body, forces = reference_body(model, load.on or ""), np.zeros(model.mesh.points.shape)
    forces[body.nodes] = body.spread(*force_and_moment(model, load))
    return forces.ravel()


def force_and_moment(model: Model, load: Load) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Force (dim,) and moment (1,) or (3,) of a load at a reference."""
    turns = 3 if model.dim == 3 else 1
    if isinstance(load, Moment):
        return np.zeros(model.dim), np.array(load.value)
    assert isinstance(load, Force)
    return np.array(load.value), np.zeros(turns)


def force_of(model: Model, load: Load) -> NDArray[np.float64]:
    """Nodal forces (dim n_points,) of one load that is no temperature, at its full value on undeformed bodies."""
    mesh = model.mesh
    if at_reference(model, load):
        return _at_points(model, load)
    if isinstance(load, Pressure):
        return pressure_load(mesh.surface(load.on), load.value, f"pressure on '{load.on}': value")
    if isinstance(load, Traction):
        return traction_load(mesh.surface(load.on), load.along, f"traction on '{load.on}': value")
    if isinstance(load, Force) and load.bearing:
        bore, where = mesh.surface(load.on), f"bearing force on '{load.on}'"
        return bearing_load(bore, np.array(load.value), at_ends(model, bore), where)
    if isinstance(load, Force):
        return force_load(mesh.surface(load.on), np.array(load.value))
    if isinstance(load, NodalForce):
        force = np.zeros(mesh.points.shape)
        nodes = mesh.nodes_of(load.on)
        force[nodes] = load.at(mesh.points[nodes])
        return force.ravel()
    if isinstance(load, Gravity):
        weights = {s.body: s.material.density * np.array(load.value) for s in model.solids}
        return body_load(mesh, weights if load.on is None else {load.on: weights[load.on]})
    if isinstance(load, Centrifugal):
        named = {s.body: _turned(load, s.material.density, mesh.axisymmetric) for s in model.solids}
        return body_load(mesh, named if load.on is None else {load.on: named[load.on]}, "centrifugal")
    assert isinstance(load, BodyForce)
    return body_load(mesh, dict.fromkeys(mesh.bodies if load.on is None else [load.on], load.value))


def _turned(
    load: Centrifugal, density: float, axisymmetric: bool
) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    """Force per volume at points."""
    return lambda points: density * load.at(points, axisymmetric)
