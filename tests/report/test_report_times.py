"""What the report draws over the steps is drawn over the times of the job file."""

from __future__ import annotations

import pytest

import abut
from abut.mesh import make
from abut.report.page import _history
from abut.report.probes import charts
from abut.report.scene import scene
from abut.report.still import _history as still_history
from abut.report.times import SHARE


@pytest.mark.parametrize(("end", "label"), [(1.0, SHARE), (8.0, "time")])
def test_times_up_to_the_end(end: float, label: str) -> None:
    """Halfway and at the end, with an end of the run or without: history, probes, picture."""
    mesh = make.join(
        {name: make.box([0, 1], [0, 1], z, cells=[1, 1, 1]) for name, z in (("low", [0, 1]), ("up", [1, 2]))}
    )
    supports = [abut.Support("low.bottom", x=0, y=0, z=0), abut.Support("up.top", x=0, y=0, z=-0.01)]
    solids = [abut.Solid(body, abut.LinearElastic(1000.0, 0.0)) for body in ("low", "up")]
    options = abut.SolveOptions(times=(0.5 * end, end), end=end)
    probe = abut.Probe("middle", at=(0.5, 0.5, 1.5))
    contact = abut.Contact("up.bottom", "low.top", "pair")
    solution = abut.solve(abut.Model(mesh, solids, supports, contacts=[contact], probes=[probe], solve=options))
    history = _history(solution)
    assert (history["time"], history["label"]) == ([0.5 * end, end], label)
    assert f"{label}</text>" in still_history(history)[0]
    chart = charts(solution)[0]
    assert (chart.x.tolist(), chart.label) == ([0.5 * end, end], label)
    assert [step["time"] for step in scene(solution).data["steps"]] == [0.5 * end, end]
