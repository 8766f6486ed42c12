"""Shells of layers in Python and in job files, against classical laminate theory."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from abut.diagnosis.cures import cures
from abut.errors import InputError
from abut.job.load import load_job
from models.thin import CLAMPED, LENGTH, THICK, WIDTH, E, strip

SOFT = 0.1  # of the stiff layer's modulus
LAYERS = (1.0, 2.0, 1.0)
STIFFNESS = WIDTH * E * THICK**3 / 12.0 * (1.0 - 0.5**3 + SOFT * 0.5**3)  # of a soft middle half


def tip(solution: abut.Solution) -> float:
    """Mean deflection of the free end."""
    far = np.abs(solution.model.mesh.points[:, 0] - LENGTH) < 1e-9
    return float(solution.displacement[far, 2].mean())


@pytest.mark.parametrize("side", ["spos", "sneg"])
def test_sandwich_under_pressure(side: str, tmp_path: Path) -> None:
    """1:100, q L^4 / 8 E I, of which shear of the soft middle, G / E = 1 / 20, is 2e-4; ten cells follow a curve of fourth
    order to h^2."""
    held = [abut.MidSupport("left", **CLAMPED)]
    thick = abut.thicken(strip(tmp_path / "a.msh"), {"strip": abut.Shell(THICK, layers=LAYERS)}, held)
    bodies = [f"strip-layer{i}" for i in (1, 2, 3)]
    assert list(thick.mesh.bodies) == bodies == list(thick.mesh.shells)
    laws = [abut.LinearElastic(share * E, 0.0) for share in (1.0, SOFT, 1.0)]
    solids = [abut.Solid(body, law, integration="reduced") for body, law in zip(bodies, laws)]
    model = abut.Model(
        thick.mesh, solids, thick.supports, [abut.Pressure(f"strip.{side}", 1e-4)], equations=thick.equations,
        couplings=thick.couplings,
    )  # fmt: skip
    exact = 1e-4 * WIDTH * LENGTH**4 / (8.0 * STIFFNESS)
    assert tip(abut.solve(model)) == pytest.approx(-exact if side == "spos" else exact, rel=0.007)


def test_section_forces(tmp_path: Path) -> None:
    """A sandwich under a couple M at its end, per width: each layer has E z M / D at its height z, so E h z M / D and
    E h^3 M / 12 D about its own middle; all of them together have M and no force."""
    couple = 0.1
    load = [abut.MidForce("right", (0.0, 0.0, 0.0), (0.0, couple * WIDTH / 5, 0.0))]  # five nodes
    thick = abut.thicken(
        strip(tmp_path / "a.msh"),
        {"strip": abut.Shell(THICK, layers=LAYERS)},
        [abut.MidSupport("left", **CLAMPED)],
        load,
    )
    youngs, sizes, heights = (E, SOFT * E, E), (0.25, 0.5, 0.25), (-0.375, 0.0, 0.375)
    solids = [
        abut.Solid(body, abut.LinearElastic(young, 0.0), integration="reduced")
        for body, young in zip(thick.mesh.shells, youngs)
    ]
    solution = abut.solve(abut.Model(thick.mesh, solids, thick.supports, thick.loads, equations=thick.equations))
    bent = couple / (STIFFNESS / WIDTH)
    for body, young, h, z in zip(thick.mesh.shells, youngs, sizes, heights):
        of = abut.mid_surface(solution, body)
        inside = np.abs(of.points[:, 0] - LENGTH / 2) < LENGTH / 4
        assert of.membrane[inside, 0] == pytest.approx(young * h * z * bent, rel=0.01, abs=1e-6)
        assert of.moment[inside, 0] == pytest.approx(young * h**3 / 12 * bent, rel=0.01)
    whole = abut.mid_surface(solution, "strip")
    inside = np.abs(whole.points[:, 0] - LENGTH / 2) < LENGTH / 4
    assert whole.thickness == pytest.approx(THICK)
    assert whole.points[:, 2] == pytest.approx(0.0)
    assert whole.moment[inside, 0] == pytest.approx(couple, rel=0.01)
    assert whole.membrane[inside] == pytest.approx(0.0, abs=1e-6)
    abut.write(solution, tmp_path / "out")
    assert "laminates_0001.vtu" in (tmp_path / "out" / "laminates.pvd").read_text()
    assert "<td>strip</td>" in (tmp_path / "out" / "report.html").read_text(encoding="utf-8")
    with pytest.raises(InputError, match=r"'strop' is no shell; shells: strip-layer1, .*strip$"):
        abut.mid_surface(solution, "strop")


def test_faces_and_groups(tmp_path: Path) -> None:
    """The outer layers have the sides, all of them the edges, and nodes are those through the whole thickness."""
    mesh = abut.thicken(strip(tmp_path / "a.msh"), {"strip": abut.Shell(THICK, layers=LAYERS, offset=0.5)}).mesh
    for side, body, height in (("spos", "strip-layer3", 0.0), ("sneg", "strip-layer1", -THICK)):
        assert set(mesh.surfaces[f"strip.{side}"][:, 0]) == set(mesh.bodies[body])
        assert mesh.points[mesh.nodes_of(f"strip.{side}")][:, 2] == pytest.approx(height)
    assert len(mesh.surfaces["strip.edge"]) == 3 * 24
    assert len(mesh.surfaces["left.edge"]) == 3 * 2
    heights = sorted(mesh.points[mesh.nodes_of("corner")][:, 2])
    assert heights == pytest.approx([-1.0, -0.875, -0.75, -0.5, -0.25, -0.125, 0.0])


def test_cross_ply_in_a_job_file(tmp_path: Path) -> None:
    """A couple at the end: w = M L^2 / (2 D11), nothing moving or turning across. Fibres along x outside, across inside;
    D11 = sum of Q11 (z1^3 - z0^3) / 3."""
    strip(tmp_path / "a.msh")
    ply = "young = [140e3, 10e3, 10e3], poisson = [0.3, 0.3, 0.45], shear = [5e3, 5e3, 3.4e3]"
    path = tmp_path / "job.toml"
    path.write_text(
        f"""
