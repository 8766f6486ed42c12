"""abut mesh: from a CAD file to a pressure in two commands. The CAD files are made here, by Gmsh itself."""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from abut import InputError, Mesh
from abut._core import shape_functions
from abut.cells import CELLS
from abut.cli import main
from abut.job import load_job
from abut.mesh.integrals import body_chunks
from abut.mesh.quadrature import product_rule
from abut.mesh.shapes import ratios
from abut.parts.geometry import body_names, cleaned
from abut.parts.program import find_gmsh, run_script
from abut.parts.scripts import Sizes
from abut.parts.step_names import decoded, solid_names
from models.step_text import Box, assembly

try:
    GMSH = find_gmsh()
except InputError:
    GMSH = ""
needs_gmsh = pytest.mark.skipif(not GMSH, reason="Gmsh is not installed")

PINNED = """Box(1) = {-20, -10, 0, 40, 20, 5};
Box(2) = {-20, -10, 5, 40, 20, 5};
Cylinder(3) = {0, 0, 0, 0, 0, 10, 4};
Cylinder(4) = {0, 0, 0, 0, 0, 10, 4};
BooleanDifference{ Volume{1, 2}; Delete; }{ Volume{4}; Delete; }
"""
STACK = """Cylinder(1) = {0, 0, 0, 0, 0, 8, 5};
Cylinder(2) = {0, 0, 8, 0, 0, 8, 5};
Cylinder(3) = {0, 0, 16, 0, 0, 8, 5};
"""


def cad(folder: Path, script: str, name: str = "parts.step") -> Path:
    """A CAD file of what a script for Gmsh makes."""
    path = folder / name
    (folder / "make.geo").write_text(f'SetFactory("OpenCASCADE");\n{script}Save "{name}";\n')
    subprocess.run([GMSH, "make.geo", "-0"], cwd=folder, check=True, capture_output=True)
    return path


def named(path: Path, names: list[str]) -> None:
    """Give the solids of a STEP file the names of their products, as other programs do."""
    text = path.read_text()
    numbers = iter(names)
    text = re.sub(
        r"PRODUCT\('Open CASCADE STEP translator [\d.]+ 1\.\d+',\s*'[^']*'",
        lambda _: "PRODUCT('{0}','{0}'".format(next(numbers)),
        text,
    )
    assert next(numbers, None) is None
    path.write_text(text)


