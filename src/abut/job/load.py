"""Load a job: read, validate (every problem with its place), build the mesh and the model."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from abut.contact.overclosure import PressureOverclosure
from abut.errors import InputError, nearest
from abut.io.toml import read_toml
from abut.job.acting import acting, parts
from abut.job.contacts import Resolved, resolve_contacts
from abut.job.load_tables import LOADS
from abut.job.material_tables import MATERIALS
from abut.job.materials import materials_of
from abut.job.other_names import key_called, kind_said
from abut.job.parameters import field_names, parameters, worked_out
from abut.job.result_fields import Named, read_fields, told, with_fields
from abut.job.schema import EquationTable, JobFile, MeshTable, OverclosureTable
from abut.job.solid_bodies import solid_bodies
from abut.job.start import Start
from abut.job.thin import with_thin
from abut.job.times import with_shares
from abut.job.values import values
from abut.mesh import make
from abut.mesh.check import check_mesh
from abut.mesh.mesh import Mesh
from abut.model import (
    Buckling,
    Connector,
    Coupling,
    Equation,
    Frequencies,
    Harmonic,
    Hold,
    Load,
    Model,
    Penetration,
    Preload,
    Probe,
    Removal,
    Rigid,
    Rotation,
    Solid,
    SolveOptions,
    Spring,
    Support,
    Term,
    Transient,
)
from abut.model.conditions import TURNS
from abut.model.response import Response
from abut.model.sector import Sector, add_sectors
from abut.model.stop import Stop, add_stops
from abut.output.options import Output
from abut.types import Json

GENERATORS: Mapping[str, Callable[..., Mesh]] = {
    name.replace("_", "-"): getattr(make, name) for name in make.__all__ if name != "join"
}

# pydantic's names for one of several types that a value may have
CHOICES = ("str", "int", "float", OverclosureTable.__name__)
ALTERNATIVES = ("list[", "literal[", "function-before[")
DECK = ".inp"
TABLES = ("model_type", "model_attributes_type", "dict_type")  # what pydantic calls the want of one


@dataclass(frozen=True)
class Job:
    """A loaded job: the model, where its results go, the file and its text; notes: what was found and chosen, or
    replaced in a deck; ignored: what the user had omitted from a deck; own_laws: of a deck's contacts, by name, which exact
    contact may replace; output: which VTU files are written; parameters: as they were used; start: where the job
    starts from."""

    model: Model
    directory: Path
    path: Path
    text: str
    notes: tuple[str, ...] = ()
    entries: tuple[int, ...] = ()  # which [[contacts]] each contact of the model comes from
    ignored: tuple[str, ...] = ()
    own_laws: Mapping[str, PressureOverclosure] = field(default_factory=dict)
    output: Output = field(default_factory=Output)
    parameters: Mapping[str, float] = field(default_factory=dict)
    start: Start | None = None


def load_job(
    path: str | Path, refine: int = 0, ignore: Collection[str] = (), soft: bool = False,
    settings: Mapping[str, float | str] | None = None,
) -> Job:  # fmt: skip
    """Read a job file, or an Abaqus or CalculiX deck (.inp). Raises InputError that lists every problem with its place.

    refine: how often to halve the cells of the meshes that abut makes (InputError for meshes from a file).
    ignore: cards and parameters of a deck to leave out although they change the result. soft: contact with a deck's own
    pressures over overclosure, not exact. settings: parameters in place of the file's."""
    path = Path(path)
    if path.suffix.lower() == DECK:
        if settings:
            raise InputError(f"{path}: --set is for job files with [parameters]; a deck has none")
        return _deck(path, refine, ignore, soft)
    if soft:
        raise InputError(f"{path}: --soft-contact is for decks ({DECK}); give the law of each contact in the job file")
    if ignore:
        raise InputError(f"{path}: --ignore is for decks ({DECK}); a job file has no cards")
    text, data = read_toml(path)
    if data.get("schema") != 1:
        raise InputError(f"{path}: schema: expected 1, got {data.get('schema')!r}; begin the file with 'schema = 1'")
    try:
        names = parameters(data, settings or {})
        shares = with_shares(worked_out(data, names))
        file = JobFile.model_validate(shares, context=field_names(data))
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    except ValidationError as error:
        problems = "\n  ".join(_explain(dict(e), data) for e in error.errors())
        raise InputError(f"{path}:\n  {problems}") from None
    try:
        named = read_fields(file.fields, names, path.parent, path.parent / file.output.directory)
        model, resolved = _model(file, path.parent, refine, named)
        table = file.output
        output = Output(table.steps, tuple(table.fields), tuple(table.formats), table.compression, table.restart)
    except InputError as error:
        raise InputError(f"{path}: {error}") from None
    said = [
        f"parameter {name} = {value:g}{' (set)' if name in (settings or {}) else ''}" for name, value in names.items()
    ]
    start = None if file.start is None else Start(path.parent / file.start.results, float(file.start.time))
    steps = acting(model, parts(file.steps, model.solve.end)) if file.steps else ()
    if start is not None:
        steps = (f"starts from the steps in {start.results}, up to time {model.solve.said(start.share)}", *steps)
    notes = (*said, *told(named), *model.mesh.notes, *resolved.notes, *steps)
    return Job(
        model,
        path.parent / file.output.directory,
        path,
        text,
        notes,
        resolved.entries,
        output=output,
        parameters=names,
        start=start,
    )


