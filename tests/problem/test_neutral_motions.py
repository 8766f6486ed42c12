"""Motions that contact without friction resists by its facets alone: rollers and balls in races, pins in bores."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

import abut
from abut.benchmarks.once_stopped import LOAD, STEEL, races
from abut.diagnosis import check
from abut.mesh import make
from abut.problem.constraints import supports
from abut.problem.contact_pairs import pairs
from abut.problem.free_modes import free_mode_springs
from abut.problem.loads import loads
from abut.problem.neutral_motions import Neutral, neutral_motions
from abut.problem.restraint import restraint


@pytest.mark.parametrize(("cell", "cells", "around"), [("quad4", 6, 53), ("quad8", 4, 37), ("tri3", 6, 53)])
def test_rollers_share_the_load(cell: str, cells: int, around: int) -> None:
    """Two rollers at 45 degrees take F / sqrt(2) each by statics: in the mean to the 1 to 2 % by which they lean as they
    give way, each to what the springs take beside. Their spin and their way round are held, with hardly any iterations and
    no turn to speak of. (Meshes so coarse have their line "resolution".)"""
    solution = abut.solve(races(cell, cells, around))
    (step,) = solution.steps
    assert len(step.iterations) <= 5
    assert step.turn < 0.05
    assert not {"force balance", "free rigid-body modes", "rotation"} & {
        c.name for c in solution.certificate if not c.passed
    }
    forces = np.array([np.hypot(*contact.force) for contact in solution.contacts])
    assert forces.mean() == pytest.approx(LOAD / np.sqrt(2.0), rel=0.02)
    assert forces == pytest.approx(LOAD / np.sqrt(2.0), rel=step.neutral)
    assert 0.0 < step.regularisation < 0.1 * step.neutral
    held = [note for note in solution.notes if "resists it by its facets alone" in note]
    assert len(held) == 4


@pytest.mark.parametrize(("share", "refused"), [(0.2, True), (0.001, False)])
def test_loads_along_the_race(share: float, refused: bool) -> None:
    """A force that drives a roller round the race sets it in motion; one below what facets leave is held and told."""
    along = share * LOAD * np.array([-1.0, 1.0]) / np.sqrt(2.0)
    model = races("quad4", 6, 53, loads=[abut.Force("r0.round", tuple(along))])
    report = check(model)
    assert report.status == (4 if refused else 0)
    if refused:
        with pytest.raises(abut.SingularModelError, match=r"body 'r0' is free to .*the loads act in that direction"):
            abut.solve(model)
    else:
        assert any("resists it by its facets alone" in finding.line for finding in report.findings)
        assert abut.solve(model).converged


def found(model: abut.Model) -> Neutral:
    constraints = supports(model)
    every = pairs(model, constraints)
    return neutral_motions(*(lambda held: (held.rigid, held.steady, every))(restraint(model.mesh, constraints, every)))


@pytest.mark.parametrize(("taper", "expected"), [(0.0, 2), (0.01, 1)])
def test_a_taper_is_no_noise(taper: float, expected: int) -> None:
    """A shaft in a bore of 16 facets turns and shifts along its axis; on a taper of 1 in 100, far less than the 0.2 by which
    facets turn, it turns only, since facets turn round the axis, not along it."""
    parts = {
        name: make.cylinder(outer, (0.0, 2.0), (2, 16, 4), "hex8", inner=inner)
        for name, outer, inner in (("shaft", 1.0, 0.5), ("hub", 2.0, 1.0))
    }
    mesh = make.join(parts)
    scale = 1.0 + taper * mesh.points[:, 2:]
    mesh = replace(mesh, points=np.column_stack([mesh.points[:, :2] * scale, mesh.points[:, 2]]))
    model = abut.Model(
        mesh, [abut.Solid(body, STEEL) for body in parts], [abut.Support("hub.round", x=0, y=0, z=0)],
        contacts=[abut.Contact("shaft.round", "hub.inner", offset=-0.001)],
    )  # fmt: skip
    assert np.linalg.matrix_rank(found(model).motions, tol=0.1) == expected


@pytest.mark.parametrize("told", [True, False])
def test_facets_that_hardly_resist(told: bool) -> None:
    """Facets of curved cells may by chance leave a spin free to 1e-8 of the strongest resistance, with a little of the other
    bodies' motions in it: their loads are none on the spin. (Balls of hex20 in grooves, an unstructured mesh.)"""
    model = races("quad4", 6, 53)
    constraints = supports(model)
    every = pairs(model, constraints)
    held = restraint(model.mesh, constraints, every)
    neutral = neutral_motions(held.rigid, held.steady, every)
    pressed = np.zeros(len(held.rigid.modes))
    pressed[1::2] = -1.0
    mixed = neutral.motions[:, 0] + 0.02 * held.rigid.modes.T @ pressed / np.linalg.norm(held.rigid.modes.T @ pressed)
    mixed /= np.linalg.norm(mixed)
    resisted = np.eye(len(mixed)) - (1.0 - 1e-8) * np.outer(mixed, mixed)
    unit = sp.identity(constraints.free.shape[1], format="csr")
    (load,) = loads(model).at_ends(model)
    args = (held.rigid, [np.zeros_like(resisted), resisted], constraints, unit, [load])
    if told:
        assert any("resists it by its facets alone" in note for note in free_mode_springs(*args, neutral).notes)
    else:
        with pytest.raises(abut.SingularModelError, match="the loads act in that direction"):
            free_mode_springs(*args)


