"""abut check: each mistake is named with its cure before anything is solved."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import abut
from abut.bodies.factor_memory import MEMORY
from abut.cells import CELLS
from abut.cli import main
from abut.diagnosis import Finding, Report, check, from_error
from abut.diagnosis.cost import foresee
from abut.diagnosis.quality import quality
from abut.errors import InputError
from abut.job import load_job
from abut.linear.cost_model import LARGE, Effort, effort, of_stiffness, seconds
from abut.mesh.make import box, join, rectangle
from abut.mesh.mesh import CellBlock, Mesh
from abut.mesh.shapes import CORNERS
from abut.nonlinear.settings import DEFAULT
from abut.problem.constraints import supports
from models.friction import pushed

EXAMPLES = Path(__file__).parents[2] / "examples"
TEXT = (EXAMPLES / "two-blocks" / "job.toml").read_text()
STEEL = abut.LinearElastic(young=210e3, poisson=0.3)
SOFT = abut.LinearElastic(young=70e3, poisson=0.3)

# fmt: off
FAULTY = {  # what the one line must say, and its cure; the exit status
    "sliding": ("body 'upper' is free to translate along x", "add a support, or a symmetry plane", 4),
    "tie-and-support": (
        "support on 'upper.bottom' and the tie constrain the same nodes",
        "remove support on 'upper.bottom'",
        4,
    ),
    "small-target": ("target 'lower.top' is too small", "add these facets to 'lower.top'", 0),
    "inside-out": ("4 quad4 cells of 'upper' are inverted", "their nodes run clockwise, those of other cells do not", 2),
    "metres-and-millimetres": ("one seems to be meshed in metres", "scale the coordinates of 'upper' by 1000", 2),
}
# fmt: on


def test_every_faulty_job_is_tested() -> None:
    assert {path.stem for path in (EXAMPLES / "faulty").glob("*.toml")} == set(FAULTY)


@pytest.mark.parametrize("name", FAULTY)
def test_faulty_jobs_are_explained_in_one_line(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    """One error or warning, the mistake and its cure both in its line, and nothing else to mend."""
    what, cure, status = FAULTY[name]
    assert main(["check", str(EXAMPLES / "faulty" / f"{name}.toml")]) == status
    lines = [
        line for line in capsys.readouterr().out.splitlines() if line.startswith(("error ", "warning ", "advice "))
    ]
    assert len(lines) == 1
    assert what in lines[0]
    assert cure in lines[0].split("; ", 1)[1]


@pytest.mark.long
@pytest.mark.parametrize("job", ["two-blocks/job", "hertz-line/quad4", "pin-lug/job"])
def test_sound_jobs_have_nothing_to_mend(job: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(EXAMPLES / f"{job}.toml")]) == 0
    assert "error" not in capsys.readouterr().out


def blocks(upper: abut.Mesh | None = None, material: abut.LinearElastic = STEEL, **options: object) -> abut.Model:
    """The two blocks of the simplest job."""
    mesh = join(
        {
            "lower": box(x=(0, 10), y=(0, 10), z=(0, 10), cells=(6, 6, 3)),
            "upper": upper or box(x=(2, 8), y=(2, 8), z=(10, 15), cells=(5, 5, 3)),
        }
    )
    model = abut.Model(
        mesh,
        [abut.Solid("lower", STEEL), abut.Solid("upper", material)],
        supports=[abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.top", x=0, y=0, z=-0.02)],
        contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", name="blocks")],
    )
    return replace(model, **options)  # type: ignore[arg-type]


def said(report: Report, severity: str) -> str:
    """The only line of a severity."""
    (finding,) = (f for f in report.findings if f.severity == severity)
    return finding.line


def test_what_a_deck_is_read_as(capsys: pytest.CaptureFixture[str]) -> None:
    """What stands in place of what the deck says is said under its name."""
    assert main(["check", str(EXAMPLES / "deck" / "pad.inp")]) == 0
    assert "info     deck: CPE4H: mean dilatation (b-bar)" in capsys.readouterr().out


def test_wrong_side_of_a_body() -> None:
    """The surfaces that do face each other are named."""
    report = check(blocks(contacts=[abut.Contact(contactor="upper.bottom", target="lower.bottom", name="blocks")]))
    assert "normals of 'upper.bottom' and 'lower.bottom' point the same way" in said(report, "error")
    assert "face each other are 'lower.top' and 'upper.bottom': use them" in said(report, "error")
    assert report.status == 2


def test_bodies_far_apart_and_gaps_that_nothing_closes() -> None:
    far = check(blocks(box(x=(2, 8), y=(2, 8), z=(30, 35), cells=(5, 5, 3))))
    assert "lie 20 apart, beyond the reach" in said(far, "error")
    near = check(blocks(box(x=(2, 8), y=(2, 8), z=(10.5, 15), cells=(5, 5, 3))))
    assert "nothing closes the gap of 0.5" in said(near, "warning")
    assert near.status == 0


@pytest.mark.parametrize(("offset", "factor", "closes"), [(-0.6, 1.0, True), (0.6, -1.0, True), (-0.6, 0.5, False)])
def test_offsets_that_come_with_time_close_gaps(offset: float, factor: float, closes: bool) -> None:
    """Offset times the amplitude's factor counts where it closes the gap of 0.5 most; the supports move by 0.02."""
    course = abut.Amplitude(((0.0, 0.0), (0.5, factor), (1.0, 0.0)))
    contact = abut.Contact(contactor="upper.bottom", target="lower.top", offset=offset, amplitude=course)
    report = check(blocks(box(x=(2, 8), y=(2, 8), z=(10.5, 15), cells=(5, 5, 3)), contacts=[contact]))
    assert closes != any("nothing closes the gap" in finding.what for finding in report.findings)


