"""Every threshold of the nonlinear solution, once: frozen records that ``abut.solve`` takes as ``settings``.

Each has a unit, a meaning, and a test that goes through it (``fields`` of ``dataclasses``, ``metadata``). Tests pass
others; nothing is patched."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


def _of(default: float, unit: str, meaning: str, model: str) -> Any:
    return field(default=default, metadata={"unit": unit, "meaning": meaning, "model": model})


@dataclass(frozen=True)
class NewtonSettings:
    """When iterations end, and how far they go."""

    balanced: float = _of(
        1e-9, "of the largest force or pressure", "what forces and laws may leave; no status changes by less",
        "test_finite_newton.py",
    )  # fmt: skip
    stalled: float = _of(
        1e-7, "of the largest force or pressure", "the same where it no longer falls: rounding; of a product its square",
        "test_coming_off.py::test_a_stiff_body_comes_from_afar_to_a_soft_one",
    )  # fmt: skip
    rounding: float = _of(
        1e-12, "of Young's modulus, of the largest stiffness, of the time of a run", "what is nothing but rounding",
        "test_rolling.py",
    )  # fmt: skip
    halvings: int = _of(6, "halvings", "of a step by a line search", "test_stabilised.py::test_an_arch_snaps_through")
    patience: int = _of(
        3, "iterations", "without progress, of a short try, or closings of a point until it may take another's place",
        "test_search.py, beam-on-sharp-end-lower",
    )  # fmt: skip
    solutions: int = _of(
        15, "linear solutions", "of one try for a status", "test_friction_assemblies.py",
    )  # fmt: skip
    bent: float = _of(
        0.2, "facets", "gap up to which a point that presses stays closed for an iteration", "test_opening.py",
    )  # fmt: skip
    same: float = _of(
        0.01, "of an error", "by which it may differ from that of an iteration to which others come back",
        "test_unsettled.py",
    )  # fmt: skip


@dataclass(frozen=True)
class AccuracySettings:
    """How well linear systems are solved where that is done iteratively."""

    rough: float = _of(1e-2, "of the residual", "left at most", "test_forcing.py")
    fine: float = _of(1e-5, "of the residual", "below which it need not fall in one solution", "test_forcing.py")
    share: float = _of(0.5, "of the last reduction squared", "left next (Eisenstat, Walker 1996)", "test_forcing.py")
    spare: float = _of(0.3, "of what may be left", "aimed at in the last solution", "test_forcing.py")
    stride: float = _of(1e-4, "of the residual", "at most in one solve while a set may change", "test_multigrid.py")
    further: float = _of(
        1e-3, "of forces and pressures", "left in a step solved again under further forces, some percent of its own",
        "test_second_solution.py",
    )  # fmt: skip
    told: float = _of(0.2, "of forces and pressures", "left in a state that tells the next set", "test_multigrid.py")


@dataclass(frozen=True)
class StepSettings:
    """Load steps that the program finds."""

    first: float = _of(0.1, "of the way to the next goal", "the first step", "test_pace.py")
    easy: int = _of(6, "iterations", "up to which the next step is longer; shorter above twice as many", "test_pace.py")
    growth: float = _of(1.5, "step over the last one", "after an easy step", "test_pace.py")
    shrink: float = _of(0.7, "step over the last one", "after a hard step", "test_pace.py")
    missed: float = _of(
        0.01, "of friction", "that a step gets wrong: where points touch and stick in it, and where slip begins in it",
        "test_step_error.py, test_onset_of_slip.py",
    )  # fmt: skip
    most: int = _of(25, "iterations", "in a step, above which it is halved", "test_large_sliding.py")
    points: int = _of(8, "load steps", "over which contact begins to slip, theory (R21)", "test_onset_of_slip.py")
    aim: float = _of(0.8, "of the longest step", "that the onset of slip allows", "test_onset_of_slip.py")
    smallest: float = _of(
        1.0 / 4096.0, "of the way to the next goal", "step; its root where the user gives steps", "test_pace.py",
    )  # fmt: skip
    folded: float = _of(
        0.5, "of a cell's change of volume", "that a point of it may differ by at once; hardly any does where F-bar holds",
        "test_swap.py::test_json_decks_and_mistakes",
    )  # fmt: skip
    careful: int = _of(
        2, "cuts in a row", "from which on a line search shortens iterations", "test_stabilised.py",
    )  # fmt: skip
    solutions: int = _of(
        60, "solutions of a step", "under a drag; after each of which a fluid may get on in a contact",
        "test_large_sliding.py::test_too_much_ends_with_words, test_penetration.py",
    )  # fmt: skip


@dataclass(frozen=True)
class HoldingSettings:
    """Bodies that contact alone holds."""

    near: float = _of(
        0.1, "facets", "an iteration may move bodies along motions that nothing resists",
        "test_corners.py::test_pin_that_falls",
    )  # fmt: skip
    absurd: float = _of(
        1e6, "sizes of the model", "that no units explain as a displacement", "test_result_size.py",
    )  # fmt: skip
    gone: float = _of(
        2.0, "sizes of the model", "beyond which a body has flown off",
        "test_stabilised.py::test_bodies_that_are_gone",
    )  # fmt: skip


@dataclass(frozen=True)
class DragSettings:
    """A drag that leads a step, theory (G23). Relative forces are over the largest of the step."""

    slight: float = _of(
        1e-3, "of the stiffness, of the largest force, of the strongest resistance to a rigid motion",
        "drag to begin with, at which bodies are all but at rest; what contact holds by less, such a drag holds rather",
        "test_stabilised.py",
    )  # fmt: skip
    change: float = _of(10.0, "drag over the last one", "at most from part to part", "test_stabilised.py")


@dataclass(frozen=True)
class StatusSettings:
    """The search for the active set: when it is left to interior points."""

    rows: int = _of(
        8, "iterations", "in which a set should settle at its pace", "test_search.py::test_when_a_set_is_hopeless"
    )
    misled: float = _of(
        0.25, "of the set", "that changes where it was foreseen wrongly", "test_search.py::test_foreseen_wrongly"
    )
    few: float = _of(0.02, "of the multipliers", "that may change for exact solutions to be tried", "test_search.py")


@dataclass(frozen=True)
class InteriorSettings:
    """Interior points."""

    boundary: float = _of(0.995, "of the way to it", "that a step goes", "test_search.py")
    central: float = _of(1e-3, "of the mean product", "that the smallest keeps", "test_search.py")
    farther: float = _of(0.3, "of a step", "that a corrector aims to gain", "test_search.py")
    worth: float = _of(
        0.1, "of that gain, of the product aimed at, of a pressure", "below which it is none: what changes or is left",
        "test_search.py",
    )  # fmt: skip
    steepest: float = _of(100.0, "coefficient of friction", "of surfaces that never slip", "test_friction.py")


@dataclass(frozen=True)
class Settings:
    """All of them."""

    newton: NewtonSettings = NewtonSettings()
    accuracy: AccuracySettings = AccuracySettings()
    steps: StepSettings = StepSettings()
    holding: HoldingSettings = HoldingSettings()
    drag: DragSettings = DragSettings()
    status: StatusSettings = StatusSettings()
    interior: InteriorSettings = InteriorSettings()


DEFAULT = Settings()
