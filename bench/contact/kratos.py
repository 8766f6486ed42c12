"""Kratos: model, material and parameter files of a case.

As a script, python bench/contact/kratos.py CASE DOFS FOLDER writes them; kratos_child.py runs them.

Augmented Lagrangian mortar contact with dual multipliers, frictionless or frictional, Newton-Raphson, residual criterion,
AMGCL, all with Kratos' own defaults; the slave side is abut's contactor.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import cases
import numpy as np

import abut
from abut.cells import BY_CODE
from abut.mesh.surface import Surface

ELEMENTS = {
    "hex8": "SmallDisplacementElement3D8N",
    "hex20": "SmallDisplacementElement3D20N",
    "tet10": "SmallDisplacementElement3D10N",
    "quad4": "SmallDisplacementElement2D4N",
}
LARGE = {kind: name.replace("SmallDisplacement", "TotalLagrangian") for kind, name in ELEMENTS.items()}
CONDITIONS = {
    "line2": "LineCondition2D2N",
    "quad4": "SurfaceCondition3D4N",
    "quad8": "SurfaceCondition3D8N",
    "tri6": "SurfaceCondition3D6N",
}
# Kratos numbers the edges of a hexahedron bottom, upright, top; abut bottom, top, upright.
ORDER = {"hex20": [*range(12), *range(16, 20), *range(12, 16)]}


def _block(name: str, lines: Iterable[str]) -> Iterator[str]:
    yield f"Begin {name}"
    yield from lines
    yield f"End {name.split()[0]}"


def _part(name: str, **members: Iterable[int]) -> Iterator[str]:
    def lines() -> Iterator[str]:
        for kind, numbers in members.items():
            yield from _block(f"SubModelPart{kind}", map(str, numbers))

    return _block(f"SubModelPart {name}", lines())


def mdpa(case: abut.Model) -> Iterator[str]:
    """The lines of the model part file: nodes, elements, contact faces, parts."""
    mesh, contact = case.mesh, case.contacts[0]
    for i in range(len(case.solids) + 1):
        yield from _block(f"Properties {i}", ())
    points = np.pad(mesh.points, ((0, 0), (0, 3 - mesh.dim))).tolist()
    yield from _block("Nodes", (f"{i} {x!r} {y!r} {z!r}" for i, (x, y, z) in enumerate(points, 1)))
    for i, solid in enumerate(case.solids, 1):
        for kind, nodes, numbers in mesh.cells_of(solid.body):
            table = np.column_stack([numbers, nodes[:, ORDER.get(kind, slice(None))]]) + 1
            rows = (f"{row[0]} {i} {' '.join(map(str, row[1:]))}" for row in table.tolist())
            names = LARGE if case.kinematics == "finite" else ELEMENTS
            yield from _block(f"Elements {names[kind]}", rows)
    first, faces, sides = 1, [], [surface_of(mesh, name) for name in (contact.contactor, contact.target)]
    for i, surface in enumerate(sides, 1):
        kind = BY_CODE[int(surface.kinds[0])]
        table = (surface.nodes[:, : kind.nodes] + 1).tolist()
        rows = (f"{number} {i} {' '.join(map(str, row))}" for number, row in enumerate(table, first))
        yield from _block(f"Conditions {CONDITIONS[kind.name]}", rows)
        faces.append(range(first, first + len(table)))
        first += len(table)
    for body in mesh.bodies:
        cells = (mesh.bodies[body] + 1).tolist()
        yield from _part(f"body_{body}", Nodes=(mesh.nodes_of(body) + 1).tolist(), Elements=cells)
    for part, surface, numbers in zip(("slave", "master"), sides, faces):
        yield from _part(part, Nodes=(surface.node_ids + 1).tolist(), Conditions=numbers)
    for i, support in enumerate(case.supports):
        yield from _part(f"support_{i}", Nodes=(mesh.nodes_of(support.on) + 1).tolist())


def surface_of(mesh: abut.Mesh, names: str | tuple[str, ...]) -> Surface:
    """One surface, or several together."""
    parts = [mesh.surface(name) for name in ([names] if isinstance(names, str) else names)]
    kinds, nodes = (np.concatenate([getattr(part, name) for part in parts]) for name in ("kinds", "nodes"))
    cells, local = (np.concatenate([getattr(part, name) for part in parts]) for name in ("cells", "local"))
    return replace(parts[0], kinds=kinds, nodes=nodes, cells=cells, local=local)


def materials(case: abut.Model) -> dict[str, Any]:
    """StructuralMaterials.json. Raises ValueError for laws that are not those of linear elasticity and von Mises
    plasticity with linear isotropic hardening under small strains, and neo-Hooke's with lambda/2 (ln J)^2."""
    return {
        "properties": [
            {
                "model_part_name": f"Structure.body_{solid.body}",
                "properties_id": i,
                "Material": {**_law(solid.material, case.kinematics), "Tables": {}},
            }
            for i, solid in enumerate(case.solids, 1)
        ]
    }