def test_deep_overlap() -> None:
    """Deeper than half a facet: hardly meant; the offset that undoes it is named."""
    report = check(blocks(box(x=(2, 8), y=(2, 8), z=(9, 15), cells=(5, 5, 3))))
    assert "overlap by up to 1, 0.83 times the facet size (deeper than half of it on 100% of the area)" in said(
        report, "warning"
    )
    assert "offset = 1" in said(report, "warning")


def test_histogram_of_gaps() -> None:
    """A face tilted by 0.01 over 6: gaps are spread evenly from 0 to 0.01, an eighth in each bar."""
    upper = box(x=(2, 8), y=(2, 8), z=(10, 15), cells=(20, 4, 2))
    points = upper.points.copy()
    points[:, 2] += 0.01 * (points[:, 0] - 2) / 6 * (15 - points[:, 2]) / 5
    report = check(blocks(replace(upper, points=points)))
    (gap,) = (f for f in report.findings if f.what.startswith("gap "))
    assert len(gap.details) == 8
    shares = [float(line.split()[-1].rstrip("%")) for line in gap.details]
    assert shares == pytest.approx([12.5] * 8, abs=3.0)  # two points a facet: 40 columns in 8 bars


def test_the_softer_side_should_be_the_contactor() -> None:
    stiff = blocks(material=abut.LinearElastic(young=400e3, poisson=0.3))
    assert "is the stiffer side" in said(check(stiff), "advice")
    assert "swap contactor and target" in said(check(stiff), "advice")
    assert check(stiff).status == 0
    assert check(blocks(material=SOFT)).count("advice") == 0
    fine = blocks(box(x=(2, 8), y=(2, 8), z=(10, 15), cells=(12, 12, 1)))
    assert "times finer than its target" in said(check(fine), "advice")


def test_contradicting_supports() -> None:
    model = blocks()
    report = check(replace(model, supports=[*model.supports, abut.Support("upper.top", z=0.5)]))
    assert "supports on 'upper.top' contradict each other at node" in said(report, "error")
    assert report.status == 4
    report = check(replace(model, supports=[*model.supports, abut.Support("upper.left", z=0.5)]))
    assert "support on 'upper.left' and support on 'upper.top' contradict each other at node" in said(report, "error")


def test_supports_on_a_contactor() -> None:
    """Contact may press on a held surface; the held side is better as the target."""
    model = blocks(
        supports=[abut.Support("lower.bottom", x=0, y=0, z=0), abut.Support("upper.bottom", x=0, y=0, z=-0.02)]
    )
    assert "make the other side the contactor" in said(check(model), "warning")


def test_symmetry_planes_across_a_tie_are_no_over_constraint() -> None:
    model = blocks(contacts=[abut.Contact(contactor="upper.bottom", target="lower.top", kind="tied")])
    across = [*model.supports, abut.Support("upper.left", x=0), abut.Support("upper.front", y=0)]
    assert check(replace(model, supports=across)).status == 0


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"loads": [abut.Pressure("upper.left", 50e3)]}, "strains body 'upper'"),
        ({"loads": [abut.Force("upper.left", (1e-5, 0, 0))]}, "which is close to zero"),
        ({"material": abut.LinearElastic(young=210.0, poisson=0.3, density=7.85e-9)}, "speaks of millimetres"),
        ({"material": abut.LinearElastic(young=1e-3, poisson=0.3)}, "is one in Pa, the other in MPa?"),
    ],
)
def test_units(change: dict[str, object], message: str) -> None:
    """Loads against moduli, moduli against each other, gravity against the speed of sound."""
    if "millimetres" in message:
        change = {**change, "loads": [abut.Gravity((0, 0, -9810.0), on="upper")]}
        change["material"] = abut.LinearElastic(young=210e3, poisson=0.3, density=7850.0)
    report = check(blocks(**change))  # type: ignore[arg-type]
    assert any(message in f.line and f.cure for f in report.findings if f.severity != "info")


