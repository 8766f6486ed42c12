"""The compiled core, and the only door to it: layers above import from here, never from the extension itself."""

from __future__ import annotations

from abut._core._core import (
    Cells,
    block_pattern,
    block_product,
    couple_surfaces,
    couple_tangent,
    integrate_given,
    integrate_hyperelastic,
    integrate_isotropic,
    joined_pattern,
    node_pattern,
    padded_blocks,
    plan_facets,
    principal_submatrix,
    shape_functions,
    single_rows,
    slip_tangent,
    smallest_determinants,
    strains,
    strong_part,
    values_in,
)

__all__ = [
    "Cells",
    "block_pattern",
    "block_product",
    "couple_surfaces",
    "couple_tangent",
    "integrate_given",
    "integrate_hyperelastic",
    "integrate_isotropic",
    "joined_pattern",
    "node_pattern",
    "padded_blocks",
    "plan_facets",
    "principal_submatrix",
    "shape_functions",
    "single_rows",
    "slip_tangent",
    "smallest_determinants",
    "strains",
    "strong_part",
    "values_in",
]
