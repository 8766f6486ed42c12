"""Friction in job files: every form of the key, found pairs, there and back, and one message for each bad value."""

from __future__ import annotations

from pathlib import Path

import pytest

import abut
from abut.errors import InputError
from abut.job import load_job
from abut.job.convert import write_job

EXAMPLE = Path(__file__).parents[2] / "examples" / "pushed-block" / "job.toml"
NAMED = 'surfaces = ["block.bottom", "plate.top"]\n'


def job(folder: Path, friction: str, contact: str = NAMED) -> Path:
    text = EXAMPLE.read_text()
    assert "friction = 0.3" in text
    assert NAMED in text
    path = folder / "job.toml"
    path.write_text(text.replace("friction = 0.3", friction).replace(NAMED, contact))
    return path


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("friction = 1", 1.0),
        ('friction = "rough"', "rough"),
        ("friction = [[0, 0.3], [1.5, 0.2]]", ((0.0, 0.3), (1.5, 0.2))),
    ],
)
@pytest.mark.parametrize("contact", [NAMED, "auto = true\n"], ids=["named", "found"])
def test_forms(tmp_path: Path, text: str, expected: object, contact: str) -> None:
    (own,) = load_job(job(tmp_path, text, contact)).model.contacts
    assert own.friction == expected
    assert own.friction_amplitude is None


@pytest.mark.parametrize("text", ["friction = 0.3", "friction = [[0, 0.3], [1.5, 0.2]]"])
def test_there_and_back(tmp_path: Path, text: str) -> None:
    loaded = load_job(job(tmp_path, f"{text}\nfriction_amplitude = [[0, 1], [1, 0.5]]"))
    write_job(tmp_path / "again.toml", loaded)
    (again,) = load_job(tmp_path / "again.toml").model.contacts
    assert again.friction == loaded.model.contacts[0].friction
    assert again.friction_amplitude == abut.Amplitude([(0, 1), (1, 0.5)])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("friction = -1", "friction: expected a coefficient >= 0, got -1"),
        (
            'friction = "slick"',
            "friction: expected a coefficient >= 0, .* \"rough\", or pairs .* got 'slick': unknown name",
        ),
        ("friction = true", "friction: expected a finite number"),
        ("friction = nan", "friction: expected a finite number"),
        ("friction = { mu = 0.3 }", "friction: expected a coefficient >= 0"),
        ("friction = [0.3, 0.2]", "friction: expected a coefficient >= 0"),
        ("friction = [[0, 0.3], [1, 0.2, 0.1]]", "friction: expected a coefficient >= 0"),
        ("friction = [[1, 0.3], [0, 0.2]]", "friction: pressures must increase, but 0 follows 1"),
        ("friction = 0.3\nfriction_amplitude = [[0, -1]]", "friction_amplitude: expected factors >= 0"),
        ("friction = 0.3\nfriction_amplitude = [[1, 1], [0, 1]]", "friction_amplitude: times must increase"),
        ("friction_amplitude = [[0, 1]]", "friction_amplitude: there is no coefficient"),
    ],
)
def test_one_message_for_each_bad_value(tmp_path: Path, text: str, words: str) -> None:
    path = job(tmp_path, text)
    with pytest.raises(InputError, match=words) as error:
        load_job(path)
    assert str(error.value).count("\n") == 0
    assert str(error.value).startswith(str(path))
