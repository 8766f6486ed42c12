"""Small and finite deformation: which materials go with which."""

from __future__ import annotations

from collections.abc import Sequence

from abut import checks
from abut.errors import InputError
from abut.materials.hyperelastic import NeoHooke, law
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
