"""Simple bodies meshed by abut itself: one body each; ``join`` puts several into one mesh under their names."""

from __future__ import annotations

from abut.mesh.make.block import box, rectangle
from abut.mesh.make.join import join

__all__ = ["box", "join", "rectangle"]
