"""Simple bodies meshed by abut itself: one body each; ``join`` puts several into one mesh under their names."""

from __future__ import annotations

from abut.mesh.make.block import box, rectangle
from abut.mesh.make.join import join
from abut.mesh.make.round import cylinder, disc, half_disc, sphere_octant

__all__ = ["box", "cylinder", "disc", "half_disc", "join", "rectangle", "sphere_octant"]
