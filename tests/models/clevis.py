"""A clevis and its pin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import abut
from abut.mesh.make import cylinder, join

STEEL = abut.LinearElastic(1000.0, 0.3)


def clevis(*contacts: abut.Contact, linear: str = "auto") -> abut.Model:
    """A pin in an eye between the two arms of a fork, which is drawn aside; surfaces eye, arm1, arm2 of the pin by hand."""
    mesh = join(
        {
            "pin": cylinder(1.0, (-1.0, 1.0), (3, 8), "hex8"),
            "eye": cylinder(2.0, (-0.5, 0.5), (1, 12, 2), "hex8", inner=1.0),
            "arm1": cylinder(1.8, (-1.0, -0.5), (1, 12, 1), "hex8", inner=1.0),
            "arm2": cylinder(1.8, (0.5, 1.0), (1, 12, 1), "hex8", inner=1.0),
        }
    )
    rows, nodes = mesh.surfaces["pin.round"], mesh.surface("pin.round").nodes
    z = np.array([mesh.points[n[n >= 0], 2].mean() for n in nodes])
    by_hand = {"at eye": np.abs(z) < 0.5, "at arm1": z < -0.5, "at arm2": z > 0.5}
    mesh = replace(mesh, surfaces={**mesh.surfaces, **{name: rows[own] for name, own in by_hand.items()}})
    arms = [abut.Support(f"{arm}.round", x=0.02, y=0, z=0) for arm in ("arm1", "arm2")]
    return abut.Model(
        mesh,
        [abut.Solid(body, STEEL) for body in mesh.bodies],
        [abut.Support("eye.round", x=0, y=0, z=0), *arms],
        contacts=contacts,
        solve=abut.SolveOptions(linear=linear),
    )
