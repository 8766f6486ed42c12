"""Job files and the command line: what is wrong, where, how to mend it; the exit status; nothing half written."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from abut.cli import main
from abut.job import json_schema

EXAMPLE = Path(__file__).parents[2] / "examples" / "two-blocks" / "job.toml"
TEXT = EXAMPLE.read_text()
MESH = TEXT[TEXT.index("[mesh.bodies.lower]") : TEXT.index("[materials")]
TWICE = '[[contacts]]\nname = "first"\ncontactor = "upper.bottom"\ntarget = "lower.top"\n[materials.steel]'


def run(tmp_path: Path, text: str, capsys: pytest.CaptureFixture[str], *options: str) -> tuple[int, str]:
    job = tmp_path / "job.toml"
    job.write_text(text)
    status = main(["run", str(job), *options])
    return status, capsys.readouterr().err


# fmt: off
BAD = {
    "unknown key": ("target = ", "tagret = ", "contacts[0].tagret: unknown key; did you mean 'target'?"),
    "key of other programs": ("poisson = 0.3", "nu = 0.3", "materials.steel.nu: unknown key; it is called 'poisson' here"),
    "master": ("target = ", "master = ", "contacts[0].master: unknown key; it is called 'target' here"),
    "plasticity": ('kind = "linear-elastic"', 'kind = "elastoplastic"', "got 'elastoplastic'; plastic is what it is called"),
    "unknown surface": ('"lower.top"', '"lower.topp"', "did you mean 'lower.top'?"),
    "unknown material": ('material = "steel"', 'material = "stel"', "did you mean 'steel'?"),
    "unknown body": ('body = "upper"', 'body = "uper"', "did you mean 'upper'?"),
    "nan": ("young = 210e3", "young = nan", "materials.steel.young"),
    "negative": ("young = 210e3", "young = -1", "expected a number > 0"),
    "poisson": ("poisson = 0.3", "poisson = 0.6", "expected -1 < nu <= 0.5"),
    "text for a number": ("young = 210e3", 'young = "stiff"', "materials.steel.young"),
    "a truth value for a number": ("young = 210e3", "young = true", "materials.steel.young: expected a number, got True"),
    "a key called like a load": ('[[contacts]]', '[[contacts]]\npressure = "P3"', "contacts[0].pressure: expected 'auto'"),
    "a list for a table": ('[[contacts]]', '[[contacts]]\nlaw = [[0, 1]]', "law: expected a table, law = { ... } with its"),
    "version": ("schema = 1", "schema = 2", "expected 1, got 2"),
    "syntax": ("[[contacts]]", "[[contacts]", "not valid TOML"),
    "generator": ('kind = "box"', 'kind = "bix"', "did you mean 'box'?"),
    "generator key": ("cells = [6, 6, 6]", "celss = [6, 6, 6]", "did you mean 'cells'?"),
    "zero cells": ("cells = [6, 6, 6]", "cells = [0, 6, 6]", "whole numbers from 1 to"),
    "same surface": ('"lower.top"', '"upper.bottom"', "same surface"),
    "plane in 3D": ("[materials.steel]", '[model]\nplane = "strain"\n[materials.steel]', "the mesh is 3D"),
    "wrong side": ('"lower.top"', '"lower.bottom"', "faces"),
    "missing solid": ('[[solids]]\nbody = "upper"\nmaterial = "steel"\n', "", "no material for body 'upper'"),
    "no mesh file": (MESH, '[mesh]\nfile = "no.msh"\n', "does not exist"),
    "a name for a table": (MESH, 'mesh = "no.msh"\n', "mesh: expected a table, [mesh] with its keys below it, got 'no.msh'"),
    "one for a list": ("[[contacts]]", "[contacts]", "contacts: expected a list: write [[contacts]] instead of [contacts]"),
    "pair given twice": ("[materials.steel]", TWICE, "pressure between them would be determined twice"),
}
# fmt: on


@pytest.mark.parametrize("case", BAD)
def test_bad_jobs(case: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    old, new, message = BAD[case]
    assert old in TEXT
    status, error = run(tmp_path, TEXT.replace(old, new), capsys)
    assert message in error
    assert status == 2
    assert "Traceback" not in error
    assert [p.name for p in tmp_path.iterdir()] == ["job.toml"]


def test_free_body_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    push = '\n[[loads]]\nkind = "force"\non = "upper.left"\nvalue = [1, 0, 0]\n'
    status, error = run(tmp_path, TEXT.replace("x = 0\ny = 0\nz = -0.02", "z = -0.02") + push, capsys)
    assert status == 4
    assert "body 'upper' is free to translate along x" in error
    assert not (tmp_path / "results").exists()


def test_motions_without_loads_are_held(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Pressed down only, the block stays where it is: said in a note, shown in the certificate."""
    status, error = run(tmp_path, TEXT.replace("x = 0\ny = 0\nz = -0.02", "z = -0.02"), capsys)
    assert (status, error) == (0, "")
    summary = json.loads((tmp_path / "results" / "summary.json").read_text())
    assert any("rotation of body 'upper' about z" in note for note in summary["notes"])
    (check,) = (c for c in summary["certificate"]["checks"] if c["name"] == "free rigid-body modes")
    assert check["passed"]


def test_body_pulled_off_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    pull = '\n[[loads]]\nkind = "force"\non = "upper.top"\nvalue = [0, 0, 100]\n'
    status, error = run(tmp_path, TEXT.replace("z = -0.02", "") + pull, capsys)
    assert status == 4
    assert "body 'upper' is free to translate along z" in error
    assert not (tmp_path / "results").exists()