schema = 1
mesh = {{ file = "a.msh", shells.strip = {{ thickness = 1.0, layers = [1, 2, 1] }} }}
materials.along = {{ kind = "orthotropic", {ply} }}
materials.across = {{ kind = "orthotropic", {ply}, axes = {{ x = [0, 1, 0], xy = [-1, 0, 0] }} }}
solids = [
  {{ body = "strip-layer1", material = "along" }}, {{ body = "strip-layer2", material = "across" }},
  {{ body = "strip-layer3", material = "along" }},
]
supports = [{{ on = "left", x = 0, z = 0, ry = 0, rz = 0 }}, {{ on = "strip", y = 0, rx = 0 }}]
loads = [
  {{ kind = "nodal-force", on = "corner", value = [0, 0, 0.2] }},
  {{ kind = "nodal-force", on = "right", value = [0, 0, 0.2] }},
]
"""
    )
    q11, q22 = (young / (1.0 - 0.3**2 * 10e3 / 140e3) for young in (140e3, 10e3))
    d11 = (q11 * (1.0 - 0.5**3) + q22 * 0.5**3) / 12.0
    force = 0.2 * 6.0  # five nodes, and one of them twice
    assert tip(abut.solve(load_job(path).model)) == pytest.approx(force * LENGTH**3 / (3.0 * WIDTH * d11), rel=0.01)


def test_a_clamp_holds_a_strip_however_thin(tmp_path: Path) -> None:
    """1:1667: the clamped edge resists the turn about itself by half of the thickness, squared 1e-7 of what resists the
    others. q L^4 / 8 E I, of which the stiffness along the strip, (L / t)^2 times as large, leaves rounding of some 1e-3."""
    thin = LENGTH / 1667.0
    held = [abut.MidSupport("left", **CLAMPED)]
    thick = abut.thicken(strip(tmp_path / "a.msh"), {"strip": abut.Shell(thin)}, held)
    solid = abut.Solid("strip", abut.LinearElastic(E, 0.0), integration="reduced")
    load = abut.Pressure("strip.spos", 1e-4 * thin**3)
    model = abut.Model(
        thick.mesh, [solid], thick.supports, [load], equations=thick.equations, couplings=thick.couplings
    )
    assert tip(abut.solve(model)) == pytest.approx(-1e-4 * LENGTH**4 / (8.0 * E / 12.0), rel=0.02)


def test_too_thin_for_double_precision(tmp_path: Path) -> None:
    """1:5000: forces that displacements in double precision leave open are a good part of those that act. The certificate
    fails the balance, says why, and what keeps the bending stiffness."""
    thin = LENGTH / 5000.0
    thick = abut.thicken(strip(tmp_path / "a.msh"), {"strip": abut.Shell(thin)}, [abut.MidSupport("left", **CLAMPED)])
    solid = abut.Solid("strip", abut.LinearElastic(E, 0.0), integration="reduced")
    load = abut.Pressure("strip.spos", 1e-4 * thin**3)
    solution = abut.solve(abut.Model(thick.mesh, [solid], thick.supports, [load], equations=thick.equations))
    ((_, cure),) = [(check, cure) for check, cure in cures(solution) if check.name == "model balance"]
    assert "double precision" in cure
    assert "E t^3" in cure


def test_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="layers: expected a number > 0"):
        abut.Shell(1.0, layers=(1.0, 0.0))
    with pytest.raises(InputError, match="layers: expected a list of numbers"):
        abut.Shell(1.0, layers=2.0)
