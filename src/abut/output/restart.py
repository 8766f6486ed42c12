"""Restart files: the state of each converged step, and a check that the model is still the same."""

from __future__ import annotations

import dataclasses
import hashlib
import json
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import abut
from abut.errors import InputError
from abut.io.atomic import make_directory, write_file
from abut.model import Model
from abut.solution import History, Iteration, Largest, Saved, SavedPart, State

FOLDER = "restart"
ARRAYS = ("unknowns", "multipliers", "status")  # of the state
HISTORY = "history."  # what the names of the other ones begin with
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
        "schema": 3,
        "abut": abut.__version__,
        "number": saved.number,
        "linear": saved.linear,
        "iterations": [vars(row) for row in saved.iterations],
        "parts": [part.iterations for part in saved.parts],
        "model": dict(model),
    }
    arrays = _arrays(saved.state, saved.inside, "")
    for i, part in enumerate(saved.parts):
        arrays |= _arrays(part.state, part.inside, f"part{i}.")

    def write(temporary: Path) -> None:
        with open(temporary, "wb") as file:  # not a name: NumPy would add an ending to it
            np.savez(file, head=np.array(json.dumps(head)), **arrays)

    write_file(folder / f"{saved.number:04d}.npz", write)


def _arrays(state: State, inside: NDArray[np.bool_], of: str) -> dict[str, Any]:
    """A state, and where "dual-P1" has ordinary functions, by name; of: what the names begin with."""
    arrays = {of + name: getattr(state, name) for name in ARRAYS}
    arrays |= {of + HISTORY + name: values for name, values in state.history.arrays.items()}
    largest = np.array([state.largest.force, state.largest.pressure])
    return {**arrays, of + "inside": inside, of + "time": np.array(state.time), of + "largest": largest}


def _state(data: Mapping[str, Any], names: Sequence[str], of: str) -> tuple[State, NDArray[np.bool_]]:
    """The same from arrays by name."""
    history = {name.removeprefix(of + HISTORY): data[name] for name in names if name.startswith(of + HISTORY)}
    arrays = {name: data[of + name] for name in ARRAYS}
    largest = Largest(*map(float, data[of + "largest"]))
    return State(float(data[of + "time"]), **arrays, history=History(history), largest=largest), data[of + "inside"]


def load_steps(directory: Path, model: Mapping[str, str]) -> list[Saved]:
    """The records of steps 1, 2, ... as far as they go. Raises InputError where there are none, where one is damaged, or
    where it belongs to another model than the one described."""
    steps: list[Saved] = []
    while (path := directory / FOLDER / f"{len(steps) + 1:04d}.npz").is_file():
        steps.append(_load(path, model))
    if not steps:
        raise InputError(
            f"nothing to go on with in {directory}: it has no restart data, because a run there has finished, or none has "
            "got past its first step; run the job without --restart"
        )
    return steps


def _load(path: Path, model: Mapping[str, str]) -> Saved:
    try:
        with np.load(path, allow_pickle=False) as data:
            head = json.loads(str(data["head"]))
            state, inside = _state(data, data.files, "")
            parts = [(*_state(data, data.files, f"part{i}."), count) for i, count in enumerate(head["parts"])]
            version, before = head["abut"], head["model"]
            saved = Saved(
                number=head["number"],
                state=state,
                inside=inside,
                linear=head["linear"],
                iterations=tuple(Iteration(**row) for row in head["iterations"]),
                parts=tuple(SavedPart(*part) for part in parts),
            )
    except (OSError, ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile):
        raise InputError(
            f"{path}: not a whole restart file; remove it and the later ones, and the run goes on from the step before"
        ) from None
    if version != abut.__version__:
        raise InputError(
            f"{path}: written by abut {version}, this is {abut.__version__}; run the job without --restart"
        )
    changes = differences(before, model)
    if changes:
        more = f"\n  and {len(changes) - NAMED} more" if len(changes) > NAMED else ""
        listed = "".join(f"\n  {change}" for change in changes[:NAMED])
        raise InputError(
            f"the model is not the one whose steps are in {path.parent}:{listed}{more}\nundo the change, or run the job "
            "without --restart"
        )
    return saved


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
