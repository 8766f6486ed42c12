"""The text of a job: what no editor writes by intent still gets one clear message, at once."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import abut
from abut.cli import main
from abut.cli.run import passes_on
from abut.decks.translation import load_deck
from abut.job import load_job
from abut.mesh import make
from models.steps import BALL

SEEDS = Path(__file__).parents[1] / "fuzz" / "seeds"
MARK = b"\xef\xbb\xbf"  # that some editors write at the beginning of UTF-8
HUGE = "0x" + "f" * 10_000  # more digits than Python prints


@pytest.mark.parametrize(
    "line", ["a" + ".a" * 50_000 + " = 1", "[" + ".".join(['"a"'] * 50_000) + "]", "x = {" + "a . " * 50_000 + "a = 1}"]
)
def test_keys_of_many_parts(line: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """TOML's reader takes time with the square of their number: minutes."""
    path = tmp_path / "job.toml"
    path.write_text(f"schema = 1\n{line}\n")
    assert main(["run", str(path)]) == 2
    assert "job.toml: line 2: a name of more than 50 parts between dots" in capsys.readouterr().err


@pytest.mark.parametrize("key", ["cells", "young", "schema"])
@pytest.mark.parametrize("value", [str(2**64), HUGE])
def test_whole_numbers_beyond_64_bits(key: str, value: str, tmp_path: Path) -> None:
    path = tmp_path / "job.toml"
    path.write_text(re.sub(rf"\b{key} = [\d.e]+", f"{key} = {value}", BALL, count=1))
    with pytest.raises(abut.InputError, match=rf"{key}: a whole number of more than 64 bits"):
        load_job(path)


def test_generators_take_numbers_that_no_array_holds() -> None:
    for bad in (
        lambda: make.disc(cells=10**400),
        lambda: make.rectangle(x=[0, 10**400]),
        lambda: make.rectangle(cells=[2, [0, 10**400]]),
        lambda: make.box(cells=(2, 2, 2**64)),
    ):
        with pytest.raises(abut.InputError):
            bad()


def test_a_byte_order_mark_is_no_text(tmp_path: Path) -> None:
    """Of jobs, meshes and decks, and of a job that asks for PETSc."""
    for seed in (*SEEDS.glob("*.msh"), *SEEDS.glob("*.vtu")):
        marked = tmp_path / seed.name
        marked.write_bytes(MARK + seed.read_bytes())
        assert abut.Mesh.read(marked).n_cells == abut.Mesh.read(seed).n_cells
    deck = tmp_path / "bricks.inp"
    deck.write_bytes(MARK + (SEEDS / "bricks.inp").read_bytes())
    assert load_deck(deck).model.mesh.n_cells == load_deck(SEEDS / "bricks.inp").model.mesh.n_cells
    job = tmp_path / "job.toml"
    job.write_bytes(MARK + BALL.encode() + b'[solve]\nlinear = "petsc"\n')
    assert load_job(job).model.solve.linear == "petsc"
    assert passes_on(job, ["-ksp_type", "minres"])


@pytest.mark.parametrize("name", ["x" * 5000 + ".msh", "x\\u0000.msh"])
def test_mesh_of_a_name_that_no_file_can_have(name: str, tmp_path: Path) -> None:
    path = tmp_path / "job.toml"
    path.write_text((SEEDS / "solid-mesh.toml").read_text().replace("mesh.msh", name))
    with pytest.raises(abut.InputError, match="does not exist"):
        load_job(path)


@pytest.mark.parametrize("name", ["x" * 5000, "x\\u0000"])
def test_output_of_a_name_that_no_folder_can_have(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "job.toml"
    path.write_text(f'{BALL}\n[output]\ndirectory = "{name}"\n')
    assert main(["run", "--quiet", str(path)]) == 2
    assert "cannot create the output directory" in capsys.readouterr().err


@pytest.mark.parametrize(
    "line",
    ["*" + 1_000_000 * "x", "*NODE," + 250_000 * "a=b,", "*NODE," + 1_000_000 * '"', "*NODE\n" + 500_000 * "1,",
     "*NODE\n1, " + 1_000_000 * "1" + "d", "*INCLUDE, INPUT=" + 1_000_000 * "x", "*NODE,\n" + 200_000 * "a=b,\n"],
)  # fmt: skip
def test_lines_of_a_megabyte(line: str, tmp_path: Path) -> None:
    deck = tmp_path / "deck.inp"
    deck.write_text(f"{line}\n")
    with pytest.raises(abut.InputError):
        load_deck(deck)
