"""Motions that nothing resists and no load works on are held without an effect; all others are refused, by name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.mesh.make import box, join, rectangle

STEEL = abut.LinearElastic(young=210e3, poisson=0.3)
DOWN = abut.Traction(
    "upper.top", lambda x: np.column_stack([0 * x[:, 0], 0 * x[:, 0], -10.0 - x[:, 0] - 0.3 * x[:, 1]])
)


def blocks(supports: Sequence[abut.Support], loads: Sequence[abut.Pressure | abut.Traction | abut.Force],
           linear: str = "auto", **options: object) -> abut.Model:  # fmt: skip
    """A block on a larger one, whose foot is held; two corners of its top as node sets."""
    mesh = join(
        {
            "lower": box(x=(0, 10), y=(0, 10), z=(0, 6), cells=(4, 4, 3)),
            "upper": box(x=(2, 8), y=(2, 8), z=(6, 11), cells=(3, 3, 2)),
        }
    )
    corners = {name: corner(mesh, at) for name, at in (("one", (2, 2, 11)), ("two", (8, 2, 11)))}
    foot = abut.Support("lower.bottom", x=0, y=0, z=0)
    return abut.Model(
        replace(mesh, node_sets=corners),
        [abut.Solid("lower", STEEL), abut.Solid("upper", STEEL)],
        supports=[foot, *supports],
        loads=loads,
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", **options)],  # type: ignore[arg-type]
        solve=abut.SolveOptions(linear=linear),
    )


def corner(mesh: abut.Mesh, at: tuple[float, ...]) -> NDArray[np.int64]:
    return np.flatnonzero(np.abs(mesh.points - at).max(axis=1) < 1e-9)


def regularisation(solution: abut.Solution) -> float:
    (check,) = (c for c in solution.certificate if c.name == "free rigid-body modes")
    assert check.passed
    return check.value


@pytest.mark.parametrize(
    ("linear", "law", "kind"),
    [
        ("direct", "complementarity", "contact"),
        ("amg", "complementarity", "contact"),
        ("direct", "constraint-function", "contact"),
    ],
)
def test_the_answer_is_that_with_a_statically_determinate_support(linear: str, law: str, kind: str) -> None:
    """Three supports that take the three loose motions and nothing else carry no force under vertical loads, so the answer
    is theirs but for the motion itself, to the accuracy of the solver (1e-9; the amg path stops at 2e-9 of equilibrium)."""
    pins = [abut.Support("one", x=0, y=0), abut.Support("two", y=0)]
    loose = abut.solve(blocks([], [DOWN], linear, law=law, kind=kind))
    proper = abut.solve(blocks(pins, [DOWN], linear, law=law, kind=kind))
    limit = 1e-9 if linear == "direct" else 1e-7
    assert regularisation(loose) < 1e-9
    assert "free rigid-body modes" not in {c.name for c in proper.certificate}
    a, b = loose.contacts[0], proper.contacts[0]
    assert np.nanmax(np.abs(a.pressure - b.pressure)) < limit * b.max_pressure
    stress = proper.steps[-1].stress
    assert np.abs(loose.steps[-1].stress - stress).max() < limit * np.abs(stress).max()
    assert sum("its mean rigid-body motion is set to zero" in note for note in loose.notes) == 3


def test_the_body_rests_in_the_mean() -> None:
    """The three motions have no share in the displacement of the loose body."""
    solution = abut.solve(blocks([], [DOWN]))
    nodes = solution.model.mesh.nodes_of("upper")
    u, x = solution.displacement[nodes], solution.model.mesh.points[nodes]
    x = x - x.mean(axis=0)
    size = np.abs(u).max() * len(nodes)
    assert np.abs(u[:, :2].sum(axis=0)).max() < 1e-12 * size
    assert abs((x[:, 0] * u[:, 1] - x[:, 1] * u[:, 0]).sum()) < 1e-12 * size * np.abs(x).max()


def test_two_blocks_without_any_support() -> None:
    """Pressed together by opposite pressures: the pressure between them is that pressure (patch test)."""
    mesh = join({"a": box(z=(0, 1), cells=(3, 3, 2)), "b": box(z=(1, 2), cells=(2, 2, 2))})
    model = abut.Model(
        mesh,
        [abut.Solid("a", STEEL), abut.Solid("b", STEEL)],
        loads=[abut.Pressure("a.bottom", 7.0), abut.Pressure("b.top", 7.0)],
        contacts=[abut.Contact(contactor="a.top", target="b.bottom")],
    )
    solution = abut.solve(model)
    pressure = solution.contacts[0].pressure
    assert pressure[np.isfinite(pressure)] == pytest.approx(7.0, rel=1e-9)
    assert regularisation(solution) < 1e-9
    assert len([note for note in solution.notes if note.startswith(("translation of", "rotation of"))]) == 9


def test_a_body_under_pressure_all_round() -> None:
    """Nothing touches it, but its loads balance: the stress is the pressure in every direction."""
    sides = ("left", "right", "front", "back", "bottom", "top")
    mesh = join({"cube": box(cells=(2, 2, 2))})
    model = abut.Model(mesh, [abut.Solid("cube", STEEL)], loads=[abut.Pressure(f"cube.{side}", 5.0) for side in sides])
    solution = abut.solve(model)
    assert solution.steps[-1].stress[:, :3] == pytest.approx(-5.0, rel=1e-9)
    assert regularisation(solution) < 1e-9


def test_plane_and_axisymmetric_models() -> None:
    """A sheet under pressure on both sides; a ring pressed between nothing but its own loads. Both are stressed evenly."""
    sheet = join({"sheet": rectangle(cells=(3, 2))})
    loads = [abut.Pressure("sheet.left", 2.0), abut.Pressure("sheet.right", 2.0)]
    plane = abut.solve(abut.Model(sheet, [abut.Solid("sheet", STEEL)], loads=loads, plane="stress"))
    assert plane.steps[-1].stress[:, 0] == pytest.approx(-2.0, rel=1e-9)
    ring = join({"ring": rectangle(x=(1, 2), cells=(3, 2))})
    loads = [abut.Pressure("ring.top", 2.0), abut.Pressure("ring.bottom", 2.0)]
    round_ = abut.solve(abut.Model(ring, [abut.Solid("ring", STEEL)], loads=loads, plane="axisymmetric"))
    assert round_.steps[-1].stress[:, 1] == pytest.approx(-2.0, rel=1e-9)
    assert max(regularisation(plane), regularisation(round_)) < 1e-9


@pytest.mark.parametrize(
    ("load", "motion"),
    [
        (abut.Force("upper.top", (1e-6, 0.0, -100.0)), "body 'upper' is free to translate along x"),
        (abut.Force("upper.right", (0.0, 1e-6, 0.0)), "body 'upper' is free to"),
    ],
)
def test_loads_along_a_loose_motion_are_refused(load: abut.Force, motion: str) -> None:
    """However small beside the others: 1e-8 of them is no rounding."""
    with pytest.raises(abut.SingularModelError, match="the loads act in that direction") as error:
        abut.solve(blocks([], [DOWN, load]))
    assert motion in str(error.value)


def test_a_body_that_nothing_touches_or_loads_is_refused() -> None:
    mesh = join({"held": box(cells=(2, 2, 2)), "lost": box(x=(5, 6), cells=(2, 2, 2))})
    model = abut.Model(
        mesh,
        [abut.Solid("held", STEEL), abut.Solid("lost", STEEL)],
        supports=[abut.Support("held.bottom", x=0, y=0, z=0)],
        loads=[abut.Pressure("held.top", 1.0)],
    )
    with pytest.raises(
        abut.SingularModelError,
        match=r"body 'lost' is free to translate along x .*5 more rigid-body modes.*no load acts on it",
    ):
        abut.solve(model)


def test_a_rigid_tool_that_may_slide() -> None:
    """Pushed down with its sideways motion and its turn left free: nothing resists the first, contact the second. The answer
    is that with the sideways motion prescribed as zero."""
    mesh = join(
        {
            "block": rectangle(x=(0, 6), y=(0, 3), cells=(6, 3), cell="quad8"),
            "tool": rectangle(x=(2, 4), y=(3, 4), cells=(3, 2), cell="quad8"),
        }
    )

    def solve(**given: float) -> abut.Solution:
        model = abut.Model(
            mesh,
            [abut.Solid("block", STEEL)],
            supports=[abut.Support("block.bottom", x=0, y=0)],
            contacts=[abut.Contact(contactor="block.top", target="tool.bottom")],
            rigid=[abut.Rigid("tool", y=-0.01, **given)],
            plane="strain",
        )
        return abut.solve(model)

    free, held = solve(), solve(x=0.0, rz=0.0)
    assert regularisation(free) < 1e-9
    a, b = free.contacts[0], held.contacts[0]
    assert a.force == pytest.approx(b.force, rel=1e-9, abs=1e-9 * abs(b.force[1]))
    assert np.nanmax(np.abs(a.pressure - b.pressure)) < 1e-8 * b.max_pressure


def test_loads_that_balance_only_at_the_end() -> None:
    """Two opposite forces, one of them late: half-way one acts alone, and the body is free to follow it."""
    late = abut.Amplitude(((0.0, 0.0), (0.5, 0.0), (1.0, 1.0)))
    push = abut.Force("upper.left", (5.0, 0.0, 0.0))
    back = [abut.Force("upper.right", (-5.0, 0.0, 0.0), amplitude=amplitude) for amplitude in (None, late)]
    assert abut.solve(blocks([], [DOWN, push, back[0]])).converged
    with pytest.raises(abut.SingularModelError, match="is free to translate along x"):
        abut.solve(replace(blocks([], [DOWN, push, back[1]]), solve=abut.SolveOptions(steps=2)))