def _deck(path: Path, refine: int, ignore: Collection[str], soft: bool) -> Job:
    from abut.decks.translation import load_deck

    if refine:
        raise InputError(f"{path}: only meshes that abut makes can be refined; leave --levels out")
    deck = load_deck(path, ignore, soft)
    return Job(
        deck.model,
        path.parent / f"{path.stem}-results",
        path,
        "",
        deck.notes,
        ignored=deck.ignored,
        own_laws=deck.own_laws,
        output=deck.output,
    )


def _model(file: JobFile, folder: Path, refine: int, named: Named) -> tuple[Model, Resolved]:
    materials = materials_of(file.materials, folder)
    thin = with_thin(file, folder, _mesh(file.mesh, folder, refine))
    solids = []
    for i, s, body in solid_bodies(file, thin.thick.mesh):
        if s.material not in materials:
            raise InputError(f"solids[{i}].material: no material named {s.material!r}{nearest(s.material, materials)}")
        how = thin.integration(body, s.integration)
        given = with_fields(values(s, f"solids[{i}]", ("body", "material", "integration")), named, f"solids[{i}]")
        solids.append(Solid(body, materials[s.material], integration=how, **given))
    resolved = resolve_contacts(file.contacts, thin.thick.mesh, solids, file.model.kinematics == "finite")
    stops = [Stop(**values(s, f"stops[{i}]")) for i, s in enumerate(file.stops)]
    stopped = add_stops(resolved.mesh, stops, file.model.plane)
    sectors = add_sectors(stopped.mesh, [Sector(**values(s, f"sectors[{i}]")) for i, s in enumerate(file.sectors)])
    model = Model(
        mesh=sectors.mesh,
        plane=file.model.plane,
        kinematics=file.model.kinematics,
        solids=solids,
        supports=[
            *(
                Support(**with_fields(values(s, f"supports[{i}]", TURNS), named, f"supports[{i}]"))
                for i, s in enumerate(file.supports)
                if i not in thin.supports
            ),
            *thin.thick.supports,
        ],
        loads=[
            *(_load(load, f"loads[{i}]", named) for i, load in enumerate(file.loads) if i not in thin.loads),
            *thin.thick.loads,
        ],
        contacts=[*resolved.contacts, *stopped.contacts],
        solve=SolveOptions(**file.solve.model_dump()),
        times_in_shares=True,
        equations=[
            *(_equation(equation, f"equations[{i}]") for i, equation in enumerate(file.equations)),
            *sectors.equations,
            *thin.thick.equations,
        ],
        rigid=[*(Rigid(**values(r, f"rigid[{i}]")) for i, r in enumerate(file.rigid)), *stopped.rigid],
        rotations=[Rotation(**values(r, f"rotations[{i}]")) for i, r in enumerate(file.rotations)],
        couplings=[
            *(Coupling(**values(c, f"couplings[{i}]")) for i, c in enumerate(file.couplings)),
            *thin.thick.couplings,
        ],
        connectors=[Connector(**values(c, f"connectors[{i}]")) for i, c in enumerate(file.connectors)],
        preloads=[Preload(**values(p, f"preloads[{i}]")) for i, p in enumerate(file.preloads)],
        springs=[Spring(**values(s, f"springs[{i}]")) for i, s in enumerate(file.springs)],
        holds=[Hold(**values(h, f"holds[{i}]")) for i, h in enumerate(file.holds)],
        removals=[Removal(**values(r, f"removals[{i}]")) for i, r in enumerate(file.removals)],
        penetrations=[Penetration(**values(p, f"penetrations[{i}]")) for i, p in enumerate(file.penetrations)],
        probes=[Probe(**values(probe, f"probes[{i}]")) for i, probe in enumerate(file.probes)],
        modes=[
            *([] if file.frequencies is None else [Frequencies(**file.frequencies.model_dump())]),
            *([] if file.buckling is None else [Buckling(**file.buckling.model_dump())]),
            *([] if file.harmonic is None else [_response(Harmonic, file.harmonic, "harmonic", named)]),
            *([] if file.transient is None else [_response(Transient, file.transient, "transient", named)]),
        ],
    )
    return model, resolved


