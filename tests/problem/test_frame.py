"""What is fixed during a load step is a record beside the converged state, which stays as it is."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

import abut
from abut.output.restart import load_steps, save_step
from abut.solution import Saved
from models.sliding import arched, finite, sharp


def test_a_step_leaves_the_state_that_it_begins_with(tmp_path: Path) -> None:
    """Every array of each converged state is the same after the steps that follow, and after a way through a file."""
    kept: list[tuple[Saved, list[bytes]]] = []

    def arrays(saved: Saved) -> list[bytes]:
        state = saved.state
        (contact,) = state.history.contacts.values()
        assert contact.past is not None
        assert contact.slips is not None
        parts = (
            state.unknowns,
            state.multipliers,
            state.status,
            contact.slips,
            contact.past.shift,
            contact.past.points.array,
        )
        return [part.tobytes() for part in parts]

    model = arched(0.3, solve=abut.SolveOptions(steps=4))
    assert abut.solve(model, on_step=lambda _, saved: kept.append((saved, arrays(saved)))).converged
    assert len(kept) > 3
    for saved, told in kept:
        assert arrays(saved) == told
        save_step(tmp_path, {}, saved)
    assert [arrays(saved) for saved in load_steps(tmp_path, {})] == [told for _, told in kept]


def test_the_frame_of_the_end_is_the_same_object_where_nothing_differs() -> None:
    """And another one where a block has gone on over a plate's nodes, whose slips count at points that it covers there."""
    problem = finite(sharp(0.3, 9))
    before = problem.start()
    frame = problem.frame(before)
    assert problem.settled(before, frame, before) is frame
    assert problem.handed(before, problem.ended(before), problem.ended(before)) is before
    moved = np.zeros_like(problem.model.mesh.points)
    moved[problem.model.mesh.nodes_of("upper"), 0] = 0.5
    end = replace(
        before.with_closed(np.ones(len(before.status), bool)), unknowns=problem.constraints.free.T @ moved.ravel()
    )
    other = problem.settled(before, frame, end)
    assert other is not frame
    (one,), (two,) = frame.pairs, other.pairs
    assert one.past is not None
    assert two.past is not None
    assert two.past.points is one.past.points
    assert one.past.late is None
    assert two.past.late is not None
