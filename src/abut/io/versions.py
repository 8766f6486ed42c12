"""Versions of what computed a result."""

from __future__ import annotations

import platform

import numpy as np
import scipy

import abut


def versions() -> dict[str, str]:
    """Versions by name."""
    return {
        "abut": abut.__version__,
        "numpy": np.__version__,
        "scipy": scipy.__version__,
        "python": platform.python_version(),
    }
