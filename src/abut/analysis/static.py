"""solve(model): the whole way from a model to its solution on one page."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from abut import checks
from abut.analysis.run import Run
from abut.analysis.taken import taken_up
from abut.errors import OutOfTime
from abut.model import Model
from abut.nonlinear.settings import DEFAULT, Settings
from abut.solution import Observer, OnStep, Saved, Solution

if TYPE_CHECKING:
    from abut.parallel.team import Team


def _silent(*_: object) -> None:
    return None


def solve(
    model: Model,
    observer: Observer | None = None,
    on_step: OnStep | None = None,
    resume: Sequence[Saved] = (),
    team: Team | None = None,
    settings: Settings = DEFAULT,
) -> Solution:
    """Solve a model step by step.

    Parameters
    ----------
    model : Model
        What is solved; ``model.solve`` says how.
    observer : callable, optional
        Called with every iteration (``abut.solution.Iteration``), with stages that begin (``abut.solution.Phase``) and
        with notes as text while it runs; what it raises ends the run.
    on_step : callable, optional
        Gets the solution so far after each converged step, and what it takes to go on from there
        (``abut.solution.Saved``).
    resume : sequence of Saved, optional
        Such records of all steps done before, in order, of the same model: the run goes on after the last of them.
    team : abut.parallel.Team, optional
        Processes that share the work (``abut.parallel.lead``); ``solve.linear`` "petsc" takes this one alone where there
        is none.
    settings : abut.nonlinear.settings.Settings, optional
        Thresholds of the nonlinear solution; for tests and studies.

    Returns
    -------
    Solution
        All steps. A run that does not converge has its last state (``solution.converged`` is False); after
        ``solve.seconds`` there are the steps done so far (``solution.complete`` is False).

    Raises
    ------
    InputError
        For a model that cannot be used.
    SingularModelError
        For one without a unique solution.
    OutOfTime
        Where ``solve.seconds`` were over before the first step was done.

    Examples
    --------
    Two stacked blocks with meshes that do not match, pressed together:

    >>> import abut
    >>> from abut.mesh import make
    >>> lower = make.rectangle([0, 2], [0, 1], cells=[4, 2])
    >>> upper = make.rectangle([0, 2], [1, 2], cells=[3, 2])
    >>> steel = abut.LinearElastic(young=210e3, poisson=0.3)
    >>> model = abut.Model(
    ...     make.join({"lower": lower, "upper": upper}),
    ...     plane="strain",
    ...     solids=[abut.Solid("lower", steel), abut.Solid("upper", steel)],
    ...     supports=[abut.Support("lower.bottom", y=0), abut.Support("lower.left", x=0), abut.Support("upper.left", x=0)],
    ...     loads=[abut.Pressure("upper.top", 3.0)],
    ...     contacts=[abut.Contact("upper.bottom", "lower.top")],
    ... )
    >>> solution = abut.solve(model)
    >>> contact = solution.contacts[0]
    >>> print(f"pressure {contact.max_pressure:.6f} over a width of {contact.area:.6f}, force {contact.force[1]:.6f}")
    pressure 3.000000 over a width of 2.000000, force 6.000000
    >>> all(check.passed for check in solution.certificate)
    True
    """
    checks.instance(model, Model, "solve", "a model (abut.Model)")
    for name, function in (("observer", observer), ("on_step", on_step)):
        if function is not None:
            checks.function(function, f"solve: {name}")
    checks.records(resume, "solve: resume", (Saved,))
    checks.instance(settings, Settings, "solve: settings", "settings (abut.nonlinear.settings.Settings)")
    resume = taken_up(resume, model)
    run = Run.of(model, observer or _silent, on_step or _silent, team, resume, settings)
    first = run.restore(resume)
    try:
        run.march(first, resume)
        run.vibrate()
    except OutOfTime as reason:
        if not run.steps:
            raise
        run.told.note(str(reason))
        return run.so_far(complete=False)
    return run.so_far(complete=True)
