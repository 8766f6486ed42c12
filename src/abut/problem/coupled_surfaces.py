"""The surfaces of a contact pair, cut against each other and integrated as its contact asks for."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

from abut.contact.clearance import of_corners, partly_adjusted
from abut.contact.coupling import Couple, Coupling, CouplingOptions, surface_degree
from abut.contact.node_to_segment import node_to_segment
from abut.contact.opposite import by_target
from abut.contact.pressure_space import DUAL, DUAL_P1, PressureSpace, pressure_space, resolve
from abut.contact.sides import words
from abut.errors import InputError
from abut.mesh.surface import Surface
from abut.model import LAWS, Contact
from abut.types import Array


def coupled(
    contact: Contact, contactor: Surface, target: Surface, reach: float, couple: Couple, normals: Array | None
) -> tuple[Surface, Coupling, PressureSpace]:
    """The contactor in parts by what they face, the coupling by the contact's method, and its pressure space. reach: a
    length; normals: as ``contact_normals``, the contactor's own where left out. Raises InputError where the surfaces do not
    face each other."""
    space: PressureSpace | None
    if contact.method != "segment-to-segment":
        coupling, space = node_to_segment(contactor, target, reach, contact.adjust)
        seen = couple(
            contactor, target, 0, CouplingOptions(points=1, reach=reach, keep_gap_samples=True, adjust=contact.adjust)
        )
        coupling = replace(coupling, gap_samples=seen.gap_samples)
    else:
        tied = contact.kind == "tied"
        name, degree = resolve(contact.pressure, contactor, not tied and (contact.law == LAWS[0] or contact.frictional))
        if contact.frictional and name == DUAL_P1:
            name = DUAL  # the law of friction looks at pressure and traction node by node
        of_dual = name in (DUAL, DUAL_P1)
        degree = surface_degree(contactor) if of_dual else degree
        keep = (contact.law == LAWS[1] and not tied) or contact.frictional
        curved = contactor.bulge is not None or target.bulge is not None
        options = CouplingOptions(
            rule=contact.integration.rule, points=contact.integration.points, reach=reach, componentwise=tied,
            keep_points=keep or (of_dual and curved), keep_gap_samples=not tied,
            normals=normals,
        )  # fmt: skip
        closed = couple(contactor, target, degree, replace(options, adjust=contact.adjust))
        without = partial(couple, contactor, target, degree, options)
        coupling = partly_adjusted(contactor, target, closed, contact.adjust, reach, without, normals)
        coupling = of_corners(contactor, target, coupling) if of_dual else coupling
        coupling = coupling if keep else replace(coupling, points=None)
        contactor = contactor if tied else by_target(contactor, target, coupling)
        space = pressure_space(name, contactor, coupling, tied) if coupling.segments.any() else None
    if space is None or not coupling.segments.any():
        raise InputError(
            f"contact '{contact.name}': no facet of {words(contact.contactor)} faces {words(contact.target)} within "
            "reach; check the names, that both surfaces' normals point out of their bodies, and the distance between them"
        )
    return contactor, coupling, space
