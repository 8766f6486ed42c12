"""Small and finite deformation, and small strains of bodies that slide far: which materials go with which."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from abut import checks
from abut.errors import InputError
from abut.materials.material import is_finite, is_small
from abut.mesh.mesh import Mesh
from abut.model.conditions import Equation, Support
from abut.model.contact import METHODS, Contact
from abut.model.solid import Solid
from abut.model.step_ends import SAME

KINEMATICS = ("small", "finite", "small-strain")


def check_kinematics(kinematics: str, solids: Sequence[Solid]) -> None:
    """Raise InputError for other names than those of ``KINEMATICS``, and for materials that do not know such strains."""
    checks.choice(kinematics, "model.kinematics", KINEMATICS)
    for i, solid in enumerate(solids):
        name = type(solid.material).__name__
        if kinematics == "finite" and not is_finite(solid.material):
            raise InputError(
                f"solids[{i}].material: {name} of body '{solid.body}' is a law for small strains; give it evaluate_finite "
                '(abut.materials.material.FiniteMaterial), or take kinematics = "small" or "small-strain"'
            )
        if kinematics != "finite" and not is_small(solid.material):
            raise InputError(
                f"solids[{i}].material: {name} of body '{solid.body}' is for finite strains; use kinematics = \"finite\", "
                "or a linear elastic material"
            )


def _check_contact(contact: Contact) -> None:
    """Raise InputError for what goes with contact between undeformed surfaces only."""
    if contact.kind != "tied" and contact.method != METHODS[0]:
        raise InputError(
            f"contact '{contact.name}': method: {contact.method} goes with kinematics = \"small\" only; leave it out"
        )
    if contact.kind == "tied" and contact.since > SAME:
        raise InputError(
            f"contact '{contact.name}': since: a tie begins on the way with kinematics = \"small\" only: surfaces that have "
            "slid do not face each other as at the outset; tie from the start, or model the next state as a job of its own"
        )


def check_finite(
    mesh: Mesh,
    contacts: Sequence[Contact],
    equations: Sequence[Equation],
    moving: Mapping[int, str],
    supports: Sequence[Support],
) -> None:
    """Raise InputError for what finite deformation does not go with; moving: as from ``coupling.moving_points``."""
    for contact in contacts:
        _check_contact(contact)
    for i, support in enumerate(supports):
        if support.normal:
            raise InputError(
                f"supports[{i}].normal: a motion along normals has no meaning once they turn; give x, y, z, or normal = 0 "
                "for a symmetry plane"
            )
    for i, support in enumerate(supports):
        held = next((moving[n] for n in mesh.nodes_of(support.on).tolist() if n in moving), None) if moving else None
        if held is not None:
            raise InputError(
                f"supports[{i}].on: '{support.on}' has points of {held}, which move as a whole; take them out of it, and "
                f"prescribe the motion of {held}"
            )
    for i, equation in enumerate(equations):
        for term in equation.terms:
            nodes = mesh.node_sets[term.on].tolist() if isinstance(term.on, str) else [term.on]
            if nodes[0] in moving:
                raise InputError(
                    f"equations[{i}]: {term.on!r} is a point of {moving[nodes[0]]}, which may turn; take the equation out"
                )
