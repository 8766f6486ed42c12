"""What decks ask for and abut does not do is refused with its place, or left out where the user says so."""

import json
from pathlib import Path

import pytest

import abut
from abut.cli import main
from abut.errors import InputError
from abut.io.deck.cards import key
from abut.io.deck.refused import PARAMETERS, PROCEDURES, REFUSED
from abut.io.deck.supported import NEEDED, QUIET, READ
from abut.job import load_job
from abut.mesh.mesh import Mesh
from models.decks import BRICKS, HELD, PAIR, PUSH, load, step, write

DECK = BRICKS + PAIR + HELD + PUSH


@pytest.mark.parametrize("name", sorted(set(REFUSED) - set(PROCEDURES)))
def test_every_refused_card_is_named_with_its_line(name, tmp_path):
    text = BRICKS + PAIR + HELD + f"*{name}\n" + PUSH
    line = text.splitlines().index(f"*{name}") + 1
    with pytest.raises(InputError, match=rf"deck\.inp:{line}: \*{name}: ") as caught:
        load(tmp_path, text)
    if key(name) in NEEDED:
        assert "--ignore" not in str(caught.value)
        return
    option = f'"{name}"' if " " in name else name
    assert f"to solve without it: --ignore {option}" in str(caught.value)
    job = load(tmp_path, text, name.lower())
    assert job.ignored == (f"*{name} ({tmp_path / 'deck.inp'}:{line})",)


@pytest.mark.parametrize("name", sorted(PROCEDURES))
def test_other_procedures_are_refused_and_left_out_with_their_step(name, tmp_path):
    text = DECK + step("*CLOAD", "18, 1, 5.", "*MODEL CHANGE", card=f"*{name}")
    with pytest.raises(InputError, match=rf"\*{name}: abut solves \*STATIC steps only"):
        load(tmp_path, text)
    job = load(tmp_path, text, name)
    assert job.model.solve.steps == 1
    assert [own.split(" (")[0] for own in job.ignored] == [f"the step with *{name}"]
    with pytest.raises(InputError) as caught:
        load(tmp_path, BRICKS + step(card=f"*{name}"))
    assert "--ignore" not in str(caught.value)  # nothing would be left


def test_every_reason_comes_with_a_cure():
    """After a semicolon, as what to do: a verb, not another "not"."""
    for name, reason in {**REFUSED, **PARAMETERS}.items():
        why, _, cure = reason.partition("; ")
        assert why, name
        assert len(cure.split()) > 1, name
        assert not {"not supported", "not read"} & {cure[-len("not supported") :], cure[-len("not read") :]}, name


def test_large_displacements_are_solved_or_left_out(tmp_path):
    text = DECK.replace("*STEP", "*STEP, INC=100, nl geom")
    job = load(tmp_path, text)
    assert job.model.kinematics == "finite"
    assert job.ignored == ()
    job = load(tmp_path, text, "NLGEOM")
    assert job.model.kinematics == "small"
    assert "NLGEOM of *STEP" in job.ignored[0]
    for value in ("NLGEOM=NO", "nlgeom = no"):
        job = load(tmp_path, DECK.replace("*STEP", f"*STEP, {value}"), "NLGEOM")
        assert job.model.kinematics == "small"
        assert job.ignored == ()


def told(tmp_path, text):
    """The lines of the error that reading ``text`` ends with, without the deck's path."""
    with pytest.raises(InputError) as caught:
        load(tmp_path, text)
    return str(caught.value).replace(str(tmp_path), "").split("\n  ")


def test_reasons_of_every_stage_come_at_once_in_the_order_of_the_deck(tmp_path):
    """Cards refused, an element type, a material, a missing name, a number and a load, each where it stands, once."""
    text = (
        DECK.replace("*ELASTIC", "*ELASTIC, TYPE=LAMINA")
        .replace("PRESSURE-OVERCLOSURE=HARD", "PRESSURE-OVERCLOSURE=SOFT")
        .replace("*BOUNDARY", "*VISCOELASTIC\n1., 0.\n*BOUNDARY")
        .replace("*STEP", "*EQUATION\n2\n1, 1, 1.\n*STEP, PERTURBATION")
        .replace("*STATIC", "*STATIC\n*CLOAD\n18, 7, 1.\n*BOUNDARY\n1, 9\n")
    )
    lines = text.splitlines()
    expected = ["*ELASTIC: TYPE=LAMINA", "*SURFACE BEHAVIOR: PRESSURE-OVERCLOSURE=SOFT", "*VISCOELASTIC: ",
                "*EQUATION: 2 terms", "*STEP: PERTURBATION", "*CLOAD: direction 7", "*BOUNDARY: directions 9"]  # fmt: skip
    starts = ["*ELASTIC", "*SURFACE BEHAVIOR", "*VISCOELASTIC", "*EQUATION", "*STEP", "18, 7", "1, 9"]
    own = told(tmp_path, text)
    assert len(own) == len(expected)
    for i, (reason, want, start) in enumerate(zip(own, expected, starts)):
        line = next(k for k, line in enumerate(lines, start=1) if line.startswith(start)) + (start == "*EQUATION")
        assert reason.startswith(f"/deck.inp:{line}: {want}" if i == 0 else f"line {line}: {want}")
    assert "--ignore" not in own[-1]  # not all of it can be left out


