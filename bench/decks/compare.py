"""abut and CalculiX on the same deck, node by node.

python bench/decks/compare.py [NAME ...] [--folder FOLDER] [--small] prints a line for each contact deck of CalculiX's own
tests (Debian: apt install calculix-ccx calculix-ccx-test), or those named, which need no contact. Shells, beams and trusses
are compared at their own nodes: the mean of the solids' nodes there. With --small displacements are small in both, else as
the deck says.
"""

from __future__ import annotations

import argparse
import re
import shlex
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from cards import Card, plain, read
from frd import Displacements
from numpy.typing import NDArray

import abut
from abut.decks.expanded import expanded
from abut.decks.large import is_finite
from abut.decks.points import with_points
from abut.decks.translation import translate
from abut.errors import AbutError, ConvergenceError, InputError
from abut.io.deck import read_deck
from abut.io.deck.record import Deck
from abut.io.deck.thin_record import Thin
from abut.io.deck.time_histories import ends
from reference import EXAMPLES, PROCEDURES, TYPES, NoReference, Reference, decks, difference, reference

AGREES = 0.01  # largest difference of displacement over the largest displacement
# What abut may be told to ignore here, because the reference run leaves it out too.
IGNORABLE = (
    "NLGEOM",
    "PERTURBATION",
    *PROCEDURES,
)


@dataclass(frozen=True)
class Outcome:
    """One deck. status: "agrees", "differs", "refused" (by abut), "no reference" (CalculiX gives none), "failed" (abut
    does not solve it). difference: largest, over the largest displacement; slave: the same with the deck's slave surfaces as
    contactors, where it differs and abut chose others; detail: why, or what was left out."""

    name: str
    cells: str
    status: str
    ignored: tuple[str, ...] = ()
    largest: float = 0.0
    difference: float = float("nan")
    kind: str = ""
    detail: str = ""
    slave: float = float("nan")


def cells(cards: Sequence[Card]) -> str:
    """Elements of a deck in words: "32 C3D20R, 2 C3D8"."""
    count: Counter[str] = Counter()
    for card in cards:
        if card.name == "ELEMENT":
            wanted = _numbers(card.options.get("TYPE", "").upper())
            numbers = sum(len([x for x in line.split(",") if x.strip()]) for line in card.data)
            count[card.options.get("TYPE", "").upper()] += numbers // wanted
    return ", ".join(f"{n} {kind}" for kind, n in count.items())


def _numbers(kind: str) -> int:
    """Element number and nodes."""
    if kind == "MASS":
        return 1 + 1
    if kind.startswith(("SPRING", "GAP", "B31", "T3D2")):
        return 1 + 2
    if kind.startswith(("B32", "T3D3")):
        return 1 + 3
    return 1 + int(re.findall(r"\d+", kind)[-1])


def compare(name: str, path: Path, limit: float = 600.0, large: bool = True) -> Outcome:
    """Solve a deck with both; large: with NLGEOM, where it stands."""
    what = cells(read(path))
    with plain(path) as text:
        return _compare(name, text, what, limit, large)


def _compare(name: str, path: Path, what: str, limit: float, large: bool) -> Outcome:
    try:
        model, at, nodes, ignored = model_of(path, large)
        steps = solved(model, at, nodes)
    except AbutError as error:
        refused = isinstance(error, InputError)
        return Outcome(name, what, "refused" if refused else "failed", detail=_reason(str(error), path))
    best: Outcome | None = None
    references: list[Reference] = []
    for kind in TYPES:
        try:
            found = reference(path, ignored, limit, kind)
        except NoReference as reason:
            best = best or Outcome(name, what, "no reference", ignored, largest(steps), kind=kind, detail=str(reason))
            continue
        references.append(found)
        error = difference(found.steps, steps)
        status = "agrees" if error <= AGREES else "differs"
        outcome = Outcome(name, what, status, ignored, largest(found.steps), error, kind)
        if best is None or best.status == "no reference" or error < best.difference:
            best = outcome
        if status == "agrees":
            break
    assert best is not None
    others = _by_slaves(model)
    if best.status == "differs" and others is not None:
        found = next(r for r in references if r.kind == best.kind)
        best = replace(best, slave=difference(found.steps, solved(others, at, nodes)))
    if best.status == "differs" and len(references) == 2:
        own = difference(references[0].steps, references[1].steps)
        return replace(best, detail=f"CalculiX's two kinds of contact differ by {own:.1%} from each other")
    return best


