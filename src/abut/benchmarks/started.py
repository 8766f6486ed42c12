"""Jobs that start from another one: a bar that has yielded is let go, by loads or by what held it; bars that press each
other are drawn apart; a bolt that was tightened is loaded."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

from abut.analysis import solve
from abut.benchmarks.preloads import FORCE, sleeve
from abut.benchmarks.record import Benchmark, Reference
from abut.errors import AbutError
from abut.materials.elastic import LinearElastic
from abut.materials.plastic import Plastic
from abut.mesh.make import box, join, rectangle
from abut.model import Amplitude, Contact, Hold, Model, Solid, SolveOptions, Support, Traction
from abut.output.restart import description, save_step
from abut.output.start import load_start
from abut.solution import Saved, Solution

YOUNG, YIELD, HARDENING, PULL, LENGTH = 200e3, 200.0, 1e4, 300.0, 2.0
SOFT, OVERLAP, DRAWN = 1000.0, 0.04, 0.03  # two bars in a row, each of the length above, without lateral contraction
APART, TAKES = 6000.0, (11200.0, 5200.0)  # of a bolted sleeve: force; what then is in the bolt, and on the sleeve
SHARE = 0.5  # of the second job's time, at which the first one's steps end
STRETCH, RELEASED, PUSHED = (
    0.05,
    0.75,
    0.0446,
)  # a bar drawn so far by a support, let go up to a time, then led elsewhere
RAMP = Amplitude(((0.0, 0.0), (1.0, 1.0)))


def _let_go(level: int) -> Model:
    """Held without hindering contraction, drawn beyond yield up to the first job's end, unloaded then."""
    n = 2**level
    mesh = join({"bar": box((0.0, LENGTH), (0.0, 1.0), (0.0, 1.0), (2 * n, n, n), "hex8")})
    return Model(
        mesh,
        [Solid("bar", Plastic(YOUNG, 0.3, YIELD, HARDENING))],
        [Support("bar.left", x=0), Support("bar.front", y=0), Support("bar.bottom", z=0)],
        [Traction("bar.right", (PULL, 0.0, 0.0), Amplitude(((0.0, 0.0), (SHARE, 1.0), (1.0, 0.0))))],
        solve=SolveOptions(times=(0.25, SHARE, 0.75, 1.0)),
    )


def _gripped(level: int) -> Model:
    """Drawn by a grip, which lets go after the first job; what has taken hold of it then leads it back in part."""
    grips = [
        Hold("bar.right", x=STRETCH, reached=SHARE, until=SHARE, released=RELEASED, name="grip"),
        Hold("bar.right", x=PUSHED, since=RELEASED, name="press"),
    ]
    return replace(_let_go(level), loads=(), holds=grips, solve=SolveOptions(times=(0.25, SHARE, 0.625, RELEASED, 1.0)))


def _drawn(level: int) -> Model:
    """Interference up to the first job's end, which stays; then the end of one bar is drawn away."""
    n = 2**level
    sides = {"left": (0.0, LENGTH), "right": (LENGTH, 2.0 * LENGTH)}
    mesh = join(
        {name: rectangle(x, (0.0, 1.0), (2 * n, (2 + i) * n), "quad4") for i, (name, x) in enumerate(sides.items())}
    )
    return Model(
        mesh,
        [Solid(name, LinearElastic(SOFT, 0.0)) for name in sides],
        [
            *(Support(f"{name}.bottom", y=0) for name in sides),
            Support("left.left", x=0),
            Support("right.right", x=DRAWN, amplitude=Amplitude(((0.0, 0.0), (SHARE, 0.0), (1.0, 1.0)))),
        ],
        contacts=[
            Contact(
                "left.right", "right.left", "joint", offset=-OVERLAP,
                amplitude=Amplitude(((0.0, 0.0), (SHARE, 1.0), (1.0, 1.0))),
            )
        ],
        plane="stress",
        solve=SolveOptions(times=(0.25, SHARE, 0.75, 1.0)),
    )  # fmt: skip


def _first(model: Model) -> Model:
    """The job before: what the model does up to the share, over its whole time. What holds is a support there; bolts are not
    locked yet."""
    supports = [Support(hold.on, x=hold.x, amplitude=RAMP) for hold in model.holds if hold.since == 0.0]
    return replace(
        model,
        holds=(),
        loads=[replace(load, amplitude=RAMP) for load in model.loads if load.amplitude and load.amplitude(SHARE)],
        preloads=[replace(preload, amplitude=RAMP, lock=None) for preload in model.preloads],
        supports=[*(_still(support) for support in model.supports), *supports],
        contacts=[replace(contact, amplitude=RAMP if contact.amplitude else None) for contact in model.contacts],
        solve=SolveOptions(steps=2),
    )


def _still(support: Support) -> Support:
    """With what it moves at rest."""
    at_rest: Any = {name: 0.0 for name in "xyz" if getattr(support, name) is not None}
    return replace(support, amplitude=None, **at_rest)