def test_what_follows_from_a_missing_file_is_not_told(tmp_path):
    rest = PAIR + HELD + PUSH.replace("*STEP", "*CREEP\n.1\n*STEP")
    own = told(tmp_path, "*INCLUDE, INPUT=mesh.inp\n*INCLUDE, INPUT=sets.inp\n" + rest)
    assert [reason.split(": ", 1)[1] for reason in own[:2]] == [
        "included file /mesh.inp does not exist",
        "included file /sets.inp does not exist",
    ]
    assert len(own) == 3
    assert "*CREEP: " in own[2]  # and not that sets and surfaces are unknown


def test_unknown_names_are_told_where_all_else_could_be_read(tmp_path):
    own = told(tmp_path, DECK.replace("SLAVE, MASTER", "SLAVE, MASTR").replace("BOTTOM, 1, 3", "BOTOM, 1, 3"))
    assert len(own) == 2
    assert "did you mean 'MASTER'?" in own[0]
    assert "did you mean 'BOTTOM'?" in own[1]


def test_faults_of_the_model_come_at_once(tmp_path):
    """Found after reading: a material, and a surface whose nodes make up no face."""
    text = DECK.replace("1000., 0.", "-1000., 0.").replace(
        "*SURFACE, NAME=SLAVE\n2, S1", "*SURFACE, NAME=SLAVE, TYPE=NODE\n18"
    )
    own = told(tmp_path, text)
    assert len(own) == 2
    assert "make up no face" in own[0]
    assert "*MATERIAL 'EL'" in own[1]


def test_no_more_than_a_screen_of_reasons(tmp_path):
    own = told(tmp_path, DECK + "".join(f"*NSET, NSET=A{i}\nNONE\n" for i in range(30)))
    assert len(own) == 21
    assert own[-1] == "and 10 more"


def test_all_refusals_come_at_once(tmp_path):
    text = DECK.replace("*STEP", "*CREEP\n0.1,\n*VISCOELASTIC\n1., 0.\n*STEP, PERTURBATION")
    with pytest.raises(InputError) as caught:
        load(tmp_path, text)
    assert all(f"--ignore {name}" in str(caught.value) for name in ("CREEP", "VISCOELASTIC", "PERTURBATION"))


def test_friction_without_effect_needs_no_permission(tmp_path):
    none = DECK.replace("*CONTACT PAIR", "*FRICTION\n0., 1.E4\n*CONTACT PAIR")
    assert load(tmp_path, none).ignored == ()
    tied = DECK.replace("HARD\n", "TIED\n*FRICTION\n0.5, 1.E4\n")
    job = load(tmp_path, tied)
    assert job.model.contacts[0].kind == "tied"
    assert any("stick stiffness" in note for note in job.notes)


def test_ignore_is_checked(tmp_path):
    for name, words in (
        ("FRICTOIN", "did you mean 'FRICTION'"),
        ("NODE", "abut reads \\*NODE, which cannot be left out"),
    ):
        with pytest.raises(InputError, match=words):
            load(tmp_path, DECK, name)
    assert load(tmp_path, DECK, "FRICTION").ignored == ()  # nothing there to leave out
    job = write(tmp_path, "schema = 1\n", "job.toml")
    assert main(["run", str(job), "--ignore", "FRICTION"]) == 2


@pytest.mark.long
def test_cards_without_effect_are_noted(tmp_path):
    for name in QUIET:
        notes = load(tmp_path, DECK.replace("*STEP", f"*{name}\n*STEP")).notes
        assert any(f"*{name}" in note for note in notes)
    assert not set(QUIET) & (set(READ) | set(REFUSED))


