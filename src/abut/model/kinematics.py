"""Small and finite deformation: which materials go with which."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from abut import checks
from abut.errors import InputError
from abut.materials.hyperelastic import NeoHooke, law
from abut.mesh.mesh import Mesh
from abut.model.conditions import Equation, Rigid, Support
from abut.model.contact import METHODS, Contact
from abut.model.solid import Solid

KINEMATICS = ("small", "finite")


def check_kinematics(kinematics: str, solids: Sequence[Solid]) -> None:
    """Raise InputError for other names than those of ``KINEMATICS``, and for materials that do not know such strains."""
    checks.choice(kinematics, "model.kinematics", KINEMATICS)
    for i, solid in enumerate(solids):
        if kinematics == "finite" and law(solid.material) is None:
            raise InputError(
                f"solids[{i}].material: {type(solid.material).__name__} of body '{solid.body}' is a law for small strains; "
                'kinematics "finite" takes LinearElastic and NeoHooke'
            )
        if kinematics == "small" and isinstance(solid.material, NeoHooke):
            raise InputError(
                f"solids[{i}].material: the neo-Hookean material of body '{solid.body}' is for finite strains; use "
                'kinematics = "finite", or a linear elastic material'
            )


def _check_contact(contact: Contact) -> None:
    """Raise InputError for what goes with contact between undeformed surfaces only."""
    if contact.kind != "tied" and contact.method != METHODS[0]:
        raise InputError(
            f"contact '{contact.name}': method: {contact.method} goes with kinematics = \"small\" only; leave it out"
        )


def check_finite(
    mesh: Mesh,
    contacts: Sequence[Contact],
    equations: Sequence[Equation],
    rigid: Sequence[Rigid],
    supports: Sequence[Support],
) -> None:
    """Raise InputError for what finite deformation does not go with."""
    for contact in contacts:
        _check_contact(contact)
    for i, support in enumerate(supports):
        if support.normal:
            raise InputError(
                f"supports[{i}].normal: a motion along normals has no meaning once they turn; give x, y, z, or normal = 0 "
                "for a symmetry plane"
            )
    bodies = {int(n) for body in rigid for _, cells, _ in mesh.cells_of(body.body) for n in np.unique(cells)}
    for i, support in enumerate(supports):
        if bodies & set(mesh.nodes_of(support.on).tolist()):
            raise InputError(
                f"supports[{i}].on: '{support.on}' lies on a rigid body; prescribe the motion of that body"
            )
    for i, equation in enumerate(equations):
        for term in equation.terms:
            nodes = mesh.node_sets[term.on].tolist() if isinstance(term.on, str) else [term.on]
            if bodies & set(nodes):
                raise InputError(
                    f"equations[{i}]: {term.on!r} lies on a rigid body, which may turn; take the equation out"
                )
