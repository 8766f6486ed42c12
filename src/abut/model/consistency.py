"""Checks of supports and loads against the mesh: names, numbers of components, rigid bodies without common points."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from abut import checks
from abut.axes import Axes
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.model.body_forces import BodyForce, Centrifugal, Gravity, Load
from abut.model.conditions import COMPONENTS, TURNS, Equation, Rigid, Support
from abut.model.loads import Force, Moment, NodalForce, Pressure, Temperature, Traction


def check_filled(mesh: Mesh, named: Sequence[tuple[str, str | None]]) -> None:
    """Raise InputError for surfaces without facets, and node sets without nodes: what is stated there would be lost.

    named: where in the model, and the name."""
    for where, name in named:
        if not isinstance(name, str):
            continue
        if name in mesh.surfaces and not len(mesh.surfaces[name]):
            raise InputError(f"{where}: surface '{name}' has no facets; fill it in the mesh, or take this entry out")
        if name not in mesh.surfaces and name in mesh.node_sets and not len(mesh.node_sets[name]):
            raise InputError(f"{where}: node set '{name}' has no nodes; fill it in the mesh, or take this entry out")


def check_supports(mesh: Mesh, supports: Sequence[Support]) -> None:
    """Raise InputError for places that do not exist, and components that do not."""
    for i, support in enumerate(supports):
        if support.normal is None:
            checks.known(support.on, [*mesh.surfaces, *mesh.node_sets], f"supports[{i}].on", "surface or node set")
        else:
            checks.known(support.on, mesh.surfaces, f"supports[{i}].on", "surface (normal needs facets)")
        check_axes(mesh, support.axes, f"supports[{i}]")
        if mesh.dim == 2 and support.z is not None:
            raise InputError(f"supports[{i}].z: the model is 2D; leave z out")


def check_axes(mesh: Mesh, axes: Axes | None, where: str) -> None:
    """Raise InputError, beginning with ``where``, for local axes that do not go with the mesh."""
    if axes is None:
        return
    axes.check(mesh.dim, where)
    if mesh.axisymmetric and axes.kind != "rectangular":
        raise InputError(f"{where}.axes: the model is axisymmetric: x is radial already; leave axes out")


def check_loads(mesh: Mesh, loads: Sequence[Load], rigid: Collection[str], couplings: Collection[str]) -> None:
    """Raise InputError for places that do not exist, vectors of another dimension, and what rigid bodies cannot carry.

    rigid, couplings: their names."""
    for i, load in enumerate(loads):
        if isinstance(load, (Gravity, Centrifugal, BodyForce)):
            if load.on is not None:
                checks.known(load.on, mesh.bodies, f"loads[{i}].on", "body")
            if isinstance(load, (Gravity, Centrifugal)) and load.on in rigid:
                raise InputError(f"loads[{i}].on: '{load.on}' is rigid and has no density; give its weight as a force")
            if isinstance(load, Centrifugal):
                _check_centrifugal(mesh, load, f"loads[{i}]")
                continue
        elif isinstance(load, Moment):
            checks.known(load.on, [*rigid, *couplings], f"loads[{i}].on", "rigid body or coupling")
            _check_moment(mesh, load, f"loads[{i}]")
            continue
        elif isinstance(load, Force):
            known = [*mesh.surfaces, *rigid, *couplings]
            checks.known(load.on, known, f"loads[{i}].on", "surface, rigid body or coupling")
            if load.bearing and load.on not in mesh.surfaces:
                raise InputError(f"loads[{i}].bearing: '{load.on}' is no surface; leave bearing out")
            if load.bearing and mesh.axisymmetric:
                raise InputError(
                    f"loads[{i}].bearing: bearing loads are not axisymmetric; take a pressure, or a 3D model"
                )
        else:
            _check_place(mesh, load, f"loads[{i}].on")
            check_axes(mesh, getattr(load, "axes", None), f"loads[{i}]")
            if isinstance(load, Temperature) and load.on in rigid and load.on not in mesh.node_sets:
                raise InputError(f"loads[{i}].on: '{load.on}' is rigid and does not expand; take the temperature out")
        if isinstance(load, (Pressure, Temperature)) or callable(load.value):
            continue
        if len(load.value) != mesh.dim:
            raise InputError(f"loads[{i}].value: expected {mesh.dim} components, got {len(load.value)}")


def _check_centrifugal(mesh: Mesh, load: Centrifugal, where: str) -> None:
    if mesh.dim == 3 and load.axis is None:
        raise InputError(f"{where}: axis is missing; give its direction, as [0, 0, 1]")
    if mesh.dim == 2 and load.axis is not None:
        which = "y" if mesh.axisymmetric else "z"
        raise InputError(f"{where}: axis: the axis of this model is {which}; leave it out")
    if mesh.axisymmetric and load.through is not None:
        raise InputError(f"{where}: through: the axis of this model is y; leave it out")
    for name in ("axis", "through"):
        value = getattr(load, name)
        if value is not None and len(value) != mesh.dim:
            raise InputError(f"{where}.{name}: expected {mesh.dim} components, got {len(value)}")


def _check_moment(mesh: Mesh, load: Moment, where: str) -> None:
    if mesh.axisymmetric:
        raise InputError(f"{where}: nothing turns in an axisymmetric model; take the moment out")
    wanted = 3 if mesh.dim == 3 else 1
    if len(load.value) != wanted:
        raise InputError(f"{where}.value: expected {wanted} component{'s' * (wanted > 1)}, got {len(load.value)}")


def _check_place(mesh: Mesh, load: Pressure | Traction | NodalForce | Temperature, where: str) -> None:
    if isinstance(load, NodalForce):
        checks.known(load.on, [*mesh.surfaces, *mesh.node_sets], where, "surface or node set")
    elif isinstance(load, Temperature):
        checks.known(load.on, [*mesh.node_sets, *mesh.bodies], where, "node set or body")
    else:
        checks.known(load.on, mesh.surfaces, where, "surface")


def check_rigid(mesh: Mesh, bodies: Sequence[Rigid]) -> None:
    """Raise InputError for bodies that do not exist, are given twice or share points, and motions that plane models lack."""
    owner: dict[int, str] = {}
    exist = ("y",) if mesh.axisymmetric else ("x", "y", "rz") if mesh.dim == 2 else (*COMPONENTS, *TURNS)
    for i, rigid in enumerate(bodies):
        checks.known(rigid.body, mesh.bodies, f"rigid[{i}].body", "body")
        if rigid.reference is not None and len(rigid.reference) != mesh.dim:
            raise InputError(f"rigid[{i}].reference: expected {mesh.dim} numbers, got {len(rigid.reference)}")
        for name in (*COMPONENTS, *TURNS):
            if name not in exist and getattr(rigid, name):
                plane = "axisymmetric" if mesh.axisymmetric else "2D"
                raise InputError(f"rigid[{i}].{name}: the model is {plane}; leave {name} out")
        nodes = {int(n) for _, cells, _ in mesh.cells_of(rigid.body) for n in np.unique(cells)}
        if rigid.body in owner.values():
            raise InputError(f"rigid[{i}].body: body '{rigid.body}' is given twice; keep one of them")
        shared = nodes & owner.keys()
        if shared:
            raise InputError(
                f"rigid[{i}].body: '{rigid.body}' and '{owner[min(shared)]}' are rigid and share points; make "
                "them one body"
            )
        owner |= dict.fromkeys(nodes, rigid.body)


def check_supported(mesh: Mesh, names: Sequence[str], where: str) -> None:
    """Raise InputError for names of what equations or couplings support that nothing has."""
    for name in names:
        checks.known(name, [*mesh.surfaces, *mesh.node_sets, *mesh.bodies], where, "surface, node set or body")


def check_equations(mesh: Mesh, equations: Sequence[Equation]) -> None:
    """Raise InputError for terms at no point, or at several, components that do not exist, and supports on nothing."""
    for i, equation in enumerate(equations):
        check_supported(mesh, equation.supports, f"equations[{i}].supports")
        for j, term in enumerate(equation.terms):
            where = f"equations[{i}].terms[{j}]"
            if isinstance(term.on, str):
                checks.known(term.on, mesh.node_sets, f"{where}.on", "node set")
                if len(mesh.node_sets[term.on]) != 1:
                    count = len(mesh.node_sets[term.on])
                    raise InputError(f"{where}.on: node set '{term.on}' has {count} nodes; a term is for one")
            elif not 0 <= term.on < len(mesh.points):
                raise InputError(f"{where}.on: no point {term.on}; the mesh has {len(mesh.points)}, from 0")
            if term.component not in COMPONENTS[: mesh.dim]:
                raise InputError(f"{where}.component: the model is 2D; z does not exist")


def check_axis(mesh: Mesh) -> None:
    """Raise InputError for points of an axisymmetric mesh beyond its axis."""
    radius = mesh.points[:, 0]
    bad = np.flatnonzero(radius < -1e-9 * np.ptp(mesh.points, axis=0).max())
    if len(bad):
        raise InputError(
            f"model.plane: axisymmetric needs radii x >= 0, but {len(bad)} points lie at x < 0 (point {bad[0]} at "
            f"{mesh.points[bad[0]].tolist()}); mesh one half of the section only"
        )
