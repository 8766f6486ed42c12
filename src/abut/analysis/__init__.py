"""The spine: from a model to its solution."""

from abut.analysis.solve import solve

__all__ = ["solve"]
