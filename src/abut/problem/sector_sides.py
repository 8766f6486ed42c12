"""What of a contact is not continued beyond the sides of a sector that it reaches."""

from __future__ import annotations

from abut.contact.turned_images import used_sides
from abut.mesh.surface import Surface
from abut.model import METHODS, Contact, Model
from abut.problem.straight_cells import of_simplices


def has_own_ends(contact: Contact, contactor: Surface, finite: bool) -> bool:
    """Whether functions at both sides stay apart: those of vectors along the axes, and of tangents that turn each with its
    own facet."""
    return contact.kind == "tied" or (finite and contact.frictional and contactor.dim == 3)


def left_out(model: Model, contact: Contact) -> str:
    """In words, of a contact as the model has it; nothing where all is continued, or no sides are reached."""
    contactor, target = model.sides(contact)
    if used_sides(contactor) is None:
        return ""
    if contact.method != METHODS[0]:
        return f'method "{contact.method}" knows nothing of what is beyond'
    if contact.kind == "tied":
        return "the tractions of a tie at both sides are each its own, though one joint turned"
    if has_own_ends(contact, contactor, model.finite):
        own = "pressures and tractions at both sides are each its own, though one joint turned"
        return f"{own}, and what slides beyond a side meets nothing"
    if model.finite:
        return "what slides beyond a side meets nothing there"
    simplices = any(of_simplices(model.mesh, side).any() for side in (contactor, target))
    if simplices and not any(each.frictional for each in model.contacts):
        return "pressures of linear triangles and tetrahedra are mended from stresses that end there"
    return ""
