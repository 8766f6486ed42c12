"""Evaluation of probes: the cells and contact facets that their points lie in, and the results of a step there."""

from __future__ import annotations

from abut.probing.cells import boxes
from abut.probing.place import Place, find_place, find_places
from abut.probing.read import read

__all__ = ["Place", "boxes", "find_place", "find_places", "read"]