def _reason(message: str, path: Path) -> str:
    """What was refused, with its line, without what could have been ignored."""
    every = [line.strip() for line in message.partition("; to solve without")[0].splitlines()]
    kept = [line for line in every if not re.search(rf": \*({'|'.join(IGNORABLE)}): |: NLGEOM: ", line)] or every
    return ", ".join(line.replace(f"{path}:", "line ").partition(";")[0] for line in kept)


def model_of(path: Path, large: bool) -> tuple[abut.Model, list[float], dict[int, Mean], tuple[str, ...]]:
    """A deck as a model, the ends of its steps, the rows of points of each of its nodes, and what abut was told to ignore:
    NLGEOM, where it stands, unless ``large``, as in the reference run."""
    stands = re.search(r"^\*STEP.*NLGEOM", path.read_text(encoding="latin-1"), re.IGNORECASE | re.MULTILINE)
    ignored: list[str] = ["NLGEOM"] if stands and not large else []
    first: InputError | None = None
    while True:
        try:
            deck = read_deck(path, ignored)
            if not deck.steps and first is not None:  # nothing static: the reason is what had to be ignored
                raise first
            model = translate(deck).model
            break
        except InputError as error:
            asked = [word.upper() for word in shlex.split(str(error).partition(": --ignore ")[2]) if word != "--ignore"]
            if error is first or not asked or any(name in ignored or name not in IGNORABLE for name in asked):
                raise
            first = first or error
            ignored += asked
    return model, list(ends(deck)), _rows(deck), tuple(ignored)


Mean = tuple[list[int], NDArray[np.float64]]  # rows of points, and their weights


def _rows(deck: Deck) -> dict[int, Mean]:
    """The points of the model at each node of a deck; at one of a shell or a beam those whose mean its displacement is."""
    solid = expanded(with_points(deck), is_finite(deck))
    numbers = np.unique(np.concatenate([block.nodes.ravel() for block in solid.blocks]))
    numbers = numbers[np.isin(numbers, solid.nodes)]
    made = {b.reference: Thin(tuple(b.nodes.tolist())) for b in solid.couplings if b not in deck.couplings} | solid.thin
    every = {node: Thin((node,)) for node in np.intersect1d(numbers, deck.nodes).tolist()} | made
    return {
        node: (np.searchsorted(numbers, thin.nodes).tolist(), np.array([weight for _, weight in thin.shares]))
        for node, thin in every.items()
    }


def _by_slaves(model: abut.Model) -> abut.Model | None:
    """With the deck's slave surfaces as contactors; None where they are, or cannot be."""
    other = [c for c in model.contacts if c.first and c.contactor != c.first]
    if not other:
        return None
    contacts = [
        replace(c, contactor=c.first, target=c.second, first="", second="") if c in other else c for c in model.contacts
    ]
    try:
        return replace(model, contacts=contacts, probes=())
    except InputError:
        return None


def solved(model: abut.Model, at: Sequence[float], nodes: dict[int, Mean]) -> list[Displacements]:
    """Displacements at the end of each step of a deck."""
    solution = abut.solve(model)
    if not solution.converged:
        raise ConvergenceError("not converged")
    result = []
    for time in at:
        step = min(solution.steps, key=lambda step: abs(step.factor - time))
        u = np.zeros((len(step.displacement), 3))
        u[:, : model.dim] = step.displacement
        result.append(
            {node: weights @ u[rows] for node, (rows, weights) in nodes.items()}
        )  # a cut bolt has more points, at the end
    return result


def largest(steps: Sequence[Displacements]) -> float:
    return max(float(np.linalg.norm(u)) for step in steps for u in step.values())


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--folder", type=Path, default=EXAMPLES)
    parser.add_argument("--limit", type=float, default=600.0, help="seconds for one run of CalculiX")
    parser.add_argument("--small", action="store_true", help="small displacements, where the deck has NLGEOM, too")
    arguments = parser.parse_args()
    found = decks(arguments.folder, ("ELEMENT",) if arguments.names else ("CONTACT PAIR",))
    for name in arguments.names or found:
        print(line(compare(name, found[name], arguments.limit, not arguments.small)), flush=True)


def line(outcome: Outcome) -> str:
    """An outcome on one line."""
    numbers = "" if outcome.difference != outcome.difference else f"{outcome.difference:.3%} of {outcome.largest:.4g}"
    slave = "" if outcome.slave != outcome.slave else f"{outcome.slave:.3%} with the deck's slave as contactor"
    words = [outcome.kind, slave, f"without {', '.join(outcome.ignored)}" if outcome.ignored else "", outcome.detail]
    return f"{outcome.name:20} {outcome.status:12} {numbers:24} {outcome.cells}; {'; '.join(w for w in words if w)}"


if __name__ == "__main__":
    main()
