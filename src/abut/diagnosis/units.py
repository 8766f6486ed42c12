"""Checks of units: whether sizes, materials and loads are consistent."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from abut.contact.geometry import full_moments
from abut.diagnosis.finding import Finding
from abut.materials.softest import softest
from abut.mesh.facets import bodies_at
from abut.mesh.mesh import Mesh
from abut.model import Force, Gravity, Model, Pressure, Traction
from abut.problem.idle_loads import idle_loads

UNLIKE = 300.0  # ratio of bodies' sizes that one would expect of metres beside millimetres, hardly of a design
STIFF = 1e5  # ratio of Young's moduli: steel on rubber is 4e4
STRAINED, UNSTRAINED = 0.05, 1e-8  # strain by a load alone that is too much, and hardly any
FAR = 0.1  # prescribed displacement over the size of the body
SOUND = {
    "metres": (9.0, 11.0, 20.0, 5e4),
    "millimetres": (9e3, 11e3, 2e4, 5e7),
}  # gravity from, to; sqrt(E / density) likewise


def units(model: Model) -> list[Finding]:
    """Findings on sizes, moduli, loads, prescribed displacements, gravity, and loads that find nothing to act on."""
    idle = [Finding("warning", one.where, one.what, one.cure) for one in idle_loads(model)]
    return [*_sizes(model), *_moduli(model), *_loads(model), *_prescribed(model), *_gravity(model), *idle]


def body_size(mesh: Mesh, body: str) -> float:
    """Largest extent of a body."""
    return float(np.ptp(mesh.points[mesh.nodes_of(body)], axis=0).max())


def _sizes(model: Model) -> list[Finding]:
    size = {body: body_size(model.mesh, body) for body in model.mesh.bodies}
    return _far_apart(
        size,
        UNLIKE,
        lambda small, large, _: (
            f"one is {small:.3g} in size, the other {large:.3g}: is one meshed in metres, the other in millimetres?"
        ),
        "scale the coordinates of one of them by 1000",
    )


def _moduli(model: Model) -> list[Finding]:
    return _far_apart(
        {body: material.modulus for body, material in model.materials.items()},
        STIFF,
        lambda soft, stiff, ratio: (
            f"Young's moduli {soft:.3g} and {stiff:.3g} differ {ratio:.0e} times: is one in Pa, the other in MPa?"
        ),
        "give both in one unit, force over the mesh's length squared",
    )


def _far_apart(
    values: dict[str, float], limit: float, what: Callable[[float, float, float], str], cure: str
) -> list[Finding]:
    """A warning where the smallest and the largest value of all bodies are further apart than a factor; what: the text for
    both and their ratio."""
    if not values:
        return []
    small, large = min(values, key=lambda b: values[b]), max(values, key=lambda b: values[b])
    if not values[large] > limit * values[small]:
        return []
    text = what(values[small], values[large], values[large] / values[small])
    return [Finding("warning", f"bodies '{small}' and '{large}'", text, cure)]


def _loads(model: Model) -> list[Finding]:
    """The strain that a surface load makes in its own body: load per area over Young's modulus."""
    findings = []
    for i, load in enumerate(model.loads):
        if not isinstance(load, (Pressure, Traction, Force)) or callable(load.value):
            continue
        if load.on not in model.mesh.surfaces:  # a force at a reference
            continue
        size = float(np.linalg.norm(load.value))
        if isinstance(load, Force):
            size /= float(full_moments(model.mesh.surface(load.on), 0)[:, 0].sum())
        cells = model.mesh.surfaces[load.on][:, 0]
        material = softest(model.mesh, model.materials, cells)
        if material is None or not size:
            continue
        strain = size / material.modulus
        body = next(b for b in bodies_at(model.mesh, cells) if model.materials.get(b) == material)
        if STRAINED > strain > UNSTRAINED:
            continue
        large = strain >= STRAINED
        if large and not model.small_strains:
            continue
        says = "more than small strains allow" if large else "which is close to zero"
        findings.append(
            Finding(
                "warning" if large else "advice",
                f"loads[{i}] on '{load.on}'",
                f"{size:.3g} per area strains body '{body}' (Young's modulus {material.modulus:.3g}) by about {strain:.0e}, "
                f"{says}",
                "give load and Young's modulus in one unit, such as N and mm with MPa, or N and m with Pa",
            )
        )
    return findings


def _prescribed(model: Model) -> list[Finding]:
    findings = []
    for i, support in enumerate(model.supports):
        nodes = model.mesh.nodes_of(support.on)
        values = [getattr(support, name) for name in ("x", "y", "z", "normal")]
        largest = max((abs(float(v)) for v in values if v is not None and not callable(v)), default=0.0)
        size = min(
            (body_size(model.mesh, b) for b in model.mesh.bodies if np.isin(nodes, model.mesh.nodes_of(b)).any()),
            default=np.inf,
        )
        if largest > FAR * size and not model.finite:
            findings.append(
                Finding(
                    "warning",
                    f"supports[{i}] on '{support.on}'",
                    f"a displacement of {largest:.3g} is {largest / size:.2g} times the size of its body ({size:.3g}): abut "
                    "takes displacements to be small",
                    "give it in the mesh's unit of length, or move the body in the mesh",
                )
            )
    return findings


def _gravity(model: Model) -> list[Finding]:
    """Gravity tells the unit of length; with it goes a speed of sound that no material is far from."""
    findings = []
    for i, load in enumerate(model.loads):
        if not isinstance(load, Gravity):
            continue
        size = float(np.linalg.norm(load.value))
        solids = [s for s in model.solids if load.on in (None, s.body)]
        for solid in solids:
            name, density = solid.body, solid.material.density
            if density == 0.0:
                continue
            speed = float(np.sqrt(solid.material.modulus / density))
            for unit, (least, most, slow, fast) in SOUND.items():
                if least <= size <= most and not slow <= speed <= fast:
                    findings.append(
                        Finding(
                            "warning",
                            f"loads[{i}]",
                            f"gravity of {size:.4g} speaks of {unit}, where sound in body '{name}' would run at {speed:.1e} "
                            f"{unit} per second",
                            "give density and Young's modulus in the same units: kg/m^3 with Pa, or t/mm^3 (steel 7.85e-9) "
                            "with MPa",
                        )
                    )
    return findings
