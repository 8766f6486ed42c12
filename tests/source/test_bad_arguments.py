"""Whatever public names are called with: one message, that of abut, or Python's own about the call itself."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import abut
from abut.mesh import make

BARE = (AttributeError, KeyError, IndexError, TypeError, ValueError)
NOTHING = (None, 3, "", 3.5, [], {})  # what a user may have in a variable that should hold something else
ERRORS = {name for name in abut.__all__ if isinstance(getattr(abut, name), type) and "Error" in name}
RESULTS = {
    "BeamForces",
    "FoundContact",
    "LoadFactor",
    "MidSurface",
    "ResultField",
    "Sectors",
    "Solution",
    "Stopped",
    "Thick",
}  # abut makes these
LISTS = (
    "solids", "supports", "loads", "contacts", "equations", "rigid", "probes", "rotations", "couplings", "preloads",
    "springs", "holds", "penetrations", "connectors",
)  # fmt: skip

BLOCKS = {"a": make.rectangle([0, 2], [0, 1], cells=[2, 1]), "b": make.rectangle([0, 2], [1, 2], cells=[2, 1])}
MESH = make.join(BLOCKS)
STEEL = abut.LinearElastic(100.0, 0.3)
MODEL = abut.Model(
    MESH,
    [abut.Solid("a", STEEL), abut.Solid("b", STEEL)],
    supports=[abut.Support("a.bottom", x=0, y=0), abut.Support("b.left", x=0)],
    loads=[abut.Pressure("b.top", 1.0)],
    contacts=[abut.Contact("b.bottom", "a.top", name="c")],
    plane="strain",
)


def within(name: str) -> Callable[[Any], object]:
    """Puts a record into a list of a model."""
    return lambda record: replace(MODEL, **{name: [*getattr(MODEL, name), record]})


def beside_frequencies(record: object) -> object:
    return replace(MODEL, modes=[abut.Frequencies(1), record])


def kept(record: object) -> object:
    return record


VALID: dict[str, tuple[dict[str, Any], Callable[[Any], object]]] = {  # arguments, and what uses the record
    "Amplitude": ({"points": [(0, 0), (1, 1)]}, lambda a: within("loads")(abut.Pressure("b.right", 1.0, amplitude=a))),
    "Anisotropic": ({"constants": np.eye(6)[np.triu_indices(6)]}, kept),
    "ArrudaBoyce": ({"bulk": 100.0, "shear": 1.0, "locking": 3.0}, kept),
    "Beam": ({"widths": (1.0, 2.0)}, kept),
    "MidForce": ({"on": "a", "value": (1.0, 0.0, 0.0)}, kept),
    "MidSupport": ({"on": "a", "x": 0.0}, kept),
    "Shell": ({"thickness": 1.0}, kept),
    "thicken": ({"path": "none.msh", "sections": {"a": abut.Shell(1.0)}}, kept),
    "Axes": ({"kind": "cylindrical"}, lambda axes: within("supports")(abut.Support("a.left", x=0, axes=axes))),
    "BodyForce": ({"value": (1.0, 0.0)}, within("loads")),
    "Centrifugal": ({"speed": 1.0}, within("loads")),
    "Contact": ({"first": "b.bottom", "second": "a.top"}, lambda contact: replace(MODEL, contacts=[contact])),
    "Coupling": ({"name": "c", "on": "b.right"}, within("couplings")),
    "Equation": ({"terms": [abut.Term(0, "y", 1.0)]}, within("equations")),
    "Force": ({"on": "b.right", "value": (1.0, 0.0)}, within("loads")),
    "Gravity": ({"value": (1.0, 0.0)}, within("loads")),
    "Hold": ({"on": "b.right", "x": 0.0}, within("holds")),
    "Removal": ({"body": "b", "until": 0.5}, within("removals")),
    "Hencky": ({"young": 1.0, "poisson": 0.3}, kept),
    "Integration": ({}, kept),
    "LinearElastic": ({"young": 1.0, "poisson": 0.3}, kept),
    "MFront": ({"library": "none.so", "behaviour": "Metal"}, kept),
    "Mesh": ({"points": MESH.points, "blocks": MESH.blocks, "bodies": MESH.bodies}, kept),
    "Model": ({"mesh": MESH, "solids": MODEL.solids, "plane": "strain"}, kept),
    "Moment": ({"on": "b.right", "value": 1.0}, within("loads")),
    "MooneyRivlin": ({"bulk": 100.0, "c10": 1.0, "c01": 1.0}, kept),
    "NeoHooke": ({"young": 1.0, "poisson": 0.3}, kept),
    "NodalForce": ({"on": "b.right", "value": (1.0, 0.0)}, within("loads")),
    "Ogden": ({"bulk": 100.0, "terms": [(1.0, 2.0)]}, kept),
    "Orthotropic": ({"young": [1.0, 2.0, 3.0], "poisson": [0.1, 0.1, 0.1], "shear": [1.0, 1.0, 1.0]}, kept),
    "Output": ({}, kept),
    "OverTemperature": ({"temperatures": [0.0, 1.0], "materials": [STEEL, STEEL], "initial_temperature": 0.0}, kept),
    "Plastic": ({"young": 1.0, "poisson": 0.3, "yield_stress": 1.0}, kept),
    "Penetration": ({"contact": "c", "source": "a.top", "value": 1.0}, within("penetrations")),
    "Preload": ({"name": "p", "surface": "b.left", "force": 1.0}, within("preloads")),
    "Pressure": ({"on": "b.right", "value": 1.0}, within("loads")),
    "Connector": ({"name": "c", "kind": "hinge", "on": "a"}, kept),
    "PressureOverclosure": ({"points": [(0, 0), (1, 1)]}, kept),
    "Probe": ({"name": "p", "at": (0.0, 0.0)}, within("probes")),
    "Rigid": ({"body": "a"}, within("rigid")),
    "Rotation": ({"on": "b.left", "angle": 1.0, "centre": (0.0, 0.0)}, within("rotations")),
    "Solid": ({"body": "a", "material": STEEL}, kept),
    "Frequencies": ({"count": 1}, within("modes")),
    "Buckling": ({"count": 1}, within("modes")),
    "Harmonic": ({"between": (1.0, 2.0), "loads": [abut.Force("b.right", (1.0, 0.0))], "damping": 0.1}, beside_frequencies),
    "Transient": ({"period": 1.0, "loads": [abut.Force("b.right", (1.0, 0.0))]}, beside_frequencies),
    "SolveOptions": ({}, lambda solve: replace(MODEL, solve=solve)),
    "Spring": ({"name": "s", "on": "b.right", "x": 1.0}, within("springs")),
    "Sector": (
        {"side": "b.left", "other": "b.right", "sectors": 3}, lambda sector: abut.add_sectors(MESH, [sector]),
    ),
    "add_sectors": ({"mesh": MESH, "sectors": [abut.Sector("b.left", "b.right", 3)]}, kept),
    "Stop": ({"on": "b.right", "direction": (1.0, 0.0)}, lambda stop: abut.add_stops(MESH, [stop])),
    "Support": ({"on": "b.right", "x": 0.0}, within("supports")),
    "Temperature": ({"on": "b", "value": 1.0}, within("loads")),
    "Term": ({"on": 0, "component": "x", "coefficient": 1.0}, lambda term: within("equations")(abut.Equation([term]))),
    "Traction": ({"on": "b.right", "value": (1.0, 0.0)}, within("loads")),
    "Viscoelastic": ({"material": STEEL, "terms": [(0.5, 0.0, 1.0)]}, kept),
    "Yeoh": ({"bulk": 100.0, "c10": 1.0}, kept),
    "add_stops": ({"mesh": MESH, "stops": [abut.Stop("b.right", (1.0, 0.0))]}, kept),
    "add_surfaces": ({"mesh": MESH, "found": ()}, kept),
    "check": ({"model": MODEL}, kept),
    "find_contacts": ({"mesh": MESH}, kept),
    "result_field": ({"path": "none.vtu", "array": "T"}, kept),
    "from_meshio": ({"mesh": SimpleNamespace(points=MESH.points, cells=[("quad", b.nodes) for b in MESH.blocks])}, kept),
}  # fmt: skip
OF_SOLUTIONS = {
    "beam_forces",
    "load_factors",
    "mid_surface",
    "plot",
    "solve",
    "to_pyvista",
    "write",
    "write_report",
}  # whose other arguments take a solution


def sound(call: Callable[[], object], what: str) -> None:
    """A call may succeed, or fail with a message of abut's."""
    try:
        call()
    except abut.AbutError:
        return
    except BARE as error:
        pytest.fail(f"{what} ends in {type(error).__name__}: {error}")


