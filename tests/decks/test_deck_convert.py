"""abut convert: the job file that a deck becomes gives the same answer; broken decks give errors, never tracebacks."""

import random
import tomllib

import numpy as np
import pytest

import abut
from abut.cli import main
from abut.errors import AbutError
from abut.job import load_job
from abut.job.convert import toml
from models.decks import BRICKS, HELD, PAIR, load, step, write

FULL = (
    BRICKS
    + PAIR.replace("INTERACTION=I,", "INTERACTION=I, ADJUST=1e-3,")
    + "*AMPLITUDE, NAME=A\n0., 0., 0.5, 1.2, 1., 1.\n*INITIAL CONDITIONS, TYPE=TEMPERATURE\nALL, 20.\n"
    + HELD
    + step("*DLOAD, AMPLITUDE=A", "2, P2, 10.", "EALL, GRAV, 9.81, 0., 0., -1.", "*CLOAD", "18, 3, -2.")
    + step("0.1, 2.", "*TEMPERATURE", "TOP, 30.", "*CLOAD, OP=NEW", "17, 3, -1.D0", "*NODE FILE", "U")
)
PLATE = """*NODE, NSET=ALL
1, 1,0
2, 2,0
3, 2,1
4, 1,1
*ELEMENT, TYPE=CPS4R, ELSET=E
1, 1,2,3,4
*MATERIAL, NAME=M
*ELASTIC
1000., 0.3
*SOLID SECTION, ELSET=E, MATERIAL=M
2.
*BOUNDARY
1, 1, 2
2, 1, 2
"""


BOUND = (
    BRICKS.replace("*ELEMENT", "*NODE\n99, 0.5, 0.5, 3.\n*ELEMENT", 1).replace("C3D8, ELSET=LOW", "C3D8R, ELSET=LOW")
    + PAIR
    + "*RIGID BODY, ELSET=HIGH, REF NODE=99\n*EQUATION\n2\n5, 3, 1., 6, 3, -1.\n"
    + "*BOUNDARY\nBOTTOM, 1, 3\n99, 1, 2\n99, 4, 6\n"
    + step("*BOUNDARY", "99, 3, 3, -0.01", "*CLOAD", "7, 1, 0.5")
    + step("*BOUNDARY", "99, 3, 3, -0.02")
)


@pytest.mark.parametrize(
    "text", [FULL, PLATE + step("*CLOAD", "3, 2, 5."), BOUND], ids=["bricks", "plate", "bound and rigid"]
)
def test_job_gives_the_same_answer(text, tmp_path):
    """Bit by bit but for the order of cells and points."""
    deck = load(tmp_path, text)
    target = tmp_path / "job.toml"
    assert main(["convert", str(tmp_path / "deck.inp"), str(target), "--quiet"]) == 0
    assert sorted(p.name for p in tmp_path.iterdir()) == ["deck.inp", "job.toml", "job.vtu"]
    job = load_job(target)
    a, b = abut.solve(deck.model), abut.solve(job.model)
    order = [np.lexsort(np.column_stack([m.points, _body(m)]).T) for m in (deck.model.mesh, job.model.mesh)]
    size = np.abs(a.displacement).max()
    assert len(a.steps) == len(b.steps)
    for one, other in zip(a.steps, b.steps):
        assert np.allclose(one.displacement[order[0]], other.displacement[order[1]], rtol=0.0, atol=1e-10 * size)
        for first, second in zip(one.contacts, other.contacts):
            assert first.force == pytest.approx(second.force, rel=1e-9, abs=1e-9)


def _body(mesh):
    """Number of each point's body: points of two bodies in one place stay apart."""
    result = np.zeros(len(mesh.points))
    for i, name in enumerate(sorted(mesh.bodies)):
        result[mesh.nodes_of(name)] = i
    return result


def test_what_was_left_out_stands_in_the_job_file(tmp_path):
    deck = write(tmp_path, FULL.replace("*STEP", "*CREEP\n0.1,\n*STEP", 1).replace("*STEP", "*STEP, NLGEOM"))
    target = tmp_path / "job.toml"
    assert main(["convert", str(deck), str(target), "--ignore", "NLGEOM", "--quiet"]) == 2
    assert not target.exists()
    assert main(["convert", str(deck), str(target), "--ignore", "NLGEOM", "--ignore", "creep", "--quiet"]) == 0
    head = target.read_text()
    assert "# ignored: NLGEOM of *STEP" in head
    assert "# ignored: *CREEP" in head


def test_meshes_become_vtu(tmp_path):
    write(tmp_path, FULL)
    assert main(["convert", str(tmp_path / "deck.inp"), str(tmp_path / "mesh.vtu"), "--quiet"]) == 0
    one, other = abut.Mesh.read(tmp_path / "deck.inp"), abut.Mesh.read(tmp_path / "mesh.vtu")
    assert (set(one.bodies), set(one.surfaces)) == (set(other.bodies), set(other.surfaces))
    assert set(one.node_sets) == set(other.node_sets) == {"ALL", "BOTTOM", "TOP"}
    assert main(["convert", str(tmp_path / "mesh.vtu"), str(tmp_path / "job.toml"), "--quiet"]) == 2
    assert main(["convert", str(tmp_path / "deck.inp"), str(tmp_path / "deck.msh"), "--quiet"]) == 2


def test_toml_is_read_back():
    table = {
        "schema": 1,
        "a b": {"x": 'say "no"\n', "list": [1.5, -2e-300], "in": {"deep": True}},
        "rows": [{"t": [{"k": 1, "on": "ü"}], "empty": []}, {"v": 0.1}],
    }
    assert tomllib.loads(toml(table)) == table


ODD = [
    "",
    "-1",
    "0",
    "1e400",
    "nan",
    "x",
    "99999999999999999999",
    "*",
    "**",
    "=",
    '"',
    ",",
    "*STEP",
    "NSET=",
    "\t",
    "1.5",
    "²",
]


def test_broken_decks_give_errors_never_tracebacks(tmp_path):
    """Cut short, tokens replaced, lines lost, doubled or swapped: read, or refused with words."""
    text = FULL + "*TRANSFORM, NSET=TOP, TYPE=C\n0,0,0,0,0,1.\n*MPC\nTIE, 5, 6\n*EQUATION\n2\n5,1,1.,6,1,-1.\n"
    draw = random.Random(7)
    refused = []
    for _ in range(300):
        broken = _break(text, draw)
        try:
            load(tmp_path, broken)
        except AbutError as error:
            refused.append(str(error))
    assert 100 < len(refused) < 300
    assert all(str(tmp_path) in message for message in refused)


def _break(text, draw):
    kind = draw.randrange(5)
    lines = text.splitlines()
    i, j = draw.randrange(len(lines)), draw.randrange(len(lines))
    if kind == 0:
        return text[: draw.randrange(len(text))]
    if kind == 1:
        fields = lines[i].split(",")
        fields[draw.randrange(len(fields))] = draw.choice(ODD)
        lines[i] = ",".join(fields)
    elif kind == 2:
        del lines[i]
    elif kind == 3:
        lines.insert(j, lines[i])
    else:
        lines[i], lines[j] = lines[j], lines[i]
    return "\n".join(lines) + "\n"
