"""abut: finite element contact mechanics that one can trust."""

from abut.analysis import solve
from abut.errors import AbutError, ConvergenceError, InputError, SingularModelError
from abut.mesh.mesh import Mesh
from abut.model import (
    Contact,
    Force,
    Gravity,
    Integration,
    Model,
    Pressure,
    Solid,
    SolveOptions,
    Support,
    Traction,
)
from abut.solids.materials import LinearElastic
from abut.state import Solution

__version__ = "0.1.0"

__all__ = [
    "AbutError", "Contact", "ConvergenceError", "Force", "Gravity", "InputError", "Integration", "LinearElastic",
    "Mesh", "Model", "Pressure", "SingularModelError", "Solid", "Solution", "SolveOptions", "Support", "Traction",
    "solve",
]  # fmt: skip
