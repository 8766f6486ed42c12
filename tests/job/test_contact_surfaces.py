"""`surfaces = [a, b]` in job files: two sides without roles."""

from __future__ import annotations

from pathlib import Path

import pytest

import abut
from abut.cli import main
from abut.errors import InputError
from abut.job import load_job
from abut.job.convert import write_job

EXAMPLES = Path(__file__).parents[2] / "examples"
TEXT = (EXAMPLES / "two-blocks" / "job.toml").read_text()
ROLES = 'contactor = "upper.bottom"\ntarget = "lower.top"'


def job(tmp_path: Path, sides: str) -> Path:
    assert ROLES in TEXT
    path = tmp_path / "job.toml"
    path.write_text(TEXT.replace(ROLES, sides))
    return path


def test_abut_chooses_and_says_so(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The lower block's facets are larger; the force stays that on the side named first, files have the contact's name."""
    path = job(tmp_path, 'surfaces = ["upper.bottom", "lower.top"]')
    (contact,) = load_job(path).model.contacts
    assert contact == abut.Contact("upper.bottom", "lower.top", name="blocks").with_choice(1, "coarser")
    assert main(["run", str(path)]) == 0
    out = capsys.readouterr().out
    assert "contact 'blocks': contactor 'lower.top' (coarser, facets of 1.67 against 1.2), target 'upper.bottom'" in out
    assert "force on 'upper.bottom' (0, 0, 16" in out
    assert (tmp_path / "results" / "contact_blocks_0001.vtu").is_file()
    assert main(["check", str(path)]) == 0
    assert "(contactor)" in capsys.readouterr().out


def test_a_restart_takes_the_same_sides(tmp_path: Path) -> None:
    from abut.output import restart

    chosen = load_job(job(tmp_path, 'surfaces = ["upper.bottom", "lower.top"]')).model
    named = load_job(job(tmp_path, 'contactor = "lower.top"\ntarget = "upper.bottom"')).model
    other = load_job(job(tmp_path, ROLES)).model
    assert restart.description(chosen) == restart.description(named)
    assert restart.differences(restart.description(other), restart.description(chosen))


@pytest.mark.parametrize(
    "sides",
    ['surfaces = ["upper.bottom", "lower.top"]', 'surfaces = [["upper.bottom", "upper.left"], "lower"]', ROLES],
)
def test_written_out_it_is_the_same(sides: str, tmp_path: Path) -> None:
    """Choices stay choices, roles stay roles."""
    original = load_job(job(tmp_path, sides))
    written, _ = write_job(tmp_path / "written.toml", original)
    again = load_job(written)
    assert again.model.contacts == original.model.contacts
    assert bool(again.model.contacts[0].first) == sides.startswith("surfaces")
    assert ("surfaces = " in written.read_text()) == sides.startswith("surfaces")


WRONG = {
    "a mixture": ('surfaces = ["upper.bottom", "lower.top"]\ncontactor = "lower.top"', "contacts[0].contactor: surfaces"),
    "one": ('surfaces = ["upper.bottom"]', "contacts[0].surfaces: expected two entries"),
    "three": ('surfaces = ["upper.bottom", "lower.top", "upper.left"]', 'are a list: [["a", "b"], "c"]'),
    "an empty one": ('surfaces = ["upper.bottom", []]', "contacts[0].surfaces: expected the names"),
    "unknown": ('surfaces = ["upper.bottom", "lower.topp"]', "contacts[0].surfaces[1]: no surface or body named"),
    "half of the roles": ('contactor = "upper.bottom"', "contacts[0].target: missing"),
    "none": ("", "contacts[0].surfaces: missing; name both surfaces"),
    "with auto": ('auto = true\nsurfaces = ["upper.bottom", "lower.top"]', "contacts[0].surfaces: auto = true finds both"),
}  # fmt: skip


@pytest.mark.parametrize("case", WRONG)
def test_what_does_not_go(case: str, tmp_path: Path) -> None:
    sides, message = WRONG[case]
    with pytest.raises(InputError) as error:
        load_job(job(tmp_path, sides))
    assert message in str(error.value)
