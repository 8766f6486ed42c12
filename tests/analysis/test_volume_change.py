"""The certificate's line "volume change": what bodies that hardly change their volume do all the same, beside what their
pressure explains."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest

import abut
from abut.analysis.volume_change import volume_change
from abut.bodies.solids import UNHEATED
from abut.bodies.stress import point_stress
from abut.diagnosis.cures import cure
from abut.materials.material import Array, Evaluated, OwnMaterial
from abut.mesh.make import box, join, rectangle
from abut.solution import Check

PRESSURE, YOUNG, POISSON = 0.1, 1.0, 0.49
BULK = YOUNG / (3.0 * (1.0 - 2.0 * POISSON))
CONFINED = YOUNG * (1.0 - POISSON) / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON))  # stress over strain of a confined block
SIDES = {"quad4": 2, "quad8": 2, "tri6": 2, "hex8": 3, "hex20": 3, "tet10": 3}
RULES = [("quad4", "b-bar"), ("quad8", "reduced"), ("tri6", "mixed"), ("hex8", "b-bar"), ("hex20", "mixed"),
         ("tet10", "mixed"), ("tet10", "full")]  # fmt: skip


def block(cell: str, law: object, how: str = "auto", pressed: tuple[str, ...] = ("top",), **of: object) -> abut.Model:
    """Held by what slides along its planes, with pressure on some of its faces and nothing moving the others out."""
    flat = SIDES[cell] == 2
    made = rectangle((0, 2), (0, 1), (3, 2), cell) if flat else box((0, 2), (0, 1), (0, 1), (3, 2, 2), cell)
    normals = {"left": "x", "right": "x", "bottom": "y", "top": "y"}
    if not flat:
        normals = {"left": "x", "right": "x", "front": "y", "back": "y", "bottom": "z", "top": "z"}
    return abut.Model(
        join({"block": made}),
        [abut.Solid("block", law, integration=how)],
        [abut.Support(f"block.{s}", **{axis: 0.0}) for s, axis in normals.items() if s not in pressed],
        [abut.Pressure(f"block.{side}", PRESSURE) for side in pressed],
        plane="strain" if flat else None,
        **of,
    )


def line(solution: abut.Solution) -> Check:
    (found,) = (check for check in solution.certificate if check.name == "volume change")
    return found


@pytest.mark.parametrize(("cell", "how"), RULES)
def test_confined(cell: str, how: str) -> None:
    """A block that cannot give way sideways loses p / M, M = E (1 - nu) / ((1 + nu) (1 - 2 nu)), all of which its mean
    stress over the bulk modulus explains."""
    solution = abut.solve(block(cell, abut.LinearElastic(YOUNG, POISSON), how))
    found = solution.steps[-1].volume_change
    assert found is not None
    for growth in (found.largest, found.whole, found.worst):
        assert growth.total == pytest.approx(-PRESSURE / CONFINED, rel=1e-10)
        assert growth.explained == pytest.approx(-PRESSURE / CONFINED, rel=1e-10)
    assert line(solution).verdict == "pass"
    assert line(solution).value < 1e-9
    assert "'block'" in line(solution).meaning


@pytest.mark.parametrize(("cell", "how"), [("hex8", "b-bar"), ("hex20", "mixed"), ("tet10", "mixed")])
def test_under_pressure_all_round(cell: str, how: str) -> None:
    """Rubber with the energy K/2 (J - 1)^2 under a fluid: J - 1 = -p / K, large as it is."""
    law = abut.NeoHooke(young=YOUNG, poisson=POISSON, volumetric="isochoric")
    solution = abut.solve(block(cell, law, how, ("top", "right", "back"), kinematics="finite"))
    found = solution.steps[-1].volume_change
    assert found is not None
    for growth in (found.largest, found.whole):
        assert growth.total == pytest.approx(-PRESSURE / BULK, rel=1e-8)
        assert growth.explained == pytest.approx(-PRESSURE / BULK, rel=1e-8)
    assert line(solution).value < 1e-6


@pytest.mark.parametrize(
    ("cell", "kinematics"), [("quad4", "small"), ("tri6", "small"), ("quad9", "finite"), ("quad4", "finite")]
)
def test_bulge(cell: str, kinematics: str) -> None:
    """Half of a bonded pad squeezed by a twentieth: its side bulges by what the plate takes away, less what the line says
    that the body loses. The areas are those of the boundary's polygon, which the cells of the inside know nothing of."""
    mesh, push = join({"pad": rectangle((0, 2), (0, 1), (12, 6), cell)}), 0.05
    law = abut.LinearElastic(1.0, 0.4999) if kinematics == "small" else abut.NeoHooke(
        young=1.0, poisson=0.4999, volumetric="isochoric")  # fmt: skip
    model = abut.Model(
        mesh,
        [abut.Solid("pad", law)],
        [
            abut.Support("pad.bottom", x=0.0, y=0.0),
            abut.Support("pad.left", x=0.0),
            abut.Support("pad.top", x=0.0, y=-push),
        ],
        plane="strain",
        kinematics=kinematics,
    )
    solution = abut.solve(model)
    found, side = solution.steps[-1].volume_change, mesh.nodes_of("pad.right")
    assert found is not None
    order = np.argsort(mesh.points[side, 1])
    at, moved = mesh.points[side][order], solution.displacement[side][order]
    height = at[:, 1] if kinematics == "small" else at[:, 1] + moved[:, 1]
    if cell == "quad4":
        bulge = (0.5 * (moved[1:, 0] + moved[:-1, 0]) * np.diff(height)).sum()
    else:  # by Simpson's rule in the parameter of each facet
        slope = np.stack([-1.5 * height[:-2:2] + 2 * height[1::2] - 0.5 * height[2::2],
                          0.5 * (height[2::2] - height[:-2:2]),
                          0.5 * height[:-2:2] - 2 * height[1::2] + 1.5 * height[2::2]])  # fmt: skip
        values = np.stack([moved[:-2:2, 0], moved[1::2, 0], moved[2::2, 0]])
        bulge = (np.array([[1.0], [4.0], [1.0]]) / 3.0 * slope * values).sum()
    assert bulge - 2.0 * push == pytest.approx(2.0 * found.whole.total, abs=1e-9)
    assert abs(found.whole.total) < 0.01 * push  # stresses about the modulus, over a bulk modulus of 1667
    assert line(solution).verdict == "pass"
    assert line(solution).value < 0.01


