"""abut: finite element contact mechanics that one can trust."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from abut.errors import AbutError, ConvergenceError, InputError, SingularModelError

if TYPE_CHECKING:
    from abut.analysis import solve
    from abut.contact.overclosure import PressureOverclosure
    from abut.detection import FoundContact, add_surfaces, find_contacts
    from abut.diagnosis import check
    from abut.materials.anisotropic import Anisotropic, Orthotropic
    from abut.materials.elastic import LinearElastic
    from abut.materials.hyperelastic import NeoHooke
    from abut.materials.logarithmic import Hencky
    from abut.materials.mfront import MFront
    from abut.materials.plastic import Plastic
    from abut.materials.rubber import ArrudaBoyce, MooneyRivlin, Ogden, Yeoh
    from abut.materials.temperature import OverTemperature
    from abut.materials.viscoelastic import Viscoelastic
    from abut.mesh.from_meshio import from_meshio
    from abut.mesh.mesh import Mesh
    from abut.model import (
        Amplitude,
        Axes,
        BodyForce,
        Buckling,
        Centrifugal,
        Connector,
        Contact,
        Coupling,
        Equation,
        Force,
        Frequencies,
        Gravity,
        Harmonic,
        Hold,
        Integration,
        Model,
        Moment,
        NodalForce,
        Penetration,
        Preload,
        Pressure,
        Probe,
        Removal,
        Rigid,
        Rotation,
        Solid,
        SolveOptions,
        Spring,
        Support,
        Temperature,
        Term,
        Traction,
        Transient,
    )
    from abut.model.sector import Sector, Sectors, add_sectors
    from abut.model.stop import Stop, Stopped, add_stops
    from abut.output.options import Output
    from abut.output.pyvista_export import plot, to_pyvista
    from abut.output.results import write
    from abut.probing.result_field import ResultField, result_field
    from abut.report import write_report
    from abut.solution import Solution
    from abut.solution.beam_forces import BeamForces, beam_forces
    from abut.solution.load_factor import LoadFactor, load_factors
    from abut.solution.mid_surface import MidSurface, mid_surface
    from abut.thin.records import Beam, MidForce, MidSupport, Shell, Thick
    from abut.thin.thicken import thicken

__version__ = "0.2.0"

_HOME = {  # of public names that do not come from abut.model
    "solve": "abut.analysis", "write": "abut.output.results", "Output": "abut.output.options", "Mesh": "abut.mesh.mesh",
    "Solution": "abut.solution",
    "write_report": "abut.report", "plot": "abut.output.pyvista_export", "to_pyvista": "abut.output.pyvista_export",
    "LinearElastic": "abut.materials.elastic", "FoundContact": "abut.detection", "add_surfaces": "abut.detection",
    "find_contacts": "abut.detection", "NeoHooke": "abut.materials.hyperelastic",
    "Hencky": "abut.materials.logarithmic", "Plastic": "abut.materials.plastic",
    **dict.fromkeys(("Anisotropic", "Orthotropic"), "abut.materials.anisotropic"),
    **dict.fromkeys(("ArrudaBoyce", "MooneyRivlin", "Ogden", "Yeoh"), "abut.materials.rubber"),
    "OverTemperature": "abut.materials.temperature", "Viscoelastic": "abut.materials.viscoelastic",
    "MFront": "abut.materials.mfront",
    "from_meshio": "abut.mesh.from_meshio", "PressureOverclosure": "abut.contact.overclosure", "check": "abut.diagnosis",
    **dict.fromkeys(("Beam", "MidForce", "MidSupport", "Shell", "Thick"), "abut.thin.records"),
    "thicken": "abut.thin.thicken",
    **dict.fromkeys(("LoadFactor", "load_factors"), "abut.solution.load_factor"),
    **dict.fromkeys(("Stop", "Stopped", "add_stops"), "abut.model.stop"),
    **dict.fromkeys(("Sector", "Sectors", "add_sectors"), "abut.model.sector"),
    **dict.fromkeys(("MidSurface", "mid_surface"), "abut.solution.mid_surface"),
    **dict.fromkeys(("BeamForces", "beam_forces"), "abut.solution.beam_forces"),
    **dict.fromkeys(("ResultField", "result_field"), "abut.probing.result_field"),
}  # fmt: skip

__all__ = [
    "AbutError", "Amplitude", "Anisotropic", "ArrudaBoyce", "Axes", "Beam", "BeamForces", "BodyForce", "Buckling",
    "Centrifugal", "Connector", "Contact", "ConvergenceError", "Coupling", "Equation", "Force", "FoundContact",
    "Frequencies", "Gravity", "Harmonic", "Hencky", "Hold", "InputError", "Integration", "LinearElastic", "LoadFactor",
    "MFront", "Mesh", "MidForce", "MidSupport",
    "MidSurface", "Model", "Moment", "MooneyRivlin", "NeoHooke", "NodalForce", "Ogden", "Orthotropic", "Output",
    "OverTemperature", "Penetration", "Plastic", "Preload", "Pressure", "PressureOverclosure", "Probe", "Removal",
    "ResultField", "Rigid", "Rotation", "Sector", "Sectors", "Shell", "SingularModelError", "Solid", "Solution",
    "SolveOptions", "Spring", "Stop", "Stopped", "Support", "Temperature", "Term", "Thick", "Traction", "Transient",
    "Viscoelastic", "Yeoh",
    "add_sectors", "add_stops", "add_surfaces", "beam_forces", "check", "find_contacts", "from_meshio", "load_factors",
    "mid_surface", "plot", "result_field", "solve", "thicken", "to_pyvista", "write", "write_report",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    """Public names are imported when first used: ``abut --version`` and error messages stay fast."""
    if name not in __all__:
        raise AttributeError(f"module 'abut' has no attribute {name!r}")
    import importlib

    return getattr(importlib.import_module(_HOME.get(name, "abut.model")), name)
