"""Simple bodies meshed by abut itself: one body each; ``join`` puts several into one mesh under their names."""

from __future__ import annotations

from abut.mesh.make.block import box, rectangle
from abut.mesh.make.join import join
from abut.mesh.make.round import half_disc, sphere_octant

__all__ = ["box", "half_disc", "join", "rectangle", "sphere_octant"]