@needs_gmsh
def test_two_commands(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Three cylinders on end, held below and pressed above: the pressure passes through each contact, pi r^2 p in all; at
    the upper one, far from where the lateral displacement is held and without friction, evenly (Saint-Venant: what is left
    of the disturbance 1.6 diameters away is below .1 %). Cells are as small as asked at contact, larger elsewhere."""
    path = cad(tmp_path, STACK)
    assert main(["mesh", str(path), "--size", "3", "--contact-size", "1.2"]) == 0
    out = capsys.readouterr().out
    assert "none inverted" in out
    assert "written: " in out
    assert main(["run", str(tmp_path / "parts.toml"), "--quiet"]) == 0
    summary = json.loads((tmp_path / "results" / "summary.json").read_text())
    pressure = load_job(tmp_path / "parts.toml").model.loads[0].value
    contacts = summary["steps"][-1]["contacts"]
    assert [contact["name"] for contact in contacts] == ["part_1-part_2", "part_2-part_3"]
    for contact in contacts:
        force = np.linalg.norm(contact["force"])
        assert force == pytest.approx(math.pi * 25.0 * pressure, rel=2e-4)  # 20 parabolas for the outline
    assert contacts[1]["max_pressure"] == pytest.approx(pressure, rel=1e-3)
    assert summary["certificate"]["passed"]
    mesh = Mesh.read(tmp_path / "parts.msh")
    near, far = (_edges(mesh, name) for name in ("part_1.to-part_2", "part_1.zmin"))
    assert near < 1.2 * 1.2
    assert far > 1.3 * near  # up to 1.96 along the outline, of which 16 make a circle


@pytest.mark.long
@needs_gmsh
def test_names_faces_and_sizes(tmp_path: Path) -> None:
    """Names of the STEP file, ends of bodies, touching faces; curved cells have the volumes of the solids."""
    path = cad(tmp_path, PINNED)
    named(path, ["lower plate", "upper plate", "pin"])
    assert main(["mesh", str(path), "--size", "6", "--contact-size", "2", "--press", "pin.zmax=30", "--quiet"]) == 0
    mesh = Mesh.read(tmp_path / "parts.msh")
    assert list(mesh.bodies) == ["lower_plate", "upper_plate", "pin"]
    model = load_job(tmp_path / "parts.toml").model
    pairs = {frozenset(contact.named) for contact in model.contacts}
    lower, upper, pin = mesh.bodies
    assert pairs == {frozenset((f"{a}.to-{b}", f"{b}.to-{a}")) for a, b in ((lower, upper), (lower, pin), (upper, pin))}
    assert [(load.on, load.value) for load in model.loads] == [("pin.zmax", 30.0)]
    for name, z in (
        ("lower_plate.zmin", 0.0),
        ("upper_plate.zmax", 10.0),
        ("pin.zmin", 0.0),
        ("lower_plate.to-upper_plate", 5.0),
    ):
        assert np.ptp(mesh.points[mesh.nodes_of(name), 2]) < 1e-9
        assert mesh.points[mesh.nodes_of(name), 2].mean() == pytest.approx(z, abs=1e-9)
    radius = np.linalg.norm(mesh.points[mesh.nodes_of("pin.to-lower_plate"), :2], axis=1)
    assert radius == pytest.approx(4.0, rel=1e-6)  # midside nodes on the cylinder too
    volume = {"pin": 10.0 * math.pi * 16.0, lower: 5.0 * (800.0 - math.pi * 16.0)}
    for name, exact in volume.items():
        assert _volume(mesh, name) == pytest.approx(exact, rel=1e-4)  # 16 parabolas for a circle: 2e-5
    assert ratios(mesh).max() < 6.0


def _volume(mesh: Mesh, body: str) -> float:
    """By the determinants of the map of each cell at integration points."""
    total = 0.0
    for kind, nodes in body_chunks(mesh, body):
        xi, weights = product_rule(kind)
        _, derivatives = shape_functions(CELLS[kind].code, np.ascontiguousarray(xi))
        jacobian = np.einsum("qai,naj->nqij", derivatives, mesh.points[nodes])
        total += float((np.linalg.det(jacobian) * weights).sum())
    return total


def _edges(mesh: Mesh, surface: str) -> float:
    """Mean edge of facets by their mean area, of triangles with equal sides."""
    facets = mesh.facets(mesh.surfaces[surface])
    corners = facets.points[facets.nodes[:, :3]]
    area = 0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    return math.sqrt(float(area.mean()) * 4.0 / math.sqrt(3.0))


@needs_gmsh
@pytest.mark.parametrize(
    ("script", "options", "message"),
    [
        ("Rectangle(1) = {0, 0, 0, 1, 1};\n", [], "no solids"),
        (STACK, ["--names", "a,b"], "2 names for 3 solids"),
        (STACK, ["--names", "a,b,a"], "occurs twice"),
        (STACK, ["--hold", "part_1.zmim"], "did you mean 'part_1.zmin'"),
        (STACK, ["--press", "part_3.zmax=much"], "SURFACE=PRESSURE"),
        ("Box(1) = {0,0,0,1,1,1}; Box(2) = {1,0,0,1,1,1}; Coherence;\n", [], "belong to two solids"),
    ],
)
def test_what_cannot_be_meshed(
    script: str, options: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = cad(tmp_path, script, "parts.brep")
    assert main(["mesh", str(path), "--size", "3", *options]) == 2
    assert message in capsys.readouterr().err
    assert not (tmp_path / "parts.toml").exists()


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (["--gmsh", "no-such-program"], "no program 'no-such-program' to make meshes with; install it"),
        (["--size", "-1"], "--size: expected a number > 0"),
        (["--contact-size", "9"], "--contact-size: 9 is larger than --size 3"),
        (["--cell", "hex8"], "--cell: expected one of"),
        (["--unit", "km"], "--unit: expected one of"),
        (["--output", "job.txt"], "expected a job file (.toml)"),
    ],
)
def test_arguments(options: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "part.step"
    path.write_text("ISO-10303-21;")
    assert main(["mesh", str(path), "--size", "3", *options]) == 2
    assert message in capsys.readouterr().err


def test_files_in_the_way(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A job file that someone may have edited stays; sources that are missing or of another kind."""
    path = tmp_path / "part.step"
    path.write_text("ISO-10303-21;")
    (tmp_path / "part.toml").write_text("# mine\n")
    assert main(["mesh", str(path), "--size", "3"]) == 2
    assert "--replace" in capsys.readouterr().err
    assert (tmp_path / "part.toml").read_text() == "# mine\n"
    assert main(["mesh", str(tmp_path / "none.step"), "--size", "3"]) == 2
    assert "does not exist" in capsys.readouterr().err
    assert main(["mesh", str(tmp_path / "none.png"), "--size", "3"]) == 2
    assert "expected a CAD file" in capsys.readouterr().err


@needs_gmsh
def test_a_damaged_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "part.step"
    path.write_text("ISO-10303-21;\nHEADER;\n#1=PRODUCT('")
    assert main(["mesh", str(path), "--size", "3"]) == 2
    assert "abut: error: abut mesh: " in capsys.readouterr().err


def test_an_old_gmsh(tmp_path: Path) -> None:
    """Names of options were others before 4.8; a program that is no Gmsh."""
    for says, message in (("4.4.1", "older than 4.8"), ("hello", "does not say its version")):
        program = tmp_path / "gmsh"
        program.write_text(f"#!/bin/sh\necho {says}\n")
        program.chmod(0o755)
        with pytest.raises(InputError, match=message):
            find_gmsh(str(program))
    failing = tmp_path / "failing"
    failing.write_text("#!/bin/sh\necho 'Error   : no such thing'\nexit 1\n")
    failing.chmod(0o755)
    with pytest.raises(InputError, match="status 1: no such thing"):
        run_script(str(failing), tmp_path / "a.geo", tmp_path / "a.msh")


@pytest.mark.skipif(shutil.which("sh") is None, reason="scripts of a shell")
def test_names_are_believed_where_they_fit() -> None:
    """A name of each solid, none twice, and as many faces as the solid has, else numbers."""
    from abut.parts.geometry import Face, Part

    def part(count: int) -> Part:
        zero, one = np.zeros(3), np.ones(3)
        return Part(1, zero, one, tuple(Face(i, zero, one) for i in range(count)))

    parts = [part(3), part(4)]
    assert body_names(parts, [], [("pin 5", 3), ("lug", 4)]) == ("pin_5", "lug")
    for found in ([("pin", 4), ("lug", 3)], [("pin", 3), ("pin", 4)], [("pin", 3)], [("", 3), ("lug", 4)], []):
        assert body_names(parts, [], found) == ("part_1", "part_2")
    assert cleaned("  Ä-b / c ") == "Ä-b_c"
    assert cleaned("Geha\u0308use №2 / 軸") == "Gehäuse_2_軸"  # a letter and its accent are one


def test_names_in_step_files(tmp_path: Path) -> None:
    """Of a solid itself, and of its product, also through a relation of representations."""
    path = tmp_path / "a.stp"
    path.write_text(
        "#1=PRODUCT('id','bush',$,());#2=PRODUCT_DEFINITION_FORMATION('','',#1);#3=PRODUCT_DEFINITION('d','',#2,#9);\n"
        "#4=PRODUCT_DEFINITION_SHAPE('','',#3);#5=SHAPE_REPRESENTATION('',(#8),#7);\n"
        "#6=SHAPE_DEFINITION_REPRESENTATION(#4,#10);#10=ADVANCED_BREP_SHAPE_REPRESENTATION('',(#11),#7);\n"
        "#11=MANIFOLD_SOLID_BREP('',#12);#12=CLOSED_SHELL('',(#13,#14,#15));\n"
        "#20=BREP_WITH_VOIDS('hollow; ball',#21,(#22));#21=CLOSED_SHELL('',(#23));\n"
        "#22=ORIENTED_CLOSED_SHELL('',*,#24,.F.);#24=CLOSED_SHELL('',(#25,#26));\n"
    )
    assert solid_names(path) == [("bush", 3), ("hollow; ball", 3)]
    assert solid_names(tmp_path / "a.brep") == []


@needs_gmsh
def test_a_file_of_another_program(tmp_path: Path) -> None:
    """An assembly in AP214 with products placed in it, coloured, solids named after features: bodies have the products'
    names, lie where the assembly puts them, and touch."""
    path = tmp_path / "assembly.step"
    boxes = (
        Box("Base plate", "Boss-Extrude1", (30.0, 20.0, 4.0), (0.0, 0.0, 0.0)),
        Box("Geh\\X2\\00E4\\X0\\use No 2", "Boss-Extrude1", (10.0, 8.0, 6.0), (5.0, 6.0, 4.0)),
    )
    path.write_text(assembly(boxes), encoding="ascii")
    assert solid_names(path) == [("Base plate", 6), ("Gehäuse No 2", 6)]
    assert main(["mesh", str(path), "--size", "4", "--quiet"]) == 0
    mesh = Mesh.read(tmp_path / "assembly.msh")
    names = [cleaned(name) for name in ("Base plate", "Gehäuse No 2")]
    assert list(mesh.bodies) == names
    for name, box in zip(names, boxes):
        assert _volume(mesh, name) == pytest.approx(math.prod(box.size), rel=1e-9)
    where = mesh.points[mesh.nodes_of(names[1])]
    assert where.min(axis=0) == pytest.approx([5.0, 6.0, 4.0], abs=1e-6)
    assert f"{names[0]}.to-{names[1]}" in mesh.surfaces


def test_characters_in_step_files() -> None:
    """ISO 10303-21: four digits for each character between X2 and X0, two after X; quotes and backslashes twice."""
    assert decoded("Geh\\X2\\00E400DF\\X0\\use") == "Gehäßuse"
    assert decoded("a\\X\\E4b''c\\\\d") == "aäb'c\\d"


def test_sizes_at_contact() -> None:
    assert Sizes(4.0).at_contact == 2.0
    assert Sizes(4.0, 1.0).at_contact == 1.0