def test_displacement_larger_than_the_body() -> None:
    model = blocks()
    report = check(replace(model, supports=[model.supports[0], abut.Support("upper.top", x=0, y=0, z=-20.0)]))
    assert "a displacement of 20 is 3.3 times the size of its body" in said(report, "warning")


@pytest.mark.parametrize(("on", "force", "stands"), [("foot", 100, False), ("head", -100, True), ("arm", -100, False)])
def test_loads_that_contact_cannot_balance(on: str, force: float, stands: bool) -> None:
    """A block is pulled off; pressed above its foot it stands; pressed outside it tips over (the foot ends at x = 8, the
    force acts at x = 10). No run converges where none can."""
    upper = box(x=[2.0, 4.0, 6.0, 8.0, 12.0], y=(2, 8), z=(10, 15), cells=(4, 5, 3))
    named = {}
    for name, side, beyond in (("foot", "bottom", False), ("head", "top", False), ("arm", "top", True)):
        facets = upper.surface(side)
        x = facets.points[facets.nodes[:, :4], 0].mean(axis=1)
        named[name] = upper.surfaces[side][(x > 8) == beyond]
    lower = box(x=(0, 8), y=(0, 10), z=(0, 10), cells=(6, 6, 3))
    model = abut.Model(
        join({"lower": lower, "upper": replace(upper, surfaces=named)}),
        [abut.Solid("lower", STEEL), abut.Solid("upper", STEEL)],
        supports=[abut.Support("lower.bottom", x=0, y=0, z=0)],
        loads=[abut.Force(f"upper.{on}", (0.0, 0.0, force))],
        contacts=[abut.Contact(contactor="upper.foot", target="lower.top")],
    )
    report = check(model)
    if stands:
        assert report.status == 0
        assert abut.solve(model).converged
        return
    assert report.status == 4
    how = {"foot": "translate along z", "arm": "rotate about y"}[on]
    assert f"body 'upper' is free to {how}: the loads pull it off its contact" in said(report, "error")
    with pytest.raises(
        abut.SingularModelError, match=f"body 'upper' is free to {how}: the loads pull it off its contact"
    ):
        abut.solve(model)


