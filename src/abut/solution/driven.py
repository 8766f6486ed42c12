"""What acts on a model, as its certificate asks."""

from __future__ import annotations

from abut.model import Model
from abut.model.conditions import drives
from abut.model.offset import smallest_offset


def driven(model: Model) -> bool:
    """Whether anything is prescribed that should have an effect: loads, motions, heat, interference."""
    given = (*model.supports, *model.loads, *model.equations, *model.rigid, *model.couplings, *model.connectors)
    hot = any(solid.temperature for solid in model.solids)
    return hot or any(map(drives, given)) or any(smallest_offset(contact) < 0.0 for contact in model.contacts)


def forces_act(model: Model) -> bool:
    """Whether forces may act, so that what contacts carry is not due to motions, heat and interference alone."""
    others = model.loads or model.preloads or model.rigid or model.couplings or model.physics
    return not model.contacts or bool(others)
