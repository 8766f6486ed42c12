"""Cells that lock are told, before and after a run, with what mends it."""

from __future__ import annotations

from collections.abc import Callable

import pytest

import abut
from abut.diagnosis import check
from abut.diagnosis.cures import cure
from abut.mesh.make import box, join, rectangle


def pad(cell: str, poisson: float, integration: str = "full", cells: int = 6, plane: str = "strain") -> abut.Model:
    """A tool pressed on half of a pad of nearly incompressible material."""
    mesh = join(
        {"pad": rectangle((0, 2), (0, 1), (2 * cells, cells), cell), "tool": rectangle((0, 0.6), (1, 1.5), (3, 2))}
    )
    return abut.Model(
        mesh,
        [
            abut.Solid("pad", abut.LinearElastic(1.0, poisson), integration=integration),
            abut.Solid("tool", abut.LinearElastic(100.0, 0.3)),
        ],
        [
            abut.Support("pad.bottom", x=0, y=0),
            abut.Support("pad.left", x=0),
            abut.Support("tool.left", x=0),
            abut.Support("tool.top", y=-0.02),
        ],
        contacts=[abut.Contact("pad.top", "tool.bottom")],
        plane=plane,
    )


def told(model: abut.Model) -> tuple[str, str]:
    """Verdict, none where there is no line, and cure."""
    solution = abut.solve(model)
    lines = [line for line in solution.certificate if line.name == "locking"]
    return (lines[0].verdict, cure(lines[0], solution)) if lines else ("", "")


def too_stiff(cell: str, poisson: float) -> float:
    """By how much the force is too large beside cells that do not lock."""
    right = abut.solve(pad("quad8", poisson, "reduced", 20)).contacts[0].force[1]
    return float(abut.solve(pad(cell, poisson)).contacts[0].force[1] / right - 1.0)


@pytest.mark.long
@pytest.mark.parametrize(
    ("cell", "poisson", "verdict"),
    [("quad4", 0.3, ""), ("quad4", 0.49, "warn"), ("quad4", 0.49999, "FAIL"), ("tri3", 0.499, "FAIL"),
     ("quad8", 0.49, ""), ("quad8", 0.4999, "warn"), ("quad8", 0.49999, "warn"), ("tri6", 0.49999, "")],
)  # fmt: skip
def test_verdicts_follow_the_error(cell: str, poisson: float, verdict: str) -> None:
    """Silent to 10 % beyond what the same mesh has at 0.3, and failed where it is above 20 %."""
    assert told(pad(cell, poisson))[0] == verdict
    locked = too_stiff(cell, poisson) - too_stiff(cell, 0.3)
    allowed: dict[str, Callable[[float], bool]] = {
        "": lambda e: e < 0.1,
        "warn": lambda e: 0.005 < e < 0.3,
        "FAIL": lambda e: e > 0.2,
    }
    assert allowed[verdict](locked)


@pytest.mark.parametrize(("cell", "integration"), [("quad4", "b-bar"), ("quad8", "reduced")])
def test_the_cure_cures(cell: str, integration: str) -> None:
    assert f'integration = "{integration}"' in told(pad(cell, 0.49999))[1]
    assert told(pad(cell, 0.49999, integration)) == ("", "")


def test_plane_stress_does_not_lock() -> None:
    assert told(pad("quad4", 0.49999, plane="stress")) == ("", "")


def test_check_warns_before_the_run() -> None:
    findings = [f for f in check(pad("tri3", 0.499)).findings if f.where == "body 'pad'" and "too stiff" in f.what]
    assert [f.severity for f in findings] == ["warning"]
    assert "tri6" in findings[0].cure
    assert not any("too stiff" in f.what for f in check(pad("quad8", 0.3)).findings)


def test_in_space() -> None:
    mesh = join({"pad": box(cells=(2, 2, 2), cell="tet4")})
    solids = [abut.Solid("pad", abut.LinearElastic(1.0, 0.499))]
    held = [abut.Support("pad.bottom", x=0, y=0, z=0)]
    model = abut.Model(mesh, solids, held, [abut.Pressure("pad.top", 1e-3)])
    assert told(model)[0] == "FAIL"
