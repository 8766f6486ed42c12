"""The pages of docs/theory, the equations that code cites, and links between documents fit together."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.cli import main
from abut.job import load_job
from abut.verify import law_tangents, material_tangent

ROOT = Path(__file__).parents[2]
PAGES = sorted((ROOT / "docs" / "theory").glob("*.md"))
CODE = sorted([*(ROOT / "src").rglob("*.py"), *(ROOT / "cpp").glob("*.[ch]pp")])
DOCUMENTS = sorted([*ROOT.glob("*.md"), *(ROOT / "examples").rglob("README.md"), *(ROOT / "docs").rglob("*.md")])

TAG = re.compile(r"\\tag\{([^}]*)\}")
LABEL = re.compile(r"\(([DEFGLPQRSTVZ]\d+)\)")
CITATION = re.compile(r"\btheory((?:,? \([A-Z]\d+\))+)")
LINK = re.compile(r"\]\(([^)\s]+)\)")


def tags(page: Path) -> list[str]:
    return TAG.findall(page.read_text(encoding="utf-8"))


def citations(file: Path) -> list[str]:
    """Labels that a source file cites: "theory (S2)", "theory (L4), (L5)"."""
    runs = CITATION.findall(file.read_text(encoding="utf-8"))
    return [label for run in runs for label in re.findall(r"\((\w+)\)", run)]


def anchors(page: Path) -> set[str]:
    """Anchors that GitHub makes of the headings."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


def name(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def test_labels_are_unique_and_of_their_page() -> None:
    every = [label for page in PAGES for label in tags(page)]
    assert len(every) > 40
    assert [label for label, count in Counter(every).items() if count > 1] == []
    for page in PAGES:
        labels = tags(page)
        assert [int(label[1:]) for label in labels] == list(range(1, len(labels) + 1)), name(page)
        assert len({label[0] for label in labels}) <= 1, name(page)


def test_code_cites_what_exists() -> None:
    known = {label for page in PAGES for label in tags(page)}
    cited = [(name(file), label) for file in CODE for label in citations(file)]
    assert len(cited) >= 20
    assert [(file, label) for file, label in cited if label not in known] == []


def test_citations_are_well_formed() -> None:
    """A citation broken over two lines, or misspelt, would escape the other tests."""
    for file in CODE:
        text = file.read_text(encoding="utf-8")
        starts = len(re.findall(r"\btheory\s*(?://|#)?\s*\(", text, re.IGNORECASE))
        assert starts == len(CITATION.findall(text)), name(file)


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_pages_refer_to_what_exists(page: Path) -> None:
    known = {label for other in PAGES for label in tags(other)}
    assert set(LABEL.findall(page.read_text(encoding="utf-8"))) <= known


def test_every_equation_is_cited() -> None:
    """By the code, or by another page."""
    by_code = {label for file in CODE for label in citations(file)}
    for page in PAGES:
        by_others = {
            label for other in PAGES if other != page for label in LABEL.findall(other.read_text(encoding="utf-8"))
        }
        assert [label for label in tags(page) if label not in by_code | by_others] == [], name(page)


@pytest.mark.parametrize("document", DOCUMENTS, ids=name)
def test_links_lead_somewhere(document: Path) -> None:
    for link in LINK.findall(document.read_text(encoding="utf-8")):
        if re.match(r"[a-z]+:", link):
            continue
        path, _, anchor = link.partition("#")
        target = document.parent / path if path else document
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), link


@pytest.mark.parametrize("document", DOCUMENTS, ids=name)
def test_files_in_commands_exist(document: Path) -> None:
    """Jobs, decks, meshes and scripts of the repository that a page names, in commands and elsewhere."""
    named = re.findall(
        r"\b(?:examples|tests|bench|src|docs/make)/[\w./-]+\.(?:toml|inp|py|msh|json)\b",
        document.read_text(encoding="utf-8"),
    )
    assert [path for path in named if not (ROOT / path).exists()] == []


