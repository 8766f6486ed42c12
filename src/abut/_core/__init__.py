"""The compiled core, and the only door to it: layers above import from here, never from the extension itself."""

from __future__ import annotations

from abut._core._core import couple_surfaces, plan_facets, shape_functions

__all__ = ["couple_surfaces", "plan_facets", "shape_functions"]
