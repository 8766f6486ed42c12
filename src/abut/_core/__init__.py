"""The compiled core, and the only door to it: layers above import from here, never from the extension itself."""

from __future__ import annotations

from abut._core._core import (
    assemble_stiffness,
    block_pattern,
    couple_surfaces,
    node_pattern,
    plan_facets,
    shape_functions,
)

__all__ = [
    "assemble_stiffness",
    "block_pattern",
    "couple_surfaces",
    "node_pattern",
    "plan_facets",
    "shape_functions",
]
