"""What users call contacts and probes becomes part of file names: each has files of its own, whatever it is called."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.io.atomic import write_text
from abut.io.names import LONGEST, file_labels
from abut.mesh import make
from abut.output.results import is_written
from models.steps import arrays

NAMES = [
    ("ring/pin", "ring pin"), ("孔", "軸"), ("Pin", "pin"), (300 * "x" + "1", 300 * "x" + "2"),
    ("a\x1b[31m", "a\n"), ("../../up", "..\\..\\up"), (100 * "軸", "pin"), ("\udcff", "\udcfe"),
]  # fmt: skip


@pytest.mark.parametrize("names", NAMES)
def test_labels_differ_whatever_the_case(names: tuple[str, str]) -> None:
    labels = file_labels(names)
    assert len({label.lower() for label in labels}) == 2
    assert all(len(label) <= LONGEST and label.isascii() and "/" not in label and "\\" not in label for label in labels)
    assert file_labels(names[::-1]) == labels[::-1]  # by the names, not by their order


def test_labels_that_need_no_mark_have_none() -> None:
    assert file_labels(["pin", "lug pin", 100 * "x"]) == ["pin", "lug_pin", 100 * "x"]


def test_a_name_that_looks_like_a_marked_one() -> None:
    marked = file_labels(["a", "A"])[0]
    assert len(set(file_labels(["a", "A", marked]))) == 3


def stack(first: str, second: str) -> abut.Model:
    """Three blocks, one on the other, pressed by 1, the middle one of weight 2: the pressures are 3 below it and 1 above."""
    blocks = {
        name: make.rectangle([0, 1], [y, y + 1], cells=[1, 1]) for y, name in enumerate(("lowest", "middle", "highest"))
    }
    contacts = [
        abut.Contact(contactor="middle.bottom", target="lowest.top", name=first),
        abut.Contact(contactor="highest.bottom", target="middle.top", name=second),
    ]
    return abut.Model(
        make.join(blocks),
        plane="strain",
        solids=[abut.Solid(name, abut.LinearElastic(100.0, 0.0)) for name in blocks],
        supports=[abut.Support("lowest.bottom", y=0), *(abut.Support(f"{name}.left", x=0) for name in blocks)],
        loads=[abut.Pressure("highest.top", 1.0), abut.BodyForce((0.0, -2.0), on="middle")],
        contacts=contacts,
        probes=[abut.Probe(name, at=(1.0, y), body="middle") for name, y in ((first, 1.0), (second, 2.0))],
    )


@pytest.mark.parametrize("names", [("ring/pin", "ring pin"), ("Pin", "pin"), (300 * "x" + "1", 300 * "x" + "2")])
def test_each_contact_and_probe_keeps_its_files(names: tuple[str, str], tmp_path: Path) -> None:
    solution = abut.solve(stack(*names))
    abut.write(solution, tmp_path)
    assert is_written(tmp_path, solution, solution.steps[0])
    step = json.loads((tmp_path / "summary.json").read_text())["steps"][0]
    for contact, probe, name, pressure in zip(step["contacts"], step["probes"], names, (3.0, 1.0)):
        assert contact["name"] == probe["name"] == name
        collection = (tmp_path / contact["file"]).read_text()
        file = re.findall(r'file="([^"]+)"', collection)[0]
        assert np.nanmax(dict(arrays(tmp_path / file))["pressure"]) == pytest.approx(pressure, rel=1e-9)
        rows = list(csv.DictReader((tmp_path / probe["file"]).read_text().splitlines()))
        assert float(rows[0]["pressure"]) == pytest.approx(pressure, rel=1e-9)


def test_the_longest_name_that_a_file_can_have(tmp_path: Path) -> None:
    path = tmp_path / (251 * "x" + ".txt")
    write_text(path, "text")
    assert [p.name for p in tmp_path.iterdir()] == [path.name]
