"""What the user states, as frozen records that check themselves and each other."""

from abut.axes import Axes
from abut.model.body_forces import BodyForce, Centrifugal, Gravity, Load
from abut.model.conditions import Amplitude, Equation, History, Rigid, Support, Term
from abut.model.connector import Connector
from abut.model.contact import LAWS, METHODS, PRESSURES, RULES, Contact, Integration
from abut.model.coupling import Coupling
from abut.model.hold import Hold
from abut.model.loads import Force, Moment, NodalForce, Pressure, Temperature, Traction
from abut.model.model import PLANES, Model
from abut.model.modes import Buckling, Frequencies
from abut.model.penetration import Penetration
from abut.model.preload import Preload
from abut.model.probe import Probe
from abut.model.removal import Removal
from abut.model.response import Harmonic, Transient
from abut.model.rotation import Rotation
from abut.model.solid import Solid
from abut.model.solve_options import SolveOptions
from abut.model.spring import Spring

__all__ = [
    "LAWS", "METHODS", "PLANES", "PRESSURES", "RULES", "Amplitude", "Axes", "BodyForce", "Buckling", "Centrifugal",
    "Connector", "Contact", "Coupling", "Equation", "Force", "Frequencies", "Gravity", "Harmonic", "History", "Hold",
    "Integration", "Load", "Model", "Moment", "NodalForce", "Penetration", "Preload", "Pressure", "Probe", "Removal",
    "Rigid", "Rotation", "Solid", "SolveOptions", "Spring", "Support", "Temperature", "Term", "Traction", "Transient",
]  # fmt: skip
