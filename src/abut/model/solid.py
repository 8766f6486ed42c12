"""A body of the mesh with its material."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from abut import checks
from abut.bodies.integration import INTEGRATIONS
from abut.errors import InputError
from abut.fields import Given, number_or_field
from abut.materials.material import Material, is_small
from abut.materials.prestressed import Prestressed


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

    initial_stress : sequence, optional
        Stress that the undeformed body has, xx yy zz xy (and yz zx in 3D), each a number, an expression of position or a
        function of points (n, dim) [force per area]: it stays where it is balanced, and springs back where not, from the
        first step on. Axisymmetric: radial, axial, hoop, and their shear.

    Raises
    ------
    InputError
        For an integration that does not exist, and stresses that are none.

    Examples
    --------
    >>> import abut
    >>> steel = abut.LinearElastic(210e3, 0.3)
    >>> rolled = abut.Solid("plate", steel, initial_stress=("100*y", 0, 0, 0, 0, 0))
    """

    body: str
    material: Material
    temperature: float = 0.0
    integration: str = "auto"
    initial_stress: Sequence[Given] | None = None

    def __post_init__(self) -> None:
        checks.choice(self.integration, f"solid '{self.body}': integration", INTEGRATIONS)
        if not isinstance(self.material, Material):
            raise InputError(
                f"solid '{self.body}': material: expected LinearElastic or a material of your own, got "
                f"{type(self.material).__name__}; see abut.materials.material.OwnMaterial"
            )
        checks.finite(self.temperature, f"solid '{self.body}': temperature")
        if self.initial_stress is not None:
            where = f"solid '{self.body}': initial_stress"
            given = checks.listed(self.initial_stress, where, "stresses")
            if len(given) not in (4, 6):
                raise InputError(
                    f"{where}: expected xx yy zz xy in 2D, xx yy zz xy yz zx in 3D, got {len(given)} values"
                )
            if not is_small(self.material):
                raise InputError(
                    f"{where}: rubber and other materials for finite strains alone hold none; take one that is linear at "
                    "small strains"
                )
            object.__setattr__(self, "initial_stress", tuple(number_or_field(value, where) for value in given))

    @property
    def law(self) -> Material:
        """The material with the initial stress."""
        if self.initial_stress is None:
            return self.material
        return Prestressed(self.material, tuple(self.initial_stress), f"solid '{self.body}'")
