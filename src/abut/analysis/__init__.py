"""The whole analysis: from a model to its solution."""

from abut.analysis.static import solve

__all__ = ["solve"]
