"""Results at places: where the points of a probe lie in cells and on contact surfaces, and what a step says there."""

from __future__ import annotations

from abut.probing.cells import boxes
from abut.probing.place import Place, find_place, find_places
from abut.probing.read import read

__all__ = ["Place", "boxes", "find_place", "find_places", "read"]
