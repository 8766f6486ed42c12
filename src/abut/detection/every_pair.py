"""Every two bodies that may come together, and every body with itself: contacts of bodies that move anywhere."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

from abut.errors import InputError, nearest
from abut.mesh.mesh import Mesh
from abut.model import Contact, Solid


@dataclass(frozen=True)
class BodyPair:
    """Two bodies in the order of the mesh, or one twice."""

    bodies: tuple[str, str]

    def contact(self, name: str = "", **options: object) -> Contact:
        """The contact of a model, which chooses the contactor; ``options`` as for ``abut.Contact``."""
        shown = "-".join(self.bodies)
        return Contact(*self.bodies, name=f"{name}-{shown}" if name else shown, **options)  # type: ignore[arg-type]

    @property
    def note(self) -> str:
        """What was found, in one line; of two bodies the model's choice of the contactor says it."""
        first, second = self.bodies
        return f"'{first}' may touch itself" if first == second else ""


def every_pair(mesh: Mesh, solids: Sequence[Solid], bodies: Sequence[str] | None = None) -> tuple[BodyPair, ...]:
    """All pairs of bodies (of ``bodies``, if given) that are not both rigid, and each deformable body with itself. Without
    a material a body is rigid. Raises InputError for bodies that the mesh has not."""
    for name in bodies or ():
        if name not in mesh.bodies:
            raise InputError(f"bodies: no body named {name!r} in the mesh{nearest(name, mesh.bodies)}")
    materials = {solid.body: solid.material for solid in solids}
    names = [name for name in mesh.bodies if bodies is None or name in bodies]
    result = [BodyPair((name, name)) for name in names if name in materials]
    result += [BodyPair(pair) for pair in combinations(names, 2) if any(name in materials for name in pair)]
    return tuple(result)