def test_friction_resists() -> None:
    assert not found(races("quad4", 6, 53, friction=0.1)).motions.shape[1]
    assert np.linalg.matrix_rank(found(races("quad4", 6, 53)).motions, tol=0.1) == 4


@pytest.mark.parametrize("cell", ["tri3", "quad4", "quad8"])
def test_a_lobed_shaft_in_a_round_bore(cell: str) -> None:
    """A shaft of radius R + .01 + .004 cos(3 t) in a bore of radius R, nodes unevenly round: p = E' (.01 (1 - (R/6R)^2) / 2
    + .004 (n^2 - 1) / (4 n) cos(n t)) / R with n = 3 (Lame; Michell, a disc in an infinite plate). The bore glides on
    itself, but for what facets leave: the shaft's turn takes a force above rounding, below the limit that they justify."""
    radius, first, order = 10.0, {"tri3": 1.0, "quad4": 1.0, "quad8": 0.5}[cell], 3
    cells = (int(24 * first), int(36 * first))
    halves = [make.ring((radius, 6 * radius), (a, a + 180), cells=cells, cell=cell) for a in (0, 180)]
    shaft = make.disc(radius, cells=int(10 * first), cell=cell)

    def polar(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.hypot(*points.T), np.arctan2(points[:, 1], points[:, 0])

    def placed(r: np.ndarray, angle: np.ndarray) -> np.ndarray:
        return r[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)

    for i, (r, angle) in enumerate(polar(half.points) for half in halves):
        halves[i] = replace(halves[i], points=placed(r, angle + 0.02 * np.sin(5 * angle)))
    r, angle = polar(shaft.points)
    angle = angle + 0.03 * np.cos(angle)
    shaft = replace(shaft, points=placed(r * (1.0 + (0.01 + 0.004 * np.cos(order * angle)) / radius), angle))
    mesh = make.join({"upper": halves[0], "lower": halves[1], "shaft": shaft})
    contacts = [
        abut.Contact(["upper.inner", "lower.inner"], "shaft.round"),
        abut.Contact("upper.start", "lower.end", kind="tied"),
        abut.Contact("upper.end", "lower.start", kind="tied"),
    ]
    solution = abut.solve(
        abut.Model(mesh, [abut.Solid(b, STEEL) for b in mesh.bodies], contacts=contacts, plane="strain")
    )
    spin = next(c for c in solution.certificate if c.name == "free rigid-body modes")
    assert spin.passed
    assert spin.limit < 0.1
    result = solution.contacts[0]
    at = polar(mesh.points[result.nodes])[1]
    modulus = 210e3 / (1 - 0.3**2)
    exact = modulus / radius * (0.005 * (1 - 1 / 36) + 0.004 * (order**2 - 1) / (4 * order) * np.cos(order * at))
    assert np.abs(result.nodal_pressure - exact).mean() < 0.03 * exact.max()  # at corners of the disc's mesh 2 to 12 %
    assert np.mean(result.nodal_pressure) == pytest.approx(exact.mean(), rel=0.02)