def test_unknown_cards_and_parameters_are_refused(tmp_path):
    with pytest.raises(InputError, match=r"\*BUNDARY: abut does not know this card.*--ignore BUNDARY"):
        load(tmp_path, DECK.replace("*BOUNDARY", "*BUNDARY"))
    with pytest.raises(InputError, match=r"\*CLOAD: FOLLOWER: abut does not know this parameter"):
        load(tmp_path, DECK.replace("*DLOAD", "*CLOAD, FOLLOWER\n18, 1, 0.\n*DLOAD"))


def test_penalty_is_replaced_with_a_note(tmp_path):
    notes = load(tmp_path, DECK.replace("=HARD", "=Linear")).notes
    assert any("LINEAR replaced by exact contact" in note for note in notes)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("1000., 0.", "1000., 0., 20.\n900., 0., 10.", "temperature: must grow from row to row, got 10 after 20"),
        ("*ELASTIC", "*ELASTIC, TYPE=LAMINA", "TYPE=LAMINA is not supported; abut knows ISO, ORTHO"),
        ("*ELASTIC", "*ELASTIC, TYPE=ORTHO", "expected 9 numbers in 2 lines"),
        ("1000., 0.", "-1000., 0.", "young"),
        ("*ELASTIC\n1000., 0.\n", "", r"material 'EL' has no \*ELASTIC"),
        ("MATERIAL=EL\n", "MATERIAL=AL\n", "no material named 'AL'; known: EL"),
        ("ELSET=EALL, M", "ELSET=EAL, M", "no element set named 'EAL'; did you mean 'EALL'"),
        ("ELSET=EALL, M", "ELSET=LOW, M", r"element 2 without \*SOLID SECTION"),
        ("INTERACTION=I,", "INTERACTION=J,", r"no \*SURFACE INTERACTION named 'J'"),
        ("SLAVE, MASTER\n", "SLAVE, MASTRE\n", "no master surface named 'MASTRE'; did you mean 'MASTER'"),
        ("2, S1\n", "2, S2\n", r"\*CONTACT PAIR: 'SLAVE' and 'MASTER' look the same way"),
        ("2, P2, 10.", "2, P9, 10.", "face label 'P9': expected P1 to P6"),
        ("2, P2, 10.", "2, NEWTON, 10.", "load 'NEWTON' is not supported"),
        ("2, P2, 10.", "3, P2, 10.", "element 3 does not exist"),
        ("2, P2, 10.", "2, P2", "magnitude is missing"),
        ("BOTTOM, 1, 3", "BOTTOM, 1, 11", r"direction 11 .* belongs to heat transfer.*; give temperatures by \*TEMPERATURE"),
        ("BOTTOM, 1, 3", "BOTTOM, 0", r"direction 0 .* belongs to heat transfer.*; give temperatures by \*TEMPERATURE"),
        ("2, P2, 10.", "2, P2NP, 18", "P2NP takes the pressure from a node of a network, .*; give it as a number, with P2"),
        ("BOTTOM, 1, 3", "BOTTOM, 3, 1", "directions 3 to 1"),
        ("*DLOAD\n2, P2, 10.", "*CLOAD\n18, 7, 1.", r"direction 7: expected 1 to 3 \(forces\) or 4 to 6 \(moments\)"),
        ("*DLOAD\n2, P2, 10.", "*CLOAD\n18, 4, 1.", "node 18 carries no moment"),
        ("*DLOAD", "*DLOAD, AMPLITUDE=A", r"no \*AMPLITUDE named 'A'"),
        ("*STEP\n*STATIC\n*DLOAD", "*STEP\n*DLOAD", "the step has no procedure"),
        ("*END STEP\n", "", r"the step has no \*END STEP"),
        ("*STEP\n", "*CLOAD\n18, 1, 1.\n*STEP\n", "loads stand inside a step"),
        ("*DLOAD\n2, P2, 10.", "*TEMPERATURE\nALL, 5.", "has no temperature to begin with"),
        ("*DLOAD\n2, P2, 10.", "*CLOAD\n77, 1, 1.", "node 77 does not exist"),
        ("*DLOAD\n2, P2, 10.", "*NODE\n77, 1., 1., 1.\n*CLOAD\n77, 1, 1.", "node 77 belongs to no element and no equation"),
        ("ALL, 1, 2", "ALL, 1, 2\n77, 1, 3, 0.1", r"deck\.inp:\d+: \*BOUNDARY: node 77 belongs to no element and"),
        ("*DLOAD", "*NODE\n77, 1., 1., 1.\n*BOUNDARY\n77, 3, 3, 0.1\n*DLOAD", r"\*BOUNDARY: node 77 belongs to no element"),
        ("*DLOAD", "*BOUNDARY\n18, 5, 5, 0.1\n*DLOAD", r"\*BOUNDARY: node 18 cannot turn \(direction 5\)"),
        ("*STEP\n", "*INITIAL CONDITIONS, TYPE=VELOCITY\n1, 5.\n*STEP\n", "TYPE=VELOCITY is not supported"),
        ("*STEP\n", "*MPC\nDIST, 1, 2\n*STEP\n", "MPC: DIST: expected two nodes, each three times"),
        ("*STEP\n", "*EQUATION\n3\n1,1,1.,2,1,-1.\n*STEP\n", "3 terms announced, but 2 given"),
    ],
)  # fmt: skip
def test_faults_of_a_deck_are_named(old, new, words, tmp_path):
    assert old in DECK
    with pytest.raises(InputError, match=words):
        load(tmp_path, DECK.replace(old, new, 1) if old != "*END STEP\n" else DECK.replace(old, new))