def _one_after_the_other(model: Model) -> Solution:
    """Solve the first job, keep its restart files, and let the model begin with them."""
    first = _first(model)
    with tempfile.TemporaryDirectory() as folder:

        def keep(_: Solution, saved: Saved) -> None:
            save_step(Path(folder), description(first), saved)

        solve(first, on_step=keep)
        begun = load_start(Path(folder), model, SHARE)
        own: list[float] = []
        solution = solve(model, resume=begun, on_step=lambda _, saved: own.append(saved.state.time))
    if min(own) <= SHARE:  # the result is the same where the model solves the first steps again
        raise AbutError(f"expected steps after {SHARE:g} only, got some at {min(own):g}")
    return solution


def _stretches(solution: Solution) -> dict[str, float]:
    nodes = solution.model.mesh.nodes_of("bar.right")
    at = {step.factor: float(step.displacement[nodes, 0].mean()) for step in solution.steps}
    return {"drawn": at[SHARE], "let go": at[1.0]}


def _grips(solution: Solution) -> dict[str, float]:
    nodes = solution.model.mesh.nodes_of("bar.right")
    at = {step.factor: step for step in solution.steps}
    forces = {f"force at {time:g}": float(at[time].reactions["bar.right"][0]) for time in (SHARE, 0.625, 1.0)}
    return {**forces, "let go": float(at[RELEASED].displacement[nodes, 0].mean())}


def _pressures(solution: Solution) -> dict[str, float]:
    at = {step.factor: abs(float(step.contacts[0].force[0])) for step in solution.steps}
    return {"pressed": at[SHARE], "drawn away": at[1.0]}


def _bolts(solution: Solution) -> dict[str, float]:
    at = {step.factor: step for step in solution.steps}
    on_sleeve = next(contact for contact in at[1.0].contacts if contact.name == "sleeve")
    return {
        "tightened": at[SHARE].preloads["bolt"].tension,
        "loaded": at[1.0].preloads["bolt"].tension,
        "on the sleeve": abs(float(on_sleeve.force[1])),
    }


def _bolted(kinematics: str) -> Benchmark:
    """Tightened in the first job, pulled apart in the second, where it is locked."""
    far = kinematics == "finite"
    near, why = (2e-3, "strains of 5e-4 beside 1") if far else (1e-5, LIKE_HOLDS)
    springs = "bolt and sleeve, springs beside each other"
    return Benchmark(
        "start-bolt" + ("-finite" if far else ""),
        "bolt in a sleeve, tightened in one job, locked and pulled apart in the next" + (", finite kinematics" * far),
        lambda level: sleeve(kinematics, APART, cells=2**level),
        _bolts,
        {
            "tightened": Reference(FORCE, 1e-6, "what is prescribed", UNIFORM),
            "loaded": Reference(TAKES[0], near, springs, why),
            "on the sleeve": Reference(TAKES[1], near, springs, why),
        },
        solve=_one_after_the_other,
    )


PLASTIC = (PULL - YIELD) / HARDENING
DRAWN_TO = (STRETCH / LENGTH + YIELD / HARDENING) / (
    1.0 / YOUNG + 1.0 / HARDENING
)  # stress of the bar drawn by its grip
STAYS = (DRAWN_TO - YIELD) / HARDENING
GRIP, LIKE_HOLDS = "E and H in a row", "uniform stresses; a hold gives a millionth of what a cell does"
BARS = "two bars in a row: E (overlap - way) / 2 L"
UNIFORM = "uniform stresses; what Newton's method leaves"
BENCHMARKS = (
    Benchmark(
        "start-plastic", "bar drawn beyond yield in one job, let go in the next: what stays", _let_go, _stretches,
        {
            "drawn": Reference(LENGTH * (PULL / YOUNG + PLASTIC), 1e-7, "E and H in a row", UNIFORM),
            "let go": Reference(LENGTH * PLASTIC, 1e-7, "(stress - yield stress) / H of the length", UNIFORM),
        },
        solve=_one_after_the_other,
    ),
    Benchmark(
        "start-holds", "bar drawn beyond yield by a support in one job; another one takes over in the next",
        _gripped, _grips,
        {
            f"force at {SHARE:g}": Reference(DRAWN_TO, 1e-7, GRIP, UNIFORM),
            "force at 0.625": Reference(0.5 * DRAWN_TO, 1e-7, GRIP, UNIFORM),
            "let go": Reference(LENGTH * STAYS, 1e-7, "(stress - yield stress) / H of the length", UNIFORM),
            "force at 1": Reference(YOUNG * (PUSHED / LENGTH - STAYS), 1e-5, "E times what is not plastic", LIKE_HOLDS),
        },
        solve=_one_after_the_other,
    ),
    Benchmark(
        "start-fit", "bars that press each other by interference in one job, drawn apart in the next", _drawn, _pressures,
        {
            "pressed": Reference(SOFT * OVERLAP / (2.0 * LENGTH), 1e-9, BARS, UNIFORM),
            "drawn away": Reference(SOFT * (OVERLAP - DRAWN) / (2.0 * LENGTH), 1e-9, BARS, UNIFORM),
        },
        solve=_one_after_the_other,
    ),
    _bolted("small"),
    _bolted("finite"),
)  # fmt: skip
