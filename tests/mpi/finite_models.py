"""Models with finite kinematics, small ones, for runs on several processes."""

from __future__ import annotations

from dataclasses import replace

import abut
from abut.mesh.make import box, join, rectangle
from models.clamps import wrung
from models.folding import accordion
from models.sliding import SOFT, THEN, arched, pressed_in_space

RUBBER = abut.NeoHooke(100.0, 0.45)


def beam() -> abut.Model:
    """A heated cantilever under a pressure that follows it, with F-bar, under a force and a moment that are spread over its
    end: no contact, and a tangent that is not symmetric."""
    return abut.Model(
        box([0, 4], [0, 1], [0, 0.5], cells=[6, 2, 2], cell="hex8"),
        [abut.Solid("body", abut.NeoHooke(100.0, 0.45, expansion=1e-3), integration="b-bar", temperature=5.0)],
        [abut.Support("left", x=0.0, y=0.0, z=0.0)],
        [abut.Pressure("top", 0.05), abut.Temperature("body", lambda x: 3.0 * x[:, 0]),
         abut.Force("end", (0.0, 0.01, 0.02)), abut.Moment("end", (0.1, -0.1, 0.05))],
        couplings=[abut.Coupling("end", "right", "distributing", (4.5, 0.5, 0.0))],
        kinematics="finite", solve=abut.SolveOptions(steps=2),
    )  # fmt: skip


def slid() -> abut.Model:
    """2D: pressed and slid with friction, under a pressure that follows a side."""
    model = arched(0.3, slide=0.25)
    return replace(model, loads=[abut.Pressure("upper.left", 1.0)])


def linear() -> abut.Model:
    """The same with linear bodies, whose stiffness every iteration needs again."""
    return replace(slid(), kinematics="small-strain")


def cushion() -> abut.Model:
    """3D: pressed and slid along and across with friction, under a pressure that follows a side."""
    model = pressed_in_space(0.3)
    supports = [*model.supports[:2], abut.Support("upper.top", x=0.1, y=0.05, amplitude=THEN)]
    return replace(model, supports=supports, loads=[abut.Pressure("upper.left", 1.0)])


def punch() -> abut.Model:
    """A rigid punch that may tilt, drawn into a strip and along it with friction."""
    mesh = join({
        "strip": rectangle([0, 3], [0, 1], cells=[9, 3], cell="quad4"),
        "punch": rectangle([0.6, 1.6], [1, 1.5], cells=[3, 1], cell="quad4"),
    })  # fmt: skip
    return abut.Model(
        mesh, [abut.Solid("strip", RUBBER)], [abut.Support("strip.bottom", x=0.0, y=0.0)],
        rigid=[abut.Rigid("punch", x=0.2, y=-0.06)],
        contacts=[abut.Contact(contactor="strip.top", target="punch", friction=0.2)],
        plane="strain", kinematics="finite",
    )  # fmt: skip


def pad() -> abut.Model:
    """3D: a rigid pad that may tilt both ways, drawn into a block and along it with friction."""
    mesh = join({
        "block": box([0, 2], [0, 1.5], [0, 1], cells=[4, 3, 2], cell="hex8"),
        "pad": box([0.5, 1.4], [0.3, 1.1], [1, 1.3], cells=[2, 2, 1], cell="hex8"),
    })  # fmt: skip
    return abut.Model(
        mesh, [abut.Solid("block", RUBBER)], [abut.Support("block.bottom", x=0.0, y=0.0, z=0.0)],
        rigid=[abut.Rigid("pad", x=0.1, y=0.03, z=-0.08, rz=0.1)],
        contacts=[abut.Contact(contactor="block.top", target="pad", friction=0.2)], kinematics="finite",
    )  # fmt: skip


def turned() -> abut.Model:
    """A surface turned about an axis, and a tie: the lower block is twisted, the upper one is tied to it."""
    mesh = join({
        "lower": box([0, 1], [0, 1], [0, 1], cells=[3, 3, 2], cell="hex8"),
        "upper": box([0, 1], [0, 1], [1, 2], cells=[2, 2, 2], cell="hex8"),
    })  # fmt: skip
    return abut.Model(
        mesh, [abut.Solid("lower", SOFT), abut.Solid("upper", RUBBER)],
        [abut.Support("lower.bottom", x=0.0, y=0.0, z=0.0)],
        rotations=[abut.Rotation("upper.top", angle=0.5, centre=(0.5, 0.5, 2.0), axis=(0.0, 0.0, 1.0))],
        contacts=[abut.Contact(contactor="lower.top", target="upper.bottom", kind="tied")],
        kinematics="finite", solve=abut.SolveOptions(steps=2),
    )  # fmt: skip


def folds() -> abut.Model:
    """A strip whose folds meet: contact with itself."""
    return accordion(shortening=0.6, cells=40, friction=0.2)


def jaws() -> abut.Model:
    """3D: a clamp that closes on itself and is pushed across, with friction."""
    return wrung("hex8", friction=0.2)


MODELS = {
    "folds": folds, "jaws": jaws, "beam": beam, "slid": slid, "linear": linear, "cushion": cushion, "punch": punch,
    "pad": pad, "turned": turned,
}  # fmt: skip
