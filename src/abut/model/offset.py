"""What the offset of a contact adds to its gap, over the steps."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from abut.model.contact import Contact
from abut.model.model import Model

FAR = 10.0  # sizes of the model: how far a contact of a body that is away is open


def offsets(model: Model, contact: Contact) -> tuple[float, NDArray[np.float64]]:
    """The offset that is there from the start, and that of each history (n_histories,), lengths."""
    varying = np.zeros(len(model.histories))
    if contact.name in model.opened:  # while a body of it is away
        varying[model.histories.index(model.opened[contact.name])] = FAR * float(
            np.ptp(model.mesh.points, axis=0).max()
        )
    if contact.amplitude is None:
        return contact.offset, varying
    varying[model.histories.index(contact.amplitude)] = contact.offset
    return 0.0, varying


def smallest_offset(contact: Contact) -> float:
    """The offset when it closes the gap most (or opens it least), at any time of the steps: a length, with its sign."""
    if contact.amplitude is None:
        return contact.offset
    return min(contact.offset * factor for _, factor in contact.amplitude.points)