def test_every_public_name_is_called() -> None:
    assert {*VALID, *OF_SOLUTIONS, *ERRORS, *RESULTS} == set(abut.__all__)


@pytest.mark.parametrize("name", sorted({*VALID, *OF_SOLUTIONS}))
def test_first_arguments_that_are_none(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All that must be given at once."""
    monkeypatch.chdir(tmp_path)
    call = getattr(abut, name)
    needed = [key for key, p in inspect.signature(call).parameters.items() if p.default is p.empty]
    for value in NOTHING:
        sound(lambda v=value: call(**dict.fromkeys(needed, v)), f"abut.{name}({', '.join(needed)} = {value!r})")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", sorted(VALID))
def test_each_argument_that_is_none(name: str) -> None:
    """One at a time, in a model where that is where it goes."""
    given, use = VALID[name]
    for key in inspect.signature(getattr(abut, name)).parameters:
        for value in NOTHING:
            sound(
                lambda k=key, v=value: use(getattr(abut, name)(**{**given, k: v})), f"abut.{name}(..., {key}={value!r})"
            )


@pytest.mark.parametrize("name", LISTS)
def test_records_in_the_wrong_list(name: str) -> None:
    """Such as a support among the loads: says which entry, and what belongs there."""
    for value in (None, 3, "x", [], abut.Probe("p", at=(0.0, 0.0)), abut.Support("a.left", x=0)):
        if (name, type(value)) in (("probes", abut.Probe), ("supports", abut.Support)):
            continue
        with pytest.raises(abut.InputError, match=rf"^{name}\[\d\]: expected \w+"):
            within(name)(value)


@pytest.mark.parametrize("value", [None, 3, "", b"mesh.msh"])
def test_paths_that_are_none(value: Any) -> None:
    solution = abut.solve(MODEL)
    with pytest.raises(abut.InputError, match=r"Mesh\.read: path: expected a path"):
        abut.Mesh.read(value)
    with pytest.raises(abut.InputError, match="write: directory: expected a path"):
        abut.write(solution, value)
    with pytest.raises(abut.InputError, match="write_report: path: expected a path"):
        abut.write_report(solution, value)


@pytest.mark.parametrize("value", [3, "", [], {}])
def test_options_of_functions_that_are_none(value: Any, tmp_path: Path) -> None:
    for key in ("observer", "on_step", "resume", "settings"):
        sound(lambda k=key: abut.solve(MODEL, **{k: value}), f"abut.solve(model, {key}={value!r})")
    solution = abut.solve(MODEL)
    for key in ("origin", "steps", "fields", "output"):
        sound(lambda k=key: abut.write(solution, tmp_path, **{k: value}), f"abut.write(..., {key}={value!r})")
    path = tmp_path / "report.html"
    for key in ("origin", "beside"):
        sound(lambda k=key: abut.write_report(solution, path, **{k: value}), f"abut.write_report(..., {key}={value!r})")
