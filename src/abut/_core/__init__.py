"""The compiled core, and the only door to it: layers above import from here, never from the extension itself."""

from __future__ import annotations

from abut._core._core import (
    add_stresses,
    assemble_stiffness,
    block_pattern,
    block_product,
    couple_surfaces,
    node_pattern,
    padded_blocks,
    plan_facets,
    principal_submatrix,
    shape_functions,
    single_rows,
    smallest_determinants,
    strong_part,
)

__all__ = [
    "add_stresses",
    "assemble_stiffness",
    "block_pattern",
    "block_product",
    "couple_surfaces",
    "node_pattern",
    "padded_blocks",
    "plan_facets",
    "principal_submatrix",
    "shape_functions",
    "single_rows",
    "smallest_determinants",
    "strong_part",
]
