"""Expressions of position in job files: friction, supports, pressures, tractions, temperatures."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.bodies.follower import follower_pressure
from abut.diagnosis import check
from abut.errors import InputError
from abut.expression import DEEPEST, Expression
from abut.job import load_job
from abut.job.convert import write_job
from abut.mesh import make
from abut.output.restart import description

POINTS = np.random.default_rng(0).uniform(0.1, 2.0, (20, 3))
X, Y, Z = POINTS.T


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("0.3", np.full(20, 0.3)),
        ("0.1 + 0.2*x", 0.1 + 0.2 * X),
        ("-x**2/y - -z", -(X**2) / Y + Z),
        ("  2*pi*x", 2.0 * np.pi * X),
        ("0.1 if x < 1 else 0.3 if not y >= 1 else 0.4", np.where(X < 1, 0.1, np.where(Y < 1, 0.3, 0.4))),
        ("1 + (0.5 < x <= 1 and y > 1 or z < 1)", 1.0 + (((X > 0.5) & (X <= 1) & (Y > 1)) | (Z < 1))),
        ("min(x, y, 1) + max(x, z) * atan2(y, x)", np.minimum(np.minimum(X, Y), 1) + np.maximum(X, Z) * np.arctan2(Y, X)),
        ("sqrt(abs(sin(x)*cos(y))) + log(z)*exp(-x)", np.sqrt(np.abs(np.sin(X) * np.cos(Y))) + np.log(Z) * np.exp(-X)),
        ("tan(x/9) + asin(x/9) + acos(x/9) + atan(x)", np.tan(X / 9) + np.arcsin(X / 9) + np.arccos(X / 9) + np.arctan(X)),
        ("sinh(x) + cosh(x) - tanh(x)", np.exp(X) - np.tanh(X)),
    ],
)  # fmt: skip
def test_values(text: str, expected: np.ndarray) -> None:
    assert Expression(text)(POINTS) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "cannot read ''"),
        ("0.1 +", "cannot read '0.1 \\+' as an expression of x, y, z"),
        ("x; y", "cannot read"),
        ("x\0", "cannot read"),
        ("9" * 1900 + "**9", None),
        ("x" * 3000, "more than 2000 characters"),
        ("(" * 900 + "x" + ")" * 900, "cannot read"),
        ("-" * (DEEPEST + 1) + "x", "too many operations"),
        ("r + 1", "unknown name 'r'; known: "),
        ("pie", "unknown name 'pie'; did you mean 'pi'?"),
        ("sine(x)", "unknown function 'sine'; did you mean 'sin'?"),
        ("x^2", "'x \\^ 2' is not part of an expression; powers are written with \\*\\*"),
        ("x // 2", "is not part of an expression"),
        ("x == 1", "is not part of an expression"),
        ("x.real", "is not part of an expression"),
        ("x[0]", "is not part of an expression"),
        ("[x]", "is not part of an expression"),
        ("__import__('os')", "unknown function '__import__'"),
        ("(lambda: x)()", "unknown function"),
        ("sin(x, y)", "sin takes one argument"),
        ("sin(x=1)", "sin takes one argument"),
        ("max(x)", "max takes two arguments or more"),
        ("max(*x)", "max takes two arguments or more"),
        ("atan2(x, y, z)", "atan2 takes two arguments"),
        ("'x'", "'x' is not a number"),
        ("1j", "1j is not a number"),
        ("True", "True is not a number"),
    ],
)
def test_refused(text: str, words: str | None) -> None:
    if words is None:  # a number beyond all: found where it is asked for
        assert np.isinf(Expression(text)(POINTS)).all()
        return
    with pytest.raises(InputError, match=words) as error:
        Expression(text)
    assert len(str(error.value).splitlines()) == 1


JOB = """
schema = 1
[mesh.bodies.block]
kind = "{kind}"
x = [0, 2]
y = [0, 1]
{z}
cells = {cells}
[mesh.bodies.lid]
kind = "{kind}"
x = [0, 2]
y = [1, 2]
{z}
cells = {cells}
{plane}
[materials.m]
kind = "linear-elastic"
young = 100.0
poisson = 0.3
expansion = 1e-4
[[solids]]
body = "block"
material = "m"
[[solids]]
body = "lid"
material = "m"
[[supports]]
on = "block.{bottom}"
x = {x}
y = "0"
{held}
[[loads]]
kind = "pressure"
on = "lid.{top}"
value = {pressure}
[[loads]]
kind = "traction"
on = "lid.{top}"
value = {traction}
[[loads]]
kind = "temperature"
on = "block"
value = {temperature}
[[contacts]]
contactor = "lid.{bottom}"
target = "block.{top}"
friction = {friction}
"""
GIVEN = {
    "x": '"1e-3*x"', "pressure": '"1 + 0.5*x"', "traction": '["-0.1*x", 0]', "temperature": '"20 + 3*y"',
    "friction": '"0.1 + 0.2*x"',
}  # fmt: skip
FUNCTIONS = {
    "x": lambda p: 1e-3 * p[:, 0], "pressure": lambda p: 1 + 0.5 * p[:, 0],
    "traction": lambda p: np.column_stack([-0.1 * p[:, 0], 0 * p[:, 0]]), "temperature": lambda p: 20 + 3 * p[:, 1],
    "friction": lambda p: 0.1 + 0.2 * p[:, 0],
}  # fmt: skip
SPACES = {
    "strain": ("rectangle", "", "[6, 3]", '[model]\nplane = "strain"', "bottom", "top", ""),
    "axisymmetric": ("rectangle", "", "[6, 3]", '[model]\nplane = "axisymmetric"', "bottom", "top", ""),
    "solid": ("box", "z = [0, 1]", "[3, 2, 1]", "", "front", "back", "z = 0"),
}


def job(folder: Path, space: str = "strain", **given: str) -> Path:
    kind, z, cells, plane, bottom, top, held = SPACES[space]
    text = JOB.format(kind=kind, z=z, cells=cells, plane=plane, bottom=bottom, top=top, held=held, **{**GIVEN, **given})
    path = folder / "job.toml"
    path.write_text(text)
    return path


@pytest.mark.parametrize("space", SPACES)
def test_as_functions_in_python(tmp_path: Path, space: str) -> None:
    """Every key with an expression gives what the same function gives."""
    traction = '["-0.1*x", 0, 0]' if space == "solid" else GIVEN["traction"]
    model = load_job(job(tmp_path, space, traction=traction)).model
    support, (pressure, force, heat), (contact,) = model.supports[0], model.loads, model.contacts
    sideways = FUNCTIONS["traction"]
    if space == "solid":
        sideways = lambda p: np.column_stack([-0.1 * p[:, 0], 0 * p[:, 0], 0 * p[:, 0]])  # noqa: E731
    same = abut.Model(
        model.mesh,
        model.solids,
        [abut.Support(support.on, x=FUNCTIONS["x"], y=0, z=None if space != "solid" else 0)],
        [
            abut.Pressure(pressure.on, FUNCTIONS["pressure"]),
            abut.Traction(force.on, sideways),
            abut.Temperature(heat.on, FUNCTIONS["temperature"]),
        ],
        [abut.Contact(contactor=contact.contactor, target=contact.target, friction=FUNCTIONS["friction"])],
        plane=model.plane,
    )
    ours, theirs = abut.solve(model), abut.solve(same)
    assert ours.converged
    assert ours.displacement == pytest.approx(theirs.displacement, abs=1e-12 * np.abs(theirs.displacement).max())
    assert all(check.passed for check in ours.certificate)


def test_pressure_over_position_against_its_integral(tmp_path: Path) -> None:
    """1 + 0.5 x on [0, 2]: 3 in all, whose first moment is 2 + 4 / 3; the contact below carries both."""
    model = load_job(job(tmp_path, traction="[0, 0]")).model
    contact = abut.solve(model).contacts[0]
    forces, x = contact.contactor_forces, model.mesh.points[contact.contactor.node_ids][:, 0]
    assert forces[:, 1].sum() == pytest.approx(3.0, rel=1e-10)
    assert x @ forces[:, 1] == pytest.approx(2.0 + 4.0 / 3.0, rel=1e-10)


@pytest.mark.parametrize("plane", ["strain", "axisymmetric"])
def test_pressure_over_position_follows(plane: str) -> None:
    """With finite kinematics the pressure is that of the undeformed place; small strains leave the dead load."""
    model = abut.Model(
        make.join({"block": make.rectangle([1, 3], [0, 1], [6, 3])}),
        [abut.Solid("block", abut.LinearElastic(100.0, 0.3))],
        [abut.Support("block.bottom", x=0, y=0)],
        [abut.Pressure("block.top", "1e-5*(1 + 0.5*x)")],
        plane=plane,
    )
    small, finite = (abut.solve(replace(model, kinematics=name)) for name in ("small", "finite"))
    largest = np.abs(small.displacement).max()
    assert finite.displacement == pytest.approx(small.displacement, abs=1e-5 * largest)  # strains are 1e-7


def test_follower_pressure_against_differences() -> None:
    """The derivative of its forces by the positions; the pressure stays that of the undeformed place."""
    surface = make.join({"block": make.rectangle([1, 3], [0, 1], [2, 1], cell="quad8")}).surface("block.top")
    rng = np.random.default_rng(2)
    start = surface.points + 0.05 * rng.standard_normal(surface.points.shape)
    way, h = rng.standard_normal(surface.points.shape), 1e-5

    def forces(points: np.ndarray) -> tuple:
        return follower_pressure(replace(surface, points=points), Expression("1 + x*y"), surface.points)

    (ahead, _), (behind, _), (_, slope) = (forces(start + s * h * way) for s in (1.0, -1.0, 0.0))
    assert slope @ way.ravel() == pytest.approx((ahead - behind) / (2.0 * h), abs=1e-8)  # of numbers about 1


def test_there_and_back(tmp_path: Path) -> None:
    loaded = load_job(job(tmp_path))
    write_job(tmp_path / "again.toml", loaded)
    again = load_job(tmp_path / "again.toml")
    assert again.model.contacts == loaded.model.contacts
    assert again.model.loads == loaded.model.loads
    assert again.model.supports == loaded.model.supports


def test_restart_knows_another_expression(tmp_path: Path) -> None:
    first, second = (description(load_job(job(tmp_path, friction=text)).model) for text in ('"0.1*x"', '"0.2*x"'))
    assert {key for key in first if first[key] != second.get(key)} == {"contacts[0].friction.text"}


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"friction": '"0.1 + q"'}, "friction: expected a coefficient >= 0, an expression .* unknown name 'q'"),
        ({"x": '"0.1 +"'}, r"supports\[0\].x: cannot read '0.1 \+' as an expression"),
        ({"x": "true"}, r"supports\[0\].x: expected a number or an expression"),
        ({"x": "nan"}, r"supports\[0\].x: expected a finite number"),
        ({"pressure": '"x^2"'}, r"loads\[0\].value: 'x \^ 2' is not part"),
        ({"traction": '["q", 0]'}, r"loads\[1\].value\[0\]: unknown name 'q'"),
        ({"traction": '"x"'}, r"loads\[1\].value: expected a valid list"),
        ({"temperature": "[1]"}, r"loads\[2\].value: expected a number or an expression"),
    ],
)
def test_one_message_for_each_bad_value(tmp_path: Path, given: dict[str, str], words: str) -> None:
    path = job(tmp_path, **given)
    with pytest.raises(InputError, match=words) as error:
        load_job(path)
    assert str(error.value).startswith(str(path))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"friction": '"0.1 - x"'}, r"friction: '0.1 - x' returns -\S+ at \[\S+, 1\.0\], not >= 0"),
        ({"friction": '"0.1/x"'}, r"friction: '0.1/x' returns inf at \[0.0, 1.0\]"),
        ({"friction": '"sqrt(x - 1)"'}, r"friction: 'sqrt\(x - 1\)' returns nan at"),
        ({"friction": '"0.1*z"'}, "friction: z: positions have x and y alone"),
        ({"x": '"log(x)"'}, r"x: 'log\(x\)' returns -inf at \[0.0, 0.0\]"),
        ({"pressure": '"1e200*x"'}, r"pressure on 'lid.top': value: '1e200\*x' returns \S+ at"),
        ({"traction": '["x", 0, 0]'}, r"must return shape"),
    ],
)
@pytest.mark.parametrize("act", [abut.solve, check], ids=["solve", "check"])
def test_one_message_for_each_bad_point(tmp_path: Path, given: dict[str, str], words: str, act: object) -> None:
    model = load_job(job(tmp_path, **given)).model
    if act is check:
        assert any(re.search(words, finding.line) for finding in check(model).findings)
        return
    with pytest.raises(InputError, match=words):
        abut.solve(model)
