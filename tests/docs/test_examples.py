"""Every job file and deck in examples/ is found, loads, and (but for the long ones) runs to balance."""

from __future__ import annotations

import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.job import load_job
from abut.report.lines import pressure_lines
from abut.report.origin import PROFILE, ellipse
from abut.report.origin import quantities as known_quantities
from models.beam_theory import belt_ratio, clip_force, leaf_forces

FOLDER = Path(__file__).parents[2] / "examples"
FILES = sorted([*FOLDER.rglob("*.toml"), *FOLDER.rglob("*.inp")])
JOBS = [path for path in FILES if path.parent.name != "faulty"]  # those: test_check.py
LONG = {
    "pin-lug",
    "hertz-sphere",
    "snap-joint",
    "crushed-ring",
    "twisted-hub",
    "o-ring",
    "accordion",
    "bolted-joint",
    "dented-plate",
    "pipe-clip",
    "belt",
    "stiffened-panel",
}


@pytest.mark.parametrize(
    "path",
    [pytest.param(p, marks=[pytest.mark.long] if p.parent.name in LONG else []) for p in JOBS],
    ids=lambda p: f"{p.parent.name}-{p.stem}",
)
def test_example_runs_and_balances(path: Path) -> None:
    """Supports carry what the loads bring; the contact carries it from body to body (to 1e-9 of the load; of the sizes of
    nodal forces where they cancel round a fit)."""
    model = load_job(path).model
    solution = abut.solve(model)
    assert solution.converged
    step = solution.steps[-1]
    tied = [contact.name for contact in model.contacts if contact.kind == "tied"]
    check_expected(path, step)
    sizes = ([np.abs(own.load).max(), *(np.abs(c.force).max() for c in own.contacts)] for own in solution.steps)
    size = max(max(own) for own in sizes)  # of all steps: in the end nothing may be loaded any more
    if path.parent.name == "twisted-hub":
        size = max(np.abs(c.contactor_forces).sum() for c in step.contacts)
    balance = (step.load + step.reaction)[1 if step.axisymmetric else 0 :]  # round an axis, radial forces cancel
    assert np.abs(balance).max() < 1e-9 * size
    for contact in (own for own in step.contacts if own.name not in tied):
        assert contact.pressure[np.isfinite(contact.pressure)].min() >= -0.1 * contact.max_pressure
    assert all(c.max_penetration < 1e-6 * np.ptp(c.contactor.points) for c in step.contacts)
    if path.parent.name in MORE:
        MORE[path.parent.name](solution)


def check_twisted_hub(solution: abut.Solution) -> None:
    """The torque that slips is 2 pi r^2 L mu p with the mean pressure, but for facets of 11 degrees (a half per cent); then
    the flange's work, torque times angle, is what friction takes."""
    last, (contact, _) = solution.steps[-1], solution.contacts
    torque = last.rigid["flange"].moment[2]
    assert torque == pytest.approx(2.0 * np.pi * 10.0**2 * 20.0 * 0.15 * contact.statistics.mean, rel=5e-3)
    assert torque == pytest.approx(-contact.resultant.moment[2], rel=1e-9)
    assert contact.friction.sticking_area == 0.0
    assert contact.friction.work == pytest.approx(torque * 0.003 / 8.0, rel=1e-3)
    slips = [step.contacts[0].friction.slipping_area for step in solution.steps[1:]]
    assert slips == sorted(slips)
    assert slips[0] < 0.5 * contact.area
    assert all(check.passed for check in solution.certificate)


def check_snap_joint(solution: abut.Solution) -> None:
    """Before the largest force the hook slides up the straight side of its catch: forces are as on a wedge with friction,
    tan(slope + angle of friction), but for what bends (2 %). Behind the peak the catch draws it in, and then lets go."""
    along, up = np.array([step.contacts[0].force for step in solution.steps]).T
    peak = int(np.argmin(along))
    slope, friction = 1.1 / 1.8, 0.2
    steepest = max(
        -along[: peak + 1] / np.maximum(up[: peak + 1], 0.5 * up[peak])
    )  # of the steps there are, on that side
    assert steepest == pytest.approx((slope + friction) / (1.0 - friction * slope), rel=0.02)
    assert along.max() > 0.2 * -along.min()
    assert peak < int(np.argmax(along)) < len(along) - 1
    for step in solution.steps:
        friction_ = step.contacts[0].friction
        assert friction_.force_by_area <= friction_.force_limit * (1.0 + 1e-9)


def check_deck(solution: abut.Solution) -> None:
    """In the end all of the pad slips, and Coulomb's law holds for the resultants but for how the surfaces lean (1 %)."""
    contact = solution.contacts[0]
    assert contact.friction.sticking_area == 0.0
    assert -contact.force[0] == pytest.approx(0.3 * contact.force[1], rel=0.01)
    assert all(check.passed for check in solution.certificate)