def _law(material: object, kinematics: str) -> dict[str, Any]:
    """Its name and constants."""
    more: dict[str, Any] = {}
    if isinstance(material, abut.LinearElastic):
        name = "LinearElastic3DLaw"
    elif isinstance(material, abut.NeoHooke) and material.volumetric == "log-squared":
        name = "HyperElastic3DLaw"
    elif _flows_linearly(material, kinematics):
        assert isinstance(material, abut.Plastic)
        name = "SmallStrainJ2Plasticity3DLaw"
        more = {
            "YIELD_STRESS": material.yield_stress,
            "ISOTROPIC_HARDENING_MODULUS": material.hardening,
            "EXPONENTIAL_SATURATION_YIELD_STRESS": material.yield_stress,
            "HARDENING_EXPONENT": 0.0,
        }
    else:
        raise ValueError(f"Kratos: {type(material).__name__} is not compared")
    constants = {"YOUNG_MODULUS": material.young, "POISSON_RATIO": material.poisson, **more}
    return {"constitutive_law": {"name": name}, "Variables": constants}


def _flows_linearly(material: object, kinematics: str) -> bool:
    return (
        isinstance(material, abut.Plastic)
        and kinematics != "finite"
        and isinstance(material.yield_stress, float)
        and not material.saturation
        and not material.backstresses
    )


def parameters(case: abut.Model) -> dict[str, Any]:
    """ProjectParameters.json; displacements grow with the time, to 1, where there is more than one load step."""
    given = case.solve.steps
    steps = given if isinstance(given, int) else 1
    supports = [
        {
            "python_module": "assign_vector_variable_process",
            "kratos_module": "KratosMultiphysics",
            "Parameters": {
                "model_part_name": f"Structure.support_{i}",
                "variable_name": "DISPLACEMENT",
                "constrained": [value is not None for value in (s.x, s.y, s.z)],
                "value": [
                    None if value is None else f"{value!r} * t" if steps > 1 else value for value in (s.x, s.y, s.z)
                ],
                "interval": [0.0, "End"],
            },
        }
        for i, s in enumerate(case.supports)
    ]
    friction = case.contacts[0].friction
    kind = "Frictional" if friction else "Frictionless"
    contact = {
        "python_module": "alm_contact_process",
        "kratos_module": "KratosMultiphysics.ContactStructuralMechanicsApplication",
        "Parameters": {
            "model_part_name": "Structure",
            "contact_model_part": {"0": ["slave", "master"]},
            "assume_master_slave": {"0": ["slave"]},
            "contact_type": kind,
            **({"friction_coefficients": {"0": friction}} if friction else {}),
        },
    }
    return {
        "problem_data": {
            "problem_name": "case",
            "parallel_type": "OpenMP",
            "start_time": 0.0,
            "end_time": 1.0 - 0.5 / steps,
            "echo_level": 0,
        },
        "solver_settings": {
            "solver_type": "Static",
            "model_part_name": "Structure",
            "domain_size": case.mesh.dim,
            "echo_level": 0,
            "analysis_type": "non_linear",
            "model_import_settings": {"input_type": "mdpa", "input_filename": "case"},
            "material_import_settings": {"materials_filename": "materials.json"},
            "time_stepping": {"time_step": 1.0 / steps if steps > 1 else 1.1},
            "contact_settings": {"mortar_type": f"ALMContact{kind}"},
            "convergence_criterion": "contact_residual_criterion",
            "compute_reactions": True,
            "max_iteration": 50,
            # Its reader of AMGCL's parameters for friction refuses their defaults (10.4.4); by this name it is not asked.
            "linear_solver_settings": {"solver_type": "KratosMultiphysics.amgcl" if friction else "amgcl"},
            "rotation_dofs": False,
        },
        "processes": {"constraints_process_list": supports, "contact_process_list": [contact]},
        "output_processes": {},
    }


def write(case: abut.Model, folder: Path) -> None:
    """Write case.mdpa, materials.json and parameters.json."""
    (folder / "case.mdpa").write_text("\n".join(mdpa(case)) + "\n", encoding="ascii")
    (folder / "materials.json").write_text(json.dumps(materials(case), indent=1), encoding="ascii")
    (folder / "parameters.json").write_text(json.dumps(parameters(case), indent=1), encoding="ascii")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("case")
    parser.add_argument("dofs", type=int)
    parser.add_argument("folder", type=Path)
    arguments = parser.parse_args()
    case = cases.model(arguments.case, arguments.dofs)
    write(case, arguments.folder)
    print(json.dumps({"dofs": cases.dofs(case)}))


if __name__ == "__main__":
    main()