def _response(kind: Callable[..., Response], table: Any, where: str, named: Named) -> Response:
    given = table.model_dump()
    for name in ("loads", "imaginary"):
        if name in given:
            given[name] = [_load(load, f"{where}.{name}[{i}]", named) for i, load in enumerate(getattr(table, name))]
    return kind(**given)


def _equation(table: EquationTable, where: str) -> Equation:
    try:
        terms = tuple(Term(**term.model_dump()) for term in table.terms)
        return Equation(**{**values(table, where), "terms": terms})
    except InputError as error:
        raise InputError(str(error) if str(error).startswith(where) else f"{where}: {error}") from None


def _load(table: BaseModel, where: str, named: Named) -> Load:
    given = with_fields(values(table, where, ("moment",)), named, where)
    made: Load = LOADS[given.pop("kind")](**given)
    return made


def _mesh(table: MeshTable, folder: Path, refine: int) -> Mesh | None:
    """None where shells and beams are to be made solid."""
    if (table.file is None) == (not table.bodies):
        raise InputError('mesh: give either file = "..." or bodies ([mesh.bodies.NAME]), not both or neither')
    if table.file is not None:
        if refine:
            raise InputError("mesh.file: only meshes that abut makes (mesh.bodies) can be refined; leave --levels out")
        return None if table.shells or table.beams else Mesh.read(folder / table.file)
    if table.shells or table.beams:
        raise InputError("mesh.shells, mesh.beams: they name groups of a mesh file; give file instead of bodies")
    meshes = {}
    for name, body in table.bodies.items():
        where = f"mesh.bodies.{name}"
        if body.kind not in GENERATORS:
            raise InputError(f"{where}.kind: no generator {body.kind!r}{nearest(body.kind, GENERATORS)}")
        generator = GENERATORS[body.kind]
        known = inspect.signature(generator).parameters
        arguments = body.model_extra or {}
        for key in arguments:
            if key not in known:
                raise InputError(f"{where}.{key}: unknown key{nearest(key, known)}")
        try:
            meshes[name] = generator(**_refined(arguments, generator, 2**refine))
        except (TypeError, ValueError) as error:
            raise InputError(f"{where}: {error}") from None
    mesh = make.join(meshes)
    check_mesh(mesh)
    return mesh


