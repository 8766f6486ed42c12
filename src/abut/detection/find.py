"""find_contacts: pairs of surfaces of different bodies that face each other, contactor and target chosen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from abut import checks
from abut.contact.contactor_choice import Choice, choose, side, where_contact_begins
from abut.detection.opposing_facets import Facing, Outside, facing, outside, seen_by
from abut.errors import InputError, nearest
from abut.materials.material import Material
from abut.materials.softest import contact_modulus
from abut.mesh.mesh import Mesh
from abut.model import Contact, Solid

AUTO = "auto:"  # what the names of found surfaces begin with
BEND = np.cos(np.deg2rad(45.0))  # facets beyond a sharper edge are not added around those that face something


@dataclass(frozen=True)
class FoundContact:
    """Two surfaces that face each other.

    Parameters
    ----------
    contactor, target : str
        Names for the surfaces: "auto:lug-pin" belongs to body 'lug' and faces 'pin'.
    bodies : (str, str)
        The contactor's and the target's.
    contactor_facets, target_facets : (n, 2) array of int
        Rows (cell, local facet).
    gap : (float, float)
        The smallest and the largest distance found [length], negative where they overlap.
    reason : str
        Why this side is the contactor.
    """

    contactor: str
    target: str
    bodies: tuple[str, str]
    contactor_facets: NDArray[np.int64]
    target_facets: NDArray[np.int64]
    gap: tuple[float, float]
    reason: str

    def contact(self, **options: Any) -> Contact:
        """The contact of a model; ``options`` as for ``abut.Contact``."""
        name = options.pop("name", "") or f"{self.bodies[0]}-{self.bodies[1]}{_patch(self.contactor)}"
        return Contact(contactor=self.contactor, target=self.target, name=name, chosen=self.reason, **options)

    @property
    def note(self) -> str:
        """What was found and chosen, in one line."""
        return (
            f"found: '{self.contactor}' ({len(self.contactor_facets)} facets, contactor: {self.reason}) faces "
            f"'{self.target}' ({len(self.target_facets)} facets), gap {self.gap[0]:.3g} to {self.gap[1]:.3g}"
        )


@dataclass(frozen=True)
class _Patch:
    """Facets (numbers of an ``Outside``) of two bodies that face each other, each side connected."""

    bodies: tuple[int, int]
    facets: tuple[NDArray[np.int64], NDArray[np.int64]]
    faces: Facing


def find_contacts(
    mesh: Mesh, solids: Sequence[Solid] = (), *, reach: float | None = None, bodies: Sequence[str] | None = None
) -> tuple[FoundContact, ...]:
    """Surfaces on the outside of different bodies that face each other: one pair for two bodies and each connected patch.

    The contactor is chosen as in ``abut.contact.contactor_choice``. Each patch is widened by the facets around it, so
    that contact may move, and the target by what the contactor sees. A facet may belong to several pairs.

    Parameters
    ----------
    mesh : Mesh
        Bodies are looked at from outside; their surfaces need no names.
    solids : sequence of Solid, optional
        The bodies' materials. A body without one counts as rigid; where there are no solids all count as alike.
    reach : float, optional
        The largest gap [length]. Left out: half the sum of two facets' sizes; overlaps count up to half of that.
    bodies : sequence of str, optional
        Look at these only.

    Returns
    -------
    tuple of FoundContact
        One for each pair of patches; empty where nothing is near.

    Raises
    ------
    InputError
        For a reach that is not positive, and for unknown bodies.

    Examples
    --------
    >>> import abut
    >>> from abut.mesh import make
    >>> blocks = {"a": make.rectangle([0, 2], [0, 1], cells=[2, 1]), "b": make.rectangle([0, 2], [1, 2], cells=[4, 2])}
    >>> mesh = make.join(blocks)
    >>> (found,) = abut.find_contacts(mesh)
    >>> found.contactor, found.target, found.reason
    ('auto:a-b', 'auto:b-a', 'coarser')
    >>> mesh = abut.add_surfaces(mesh, [found])
    >>> contacts = [found.contact()]  # of a Model of this mesh
    """
    checks.instance(mesh, Mesh, "find_contacts", "a mesh (abut.Mesh)")
    solids = checks.records(solids, "find_contacts: solids", (Solid,))
    if reach is not None:
        checks.positive(reach, "reach")
    bodies = None if bodies is None else checks.listed(bodies, "find_contacts: bodies", "names")
    for name in bodies or ():
        if name not in mesh.bodies:
            raise InputError(f"bodies: no body named {name!r} in the mesh{nearest(name, mesh.bodies)}")
    names = [name for name in mesh.bodies if bodies is None or name in bodies]
    if not names:
        return ()
    every = outside(mesh, names)
    patches = _patches(every, facing(every, reach))
    materials = {solid.body: solid.material for solid in solids} or None
    count: dict[tuple[int, int], int] = {}
    result = []
    for patch in patches:
        chosen = _choose(every, patch, materials)
        first = chosen.contactor
        count[patch.bodies] = count.get(patch.bodies, 0) + 1
        number = f":{count[patch.bodies]}" if count[patch.bodies] > 1 else ""
        a, b = (every.names[i] for i in patch.bodies)
        surface = f"{AUTO}{a}-{b}{number}", f"{AUTO}{b}-{a}{number}"
        grown = [_widened(every, facets) for facets in patch.facets]
        grown[1 - first] = seen_by(every, grown[first], grown[1 - first])
        result.append(
            FoundContact(
                contactor=surface[first], target=surface[1 - first], bodies=(a, b) if first == 0 else (b, a),
                contactor_facets=every.rows[grown[first]], target_facets=every.rows[grown[1 - first]],
                gap=(float(patch.faces.gap.min()), float(patch.faces.gap.max())), reason=chosen.reason,
            )
        )  # fmt: skip
    return tuple(result)


def add_surfaces(mesh: Mesh, found: Sequence[FoundContact]) -> Mesh:
    """The mesh with the surfaces of found contacts under their names.

    Parameters
    ----------
    mesh : Mesh
        The mesh in which they were found.
    found : sequence of FoundContact
        From ``find_contacts``.

    Returns
    -------
    Mesh
        The same with more surfaces.

    Raises
    ------
    InputError
        Where it has such names already.
    """
    checks.instance(mesh, Mesh, "add_surfaces", "a mesh (abut.Mesh)")
    surfaces = dict(mesh.surfaces)
    for contact in checks.listed(found, "add_surfaces: found", "found contacts"):
        checks.instance(contact, FoundContact, "add_surfaces: found", "what find_contacts returns (abut.FoundContact)")
        for name, rows in ((contact.contactor, contact.contactor_facets), (contact.target, contact.target_facets)):
            if name in surfaces:
                raise InputError(
                    f"mesh: a surface named '{name}' is there already, so that contact between bodies "
                    f"{contact.bodies[0]!r} and {contact.bodies[1]!r} cannot be named; rename the surface or a body"
                )
            surfaces[name] = rows
    return replace(mesh, surfaces=surfaces)


def _patch(name: str) -> str:
    """ ":2" of the second patch between two bodies."""
    number = name.rsplit(":", 1)[-1]
    return f":{number}" if number.isdigit() and name.count(":") > 1 else ""


def _patches(every: Outside, found: Facing) -> list[_Patch]:
    """Facets connected by common nodes or by facing each other, for two bodies each."""
    result = []
    n = len(every.names)
    code = every.body[found.one] * n + every.body[found.other]
    for number in np.unique(code):
        pairs = found.where(code == number)
        facets = np.unique(np.concatenate([pairs.one, pairs.other]))
        one, other = np.searchsorted(facets, pairs.one), np.searchsorted(facets, pairs.other)
        nodes = every.surface.nodes[facets]
        facet, local = np.nonzero(nodes >= 0)
        touch = sp.csr_matrix((np.ones(len(facet)), (facet, nodes[facet, local])))
        links = touch @ touch.T + sp.csr_matrix((np.ones(len(one)), (one, other)), shape=(len(facets),) * 2)
        _, label = connected_components(links, directed=False)
        for piece in np.unique(label):  # in the order of their first facets
            inside = pairs.where(label[one] == piece)
            sides = np.unique(inside.one), np.unique(inside.other)
            result.append(_Patch((int(number // n), int(number % n)), sides, inside))
    return result


def _choose(every: Outside, patch: _Patch, materials: dict[str, Material] | None) -> Choice:
    """Which side is the contactor; materials: by body, one without counts as rigid; None: there are none at all."""
    faces = patch.faces
    begins = where_contact_begins(faces.gap, every.size[faces.one] + every.size[faces.other])
    opposite = float(faces.area.sum())
    sides = [
        side(
            every.size[np.unique(those[begins])], every.area[facets], opposite,
            1.0 if materials is None else contact_modulus(materials.get(every.names[body])),
        )
        for body, facets, those in zip(patch.bodies, patch.facets, (faces.one, faces.other))
    ]  # fmt: skip
    return choose(*sides)


def _widened(every: Outside, core: NDArray[np.int64]) -> NDArray[np.int64]:
    """The facets with those around them on the same body that no sharp edge parts off."""
    nodes = every.surface.nodes
    normal = np.zeros_like(every.surface.points)
    facet, local = np.nonzero(nodes[core] >= 0)
    np.add.at(normal, nodes[core[facet], local], every.normal[core[facet]])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    free = np.flatnonzero(every.body == every.body[core[0]])
    facet, local = np.nonzero(nodes[free] >= 0)
    along = np.einsum("ij,ij->i", normal[nodes[free[facet], local]], every.normal[free[facet]])
    return np.union1d(core, free[facet[along > BEND]])
