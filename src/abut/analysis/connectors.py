"""What connectors do at the end of a step, from its state."""

from __future__ import annotations

from dataclasses import replace

from abut.problem.connectors import Connectors
from abut.problem.problem import ContactProblem
from abut.solution.connectors import ConnectorResult
from abut.solution.state import State


def connector_results(problem: ContactProblem, state: State) -> dict[str, ConnectorResult]:
    """By name."""
    motion = problem.motion(state.time, problem.values(state))
    for term in problem.terms:
        if isinstance(term, Connectors):
            here = replace(motion, history=state.history.of(term.name))
            return term.results(here, here)
    return {}
