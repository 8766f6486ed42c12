"""abut: finite element contact mechanics that one can trust."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from abut.errors import AbutError, ConvergenceError, InputError, SingularModelError

if TYPE_CHECKING:
    from abut.analysis import solve
    from abut.facing import FoundContact, add_surfaces, find_contacts
    from abut.io.results import write
    from abut.mesh.mesh import Mesh
    from abut.model import (
        Amplitude,
        BodyForce,
        Contact,
        Equation,
        Force,
        Gravity,
        Integration,
        Model,
        NodalForce,
        Pressure,
        Probe,
        Rigid,
        Solid,
        SolveOptions,
        Support,
        Temperature,
        Term,
        Traction,
    )
    from abut.report import write_report
    from abut.solids.materials import LinearElastic
    from abut.state import Solution
    from abut.view import plot, to_pyvista

__version__ = "0.1.0"

_HOME = {
    "solve": "abut.analysis", "write": "abut.io.results", "Mesh": "abut.mesh.mesh", "Solution": "abut.state",
    "write_report": "abut.report", "plot": "abut.view", "to_pyvista": "abut.view",
    "LinearElastic": "abut.solids.materials", "FoundContact": "abut.facing", "add_surfaces": "abut.facing",
    "find_contacts": "abut.facing", **dict.fromkeys(
        ("Amplitude", "BodyForce", "Contact", "Equation", "Force", "Gravity", "Integration", "Model", "NodalForce",
         "Pressure", "Probe", "Rigid", "Solid", "SolveOptions", "Support", "Temperature", "Term", "Traction"),
        "abut.model",
    ),
}  # fmt: skip

__all__ = [
    "AbutError", "Amplitude", "BodyForce", "Contact", "ConvergenceError", "Equation", "Force", "FoundContact", "Gravity",
    "InputError", "Integration", "LinearElastic", "Mesh", "Model", "NodalForce", "Pressure", "Probe",
    "Rigid", "SingularModelError", "Solid", "Solution", "SolveOptions", "Support", "Temperature", "Term", "Traction",
    "add_surfaces", "find_contacts", "plot", "solve", "to_pyvista", "write", "write_report",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Public names are imported when first used: ``abut --version`` and error messages stay fast."""
    if name not in _HOME:
        raise AttributeError(f"module 'abut' has no attribute {name!r}")
    import importlib

    return getattr(importlib.import_module(_HOME[name]), name)
