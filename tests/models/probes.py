"""Models, a job and a reader of tables that tests of probes share."""

from __future__ import annotations

import csv
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

import abut
from abut.cells import CELLS
from abut.mesh import make
from abut.mesh.make import block
from abut.mesh.mesh import Mesh
from models import patch

STEEL = abut.LinearElastic(1000.0, 0.3)
JOB = Path(__file__).parents[2] / "examples" / "two-blocks" / "job.toml"
TEXT = JOB.read_text()
PROBES = """
[[probes]]
name = "edge"
line = [[1, 5, 10], [9, 5, 10]]
points = 7
of = ["pressure", "gap"]

[[probes]]
name = "spot"
at = [5, 5, 5]

[[probes]]
name = "held"
on = "lower.bottom"
of = ["displacement", "von-mises"]
"""


def distorted(cell: str, curved: bool = False) -> Mesh:
    """A unit square or cube of cells in general position; curved: all nodes moved, so that edges and sides bend."""
    dim = CELLS[cell].dim
    n = (3,) * dim
    move = patch._perturb(0.2, np.zeros(dim), np.ones(dim), 5, n)
    mesh = make.join({"a": block.grid([np.linspace(0.0, 1.0, k + 1) for k in n], cell, move)})
    if not curved:
        return mesh
    x = mesh.points
    bent = x + 0.06 * np.sin(2.0 * x[:, ::-1] + np.arange(1, dim + 1)) + 0.05 * x[:, ::-1] ** 2
    return replace(mesh, points=bent)


def free(mesh: Mesh, *probes: abut.Probe) -> abut.Model:
    return abut.Model(
        mesh, [abut.Solid("a", STEEL)], plane="strain" if mesh.dim == 2 else None, probes=probes,
    )  # fmt: skip


def two_blocks(*probes: abut.Probe, **options: Any) -> abut.Model:
    """A small block on a larger one in the plane, the upper one pressed down by 0.01."""
    lower = make.rectangle([0, 2], [0, 1], cells=[4, 2], cell="quad8")
    upper = make.rectangle([0.5, 1.5], [1, 2], cells=[3, 2], cell="quad8")
    given = {
        "plane": "strain",
        "solids": [abut.Solid("lower", STEEL), abut.Solid("upper", STEEL)],
        "supports": [abut.Support("lower.bottom", x=0, y=0), abut.Support("upper.top", x=0, y=-0.01)],
        "contacts": [abut.Contact(contactor="upper.bottom", target="lower.top", name="blocks")],
        **options,
    }
    return abut.Model(make.join({"lower": lower, "upper": upper}), probes=probes, **given)


def table(path: Path) -> list[dict[str, str]]:
    with path.open(newline="") as file:
        return list(csv.DictReader(file))
