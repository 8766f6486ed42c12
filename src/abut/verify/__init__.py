"""Checks that a user can run on the method and on a model of their own."""

from __future__ import annotations

from abut.verify.infsup import InfSup, InfSupLevel, inf_sup

__all__ = ["InfSup", "InfSupLevel", "inf_sup"]
