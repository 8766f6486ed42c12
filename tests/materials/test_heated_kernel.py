"""Metal that yields over temperature in the compiled core: as evaluated at the points in Python, and its stored energy."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

import abut
from abut.bodies.assemble import respond
from abut.bodies.solids import Solids, TemperatureChange
from abut.mesh.make import box, rectangle

COLD = abut.Plastic(200.0, 0.3, 2.0, 1.0, 0.5, 20.0, [(40.0, 0.0)], expansion=1e-4)
HOT = abut.Plastic(100.0, 0.4, 1.0, 2.0, 0.2, 10.0, [(10.0, 0.0)], expansion=3e-4)
FADING = [
    abut.Plastic(200.0, 0.3, [(0.0, 2.0), (0.05, 3.0)], backstresses=[(40.0, 30.0)], expansion=1e-4),
    abut.Plastic(100.0, 0.3, [(0.0, 1.0), (0.1, 2.0)], backstresses=[(10.0, 5.0)], expansion=2e-4),
]


@dataclass(frozen=True)
class InPython(abut.OverTemperature):
    """Not compiled: asked at the points."""

    def compiled(self, finite: bool) -> None:
        return None


def bodies(kind: str, integration: str, plane: str | None, kinematics: str, materials: list) -> tuple[Solids, Solids]:
    """The same cells, compiled and in Python."""
    if kind.startswith("hex"):
        mesh = box(cells=(3, 2, 2), cell=kind)
    else:
        mesh = rectangle(x=(1.0, 2.0), y=(0.0, 1.0), cells=(3, 2), cell=kind)
    rows = [0.0, 100.0], materials, 20.0, -50.0
    one, other = abut.OverTemperature(*rows), InPython(*rows)
    rules = {"body": integration}
    return tuple(Solids(mesh, {"body": x}, plane, rules, kinematics) for x in (one, other))


CASES = [
    ("hex8", "full", None), ("hex8", "b-bar", None), ("hex20", "reduced", None), ("hex27", "mixed", None),
    ("quad4", "b-bar", "strain"), ("quad8", "full", "stress"), ("quad9", "mixed", "strain"),
]  # fmt: skip


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize(("kind", "integration", "plane"), CASES)
@pytest.mark.parametrize("materials", [[COLD, HOT], FADING], ids=["linear", "fading"])
def test_as_in_python(kind: str, integration: str, plane: str | None, kinematics: str, materials: list) -> None:
    """Loaded, and back by half, while the temperature changes: forces, tangents and histories are the same."""
    ours, twin = bodies(kind, integration, plane, kinematics, materials)
    rng = np.random.default_rng(0)
    points = ours.points
    way = 0.05 * points @ rng.uniform(-1.0, 1.0, (points.shape[1],) * 2) + 0.002 * rng.uniform(-1, 1, points.shape)
    history = found = None
    flowed = []
    for share in (0.5, 1.0, 0.5):
        heat = TemperatureChange({"body": 30.0}, share * rng.uniform(-60.0, 120.0, len(points)))
        one, other = respond(ours, share * way, heat, history), respond(twin, share * way, heat, found)
        history, found = one.history, other.history
        size = np.abs(other.force).max()
        assert np.abs(one.force - other.force).max() < 1e-12 * size
        assert np.abs(one.tangent.data - other.tangent.data).max() < 1e-12 * np.abs(other.tangent.data).max()
        assert np.abs(history["body"] - found["body"]).max() < 1e-12
        flowed.append(history["body"][:, 6].max())
    assert 0.0 < flowed[0] < flowed[1]


def test_stored_energy() -> None:
    """Of a bar pulled beyond its yield stress at 70 degrees, half way between its rows: Y^2 / (2 E) per volume; and what the
    forces have done beside that has flowed away. The heat alone, which nothing holds, stores none."""
    cold, hot = abut.Plastic(200.0, 0.3, 2.0, expansion=1e-3), abut.Plastic(100.0, 0.3, 1.0, expansion=1e-3)
    steel = abut.OverTemperature([20.0, 120.0], [cold, hot], initial_temperature=20.0)
    solids = Solids(box(cells=(1, 1, 1)), {"body": steel}, kinematics="small")
    heat = TemperatureChange({"body": 50.0})
    swollen = 0.05 * solids.points
    assert respond(solids, swollen, heat).energy == pytest.approx(0.0, abs=1e-15)
    young, yields, flow = 150.0, 1.5, 0.02
    across = -0.3 * yields / young - flow / 2.0
    pulled = swollen + solids.points * [yields / young + flow, across, across]
    assert respond(solids, pulled, heat).energy == pytest.approx(yields**2 / (2.0 * young), rel=1e-12)
    stretch = np.exp([yields / young + flow, across, across])  # the same in logarithmic strains, upon what heat makes
    finite = Solids(box(cells=(1, 1, 1)), {"body": steel}, kinematics="finite")
    moved = finite.points * (1.05 * stretch - 1.0)
    assert respond(finite, moved, heat).energy == pytest.approx(1.05**3 * yields**2 / (2.0 * young), rel=1e-12)
