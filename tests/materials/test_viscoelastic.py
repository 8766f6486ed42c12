"""Bodies that relax: closed forms over time, tangents, turns, restart files, contact."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.job import load_job
from abut.job.convert import write_job
from abut.materials.evaluated import Array
from abut.materials.places import Places
from abut.mesh.make import join, rectangle
from abut.verify.tangents import differences

E, NU = 10.0, 0.4
BASES = (
    abut.LinearElastic(E, NU),
    abut.Hencky(E, NU),
    abut.MooneyRivlin(bulk=50.0, c10=1.0, c01=0.3),
    abut.Ogden(bulk=100.0, terms=[(1.0, 2.0), (0.2, -2.0)]),
)
TERMS = [(0.3, 0.1, 2.0), (0.2, 0.5, 0.1)]
K, G = E / (3.0 * (1.0 - 2.0 * NU)), E / (2.0 * (1.0 + NU))


def told(law: abut.Viscoelastic, elapsed: float, finite: bool = False) -> Any:
    here = law.at(Places(np.zeros((1, 3)), np.zeros(1), elapsed))
    return here.evaluate_finite if finite else here.evaluate


@pytest.mark.parametrize("finite", [False, True])
@pytest.mark.parametrize("base", BASES)
def test_tangent(base: Any, finite: bool) -> None:
    law, rng = abut.Viscoelastic(base, TERMS), np.random.default_rng(0)
    first = rng.uniform(-0.1, 0.1, (20, 6))
    history = told(law, 0.7, finite)(first, law.initial(20))[2]
    strain = first + rng.uniform(-0.05, 0.05, (20, 6))
    evaluate = told(law, 0.7, finite)
    tangent = evaluate(strain, history)[1]
    found = differences(lambda x: evaluate(x, history)[0], strain)
    assert np.abs(tangent - found).max() < 1e-7 * np.abs(tangent).max()
    if law.symmetric:
        assert np.abs(tangent - np.swapaxes(tangent, 1, 2)).max() < 1e-12 * np.abs(tangent).max()


@pytest.mark.parametrize("base", BASES)
def test_at_once_and_after_long(base: Any) -> None:
    """At once the material itself; after a long time with the shares that are left, of shape and volume: for shares that are
    alike the stress itself times these; held, nothing changes with no time."""
    rng = np.random.default_rng(1)
    strain = rng.uniform(-0.1, 0.1, (10, 6))
    plain = base.evaluate if isinstance(base, abut.LinearElastic) else base.evaluate_finite
    known = plain(strain, np.zeros((10, 0)))[0]
    law = abut.Viscoelastic(base, [(0.3, 0.3, 2.0), (0.4, 0.4, 5.0)])
    stress, tangent, history = told(law, 0.0, True)(strain, law.initial(10))
    assert np.abs(stress - known).max() < 1e-12 * np.abs(known).max()
    assert np.abs(tangent - plain(strain, np.zeros((10, 0)))[1]).max() < 1e-12 * np.abs(tangent).max()
    again, _, after = told(law, 0.0, True)(strain, history)
    assert np.abs(again - stress).max() < 1e-12 * np.abs(known).max()
    assert np.array_equal(after, history)
    late = told(law, 1e4, True)(strain, history)[0]
    assert np.abs(late - 0.3 * known).max() < 1e-12 * np.abs(known).max()
    held = told(law, 3.0, True)(strain, history)[0]
    assert np.abs(held - (0.3 + 0.3 * np.exp(-1.5) + 0.4 * np.exp(-0.6)) * known).max() < 1e-12 * np.abs(known).max()


def test_shape_and_volume() -> None:
    """Shear relaxes by its shares, pressure by the others, both exactly for strains that grow evenly."""
    law = abut.Viscoelastic(abut.LinearElastic(E, NU), [(0.3, 0.1, 2.0)])
    strain = np.array([[1e-2, 1e-2, 1e-2, 0, 0, 0], [0, 0, 0, 2e-2, 0, 0]])
    history = law.initial(2)
    for part in (0.25, 0.5, 1.0):  # unequal steps of an even growth over a time of 4
        elapsed = 4.0 * (part - {0.25: 0.0, 0.5: 0.25, 1.0: 0.5}[part])
        stress, _, history = told(law, elapsed)(part * strain, history)
    left = lambda share: 1.0 - share + share * 2.0 / 4.0 * (1.0 - np.exp(-4.0 / 2.0))  # noqa: E731
    assert stress[0, :3] == pytest.approx(3.0 * K * 1e-2 * left(0.1), rel=1e-12)
    assert stress[1, 3] == pytest.approx(G * 2e-2 * left(0.3), rel=1e-12)


def test_pressure_of_rubber() -> None:
    """Under a change of volume alone only the shares of the bulk count, in large shear only those of shape."""
    law = abut.Viscoelastic(BASES[2], [(0.5, 0.2, 1.0)])
    green = np.array([[0.5 * (0.9**2 - 1.0)] * 3 + [0.0] * 3])
    stress, _, history = told(law, 0.0, True)(green, law.initial(1))
    late = told(law, 1e3, True)(green, history)[0]
    assert late == pytest.approx(0.8 * stress, rel=1e-12)
    shear = np.array([[0.0, 0.5 * 0.6**2, 0.0, 0.6, 0.0, 0.0]])  # x += 0.6 y: no change of volume
    stress, _, history = told(law, 0.0, True)(shear, law.initial(1))
    late = told(law, 1e3, True)(shear, history)[0]
    assert np.abs(late - 0.5 * stress).max() < 1e-12 * np.abs(stress).max()


def test_small_is_the_limit_of_large() -> None:
    strain = 1e-8 * np.random.default_rng(2).uniform(-1.0, 1.0, (10, 6))
    for base in BASES:
        law = abut.Viscoelastic(base, TERMS)
        small, large = ([told(law, 0.3, finite)(strain, law.initial(10))[0]] for finite in (False, True))
        assert large[0] == pytest.approx(small[0], abs=1e-6 * np.abs(small[0]).max())


def test_long_term_moduli() -> None:
    """What scales and cells go by: shear and bulk that are left."""
    law = abut.Viscoelastic(abut.LinearElastic(E, NU), TERMS)
    rest = law.linear
    assert rest is not None
    assert rest.young / (2.0 * (1.0 + rest.poisson)) == pytest.approx(0.5 * G, rel=1e-12)
    assert rest.young / (3.0 * (1.0 - 2.0 * rest.poisson)) == pytest.approx(0.4 * K, rel=1e-12)
    assert law.modulus == rest.young


def pad(law: Any, kinematics: str, steps: int = 6, share: float = 0.2) -> abut.Model:
    """Pressed by a steel block at once, and held; friction."""
    course = abut.Amplitude(((0.0, 0.0), (1e-3, 1.0)))
    return abut.Model(
        join({"pad": rectangle((0, 4), (0, 2), (8, 4), "quad8"), "punch": rectangle((1, 3), (2, 3), (5, 2), "quad8")}),
        [abut.Solid("pad", law), abut.Solid("punch", abut.LinearElastic(210e3, 0.3))],
        [abut.Support("pad.bottom", x=0, y=0), abut.Support("punch.top", x=0, y=-share, amplitude=course)],
        contacts=[abut.Contact("punch.bottom", "pad.top", name="c", friction=0.3)],
        plane="strain",
        kinematics=kinematics,
        solve=abut.SolveOptions(end=8.0, times=(1e-3, *np.linspace(0.0, 8.0, steps)[1:])),
    )


def test_held_contact() -> None:
    """Shear and bulk that relax alike: all forces and pressures fade by one factor, displacements stay (linear)."""
    law = abut.Viscoelastic(abut.LinearElastic(E, NU), [(0.6, 0.6, 2.0)])
    solution = abut.solve(pad(law, "small", share=1e-3))
    first, *others = solution.steps
    times = np.linspace(0.0, 8.0, 6)[1:]
    start = 1.0 - 0.6 + 0.6 * -np.expm1(-5e-4) / 5e-4
    for step, time in zip(others, times, strict=True):
        left = 0.4 + 0.6 * np.exp(-(time - 1e-3) / 2.0) * -np.expm1(-5e-4) / 5e-4
        assert step.contacts[0].force == pytest.approx(first.contacts[0].force * left / start, rel=1e-4)
        size = np.abs(first.displacement).max()
        assert np.abs(step.displacement - first.displacement).max() < 1e-4 * size  # of the block, 5e-5 as soft
    assert [line.name for line in solution.certificate if line.name == "energy balance" and not line.passed] == []


@pytest.mark.parametrize("base", [abut.Hencky(E, NU), abut.MooneyRivlin(bulk=20.0, c10=1.0, c01=0.3)])
def test_large_contact_fades(base: Any) -> None:
    """At large strains, too, the force falls from step to step, toward that of what is left."""
    law = abut.Viscoelastic(base, [(0.5, 0.5, 1.0)])
    held, plain = abut.solve(pad(law, "finite")), abut.solve(pad(base, "finite"))
    force = [step.contacts[0].force[1] for step in held.steps]
    assert (np.diff(np.abs(force)) < 0.0).all()
    assert force[0] == pytest.approx(
        plain.steps[0].contacts[0].force[1], rel=1e-3
    )  # a thousandth of the time has passed
    assert force[-1] == pytest.approx(0.5 * plain.steps[-1].contacts[0].force[1], rel=5e-3)
    assert [line.name for line in held.certificate if line.name == "energy balance" and not line.passed] == []


@pytest.mark.parametrize("plane", ["strain", "stress"])
def test_heat(plane: str) -> None:
    """A body that is free to grow warm grows as any does, without stress."""
    law = abut.Viscoelastic(abut.LinearElastic(E, NU, expansion=1e-3), TERMS)
    strip = abut.Model(
        join({"strip": rectangle((0, 2), (0, 1), (2, 1), "quad8")}),
        [abut.Solid("strip", law, temperature=10.0)],
        [abut.Support("strip.left", x=0), abut.Support("strip.bottom", y=0)],
        plane=plane,
        solve=abut.SolveOptions(end=5.0, steps=2),
    )
    step = abut.solve(strip).steps[-1]
    free = step.displacement[:, 0].max() / 2.0
    if plane == "stress":
        assert free == pytest.approx(1e-2, rel=1e-12)
        assert np.abs(step.stress).max() < 1e-12 * E
    else:  # held out of the plane, which relaxes: more than the free one, less than what no volume could give
        assert 1e-2 < free < 1.5e-2


JOB = """
schema = 1
[model]
plane = "strain"
[mesh.bodies.pad]
kind = "rectangle"
x = [0, 4]
y = [0, 2]
cells = [4, 2]
[materials.now]
kind = "linear-elastic"
young = 10
poisson = 0.4
[materials.seal]
kind = "viscoelastic"
material = "now"
terms = [[0.3, 0, 2], [0.2, 0.1, 60]]
[[solids]]
body = "pad"
material = "seal"
[[supports]]
on = "pad.bottom"
x = 0
y = 0
[[supports]]
on = "pad.top"
y = -0.01
[solve]
end = 600
steps = 4
"""


def test_job(tmp_path: Path) -> None:
    path = tmp_path / "job.toml"
    path.write_text(JOB)
    law = load_job(path).model.solids[0].material
    assert law == abut.Viscoelastic(abut.LinearElastic(10.0, 0.4), [(0.3, 0.0, 2.0), (0.2, 0.1, 60.0)])
    write_job(tmp_path / "again.toml", load_job(path))
    assert load_job(tmp_path / "again.toml").model.solids[0].material == law


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('material = "now"', 'material = "then"', "materials.seal.material: no other material named 'then'"),
        ('material = "now"', 'material = "seal"', "materials.seal.material: no other material named 'seal'"),
        ("[[0.3, 0, 2]", "[[0.3, 2]", "materials.seal.terms"),
        ("[[0.3, 0, 2]", "[[0.9, 0, 2]", r"materials.seal.terms: the shares g add up to 1.1; what never fades"),
        ("[[0.3, 0, 2]", "[[-0.1, 0, 2]", r"materials.seal.terms\[0\]: expected a share g >= 0, got -0.1"),
        ("[[0.3, 0, 2]", "[[0.3, 0, 0]", r"materials.seal.terms\[0\]\[2\]: expected a number > 0"),
        (
            'kind = "linear-elastic"',
            'kind = "neo-hooke"',
            "materials.seal.material: expected .* MooneyRivlin with c01 = 0",
        ),
    ],
)
def test_wrong(tmp_path: Path, old: str, new: str, words: str) -> None:
    path = tmp_path / "job.toml"
    path.write_text(JOB.replace(old, new))
    with pytest.raises(InputError, match=words):
        load_job(path)


def test_users_own_law_with_rates() -> None:
    """The time since the history reaches a material of one's own, in that of the run, in bodies that come and go, too."""
    seen: list[float] = []

    class Timed(abut.materials.material.OwnMaterial):  # type: ignore[name-defined]
        modulus = 1.0

        def at(self, places: Places) -> Timed:
            seen.append(places.elapsed)
            return self

        def evaluate(self, strain: Array, history: Array) -> Any:
            return abut.LinearElastic(1.0, 0.3).evaluate(strain, history)

    strip = abut.Model(
        join({"strip": rectangle((0, 2), (0, 1), (2, 1)), "other": rectangle((0, 1), (3, 4), (1, 1))}),
        [abut.Solid("strip", Timed()), abut.Solid("other", Timed())],
        [abut.Support("strip.left", x=0), abut.Support("strip.bottom", y=0), abut.Support("other.bottom", x=0, y=0),
         abut.Support("strip.right", x=0.1)],
        plane="strain",
        solve=abut.SolveOptions(end=10.0, times=(2.0, 10.0)),
    )  # fmt: skip
    abut.solve(strip)
    assert {round(each, 9) for each in seen} == {0.0, 2.0, 8.0}
    seen.clear()
    abut.solve(replace(strip, removals=[abut.Removal("other", until=0.5)]))
    assert {round(each, 9) for each in seen} == {0.0, 2.0, 3.0, 5.0}  # it goes at 5
