"""What the user states, as frozen records that check themselves and each other."""

from abut.model.model import (
    LAWS,
    METHODS,
    PLANES,
    PRESSURES,
    RULES,
    Amplitude,
    BodyForce,
    Contact,
    Equation,
    Force,
    Gravity,
    History,
    Integration,
    Load,
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

__all__ = [
    "LAWS", "METHODS", "PLANES", "PRESSURES", "RULES", "Amplitude", "BodyForce", "Contact", "Equation", "Force", "Gravity",
    "History", "Integration", "Load", "Model", "NodalForce", "Pressure", "Probe", "Rigid", "Solid", "SolveOptions",
    "Support", "Temperature", "Term", "Traction",
]  # fmt: skip
