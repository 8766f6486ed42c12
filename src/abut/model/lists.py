"""What the lists of a model are of."""

from __future__ import annotations

from typing import get_args

from abut.model.body_forces import Load
from abut.model.conditions import Equation, Rigid, Support
from abut.model.connector import Connector
from abut.model.contact import Contact
from abut.model.coupling import Coupling
from abut.model.hold import Hold
from abut.model.penetration import Penetration
from abut.model.preload import Preload
from abut.model.probe import Probe
from abut.model.removal import Removal
from abut.model.response import Wanted
from abut.model.rotation import Rotation
from abut.model.solid import Solid
from abut.model.spring import Spring

LISTS: dict[str, tuple[type, ...]] = {
    "solids": (Solid,), "supports": (Support,), "loads": get_args(Load), "contacts": (Contact,), "equations": (Equation,),
    "rigid": (Rigid,), "probes": (Probe,), "rotations": (Rotation,), "couplings": (Coupling,), "preloads": (Preload,),
    "springs": (Spring,), "holds": (Hold,), "penetrations": (Penetration,), "modes": get_args(Wanted),
    "removals": (Removal,), "connectors": (Connector,),
}  # fmt: skip
