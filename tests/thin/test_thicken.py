"""Surface and line meshes made solid, in Python and in job files: beams and plates of the textbook."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.errors import InputError
from abut.job.load import load_job
from models.gmsh_files import write_msh
from models.thin import CLAMPED, INERTIA, LENGTH, THICK, WIDTH, E, solved, strip


def mid(solution: abut.Solution, x: float, axis: int = 2) -> float:
    """Mean displacement of the section at x."""
    points = solution.model.mesh.points
    here = np.abs(points[:, 0] - x) < 1e-9
    return float(solution.displacement[here, axis].mean())


@pytest.mark.parametrize("kind", ["quad4", "tri3"])
@pytest.mark.parametrize("side", ["spos", "sneg"])
def test_clamped_strip_under_pressure(kind: str, side: str, tmp_path: Path) -> None:
    """1:100, q L^4 / 8 E I; a pressure pushes against the side it is on. Ten cells follow a curve of fourth order to h^2."""
    thick = abut.thicken(
        strip(tmp_path / "a.msh", kind=kind), {"strip": abut.Shell(THICK)}, [abut.MidSupport("left", **CLAMPED)]
    )
    solution = solved(thick, "strip", loads=[abut.Pressure(f"strip.{side}", 1e-4)])
    exact = 1e-4 * WIDTH * LENGTH**4 / (8 * E * INERTIA)
    assert mid(solution, LENGTH) == pytest.approx(-exact if side == "spos" else exact, rel=0.005)


def test_groups_of_a_shell(tmp_path: Path) -> None:
    """Faces and nodes of a strip, of a part of it, of its ends."""
    mesh = abut.thicken(strip(tmp_path / "a.msh"), {"strip": abut.Shell(THICK, offset=0.5)}).mesh
    area = {name: float(np.linalg.norm(_areas(mesh, name))) for name in mesh.surfaces}
    expected = {"strip.spos": 1000.0, "strip.sneg": 1000.0, "pad.spos": 500.0, "pad.sneg": 500.0}
    expected |= {"left.edge": 10.0, "right.edge": 10.0}
    assert {name: area[name] for name in expected} == pytest.approx(expected)
    assert len(mesh.surfaces["strip.edge"]) == 24
    assert mesh.points[mesh.nodes_of("strip.spos")][:, 2] == pytest.approx(0.0)
    assert mesh.points[mesh.nodes_of("strip.sneg")][:, 2] == pytest.approx(-THICK)
    assert mesh.points[mesh.nodes_of("corner")][:, 2] == pytest.approx([-1.0, -0.5, 0.0])
    assert set(mesh.points[mesh.nodes_of("right")][:, 0]) == {LENGTH}


def _areas(mesh: abut.Mesh, name: str) -> NDArray[np.float64]:
    from abut.bodies.loads import stress_load

    return np.asarray(stress_load(mesh.surface(name), np.eye(3)).reshape(-1, 3).sum(axis=0))


def test_turned_end(tmp_path: Path) -> None:
    """A turn of the end and no force: a parabola, which quadratic cells hold exactly."""
    angle = 1e-2
    held = [abut.MidSupport("left", **CLAMPED), abut.MidSupport("right", ry=angle)]
    solution = solved(abut.thicken(strip(tmp_path / "a.msh"), {"strip": abut.Shell(THICK)}, held), "strip")
    assert mid(solution, LENGTH) == pytest.approx(-angle * LENGTH / 2, rel=1e-6)
    assert mid(solution, LENGTH / 2) == pytest.approx(-angle * LENGTH / 8, rel=1e-6)


def test_hinged_strip(tmp_path: Path) -> None:
    """Held along both ends, free to turn there, where forces of the middle go: 5 q L^4 / 384 E I."""
    held = [abut.MidSupport("left", x=0, y=0, z=0), abut.MidSupport("right", z=0)]
    thick = abut.thicken(strip(tmp_path / "a.msh", 20), {"strip": abut.Shell(THICK)}, held)
    solution = solved(thick, "strip", loads=[abut.Pressure("strip.sneg", 1e-4)])
    assert mid(solution, LENGTH / 2) == pytest.approx(5e-4 * WIDTH * LENGTH**4 / (384 * E * INERTIA), rel=0.005)


def test_history_and_expression(tmp_path: Path) -> None:
    """An end that goes up and half way back; along its width by y."""
    up = abut.Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, 0.5)))
    held = [abut.MidSupport("left", **CLAMPED), abut.MidSupport("right", z="0.1 + 0.01*y", amplitude=up)]
    thick = abut.thicken(strip(tmp_path / "a.msh"), {"strip": abut.Shell(THICK)}, held)
    solution = solved(thick, "strip", solve=abut.SolveOptions(times=(0.5, 1.0)))
    points = solution.model.mesh.points
    for step, factor in zip(solution.steps, (1.0, 0.5)):
        for y in (0.0, WIDTH):
            here = (np.abs(points[:, 0] - LENGTH) < 1e-9) & (np.abs(points[:, 1] - y) < 1e-9)
            ends = step.displacement[here][np.abs(points[here][:, 2]) > 0.1]
            assert ends[:, 2].mean() == pytest.approx(factor * (0.1 + 0.01 * y), rel=1e-9)


def test_fold(tmp_path: Path) -> None:
    """An angle of two arms, a force P at the end of one across it: P a^3 / 3EI + P a^2 b / EI. The fold is a knot, rigid
    over half the thickness."""

    def angle(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.array([min(x[0], LENGTH / 2), x[1], max(x[0] - LENGTH / 2, 0.0)])

    held, load = [abut.MidSupport("left", **CLAMPED)], [abut.MidForce("right", (0.01, 0.0, 0.0))]
    path = strip(tmp_path / "a.msh", place=angle)
    solution = solved(abut.thicken(path, {"strip": abut.Shell(THICK)}, held, load), "strip")
    points, arm = solution.model.mesh.points, LENGTH / 2
    end = solution.displacement[points[:, 2] > arm - 1e-9][:, 0].mean()
    assert end == pytest.approx(0.05 * arm**3 / (E * INERTIA) * (1 / 3 + 1), rel=0.02)  # five nodes


def line(path: Path, count: int = 10) -> Path:
    """A line along x with groups "rib", "root" and "tip"."""
    points = np.outer(np.linspace(0.0, LENGTH, count + 1), [1.0, 0.0, 0.0])
    cells = np.stack([np.arange(count), np.arange(1, count + 1)], axis=1)
    return write_msh(path, points, {"rib": {"line2": cells}, "root": {"point": [[0]]}, "tip": {"point": [[count]]}})


@pytest.mark.parametrize(
    ("force", "axis", "inertia"), [((0, 0, 1.0), 2, 2 * 5**3 / 12), ((0, 1.0, 0), 1, 5 * 2**3 / 12)]
)
def test_cantilever_of_lines(force: tuple[float, ...], axis: int, inertia: float, tmp_path: Path) -> None:
    """P L^3 / 3 E I; shear adds (h / L)^2. Widths 2 along y and 5 along z."""
    held, load = [abut.MidSupport("root", **CLAMPED)], [abut.MidForce("tip", force)]
    thick = abut.thicken(line(tmp_path / "a.msh"), {"rib": abut.Beam((2.0, 5.0), (0.0, 1.0, 0.0))}, held, load)
    assert thick.mesh.points[:, 1].max() == pytest.approx(1.0)
    assert thick.mesh.points[:, 2].max() == pytest.approx(2.5)
    solution = solved(thick, "rib", "full")
    assert mid(solution, LENGTH, axis) == pytest.approx(LENGTH**3 / (3 * E * inertia), rel=0.005)


def test_twisted_line(tmp_path: Path) -> None:
    """A moment about the line turns its end about it alone; one across bends it: M L^2 / 2 E I."""
    held, load = [abut.MidSupport("root", **CLAMPED)], [abut.MidForce("tip", (0.0, 0.0, 0.0), (0.0, -100.0, 0.0))]
    thick = abut.thicken(line(tmp_path / "a.msh"), {"rib": abut.Beam((2.0, 5.0), (0.0, 1.0, 0.0))}, held, load)
    assert mid(solved(thick, "rib", "full"), LENGTH) == pytest.approx(
        100.0 * LENGTH**2 / (2 * E * 2 * 5**3 / 12), rel=0.005
    )


JOB = """
schema = 1
mesh = {{ file = "a.msh", shells.strip = {{ thickness = 1.0{offset} }} }}
materials.steel = {{ kind = "linear-elastic", young = 210e3, poisson = 0.0 }}
solids = [{{ body = "strip", material = "steel" }}]
supports = [{{ on = "left", x = 0, y = 0, z = 0, rx = 0, ry = 0, rz = 0 }}{support}]
loads = [{load}]
[model]
{model}
"""


def job(tmp_path: Path, load: str = "", support: str = "", offset: str = "", model: str = "") -> Path:
    strip(tmp_path / "a.msh")
    path = tmp_path / "job.toml"
    path.write_text(JOB.format(load=load, support=support, offset=offset, model=model))
    return path


def test_job(tmp_path: Path) -> None:
    """Forces at the corner and at all nodes of the end: P L^3 / 3 E I of six."""
    one = '{{ kind = "nodal-force", on = "{}", value = [0, 0, 0.1] }}'
    forces = ", ".join(map(one.format, ("right", "corner")))
    solution = abut.solve(load_job(job(tmp_path, forces)).model)
    points = solution.model.mesh.points
    middle = (np.abs(points[:, 0] - LENGTH) < 1e-9) & (np.abs(points[:, 1] - WIDTH / 2) < 1e-9)
    assert solution.displacement[middle][:, 2].mean() == pytest.approx(0.6 * LENGTH**3 / (3 * E * INERTIA), rel=0.005)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"offset": ", thicknes = 2"}, "mesh.shells.strip.thicknes: unknown key"),
        ({"offset": ', offset = "top"'}, "mesh.shells.strip.offset"),
        ({"support": ', { on = "rigt", x = 0 }'}, "did you mean 'right'"),
        ({"support": ', { on = "strip.spos", rx = 0 }'}, r"supports\[1\].rx: 'strip.spos' has none: nodes of shells"),
        ({"support": ', { on = "right", normal = 0 }'}, r"supports\[1\].normal: 'right' is a group of nodes of shells"),
        (
            {"support": ', { on = "right", ry = 1 }', "model": 'kinematics = "finite"'},
            r"supports\[1\].ry: turns other than",
        ),
        (
            {"load": '{ kind = "nodal-force", on = "right", value = [0, 0, 0], moment = [0, 0, 1] }'},
            "has a moment about the normal of its shell",
        ),
        (
            {"load": '{ kind = "pressure", on = "strip", value = 1 }'},
            "no surface named 'strip' in the mesh; did you mean",
        ),
    ],
)
def test_refused(changes: dict[str, str], words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        load_job(job(tmp_path, **changes))


@pytest.mark.parametrize(
    ("sections", "words"),
    [
        ({"strop": abut.Shell(1.0)}, "no group named 'strop' in the mesh; did you mean 'strip'"),
        ({"left": abut.Shell(1.0)}, "group 'left' has cells line2; a section is for surfaces"),
        ({"strip": abut.Beam((1.0, 1.0))}, "group 'strip' has cells quad4; a section is for lines"),
    ],
)
def test_sections_refused(sections: dict[str, abut.Shell | abut.Beam], words: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=words):
        abut.thicken(strip(tmp_path / "a.msh"), sections)


def on_a_block(path: Path, above: float, upright: str = "") -> Path:
    """A unit cube of groups "block" and "base"; over it a sheet of one cell, whose mesh is ``above`` it; upright: that
    stands on an edge of the cube instead, by its nodes there ("shared") or in its middle by nodes of its own ("apart");
    "foot" and "crest" are its edges there and above."""
    cube = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
    flat = [[x, y, 1 + above] for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))]
    apart = [[0.5, y, z] for y, z in ((0.1, 1), (0.9, 1), (0.9, 2), (0.1, 2))]
    sheet = {"": flat, "shared": [[0, 1, 2], [0, 0, 2]], "apart": apart}[upright]
    cell = [4, 7, 8, 9] if upright == "shared" else [8, 9, 10, 11]
    groups = {
        "block": {"hex8": [list(range(8))]},
        "base": {"quad4": [[0, 3, 2, 1]]},
        "top": {"quad4": [[4, 5, 6, 7]]},
        "sheet": {"quad4": [cell]},
        "foot": {"line2": [cell[:2]]},
        "crest": {"line2": [cell[2:]]},
        "all": {"point": [[n] for n in range(8)]},
    }
    return write_msh(path, np.array([*cube, *sheet], dtype=float), groups)


SHEET = """
schema = 1
mesh = { file = "a.msh", shells.sheet = { thickness = 0.2 } }
materials.soft = { kind = "linear-elastic", young = 1000.0, poisson = 0.0 }
solids = [{ body = "block", material = "soft" }, { body = "sheet", material = "soft" }]
"""


@pytest.mark.parametrize("auto", [False, True])
def test_contact_on_a_side(auto: bool, tmp_path: Path) -> None:
    """A sheet that a pressure presses on a block, its true face touches: p L / E of the block and of half the sheet."""
    on_a_block(tmp_path / "a.msh", 0.1)
    text = (
        SHEET + "contacts = [{ auto = true }]\n"
        if auto
        else SHEET + 'contacts = [{ surfaces = ["sheet.sneg", "top"] }]\n'
    )
    text += 'supports = [{ on = "base", z = 0 }, { on = "all", x = 0, y = 0 }, { on = "sheet", x = 0, y = 0 }]\n'
    text += 'loads = [{ kind = "pressure", on = "sheet.spos", value = 10.0 }]\n'
    (tmp_path / "job.toml").write_text(text)
    solution = abut.solve(load_job(tmp_path / "job.toml").model)
    points, u = solution.model.mesh.points, solution.displacement
    assert u[points[:, 2] > 1.15][:, 2] == pytest.approx(-10.0 * 1.2 / 1000.0, rel=1e-6)
    assert abs(solution.contacts[0].force[2]) == pytest.approx(10.0, rel=1e-9)


def test_sheet_on_shared_nodes(tmp_path: Path) -> None:
    """A sheet that shares nodes with the edge of a block and is pulled along itself pulls the block: with Poisson's ratio 0
    the sheet lengthens by p L / E."""
    on_a_block(tmp_path / "a.msh", 0.0, "shared")
    text = SHEET + 'supports = [{ on = "all", x = 0, y = 0, z = 0 }, { on = "sheet", x = 0, y = 0 }]\n'
    text += 'loads = [{ kind = "traction", on = "crest.edge", value = [0, 0, 10.0] }]\n'
    (tmp_path / "job.toml").write_text(text)
    solution = abut.solve(load_job(tmp_path / "job.toml").model)
    points = solution.model.mesh.points
    assert solution.displacement[points[:, 2] > 1.9][:, 2] == pytest.approx(10.0 / 1000.0, rel=1e-4)


def test_tied_by_its_edge(tmp_path: Path) -> None:
    """A sheet tied to the top of a block by the face of its edge: pulled, both carry the force, the sheet lengthens by
    p L / E and what the block gives way by."""
    on_a_block(tmp_path / "a.msh", 0.0, "apart")
    text = SHEET.replace(
        '"sheet", material', '"sheet", integration = "full", material'
    )  # one cell alone would be loose
    text += 'supports = [{ on = "all", x = 0, y = 0, z = 0 }, { on = "sheet", x = 0, y = 0 }]\n'
    text += 'loads = [{ kind = "traction", on = "crest.edge", value = [0, 0, 10.0] }]\n'
    text += 'contacts = [{ contactor = "foot.edge", target = "top", kind = "tied" }]\n'
    (tmp_path / "job.toml").write_text(text)
    solution = abut.solve(load_job(tmp_path / "job.toml").model)
    points = solution.model.mesh.points
    assert solution.displacement[points[:, 2] > 1.9][:, 2] == pytest.approx(10.0 / 1000.0, rel=1e-3)
    assert abs(solution.contacts[0].force[2]) == pytest.approx(10.0 * 0.8 * 0.2, rel=1e-6)


@pytest.mark.parametrize("kind", ["quad4", "tri3"])
def test_membrane_carries_no_moments(kind: str, tmp_path: Path) -> None:
    """One half held, the end of the other one raised: it turns about the nodes between them, and no stress comes of it; a
    shell bends."""
    path = strip(tmp_path / "a.msh", 2, kind)
    held = [abut.MidSupport("pad", x=0, y=0, z=0), abut.MidSupport("left", z=1e-3)]
    largest = []
    for membrane in (True, False):
        thick = abut.thicken(path, {"strip": abut.Shell(THICK, membrane=membrane)}, held)
        largest.append(float(np.abs(solved(thick, "strip", "full").steps[-1].stress).max()))
    assert largest[0] < 1e-6 * largest[1]
    assert largest[1] > E * THICK / 2 * 1e-3 / LENGTH**2


def test_membrane_pulled(tmp_path: Path) -> None:
    """Its end moved along: an even strain, and the force that the mid-surface shows."""
    held = [abut.MidSupport("left", x=0, z=0), abut.MidSupport("corner", y=0), abut.MidSupport("right", x=0.1, z=0)]
    thick = abut.thicken(strip(tmp_path / "a.msh", 4), {"strip": abut.Shell(THICK, membrane=True)}, held)
    solution = solved(thick, "strip", "full")
    assert abut.mid_surface(solution, "strip").membrane[:, 0] == pytest.approx(E * THICK * 0.1 / LENGTH, rel=1e-8)


@pytest.mark.parametrize(
    ("given", "words"),
    [({"membrane": True, "layers": (1, 2)}, "a membrane has no layers"), ({"membrane": 1}, "true or false")],
)
def test_membranes_that_are_none(given: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        abut.Shell(1.0, **given)  # type: ignore[arg-type]