def test_what_was_ignored_stands_in_the_summary(tmp_path, capsys):
    deck = write(tmp_path, DECK.replace("*STEP", "*STEP, PERTURBATION"))
    assert main(["run", str(deck)]) == 2
    assert f"{deck}:" in capsys.readouterr().err
    assert main(["run", str(deck), "--ignore", "PERTURBATION", "--quiet"]) == 0
    summary = json.loads((tmp_path / "deck-results" / "summary.json").read_text())
    assert [own.split(" (")[0] for own in summary["ignored"]] == ["PERTURBATION of *STEP"]
    assert any("*NODE PRINT" in note for note in summary["notes"])


def test_every_card_stands_in_the_documents():
    text = (Path(__file__).parents[2] / "docs" / "decks.md").read_text(encoding="utf-8")
    for name in (*READ, *QUIET, *REFUSED):
        assert f"`*{name}`" in text, name


REFERENCE = "*NODE, NSET=REF\n99, 0., 0., 3.\n"


def test_a_reference_node_without_its_coupling_is_no_zero_result(tmp_path):
    """What drives the body went with the coupling: the deck is refused, with the line, by displacement and by force."""
    coupled = BRICKS + REFERENCE + "*SURFACE, NAME=PUSHED\n2, S2\n" + PAIR + HELD
    coupled += "*COUPLING, REF NODE=99, SURFACE=PUSHED\n*KINEMATIC\n3\n"
    for card, value in (("*BOUNDARY", "99, 3, 3, -0.1"), ("*BOUNDARY", "REF, 3, 3, -0.1"), ("*CLOAD", "99, 3, -5.")):
        text = coupled + step(card, value)
        line = text.splitlines().index(value) + 1
        with pytest.raises(
            InputError, match=rf"deck\.inp:{line}: \{card}: node 99 belongs to no element and no equation"
        ):
            load(tmp_path, text, "COUPLING", "KINEMATIC")


def test_supports_that_hold_nothing_are_noted(tmp_path):
    for node, what in ((99, "belongs to no element and no equation"), (77, "does not exist")):
        text = DECK.replace("*STEP", f"{REFERENCE}*BOUNDARY\n{node}, 1, 3\n*STEP")
        line = text.splitlines().index(f"{node}, 1, 3") + 1
        job = load(tmp_path, text)
        assert f"{tmp_path / 'deck.inp'}:{line}: *BOUNDARY: node {node} {what}: the line holds nothing" in job.notes
        assert len(job.model.supports) == len(load(tmp_path, DECK).model.supports)
    assert not any("holds nothing" in note for note in load(tmp_path, DECK).notes)


def test_nodes_without_elements_in_a_set_that_moves_are_noted(tmp_path):
    more = "*NODE\n98, 5., 5., 5.\n99, 5., 5., 5.\n*NSET, NSET=MOVED\nTOP, 98, 99\n*STEP"
    text = DECK.replace("*STEP", more).replace("*DLOAD\n2, P2, 10.", "*BOUNDARY\nMOVED, 3, 3, -0.1")
    line = text.splitlines().index("MOVED, 3, 3, -0.1") + 1
    job = load(tmp_path, text)
    words = "*BOUNDARY: node 98 and 1 more belong to no element: nothing follows there"
    assert f"{tmp_path / 'deck.inp'}:{line}: {words}" in job.notes
    kept = load(tmp_path, text.replace("MOVED, 3, 3", "TOP, 3, 3"))
    one, other = (abut.solve(each.model).displacement for each in (job, kept))
    assert (one == other).all()
    with pytest.raises(InputError, match="node 98 belongs to no element and no equation"):
        load(tmp_path, text.replace("TOP, 98, 99\n", "98, 99\n"))


