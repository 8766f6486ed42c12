"""Contact detection: pairs of surfaces that face each other; no surface has to be named."""

from abut.detection.every_pair import BodyPair, every_pair
from abut.detection.find import AUTO, FoundContact, add_surfaces, find_contacts

__all__ = ["AUTO", "BodyPair", "FoundContact", "add_surfaces", "every_pair", "find_contacts"]