def check_leaf_spring(solution: abut.Solution) -> None:
    """The forces between the leaves, of which the last facets are a tenth of the shortest one: 3 %."""
    exact = leaf_forces([200.0, 160.0, 120.0, 80.0, 40.0], 210e3 * 20.0 * 4.0**3 / 12.0, 200.0)
    forces = [float(contact.force[2]) for contact in solution.contacts]
    assert forces == pytest.approx(exact, rel=0.03)
    assert all(check.passed for check in solution.certificate)


def check_pipe_clip(solution: abut.Solution) -> None:
    """From where its flat arm lies on the pipe (x = 6 at the outset, a facet more for the force that moves on by facets) the
    force across is that of a beam, within 3 %; along it Coulomb's, in the direction of the slope."""
    lifted = [step for step in solution.steps if 14.0 * step.factor > 8.0]
    for step in lifted:
        exact = clip_force(14.0 * step.factor, 200e3 * 10.0 * 1.5**3 / 12.0, 1.5, 10.0, 1.0, 22.0, 0.2)
        assert step.contacts[0].force[1] == pytest.approx(exact, rel=0.03)
    assert len(lifted) > 2
    assert all(check.passed for check in solution.certificate)


def check_belt(solution: abut.Solution) -> None:
    """All of the belt slips in the end; the forces at its ends are as theory says for its thickness (1 %)."""
    contact = solution.contacts[0]
    assert contact.friction is not None
    assert contact.friction.sticking_area == 0.0
    tight = float(contact.force[1]) - 100.0  # what both ends carry, less the slack one
    assert tight / 100.0 == pytest.approx(belt_ratio(0.3, 50.0, 1.0, np.pi), rel=0.01)
    assert all(check.passed for check in solution.certificate)


def check_stiffened_panel(solution: abut.Solution) -> None:
    """The bolts clamp with what they are tightened to; the load then bends panel and rib less than if they slid on each
    other, and more than if they were one: 5 q L^4 / 384 E I."""
    tight, *_, last = solution.steps
    assert [abs(float(contact.force[2])) for contact in tight.contacts] == pytest.approx([16e3] * 3, rel=1e-6)
    apart = (80.0 * 2.0**3 + 24.0 * 6.0**3) / 12.0
    one = apart + 160.0 * 144.0 / (160.0 + 144.0) * 4.0**2
    middle = np.linalg.norm(solution.model.mesh.points[:, :2] - [120.0, 0.0], axis=1) < 1e-6
    bent = float((last.displacement - tight.displacement)[middle, 2].mean())
    sliding, bonded = (5.0 * 0.01 * 80.0 * 240.0**4 / (384.0 * 70e3 * inertia) for inertia in (apart, one))
    assert 1.05 * bonded < bent < 0.95 * sliding
    assert all(check.passed for check in solution.certificate)


MORE = {
    "stiffened-panel": check_stiffened_panel,
    "leaf-spring": check_leaf_spring,
    "pipe-clip": check_pipe_clip,
    "belt": check_belt,
    "twisted-hub": check_twisted_hub,
    "snap-joint": check_snap_joint,
    "deck": check_deck,
}  # what else theory says of an example


def check_expected(path: Path, step: abut.solution.Step) -> None:
    """What theory says of the first contact and of probes: expected.json beside the job, by the job file's name."""
    expected = json.loads((path.parent / "expected.json").read_text())[path.stem]
    quantities = known_quantities(step)
    for name, wanted in expected.items():
        assert wanted["source"]
        if name == PROFILE:
            check_profile(step.contacts[0], expected, wanted["tolerance"])
            continue
        value = quantities[name]
        if "value" in wanted:
            assert value == pytest.approx(wanted["value"], rel=wanted["tolerance"]), name
        assert wanted.get("at_least", -np.inf) <= value <= wanted.get("at_most", np.inf), name


def check_profile(contact: abut.solution.ContactResult, expected: dict, tolerance: float) -> None:
    """The pressure along the report's line is Hertz's ellipse, in the mean over the line (as share of the peak): its edge,
    where the slope is infinite, falls within a facet."""
    theory = ellipse(expected)
    assert theory is not None
    peak, half, centre = theory
    line = pressure_lines(contact)[0]
    s = line.distance_from(np.array(centre))
    error = np.abs(line.pressure - peak * np.sqrt(np.maximum(1.0 - (s / half) ** 2, 0.0)))
    assert np.sum(0.5 * (error[1:] + error[:-1]) * np.diff(s)) < tolerance * peak * np.ptp(s)


def test_another_code_uses_the_interface_alone() -> None:
    """scikit-fem with abut's interface gives what abut gives: the same equations, to rounding (1e-10)."""
    pytest.importorskip("skfem")
    path = Path(__file__).parents[2] / "examples" / "scikit-fem" / "contact.py"
    spec = importlib.util.spec_from_file_location("contact_by_scikit_fem", path)
    assert spec is not None
    assert spec.loader is not None
    example = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(example)
    assert example.main() < 1e-10
    active = example.solve()[2]
    assert 0 < active.sum() < len(active)  # the crown opens towards the corners: the active set had to be found