@dataclass(frozen=True)
class SoftVolume(OwnMaterial):
    """A law whose bulk modulus is a part of the one that its ``linear`` tells."""

    share: float

    @property
    def modulus(self) -> float:
        return YOUNG

    @property
    def linear(self) -> abut.LinearElastic:  # type: ignore[override]
        return abut.LinearElastic(YOUNG, POISSON)

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        told = self.linear.evaluate(strain, history)
        volume = np.outer([1, 1, 1, 0, 0, 0], [1, 1, 1, 0, 0, 0]) * (self.share - 1.0) * BULK
        return told[0] + strain @ volume, told[1] + volume, history


@pytest.mark.parametrize(("share", "verdict"), [(1.0, "pass"), (0.8, "warn"), (0.3, "FAIL")])
def test_wrong_law(share: float, verdict: str) -> None:
    solution = abut.solve(block("quad4", SoftVolume(share)))
    assert line(solution).verdict == verdict
    assert (line(solution).value < 1e-9) == (share == 1.0)
    assert ("linear" in cure(line(solution), solution)) == (verdict != "pass")


def test_wrong_pressures() -> None:
    """Pressures off by a half in one cell are found there, with how much."""
    model = block("quad4", abut.LinearElastic(YOUNG, POISSON))
    u = abut.solve(model).displacement
    (stress,) = (values.copy() for values in point_stress(model.deformable, u))
    stress[4, :, :3] *= 0.5
    found = volume_change(model.deformable, u, [stress], UNHEATED)
    assert found is not None
    assert found.place == pytest.approx(model.mesh.points[model.mesh.blocks[0].nodes[4]].mean(axis=0))
    assert found.worst.explained == pytest.approx(0.5 * found.worst.total)
    assert not found.check.passed


def test_heat_explains() -> None:
    """Free expansion is no change of volume that a pressure must account for."""
    law = abut.LinearElastic(YOUNG, POISSON, expansion=1e-4)
    model = block("hex8", law, pressed=("top", "right", "back"))
    model = replace(model, loads=[], solids=[replace(model.solids[0], temperature=50.0)])
    found = abut.solve(model).steps[-1].volume_change
    assert found is not None
    assert found.whole.total == pytest.approx(3 * 50e-4, rel=1e-9)
    assert found.check.value < 1e-9


def test_flowing_metal() -> None:
    """Its plastic strain keeps the volume, so what is left is elastic."""
    model = block("quad4", abut.Plastic(1.0, 0.3, yield_stress=0.02, hardening=0.1), pressed=("top", "right"))
    model = replace(model, loads=[abut.Pressure("block.top", PRESSURE)])
    found = abut.solve(model).steps[-1]
    assert found.flow is not None
    assert found.flow.largest > 0.01
    assert found.volume_change is not None
    assert found.volume_change.check.value < 1e-9


def test_no_line() -> None:
    """Of compressible bodies, in plane stress, and where nothing is strained."""
    soft = block("quad4", abut.LinearElastic(YOUNG, 0.3))
    thin = replace(block("quad4", abut.LinearElastic(YOUNG, POISSON)), plane="stress")
    still = block("quad4", abut.LinearElastic(YOUNG, POISSON))
    moved = replace(still, loads=[], supports=[abut.Support("block.bottom", x=0.3, y=0.1)])
    for model in (soft, thin, moved):
        assert not any(check.name == "volume change" for check in abut.solve(model).certificate)
