"""Checks that a user can run on the method and on a model of their own."""

from __future__ import annotations

from abut.verify.infsup import InfSup, InfSupLevel, inf_sup
from abut.verify.interface_patch import InterfacePatch, interface_patch
from abut.verify.tangents import law_tangents, material_tangent

__all__ = ["InfSup", "InfSupLevel", "InterfacePatch", "inf_sup", "interface_patch", "law_tangents", "material_tangent"]
