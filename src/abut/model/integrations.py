"""How the cells of each solid are integrated, "auto" resolved; which have pressures that are continuous."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from abut.bodies.integration import check_integration, check_resolved, resolved
from abut.mesh.mesh import Mesh
from abut.mesh.quadrature import CONTINUOUS
from abut.model.solid import Solid


@dataclass(frozen=True)
class Integrations:
    """plane: as the model's; finite: under finite strains."""

    mesh: Mesh
    solids: Sequence[Solid]
    plane: str | None
    finite: bool

    def of(self, solid: Solid) -> str:
        """Of one of the solids."""
        return resolved(solid.integration, self.kinds(solid.body), self.plane, solid.law, self.finite)

    def check(self, solid: Solid, where: str) -> None:
        """Raises InputError, beginning with ``where``, for cells and materials that it is not for."""
        kinds = self.kinds(solid.body)
        check_integration(solid.integration, kinds, self.plane, where)
        check_resolved(self.of(solid), kinds, solid.law, self.plane, self.finite, where)

    @property
    def by_body(self) -> dict[str, str]:
        """Of all."""
        return {solid.body: self.of(solid) for solid in self.solids}

    @property
    def kinematics(self) -> str:
        """Of the strains."""
        return "finite" if self.finite else "small"

    @property
    def wide(self) -> list[str]:
        """Bodies whose pressures are continuous."""
        known = [solid for solid in self.solids if solid.body in self.mesh.bodies]
        tetrahedra = [solid for solid in known if any(kind in CONTINUOUS for kind in self.kinds(solid.body))]
        return [solid.body for solid in tetrahedra if self.of(solid) == "mixed"]

    def kinds(self, body: str) -> list[str]:
        """Types of its cells."""
        return sorted({kind for kind, _, _ in self.mesh.cells_of(body)})