def test_members_that_are_missing_are_left_out_with_a_note(tmp_path):
    more = "*NSET, NSET=N\n15, 16, 77, 78\n*ELSET, ELSET=E\n2, 9\n*NSET, NSET=G, GENERATE\n15, 30\n"
    job = load(tmp_path, DECK.replace("*STEP", f"{more}*STEP").replace("2, P2, 10.", "E, P2, 10."))
    notes = [note.split(": ", 1)[1] for note in job.notes if "left out" in note]
    assert notes == [
        "*NSET: node 77 and 1 more of set 'N' does not exist: left out",
        "*ELSET: element 9 of set 'E' does not exist: left out",
    ]
    assert len(job.model.loads) == 1
    assert set(Mesh.read(tmp_path / "deck.inp").notes) == {note for note in job.notes if "left out" in note}


def test_empty_surfaces_and_sets_are_faults_only_where_they_are_used(tmp_path):
    empty = "*NSET, NSET=NONE\n*ELSET, ELSET=NOTHING\n*SURFACE, NAME=S0\n"
    empty += "*SURFACE, NAME=S1, TYPE=NODE\nNONE,\n*SURFACE, NAME=S2\nNOTHING, S1\n"
    text = DECK.replace("*SURFACE INTERACTION", f"{empty}*SURFACE INTERACTION")
    assert "S0" not in load(tmp_path, text).model.mesh.surfaces
    assert not {"S0", "S1", "S2"} & set(Mesh.read(tmp_path / "deck.inp").surfaces)
    for own in ("S0", "S1", "S2"):
        with pytest.raises(InputError, match=rf"\*SURFACE: surface '{own}' is empty"):
            load(tmp_path, text.replace("SLAVE, MASTER\n", f"SLAVE, {own}\n"))
    with pytest.raises(InputError, match=r"\*DSLOAD: surface 'S0' is empty"):
        load(tmp_path, text.replace("*DLOAD\n2, P2, 10.", "*DSLOAD\nS0, P, 10."))
    with pytest.raises(InputError, match="node set 'NONE' is empty"):
        load(tmp_path, text.replace("BOTTOM, 1, 3", "NONE, 1, 3"))


@pytest.mark.parametrize("card", ["*ELEMENT, TYPE=T2D3", "*VISCOELASTIC", "*AMPLITUDE, NAME=A", "*FANCY"])
def test_files_of_cards_that_are_refused_are_not_opened(card, tmp_path):
    with pytest.raises(InputError) as caught:
        load(tmp_path, DECK.replace("*STEP", f"{card}, INPUT=none.inc\n*STEP"))
    assert "none.inc" not in str(caught.value)
    assert card.split(",")[0] in str(caught.value)


def test_a_file_may_be_named_on_the_second_line_of_a_card(tmp_path):
    rows = "1, 0., 0., 0.\n2, 1., 0., 0.\n"
    (tmp_path / "nodes.inc").write_text(rows)
    text = DECK.replace("1, 0,0,0\n2, 1,0,0\n", "").replace(
        "*ELEMENT", "*NODE, NSET=ALL,\nINPUT=nodes.inc\n*ELEMENT", 1
    )
    assert load(tmp_path, text).model.mesh.n_cells == 2
    with pytest.raises(InputError, match=r"included file .*none\.inc does not exist"):
        load(tmp_path, text.replace("nodes.inc", "none.inc"))


def test_messages_name_the_file_once_and_each_word_once(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = DECK.replace("*STEP", "*CREEP\n0.1,\n*STEP, PERTURBATION")
    text += step("*CLOAD", "18, 1, 0.", card="*STATIC, PERTURBATION")
    write(tmp_path, text)
    for name in ("deck.inp", "./deck.inp"):
        with pytest.raises(InputError) as caught:
            load_job(Path(name))
        text = str(caught.value)
        assert text.count("deck.inp") == 1
        assert text.count("--ignore PERTURBATION") == text.count("--ignore CREEP") == 1
        assert text.count("line ") == 2
    write(tmp_path, DECK.replace("1000., 0.", "1000., 0.7"))
    with pytest.raises(InputError) as caught:
        load_job(Path("deck.inp"))
    assert str(caught.value).count("deck.inp") == 1
