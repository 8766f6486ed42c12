"""Simple bodies meshed by abut itself: one body each; ``join`` puts several into one mesh under their names."""

from __future__ import annotations

from abut.mesh.make.block import box, rectangle
from abut.mesh.make.join import join
from abut.mesh.make.ring import ring
from abut.mesh.make.round import cylinder, disc, half_disc, quarter_disc, sphere_octant

__all__ = ["box", "cylinder", "disc", "half_disc", "join", "quarter_disc", "rectangle", "ring", "sphere_octant"]
