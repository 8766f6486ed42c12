"""Restart files: the state of each converged step, and a check that the model is still the same."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import abut
from abut.contact.slip_points import Past, SlipPoints
from abut.errors import InputError
from abut.io.atomic import make_directory, write_file
from abut.io.names import is_file
from abut.model import Model
from abut.model.rates import Rates
from abut.solution import History, Iteration, Largest, Saved, SavedPart, State
from abut.solution.state import CLOSED, OPEN, SLIPPING, ContactHistory

FOLDER = "restart"
SCHEMA = 5  # of the files
ARRAYS = ("unknowns", "multipliers", "status")  # of the state
HISTORY, CONTACT, DRAG = "history.", "contact.", "drag"  # what the names of the other ones begin with, or are
RATES = ("velocities", "accelerations")  # with a time integration
MOVED = "displacement"  # of all points
FIELDS = ("slips", "inner", "following", "fit", "began")  # of a contact's history
COUNTS, SIZES = ("step", "iteration", "active", "changed"), ("residual", "contact_residual", "penetration", "seconds")
NAMED = 4  # differences of a changed model that the message lists


def description(model: Model) -> dict[str, str]:
    """Everything that decides a model's solution, leaf by leaf: "supports[1].z" -> "-0.02"; of arrays a hash.

    How it is solved (``Model.solve``) and what is read from it (``Model.probes``) are left out. Functions of position
    cannot be compared: only that there is one.
    """
    fields = [f.name for f in dataclasses.fields(model) if f.name not in ("solve", "probes")]
    return dict(leaf for name in fields for leaf in _leaves(getattr(model, name), name))


def _leaves(value: object, name: str) -> Iterator[tuple[str, str]]:
    if isinstance(value, np.ndarray):
        digest = hashlib.sha256(np.ascontiguousarray(value).tobytes()).hexdigest()[:32]
        yield name, f"{value.dtype} {value.shape} {digest}"
    elif dataclasses.is_dataclass(value):
        yield name, type(value).__name__
        for field in dataclasses.fields(value):
            if not field.metadata.get("decides", True):
                continue
            yield from _leaves(getattr(value, field.name), f"{name}.{field.name}")
    elif isinstance(value, Mapping):
        for key, item in value.items():
            yield from _leaves(item, f"{name}.{key}")
    elif isinstance(value, (list, tuple)):
        for i, item in enumerate(value):
            yield from _leaves(item, f"{name}[{i}]")
    elif callable(value):
        yield name, "a function"
    else:
        yield name, repr(value)


def save_step(directory: Path, model: Mapping[str, str], saved: Saved) -> None:
    """Write the record of one step; ``model``: its description. Raises InputError where that is not possible."""
    folder = directory / FOLDER
    make_directory(folder)
    head = {
        "schema": SCHEMA,
        "abut": abut.__version__,
        "number": saved.number,
        "linear": saved.linear,
        "iterations": [vars(row) for row in saved.iterations],
        "parts": [part.iterations for part in saved.parts],
        "model": dict(model),
    }
    arrays = _arrays(saved, "")
    for i, part in enumerate(saved.parts):
        arrays |= _arrays(part, f"part{i}.")

    def write(temporary: Path) -> None:
        with open(temporary, "wb") as file:  # not a name: NumPy would add an ending to it
            np.savez(file, head=np.array(json.dumps(head)), **arrays)

    write_file(folder / f"{saved.number:04d}.npz", write)


def _arrays(saved: Saved | SavedPart, of: str) -> dict[str, Any]:
    """A state, where "dual-P1" has ordinary functions, and displacements, by name; of: what the names begin with."""
    state = saved.state
    arrays = {of + name: getattr(state, name) for name in ARRAYS}
    arrays |= {of + HISTORY + name: values for name, values in state.history.arrays.items()}
    for name, contact in state.history.contacts.items():
        parts: dict[str, Any] = {field: getattr(contact, field) for field in (*FIELDS, "landed")}
        if contact.past is not None:
            parts |= {"points": contact.past.points.array, "shift": contact.past.shift}
        arrays |= {f"{of}{CONTACT}{part}.{name}": np.asarray(v) for part, v in parts.items() if v is not None}
    if state.history.drag is not None:
        arrays[of + DRAG] = state.history.drag
    if state.rates is not None:
        arrays |= {of + name: getattr(state.rates, name) for name in RATES}
    if saved.displacement is not None:
        arrays[of + MOVED] = saved.displacement
    largest = np.array([state.largest.force, state.largest.pressure])
    return {**arrays, of + "inside": saved.inside, of + "time": np.array(state.time), of + "largest": largest}


def _state(data: Mapping[str, Any], names: Sequence[str], of: str) -> tuple[State, NDArray[np.bool_]]:
    """The same from arrays by name. Raises ValueError where they are none of a state."""
    history = {name.removeprefix(of + HISTORY): data[name] for name in names if name.startswith(of + HISTORY)}
    arrays = {name: data[of + name] for name in ARRAYS}
    time, largest, inside = float(data[of + "time"]), data[of + "largest"], data[of + "inside"]
    unknowns, multipliers, status = arrays.values()
    sound = all(values.dtype == float and np.isfinite(values).all() for values in (unknowns, multipliers, largest))
    if not (sound and status.dtype == np.int8 and np.isin(status, (OPEN, CLOSED, SLIPPING)).all()):
        raise ValueError("not the arrays of a state")
    if not (unknowns.ndim == 1 and multipliers.shape == status.shape == inside.shape == (len(status),)):
        raise ValueError("not the arrays of a state")
    if not (inside.dtype == bool and 0.0 < time <= 1.0):
        raise ValueError("not the arrays of a state")
    drag = data[of + DRAG] if of + DRAG in names else None
    whole = History(history, _contacts(data, names, of + CONTACT), drag)
    rates = Rates(*(data[of + name] for name in RATES)) if of + RATES[0] in names else None
    return State(time, **arrays, history=whole, largest=Largest(*map(float, largest)), rates=rates), inside


def _displacement(data: Mapping[str, Any], of: str) -> NDArray[np.float64] | None:
    """Of all points, None without. Raises ValueError for anything else."""
    if of + MOVED not in data:
        return None
    values = data[of + MOVED]
    if values.dtype != float or values.ndim != 1 or not np.isfinite(values).all():
        raise ValueError("not displacements")
    return np.asarray(values)


def _contacts(data: Mapping[str, Any], names: Sequence[str], of: str) -> dict[str, ContactHistory]:
    """What contacts remember, from arrays by name. Raises any exception where they are none of a contact."""
    parts: dict[str, dict[str, Any]] = {}
    for key in names:
        if key.startswith(of):
            field, _, name = key.removeprefix(of).partition(".")
            parts.setdefault(name, {})[field] = data[key]
    result = {}
    for name, found in parts.items():
        past = Past(SlipPoints.from_array(found["points"]), found["shift"]) if "points" in found else None
        unsure, limit = map(float, found["landed"]) if "landed" in found else (0.0, 0.0)
        known = {field: found[field] for field in FIELDS if field in found}
        result[name] = ContactHistory(past=past, landed=(unsure, limit) if "landed" in found else None, **known)
    return result


def load_steps(directory: Path, model: Mapping[str, str]) -> list[Saved]:
    """The records of steps 1, 2, ... as far as they go. Raises InputError where there are none, where one is damaged, or
    where it belongs to another model than the one described."""
    found = read_steps(directory)
    if not found:
        raise InputError(
            f"nothing to go on with in {directory}: it has no restart data, because a run there has finished, or none has "
            "got past its first step; run the job without --restart"
        )
    for _, before in found:
        if changes := differences(before, model):
            raise InputError(
                f"the model is not the one whose steps are in {directory / FOLDER}:{listed(changes)}\nundo the change, or "
                "run the job without --restart"
            )
    return [saved for saved, _ in found]


def read_steps(directory: Path) -> list[tuple[Saved, dict[str, str]]]:
    """The records of steps 1, 2, ... as far as they go, each with the description of its model. Raises InputError where one
    is damaged or of another version."""
    found: list[tuple[Saved, dict[str, str]]] = []
    while is_file(path := directory / FOLDER / f"{len(found) + 1:04d}.npz"):
        found.append(_sound(path, len(found) + 1))
    return found


def listed(changes: Sequence[str]) -> str:
    """The first of the differences between two models, a line each."""
    more = f"\n  and {len(changes) - NAMED} more" if len(changes) > NAMED else ""
    return "".join(f"\n  {change}" for change in changes[:NAMED]) + more


def _sound(path: Path, number: int) -> tuple[Saved, dict[str, str]]:
    """The record of a step from its file, and the description of its model."""
    try:
        saved, version, before = _read(path)
        if saved.number != number:
            raise ValueError("the record of another step")
    except Exception:  # zipfile, tokenize, json and NumPy each have errors of their own for what no run has written
        raise InputError(
            f"{path}: not a whole restart file; remove it and the later ones, and the run goes on from the step before"
        ) from None
    if version != abut.__version__:
        raise InputError(
            f"{path}: written by abut {version}, this is {abut.__version__}; run the job that wrote it again, without "
            "--restart"
        )
    return saved, before


def _read(path: Path) -> tuple[Saved, str, dict[str, str]]:
    """What a file holds: the record, the version that wrote it, the description of its model. Raises any exception where it
    is no restart file."""
    with np.load(path, allow_pickle=False) as data:
        head = json.loads(str(data["head"]))
        state, inside = _state(data, data.files, "")
        parts = [(*_state(data, data.files, f"part{i}."), count) for i, count in enumerate(head["parts"])]
        moved = [_displacement(data, of) for of in ("", *(f"part{i}." for i in range(len(parts))))]
    rows = tuple(Iteration(**row) for row in head["iterations"])
    texts = [head["abut"], head["linear"], *head["model"].keys(), *head["model"].values()]
    if type(head["schema"]) is not int or head["schema"] != SCHEMA:
        raise ValueError("not a file of this form")
    counts = [head["number"], *head["parts"], *(getattr(row, name) for row in rows for name in COUNTS)]
    sizes = [getattr(row, name) for row in rows for name in SIZES]
    if not (rows and all(type(text) is str for text in texts) and all(type(n) is int and n >= 0 for n in counts)):
        raise ValueError("not the head of a record")
    if not all(type(size) in (int, float) for size in sizes):
        raise ValueError("not the head of a record")
    earlier = tuple(SavedPart(*part, here) for part, here in zip(parts, moved[1:]))
    saved = Saved(head["number"], state, inside, head["linear"], rows, earlier, displacement=moved[0])
    return saved, head["abut"], head["model"]


def differences(before: Mapping[str, str], now: Mapping[str, str]) -> list[str]:
    """What differs between two descriptions, in words."""
    result = []
    for name in [*before, *(name for name in now if name not in before)]:
        old, new = before.get(name), now.get(name)
        if old == new:
            continue
        if old is None or new is None:
            parent = name.rpartition(".")[0]
            if parent and (before.get(parent) is None) == (old is None) and (now.get(parent) is None) == (new is None):
                continue  # the record it belongs to has been named already
            result.append(f"{name}: {'new' if old is None else 'gone'}")
        elif name.startswith("mesh."):
            result.append(f"{name}: changed")
        else:
            result.append(f"{name}: was {old}, is {new}")
    return result


def clear(directory: Path) -> None:
    """Remove all restart files, the last first: what is left at any moment still belongs together."""
    folder = directory / FOLDER
    if not folder.is_dir():
        return
    for path in sorted(folder.glob("[0-9]*.npz"), key=lambda p: (len(p.name), p.name), reverse=True):
        path.unlink()
    if not any(folder.iterdir()):
        folder.rmdir()


def last(steps: Sequence[Saved]) -> str:
    """Where a restart goes on, in words."""
    return f"going on after step {steps[-1].number} ({100.0 * steps[-1].state.time:.4g} % of the load)"
