"""Every two bodies that may come together, and every body with itself: contacts of bodies that move anywhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from abut.contact.contactor_choice import Choice, choose, side
from abut.contact.geometry import facet_sizes, full_moments, mean_normals, straight
from abut.errors import InputError, nearest
from abut.materials.material import Material
from abut.materials.softest import contact_modulus
from abut.mesh.exterior import exterior
from abut.mesh.mesh import Mesh
from abut.mesh.surface import Surface
from abut.model import Contact, Solid


@dataclass(frozen=True)
class BodyPair:
    """Two bodies, the contactor first, or one twice; reason: why it is the contactor."""

    bodies: tuple[str, str]
    reason: str

    def contact(self, name: str = "", **options: object) -> Contact:
        """The contact of a model; ``options`` as for ``abut.Contact``."""
        shown = "-".join(self.bodies)
        return Contact(*self.bodies, name=f"{name}-{shown}" if name else shown, **options)  # type: ignore[arg-type]

    @property
    def note(self) -> str:
        """What was chosen, in one line."""
        first, second = self.bodies
        with_itself = f"'{first}' may touch itself"
        return with_itself if first == second else f"'{first}' (contactor: {self.reason}) may meet '{second}'"


def every_pair(mesh: Mesh, solids: Sequence[Solid], bodies: Sequence[str] | None = None) -> tuple[BodyPair, ...]:
    """All pairs of bodies (of ``bodies``, if given) that are not both rigid, and each deformable body with itself. Without
    a material a body is rigid. Raises InputError for bodies that the mesh has not."""
    for name in bodies or ():
        if name not in mesh.bodies:
            raise InputError(f"bodies: no body named {name!r} in the mesh{nearest(name, mesh.bodies)}")
    materials = {solid.body: solid.material for solid in solids}
    names = [name for name in mesh.bodies if bodies is None or name in bodies]
    outside = exterior(mesh)
    surfaces = {name: straight(mesh.facets(outside[np.isin(outside[:, 0], mesh.bodies[name])])) for name in names}
    result = [BodyPair((name, name), "") for name in names if name in materials]
    for pair in combinations(names, 2):
        if not any(name in materials for name in pair):
            continue
        chosen = _choose([surfaces[name] for name in pair], [materials.get(name) for name in pair])
        first = chosen.contactor
        result.append(BodyPair((pair[first], pair[1 - first]), chosen.reason))
    return tuple(result)


def _choose(surfaces: Sequence[Surface], materials: Sequence[Material | None]) -> Choice:
    sides = []
    for surface, material in zip(surfaces, materials):
        area = full_moments(surface, 0)[:, 0]
        modulus = contact_modulus(material)
        sides.append(side(facet_sizes(surface), area, mean_normals(surface), float(area.sum()), modulus))
    return choose(*sides)
