"""Contact detection: bodies whose facets face each other."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import abut
from abut.detection.opposing_facets import facing, outside
from abut.errors import InputError
from abut.job import load_job
from abut.job.pairs import write_pairs
from abut.mesh.exterior import exterior
from abut.mesh.make import box, join, rectangle, ring

EXAMPLES = Path(__file__).parents[2] / "examples"
TEXT = (EXAMPLES / "two-blocks" / "job.toml").read_text()
AUTO = TEXT.replace('contactor = "upper.bottom"\ntarget = "lower.top"', "auto = true")
STEEL = abut.LinearElastic(young=210e3, poisson=0.3)
RUBBER = abut.LinearElastic(young=5.0, poisson=0.45)


def rows(array: np.ndarray) -> set[tuple[int, int]]:
    return {(int(a), int(b)) for a, b in array}


@pytest.mark.parametrize("cell", ["hex8", "hex20", "tet4", "wedge6"])
def test_exterior_is_all_sides(cell: str) -> None:
    """The outside of a box is the union of its six named sides."""
    mesh = box(cells=(3, 2, 2), cell=cell)
    every = set().union(*(rows(facets) for facets in mesh.surfaces.values()))
    found = exterior(mesh)
    assert rows(found) == every
    assert len(found) == len(every)


def test_interface_of_glued_bodies_is_inside() -> None:
    mesh = rectangle(cells=(4, 1))
    glued = replace(mesh, bodies={"a": np.arange(2), "b": np.arange(2, 4)})
    assert len(exterior(glued)) == 10
    assert abut.find_contacts(glued) == ()


def stacked(upper: float = 0.0, cells: tuple[int, int] = (5, 6)) -> abut.Mesh:
    n, m = cells
    return join(
        {
            "lower": box(x=(0, 10), y=(0, 10), z=(0, 10), cells=(m, m, 3)),
            "upper": box(x=(2, 8), y=(2, 8), z=(10 + upper, 15 + upper), cells=(n, n, 3)),
        }
    )


@pytest.mark.parametrize("gap", [0.0, 0.5, -0.2])
def test_two_blocks(gap: float) -> None:
    """The whole lower face of the upper block, and of the lower one, whose facets are larger, what lies opposite with the
    facets around it: here all of the top."""
    mesh = stacked(gap)
    (found,) = abut.find_contacts(mesh)
    assert (found.contactor, found.target) == ("auto:lower-upper", "auto:upper-lower")
    assert rows(found.target_facets) == rows(mesh.surfaces["upper.bottom"])
    assert rows(found.contactor_facets) == rows(mesh.surfaces["lower.top"])
    assert found.gap == pytest.approx((gap, gap), abs=1e-12)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e3])
def test_units_and_position_do_not_matter(scale: float) -> None:
    """The same facets in any unit of length, turned and shifted."""
    mesh = join(
        {
            "lower": box(x=(0, 10), y=(0, 10), z=(0, 10), cells=(6, 6, 3), cell="tet10"),
            "upper": box(x=(2, 8), y=(2, 8), z=(10.3, 15), cells=(4, 4, 3), cell="hex20"),
        }
    )
    turn, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    moved = replace(mesh, points=np.ascontiguousarray(scale * (mesh.points @ turn.T + [3.0, -4.0, 50.0])))
    (one,), (other,) = abut.find_contacts(mesh), abut.find_contacts(moved)
    assert rows(one.contactor_facets) == rows(other.contactor_facets) == rows(mesh.surfaces["upper.bottom"])
    assert rows(one.target_facets) == rows(other.target_facets)
    assert other.gap == pytest.approx((0.3 * scale, 0.3 * scale), rel=1e-9)


def test_reach_and_bodies() -> None:
    """Gaps beyond the reach do not count; bodies restrict the search."""
    mesh = stacked(0.5)
    assert abut.find_contacts(mesh, reach=0.4) == ()
    assert len(abut.find_contacts(mesh, reach=0.6)) == 1
    assert abut.find_contacts(mesh, bodies=["upper"]) == ()
    with pytest.raises(InputError, match="did you mean 'upper'"):
        abut.find_contacts(mesh, bodies=["uper", "lower"])
    with pytest.raises(InputError, match="reach"):
        abut.find_contacts(mesh, reach=0.0)


def test_contactor_is_the_softer_then_the_coarser() -> None:
    mesh = stacked()
    for soft, other in (("upper", "lower"), ("lower", "upper")):
        (found,) = abut.find_contacts(mesh, [abut.Solid(soft, RUBBER), abut.Solid(other, STEEL)])
        assert found.bodies == (soft, other)
        assert found.reason == "softer"
    alike = [abut.Solid("upper", STEEL), abut.Solid("lower", STEEL)]
    for cells, finer in (((5, 6), "upper"), ((2, 9), "lower")):
        (found,) = abut.find_contacts(stacked(cells=cells), alike)
        assert found.bodies[1] == finer
        assert found.reason == "coarser"
    (rigid,) = abut.find_contacts(mesh, alike[1:])
    assert rigid.bodies == ("lower", "upper")


def test_the_coarser_side_is_the_contactor_flat_or_curved() -> None:
    """The pressure of a finer one would show every facet of the coarse one."""
    round_ = {
        "shaft": ring(radii=(5, 10), cells=(2, 4), cell="quad4"),
        "bush": ring(radii=(10, 12), cells=(2, 40), cell="quad4"),
    }
    flat = {
        "shaft": rectangle(x=(0, 10), y=(0, 5), cells=(4, 2), cell="quad4"),
        "bush": rectangle(x=(0, 10), y=(5, 7), cells=(40, 2), cell="quad4"),
    }
    assert [f.bodies[0] for f in abut.find_contacts(join(round_))] == ["shaft"]
    assert [f.bodies[0] for f in abut.find_contacts(join(flat))] == ["shaft"]


def test_thin_plates_hide_what_is_behind_them() -> None:
    """Within reach of each other, but with a plate (or their own thickness) in between: no pair."""
    mesh = join(
        {
            "a": rectangle(x=(0, 10), y=(0, 5), cells=(2, 2)),
            "thin": rectangle(x=(0, 10), y=(5, 5.3), cells=(3, 1)),
            "c": rectangle(x=(0, 10), y=(5.3, 5.5), cells=(2, 1)),
        }
    )
    every = outside(mesh, list(mesh.bodies))
    seen = facing(every, None)
    assert set(zip(every.body[seen.one].tolist(), every.body[seen.other].tolist())) == {(0, 1), (1, 2)}
    assert np.abs(seen.gap).max() < 1e-12
    found = abut.find_contacts(mesh)
    assert {f.bodies for f in found} == {("a", "thin"), ("c", "thin")}
    assert all(len(f.contactor_facets) == 2 and len(f.target_facets) == 3 for f in found)


def test_patches_apart_are_pairs_of_their_own() -> None:
    """A bridge with two feet on a plate."""
    feet = {f"foot{i}": rectangle(x=x, y=(1, 2), cells=(2, 2)) for i, x in enumerate([(0, 1), (5, 6)])}
    joined = join({"plate": rectangle(x=(0, 6), y=(0, 1), cells=(24, 2)), **feet})
    bridge = np.concatenate([joined.bodies["foot0"], joined.bodies["foot1"]])
    mesh = replace(joined, bodies={"plate": joined.bodies["plate"], "bridge": bridge})
    found = abut.find_contacts(mesh)
    assert [f.contactor for f in found] == ["auto:bridge-plate", "auto:bridge-plate:2"]
    assert [f.contact().name for f in found] == ["bridge-plate", "bridge-plate:2"]
    assert rows(found[0].contactor_facets) | rows(found[1].contactor_facets) == rows(
        np.concatenate([mesh.surfaces["foot0.bottom"], mesh.surfaces["foot1.bottom"]])
    )


def test_facets_may_belong_to_several_pairs() -> None:
    """Two hard blocks on a soft plate, one facet of which lies under both: it is the contactor's in both pairs, and a
    model made of what is found is accepted."""
    mesh = join(
        {
            "plate": box(x=(0, 10), y=(0, 4), z=(0, 2), cells=(3, 2, 2)),
            "a": box(x=(0, 4.8), y=(0, 4), z=(2, 3), cells=(4, 3, 1)),
            "b": box(x=(5.2, 10), y=(0, 4), z=(2, 3), cells=(4, 3, 1)),
        }
    )
    solids = [abut.Solid("plate", RUBBER), abut.Solid("a", STEEL), abut.Solid("b", STEEL)]
    found = abut.find_contacts(mesh, solids)
    on_plate = [f for f in found if "plate" in f.bodies]
    assert {f.bodies for f in on_plate} == {("plate", "a"), ("plate", "b")}
    assert all(f.reason == "softer" for f in on_plate)
    own = [rows(f.contactor_facets) for f in on_plate]
    assert len(own[0] & own[1]) > 0
    abut.Model(abut.add_surfaces(mesh, found), solids, contacts=[f.contact() for f in found])


@pytest.mark.long
def test_hertz_found_by_itself() -> None:
    """The found pair gives the force and the pressure of the named one (the area of contact lies inside both)."""
    model = load_job(EXAMPLES / "hertz-line" / "quad8.toml").model
    named = model.contacts[0]
    (found,) = abut.find_contacts(model.mesh, model.solids)
    contact = found.contact(pressure=named.pressure, law=named.law)
    auto = replace(model, mesh=abut.add_surfaces(model.mesh, [found]), contacts=[contact])
    a, b = abut.solve(auto).contacts[0], abut.solve(model).contacts[0]
    assert np.linalg.norm(a.force) == pytest.approx(np.linalg.norm(b.force), rel=1e-9)
    assert a.max_pressure == pytest.approx(b.max_pressure, rel=0.02)


def test_auto_in_a_job(tmp_path: Path) -> None:
    """One note says what was chosen; written out, the job gives the same run to the last bit."""
    path, written = tmp_path / "job.toml", tmp_path / "pairs.toml"
    entry = "auto = true\nreach = 1.0\n[contacts.integration]\npoints = 3\n\n# what follows\n[solve]\nsteps = 2\n"
    path.write_text(AUTO.replace("auto = true", entry))
    job = load_job(path)
    assert "'auto:lower-upper' (36 facets, contactor: coarser) faces" in job.notes[0]
    write_pairs(job, written)
    text = written.read_text()
    assert 'contactor = "auto:lower-upper"' in text
    assert "auto = true" not in text
    assert "reach = 1.0" in text
    assert "\n# what follows\n[solve]\n" in text
    again = load_job(written)
    assert again.model.contacts == job.model.contacts
    assert np.array_equal(abut.solve(again.model).displacement, abut.solve(job.model).displacement)


# fmt: off
BAD = {
    "surface with auto": (AUTO + 'target = "lower.top"\n', "contacts[0].target: auto = true finds both"),
    "no surface": (TEXT.replace('target = "lower.top"', ""), "contacts[0].target: missing"),
    "reach without auto": (TEXT + "reach = 1.0\n", "bodies and reach are for auto"),
    "nothing there": (AUTO.replace("z = [10, 15]", "z = [30, 35]"), "no two bodies face each other within reach"),
    "unknown body": (AUTO + 'bodies = ["upper", "lowr"]\n', "did you mean 'lower'?"),
    "unknown pair": (TEXT.replace('"lower.top"', '"auto:lower-uper"'), "did you mean 'auto:lower-upper'?"),
}
# fmt: on


@pytest.mark.parametrize("case", BAD)
def test_bad_entries(case: str, tmp_path: Path) -> None:
    text, message = BAD[case]
    (tmp_path / "job.toml").write_text(text)
    with pytest.raises(InputError) as error:
        load_job(tmp_path / "job.toml")
    assert message in str(error.value)


def test_auto_leaves_named_pairs_alone(tmp_path: Path) -> None:
    path = tmp_path / "job.toml"
    path.write_text(TEXT + "\n[[contacts]]\nauto = true\n")
    with pytest.raises(InputError, match="other than those of other entries"):
        load_job(path)
