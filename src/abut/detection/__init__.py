"""Contact detection: pairs of surfaces that face each other; no surface has to be named."""

from abut.detection.find import AUTO, FoundContact, add_surfaces, find_contacts

__all__ = ["AUTO", "FoundContact", "add_surfaces", "find_contacts"]