def _refined(arguments: Json, generator: Callable[..., Mesh], times: int) -> Json:
    """Arguments of a generator with ``times`` as many cells along every axis."""
    if times == 1:
        return arguments
    cells = arguments.get("cells", inspect.signature(generator).parameters["cells"].default)
    return {**arguments, "cells": cells * times if isinstance(cells, int) else [n * times for n in cells]}


def _explain(error: Json, data: Json) -> str:
    """One problem in words, with its place as in ``contacts[0].tagret``."""
    location = _location(error["loc"])
    place = ""
    for part in location:
        place += f"[{part}]" if isinstance(part, int) else f".{part}" if place else str(part)
    kind = error["type"]
    if kind == "extra_forbidden":
        return f"{place}: unknown key{_suggest(location, data)}"
    if kind == "missing":
        return f"{place}: missing"
    if kind == "union_tag_not_found":
        return f"{place}.kind: missing"
    if kind == "union_tag_invalid":
        said = kind_said(str(error["ctx"]["tag"])) if location[:1] == ["materials"] else ""
        tags, tag = error["ctx"]["expected_tags"], error["ctx"]["tag"]
        return f"{place}.kind: expected one of {tags}, got {tag!r}" + (f"; {said}" if said else "")
    if kind == "finite_number":
        return f"{place}: expected a finite number, got {error['input']!r}"
    if kind in TABLES:
        written = (
            f"{location[-1]} = {{ ... }} with its keys inside" if "[" in place else f"[{place}] with its keys below it"
        )
        return f"{place}: expected a table, {written}, got {error['input']!r}"
    if kind == "list_type" and len(location) == 1 and isinstance(error["input"], dict):
        return f"{place}: expected a list: write [[{place}]] instead of [{place}], once for each"
    return f"{place}: {error['msg'].replace('Input should be', 'expected')}, got {error['input']!r}"


def _location(given: Sequence[Any]) -> list[Any]:
    """Keys and numbers of entries as they stand in the file: without the kind of a load or a material, after its number or
    name, and without the alternatives that a value may be one of."""
    nested = 1 if given[0] in ("harmonic", "transient") else 0
    tagged = given[nested] in ("loads", "imaginary", "materials") if len(given) > nested + 2 else False
    at = nested + 2
    keys = [*given[:at], *given[at + 1 :]] if tagged and given[at] in (*LOADS, *MATERIALS) else list(given)
    return [part for part in keys if part not in CHOICES and not str(part).startswith(ALTERNATIVES)]


def _suggest(location: list[Any], data: Json) -> str:
    known = _fields(JobFile, location[:-1])
    called = key_called(str(location[-1]), known)
    if called:
        return f"; it is called '{called}' here"
    return nearest(str(location[-1]), known) if known else ""


def _fields(model: Any, location: list[Any]) -> list[str]:
    """Keys known at a place, found by walking the field annotations."""
    schema = model.model_json_schema(by_alias=True)
    node: Any = schema

    def resolve(item: Any) -> Any:
        while "$ref" in item or "$ref" in item.get("anyOf", [{}])[0]:  # anyOf: a table that may be left out
            item = item if "$ref" in item else item["anyOf"][0]
            item = schema["$defs"][item["$ref"].rsplit("/", 1)[1]]
        return item

    for part in location:
        node = resolve(node)
        if isinstance(part, int):
            node = node.get("items", {})
        else:
            node = node.get("properties", {}).get(part) or node.get("additionalProperties", {})
    node = resolve(node)
    options = [resolve(item) for item in node.get("oneOf", [])] or [node]
    return sorted({key for option in options for key in option.get("properties", {})})
