"""*INITIAL CONDITIONS, TYPE=STRESS: of elements as Abaqus, of integration points as CalculiX has them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import abut
from abut.cli import main
from abut.decks.translation import load_deck
from abut.errors import InputError

NODES = "\n".join(f"{1 + i + 2 * j + 4 * k}, {i}, {j}, {k}" for k in range(3) for j in range(2) for i in range(2))
COLUMN = f"""*NODE, NSET=ALL
{NODES}
*ELEMENT, TYPE=C3D8, ELSET=EALL
1, 1,2,4,3,5,6,8,7
2, 5,6,8,7,9,10,12,11
*ELSET, ELSET=LOW
1
*MATERIAL, NAME=EL
*ELASTIC
1000., 0.25
*SOLID SECTION, ELSET=EALL, MATERIAL=EL
*BOUNDARY
1, 1, 3
2, 2, 3
3, 3, 3
4, 3, 3
"""
STEP = "*STEP\n*STATIC\n*END STEP\n"


def loaded(folder: Path, lines: str) -> abut.Model:
    path = folder / "deck.inp"
    path.write_text(f"{COLUMN}*INITIAL CONDITIONS, TYPE=STRESS\n{lines}\n{STEP}")
    return load_deck(path).model


def at_every_point(element: int, stress: str) -> str:
    return "\n".join(f"{element}, {point}, {stress}" for point in range(1, 9))


@pytest.mark.parametrize(
    "lines",
    ["EALL, 0., 0., 10., 0., 0., 0.", "\n".join(at_every_point(e, "0., 0., 10., 0., 0., 0.") for e in (1, 2))],
)
def test_a_free_column_springs_back(lines: str, tmp_path: Path) -> None:
    """Both forms: shorter by s / E, wider by Poisson's share, and free of stress."""
    model = loaded(tmp_path, lines)
    step = abut.solve(model).steps[-1]
    assert step.displacement == pytest.approx(model.mesh.points * (0.0025, 0.0025, -0.01), abs=1e-12)
    assert np.abs(step.stress).max() < 1e-10


def test_elements_without_have_none(tmp_path: Path) -> None:
    """The lower cell alone shortens; all six components at their places (11 22 33 12 13 23)."""
    model = loaded(tmp_path, "LOW, 1., 2., 3., 4., 5., 6.")
    components = model.solids[0].initial_stress
    inside = np.array([[0.5, 0.5, 0.5], [0.5, 0.5, 1.5]])
    found = np.array([component(inside) for component in components])
    assert pytest.approx(np.array([[1, 2, 3, 4, 6, 5], [0, 0, 0, 0, 0, 0]])) == found.T


def test_points_of_an_element(tmp_path: Path) -> None:
    """CalculiX numbers them along the first direction first, the third one last."""
    lines = "\n".join(f"1, {point}, {point}., 0., 0., 0., 0., 0." for point in range(1, 9))
    component = loaded(tmp_path, lines).solids[0].initial_stress[0]
    low, high = 0.5 - 0.5 / np.sqrt(3.0), 0.5 + 0.5 / np.sqrt(3.0)
    points = np.array([[x, y, z] for z in (low, high) for y in (low, high) for x in (low, high)])
    assert component(points) == pytest.approx(np.arange(1.0, 9.0))


def test_as_a_job(tmp_path: Path) -> None:
    """Stresses that are one all over the body are numbers of a job, others are refused with the reason."""
    loaded(tmp_path, "EALL, 0., 0., 10., 0., 0., 0.")
    assert main(["convert", str(tmp_path / "deck.inp"), str(tmp_path / "job.toml")]) == 0
    assert "initial_stress = [0.0, 0.0, 10.0, 0.0, 0.0, 0.0]" in (tmp_path / "job.toml").read_text()
    loaded(tmp_path, "LOW, 0., 0., 10., 0., 0., 0.")
    assert main(["convert", str(tmp_path / "deck.inp"), str(tmp_path / "other.toml")]) == 2


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ("1, 1, 1., 0., 0., 0., 0., 0.\n1, 2, 2., 0., 0., 0., 0., 0.", "element 1 has stresses that differ"),
        ("HIGH, 1., 0., 0., 0., 0., 0.", "no element set named 'HIGH'"),
    ],
)
def test_messages(lines: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=said):
        loaded(tmp_path, lines)


def test_other_conditions_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "deck.inp"
    path.write_text(f"{COLUMN}*INITIAL CONDITIONS, TYPE=VELOCITY\nALL, 1, 1.\n{STEP}")
    with pytest.raises(InputError, match="TYPE=VELOCITY is not supported"):
        load_deck(path)