def test_absurd_units(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    push = '\n[[loads]]\nkind = "pressure"\non = "upper.top"\nvalue = 1\n'
    text = TEXT.replace("z = -0.02", "").replace("210e3", "210e-9") + push
    status, error = run(tmp_path, text, capsys)
    assert status == 4
    assert "check the units" in error


def test_contradicting_supports(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    status, error = run(tmp_path, TEXT + '\n[[supports]]\non = "upper.top"\nz = 0.5\n', capsys)
    assert status == 4
    assert "supports on 'upper.top' contradict each other at node" in error


@pytest.mark.parametrize("name", ["results", "results/deep/er"])
def test_a_file_where_results_should_go(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Foreseen by the check, which names the file, and refused by the run before it solves."""
    (tmp_path / "results").write_text("notes")
    status, error = run(tmp_path, TEXT + f'\n[output]\ndirectory = "{name}"\n', capsys)
    assert (status, "cannot create the output directory" in error) == (2, True)
    assert main(["check", str(tmp_path / "job.toml")]) == 2
    said = capsys.readouterr().out
    assert f"{tmp_path / 'results'} is a file; choose another" in said
    assert (tmp_path / "results").read_text() == "notes"
    (tmp_path / "results").unlink()
    assert main(["check", str(tmp_path / "job.toml")]) == 0


@pytest.mark.parametrize("law", ["complementarity", "constraint-function"])
def test_no_convergence_writes_the_last_state_and_names_facets(
    law: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A ball pressed on a plane starts from one point of contact: one iteration cannot be enough."""
    ball = (EXAMPLE.parents[1] / "hertz-sphere" / "job.toml").read_text()
    text = ball.replace("cells = 16", "cells = 3").replace("hex20", "hex8")
    text = text.replace('"plane.top"]', f'"plane.top"]\nlaw = "{law}"')
    assert law in text
    status, error = run(tmp_path, text + "\n[solve]\nmax_iterations = 1", capsys)
    assert status == 3
    assert "did not converge" in error
    assert "contact 'hertz': the contact status of " in error
    summary = json.loads((tmp_path / "results" / "summary.json").read_text())
    assert summary["status"] == "not converged"
    assert summary["steps"][-1]["cycling"]["hertz"]
    assert (tmp_path / "results" / "fields_0001.vtu").exists()


def test_committed_schema_is_current() -> None:
    """docs/job.schema.json is what editors point to: renew it with `abut schema --output docs/job.schema.json`."""
    committed = json.loads((EXAMPLE.parents[2] / "docs" / "job.schema.json").read_text())
    assert committed == json_schema()


LINES = [i for i, line in enumerate(TEXT.splitlines()) if line.strip() and not line.startswith("#")]
VALUES = ["nan", "-1", "0", "1e400", '""', '"lower.top"', "[]", "[1, 2]", "{}", "true", "inf", "1e-320", "10000000000"]


@pytest.mark.long
@settings(max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(line=st.sampled_from(LINES), value=st.sampled_from(VALUES), drop=st.booleans())
def test_any_broken_line_ends_in_a_message(
    line: int, value: str, drop: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Every line dropped, every value replaced by nonsense: done, refused or unsolvable, never a bug."""
    lines = TEXT.splitlines()
    if drop or "=" not in lines[line]:
        del lines[line]
    else:
        lines[line] = f"{lines[line].split('=')[0]}= {value}"
    status, error = run(tmp_path, "\n".join(lines), capsys)
    assert status in (0, 2, 3, 4), error
    assert (status == 0) == (error == "")


def test_results(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A good run: every promised file, forces that balance, VTU files that VTK reads."""
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader

    status, error = run(tmp_path, TEXT + "\n[solve]\nsteps = 2\n", capsys)
    assert (status, error) == (0, "")
    results = tmp_path / "results"
    names = sorted(p.name for p in results.iterdir())
    assert names == sorted(
        ["summary.json", "history.csv", "forces.csv", "report.html", "run.jsonl", "fields.pvd", "contact_blocks.pvd"]
        + [f"{stem}_{n:04d}.vtu" for stem in ("fields", "contact_blocks") for n in (1, 2)]
    )
    summary = json.loads((results / "summary.json").read_text())
    for step in summary["steps"]:
        contact = step["contacts"][0]
        assert contact["force"][2] == pytest.approx(-step["reactions"]["upper.top"][2], rel=1e-9)
        assert contact["force"][2] == pytest.approx(step["reactions"]["lower.bottom"][2], rel=1e-9)
        assert step["balance_error"] < 1e-9
    for name in names:
        if name.endswith(".vtu"):
            reader = vtkXMLUnstructuredGridReader()
            reader.SetFileName(str(results / name))
            reader.Update()
            assert reader.GetOutput().GetNumberOfCells() > 0
            assert reader.GetOutput().GetPointData().GetArray("displacement").GetNumberOfComponents() == 3


def test_output_directory_in_the_way(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "results").write_text("a file")
    status, error = run(tmp_path, TEXT, capsys)
    assert status == 2
    assert "cannot create the output directory" in error


def test_every_key_has_a_meaning() -> None:
    """The reference page and editors show it: a new key comes with a line in abut/job/key_descriptions.py."""
    schema = json_schema()
    tables = {"JobFile": schema, **schema["$defs"]}
    entries = {(name, key): entry for name, table in tables.items() for key, entry in table["properties"].items()}
    assert [place for place, entry in entries.items() if len(entry.get("description", "")) < 10] == []


def test_schema_lists_all_tables(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["schema"]) == 0
    schema = json.loads(capsys.readouterr().out)
    assert {"schema", "mesh", "materials", "solids", "supports", "loads", "contacts", "solve", "output"} <= set(
        schema["properties"]
    )
