"""A body of the mesh with its material."""

from __future__ import annotations

from dataclasses import dataclass

from abut import checks
from abut.bodies.integration import INTEGRATIONS
from abut.errors import InputError
from abut.materials.material import Material


@dataclass(frozen=True)
class Solid:
    """A body of the mesh with its material.

    Parameters
    ----------
    body : str
        The body.
    material : Material
        ``LinearElastic``, ``NeoHooke``, another one of abut's, or one of your own
        (``abut.materials.material.OwnMaterial``).
    temperature : float
        A uniform change that strains it [temperature].
    integration : str
        Of its cells: "full"; "reduced" (fewer points: softer in bending, for tri6, quad8, tet10, hex20 and wedge15);
        "b-bar" (volume change averaged over each quad4 or hex8: no locking near Poisson's ratio 0.5; F-bar under finite
        deformation, theory (D7)); "mixed" (tri6, quad4, quad8, quad9, hex8, hex20, hex27: pressures of each cell's own,
        eliminated, theory (E6), (D19); tet10: pressures at corners, theory (E8), (D25), of materials whose mean stress is a
        matter of the volume alone: Poisson's ratios up to 0.5); "auto": the first that does not lock.

    Raises
    ------
    InputError
        For an integration that does not exist.
    """

    body: str
    material: Material
    temperature: float = 0.0
    integration: str = "auto"

    def __post_init__(self) -> None:
        checks.choice(self.integration, f"solid '{self.body}': integration", INTEGRATIONS)
        if not isinstance(self.material, Material):
            raise InputError(
                f"solid '{self.body}': material: expected LinearElastic or a material of your own, got "
                f"{type(self.material).__name__}; see abut.materials.material.OwnMaterial"
            )
        checks.finite(self.temperature, f"solid '{self.body}': temperature")