def test_loose_motions_are_advice_and_drawn(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Three motions that contact holds and three that nothing does, each a field of the file."""
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    job = tmp_path / "job.toml"
    job.write_text(TEXT.replace("x = 0\ny = 0\nz = -0.02", "z = -0.02"))
    assert main(["check", str(job), "--json", "--output", str(tmp_path / "out")]) == 0
    answer = json.loads(capsys.readouterr().out)
    assert answer["status"] == 0
    assert sum(f["severity"] == "advice" for f in answer["findings"]) == 3
    held = {m["motion"]: m["resisted_by"] for m in answer["motions"]}
    assert held == {
        "translation of body 'upper' along x": "nothing",
        "translation of body 'upper' along y": "nothing",
        "rotation of body 'upper' about z": "nothing",
    }
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(tmp_path / "out" / "motions.vtu"))
    reader.Update()
    assert reader.GetOutput().GetPointData().GetNumberOfArrays() == 3


def test_pairs_are_written_out(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    job, out = tmp_path / "job.toml", tmp_path / "pairs.toml"
    job.write_text(TEXT.replace('contactor = "upper.bottom"\ntarget = "lower.top"', "auto = true"))
    assert main(["check", str(job), "--write-pairs", str(out)]) == 0
    assert "found: 'auto:lower-upper'" in capsys.readouterr().out
    assert load_job(out).model.contacts == load_job(job).model.contacts
    assert main(["check", str(out), "--write-pairs", str(tmp_path / "again.toml")]) == 2
    assert "nothing to write out" in capsys.readouterr().err


@pytest.mark.parametrize("kind", ["tri3", "quad4", "tet4", "hex8", "wedge6"])
def test_best_cells_have_scaled_jacobian_one(kind: str) -> None:
    """Equilateral triangles and tetrahedra, squares, cubes, prisms on an equilateral triangle (with unit edges)."""
    h = np.sqrt(0.75)
    shapes = {
        "tri3": [(0, 0), (1, 0), (0.5, h)],
        "quad4": [(0, 0), (1, 0), (1, 1), (0, 1)],
        "tet4": [(0, 0, 0), (1, 0, 0), (0.5, h, 0), (0.5, h / 3, np.sqrt(2 / 3))],
        "hex8": [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
        "wedge6": [(0, 0, 0), (1, 0, 0), (0.5, h, 0), (0, 0, 1), (1, 0, 1), (0.5, h, 1)],
    }
    x = np.array(shapes[kind], dtype=float)
    mesh = Mesh(x, (CellBlock(kind, np.arange(len(x), dtype=np.int32)[None]),), {"a": np.array([0])})
    (info,) = quality(mesh)
    assert "scaled Jacobian 1 to 1, longest over shortest edge up to 1" in info.what
    assert any(kind.startswith(name) for name, _ in CORNERS)


def test_skewed_and_long_cells_are_named() -> None:
    """A parallelogram's scaled Jacobian is the sine of its angle."""
    mesh = rectangle(cells=(4, 1), cell="quad4")
    points = mesh.points.copy()
    points[:, 0] += np.where(points[:, 1] > 0.5, 8.0, 0.0)  # angle atan(1 / 8): sine 0.124
    info, poor = quality(replace(mesh, points=points))
    assert "0.12" in info.what
    assert poor.severity == "advice"
    assert "4 cells of 'body' are skewed" in poor.what
    long = quality(rectangle(x=(0, 1000), cells=(1, 1), cell="quad4"))[1]
    assert "more than 100 times as long as thick" in long.what


def test_cells_turned_inside_out_are_an_error() -> None:
    """One corner of a quadrilateral pushed beyond its diagonal: positive at the integration points, negative there."""
    mesh = rectangle((0, 1), (0, 1), cells=(1, 1), cell="quad4")
    points = mesh.points.copy()
    points[np.argmax(points.sum(axis=1))] = (0.45, 0.45)
    _, turned, *_ = quality(replace(mesh, points=points))
    assert turned.severity == "error"
    assert "1 cells of 'body' are turned inside out at a corner (negative Jacobian" in turned.what
    assert "0 at (0.3625, 0.3625)" in turned.what
    assert "Gmsh" in turned.cure


def test_findings_check_themselves() -> None:
    with pytest.raises(InputError, match="did you mean 'warning'"):
        Finding("warnin", "here", "something")


def test_estimate_of_memory() -> None:
    """Within the factor of three that the page promises of what docs/performance.md measured (tilted, then the ball, then
    hex20 and tet10; one core)."""
    for solver, degree, n, megabytes in (
        ("direct", 1, 9591, 172),
        ("amg", 1, 154686, 769),
        ("amg", 1, 1026453, 4712),
        ("amg", 1, 401568, 2077),
        ("amg", 2, 154011, 1370),
        ("amg", 2, 154686, 865),
    ):
        assert 1 / 3 < MEMORY[3, solver, degree].megabytes(n) / megabytes < 3


@pytest.mark.parametrize(("dim", "power"), [(2, 1.5), (3, 2.0)])
def test_estimate_of_time_grows_as_nested_dissection(dim: int, power: float) -> None:
    """Operations of a factorisation: n^(3/2) of a square, n^2 of a cube; of a bar ten times as long, ten times those of its
    tenth part."""

    def fronts(n: int, length: int = 1) -> float:
        mesh = (
            rectangle(x=(0, length), cells=(n * length, n), cell="quad4")
            if dim == 2
            else box(x=(0, length), cells=(n * length, n, n), cell="hex8")
        )
        return of_stiffness(mesh, mesh.points.size).fronts

    coarse, fine = (8, 16) if dim == 3 else (20, 40)
    unknowns = [dim * (n + 1) ** dim for n in (coarse, fine)]
    assert np.log(fronts(fine) / fronts(coarse)) / np.log(unknowns[1] / unknowns[0]) == pytest.approx(power, rel=1e-9)
    assert fronts(fine, 10) == pytest.approx(10 * fronts(fine), rel=0.15)  # nodes at the ends count once


@pytest.mark.parametrize("cell", ["hex8", "hex20"])
def test_expected_times_agree_with_the_choice_of_the_solver(cell: str) -> None:
    """Both are of one model: where multigrid is chosen by far, it is the faster one by its estimate, and conversely. Of a
    cube with a contact on one side, by eight times more and less displacements than where the choice turns."""
    degree = CELLS[cell].degree
    for times, faster in ((1 / 8, "direct"), (8, "amg")):
        n = round((times * LARGE[degree] / 3) ** (1 / 3) / degree)
        mesh = box(cells=(n, n, n), cell=cell)
        stiffness = of_stiffness(mesh, mesh.points.size)
        own = Effort(stiffness, {cell: n**3}, multipliers=n**2, pairs=1, bodies=1, cutting=0.0, steps=1, stretched=1.0)
        expected = {solver: seconds(own, solver)["solve"] for solver in ("direct", "amg")}
        assert min(expected, key=lambda solver: expected[solver]) == faster


def test_time_at_large_displacements_counts_iterations_and_steps() -> None:
    """Each iteration has new factors: thirty where five steps are given; as many steps as runs find where none are."""

    def foreseen(**solve: Any) -> float:
        mesh = rectangle(cells=(20, 20), cell="quad8")
        held = [abut.Support("bottom", x=0, y=0), abut.Support("top", y=0.1)]
        rubber = abut.NeoHooke(1.0, 0.4)
        model = abut.Model(
            mesh, [abut.Solid("body", rubber)], held, plane="strain", kinematics="finite",
            solve=abut.SolveOptions(**solve),
        )  # fmt: skip
        (found,) = (finding for finding in check(model).findings if "free displacements" in finding.what)
        assert ("18 load steps" in found.what) == (not solve)
        return foresee(model, supports(model), []).stages["solve"]

    assert foreseen(steps=10) == pytest.approx(2.0 * foreseen(steps=5))
    assert foreseen() == pytest.approx(18.0 / 5.0 * foreseen(steps=5))
    assert foreseen(times=(0.5, 1.0)) == pytest.approx(2.0 / 5.0 * foreseen(steps=5))


LINES = [i for i, line in enumerate(TEXT.splitlines()) if line.strip() and not line.startswith("#")]
VALUES = [
    "nan",
    "-1",
    "0",
    "1e400",
    '""',
    '"lower.top"',
    '"auto:upper-lower"',
    "[]",
    "[1, 2]",
    "true",
    "1e-320",
    "1e10",
]


@pytest.mark.long
@settings(max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(line=st.sampled_from(LINES), value=st.sampled_from(VALUES), drop=st.booleans(), auto=st.booleans())
def test_any_broken_line_ends_in_findings(
    line: int, value: str, drop: bool, auto: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Every line dropped, every value replaced by nonsense, with named and with found pairs: findings, never a bug."""
    text = TEXT.replace('contactor = "upper.bottom"\ntarget = "lower.top"', "auto = true\n") if auto else TEXT
    lines = text.splitlines()
    if drop or "=" not in lines[line]:
        del lines[line]
    else:
        lines[line] = f"{lines[line].split('=')[0]}= {value}"
    (tmp_path / "job.toml").write_text("\n".join(lines))
    status = main(["check", str(tmp_path / "job.toml")])
    captured = capsys.readouterr()
    assert captured.err == ""
    assert status in (0, 2, 4), captured.out


def test_time_with_friction_counts_the_onset_of_slip() -> None:
    """A block that is drawn along at small displacements: steps that abut finds are more than the one that it takes without
    friction; those that are given are what they are."""

    def foreseen(friction: float, **solve: Any) -> tuple[str, float]:
        model = replace(pushed(friction=friction), solve=abut.SolveOptions(**solve))
        (found,) = (finding for finding in check(model).findings if "free displacements" in finding.what)
        return found.what, effort(model, 100, ()).steps

    text, steps = foreseen(0.3)
    assert steps > DEFAULT.steps.points
    assert f"for {steps} load steps" in text
    for friction, solve, count in ((0.0, {}, 1), (0.3, {"steps": 5}, 5)):
        text, steps = foreseen(friction, **solve)
        assert steps == count
        assert "load steps; a run finds them" not in text


@pytest.mark.parametrize(
    ("said", "where", "what"),
    [
        ("start.time: expected a time; give one", "start.time", "expected a time"),
        ("start: no steps of another job; model both", "start", "no steps of another job"),
        ("a.msh: line 3; mend it", "job", "a.msh: line 3"),
    ],
)
def test_places_of_errors_are_said_once(said: str, where: str, what: str) -> None:
    finding = from_error(InputError(said), where.partition(".")[0])
    assert (finding.where, finding.what, finding.cure) == (where, what, said.partition("; ")[2])