@pytest.mark.parametrize("folder", ["contact", "problem", "nonlinear", "analysis"])
def test_files_of_the_largest_folders(folder: str) -> None:
    """docs/architecture.md names each of them, and no others."""
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    (table,) = re.findall(rf"^\| `{folder}` \| files \|$(.*?)\n\n", text, re.DOTALL | re.MULTILINE)
    names = re.findall(r"`(\w+)`", table)
    files = {path.stem for path in (ROOT / "src" / "abut" / folder).glob("*.py")} - {"__init__"}
    assert len(files) > 20
    assert set(names) == files


@pytest.mark.parametrize("page", ["api.md"])
def test_python_on_pages_runs(page: str) -> None:
    """The coupling of two triangles with a square: no gap where they lie on each other, and none by a rigid shift. The law
    and the material have the derivatives that they claim."""
    text = (ROOT / "docs" / page).read_text(encoding="utf-8")
    scope: dict = {"__name__": "__main__"}  # dataclasses look their module up
    for code in re.findall(r"```python\n(.*?)```", text, re.DOTALL):
        exec(code, scope)
    assert scope["operator"].shape == (4, 3 * 8)
    assert np.abs(scope["operator"] @ np.tile([0.3, -0.2, 0.7], 8)).max() < 1e-14
    assert np.abs(scope["gap"]).max() < 1e-14
    law, material = scope["SoftLayer"](1e5), scope["Hooke"](5.0, 1.0)
    assert law_tangents(law, np.array([[-0.01], [0.02]]), np.array([[5.0], [1.0]])) < 1e-7
    assert material_tangent(material, np.random.default_rng(0).uniform(-1, 1, (5, 6))) < 1e-7


def test_python_on_the_front_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A punch pressed on a block: what it writes, and a force that pushes it up."""
    monkeypatch.chdir(tmp_path)
    (code,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    scope: dict = {}
    exec(code, scope)
    assert (tmp_path / "results" / "report.html").exists()
    assert scope["solution"].contacts[0].force[1] > 0.0
    assert all(check.passed for check in scope["solution"].certificate)


@pytest.mark.long
def test_the_tour_prints_what_abut_prints(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Its job, with P1 and with P0: contact forces, and the verdicts on stability."""
    tour = (ROOT / "docs" / "tour.md").read_text(encoding="utf-8")
    job = (ROOT / "examples" / "two-blocks" / "job.toml").read_text(encoding="utf-8")
    for name, text in (("p1", job), ("p0", job.rstrip() + '\npressure = "P0"\n')):
        path = tmp_path / f"{name}.toml"
        path.write_text(text)
        assert main(["run", str(path)]) == 0
        (force,) = (line for line in capsys.readouterr().out.splitlines() if ": force on '" in line)
        assert force.partition(", largest penetration")[0] in tour
        assert main(["infsup", str(path), "--levels", "2"]) == (name == "p0")
        for line in capsys.readouterr().out.splitlines():
            assert line in tour


def test_the_checkerboard_of_the_tour() -> None:
    """P0 on linear cells: what the tour shows, facet by facet, what it says of the average, and the line that fails."""
    model = load_job(ROOT / "examples" / "two-blocks" / "job.toml").model
    solution = abut.solve(replace(model, contacts=[replace(model.contacts[0], pressure="P0")]))
    result = solution.contacts[0]
    x = np.array([result.contactor.points[own[own >= 0]].mean(axis=0) for own in result.contactor.nodes])
    rows = result.multiplier[np.lexsort((x[:, 0], x[:, 1])), 0].reshape(5, 5)
    tour = (ROOT / "docs" / "tour.md").read_text(encoding="utf-8")
    assert "\n".join(" ".join(f"{p:3.0f}" for p in row) for row in rows) in tour
    shown = result.pressure[result.contactor.nodes >= 0]
    assert f"{shown.max():.0f} in the corners of the block, {shown.min():.0f} in its middle" in tour
    (failed,) = (check for check in solution.certificate if not check.passed)
    assert f"FAIL   {failed.value:.2e}   {failed.limit:.2e}  blocks: {failed.name}" in tour
