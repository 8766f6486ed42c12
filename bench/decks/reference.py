"""What CalculiX answers for a deck with stiff, frictionless contact and small displacements.

abut's contact is hard and its displacements are small; the decks ask for a soft contact and most for NLGEOM. So a deck is
edited before CalculiX runs it: NLGEOM goes, steps that are not static go, friction goes, contact pressure becomes linear
over penetration with a stiffness that is raised tenfold until the displacements stay (to ``SETTLED``), and all
displacements are written at the end of each step. Everything else is left as it is.
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from cards import Card, read, write
from frd import Displacements, displacements

EXAMPLES = Path("/usr/share/doc/calculix-ccx-test/examples/test")
SETTLED = 1e-3  # change of displacement over the largest one, when the contact stiffness is raised tenfold
STIFF = (1e2, 1e3, 1e4, 1e5, 1e6, 1e7)  # contact stiffness times element size over Young's modulus
OUTPUT = (
    "NODE FILE",
    "EL FILE",
    "CONTACT FILE",
    "NODE PRINT",
    "EL PRINT",
    "CONTACT PRINT",
    "NODE OUTPUT",
    "SECTION PRINT",
)
FRICTION = ("FRICTION", "CHANGE FRICTION")
PLANE = ("CPS", "CPE", "CAX")


class NoReference(Exception):
    """CalculiX gives no result to compare with; the text says why."""


@dataclass(frozen=True)
class Reference:
    """Displacements at the end of each static step; ``change``: what the last rise of stiffness still did, over the
    largest displacement; ``edits``: what was taken out of the deck; ``stiffness``: force per area and length."""

    steps: list[Displacements]
    change: float
    stiffness: float
    edits: tuple[str, ...]


def decks(folder: Path = EXAMPLES) -> dict[str, Path]:
    """Decks with a contact pair, by name."""
    found = {}
    for path in sorted([*folder.glob("*.inp"), *folder.glob("*.inp.gz")]):
        if any(card.name == "CONTACT PAIR" for card in read(path)):
            found[path.name.split(".")[0]] = path
    return found


def reference(path: Path, limit: float = 600.0, kind: str = "") -> Reference:
    """Run CalculiX with stiffer and stiffer contact. ``kind`` replaces the contact's TYPE (MORTAR, ...).

    Raises NoReference where it cannot be run, does not converge, or does not settle."""
    if shutil.which("ccx") is None:
        raise NoReference("CalculiX (ccx) is not installed")
    cards = read(path)
    if not any(card.name == "STATIC" for card in cards):
        raise NoReference("no static step")
    unit = _young(cards) / _size(cards)
    last: list[Displacements] | None = None
    reason, change = "", np.inf
    for factor in STIFF:
        edited, edits = edit(cards, factor * unit, kind)
        try:
            steps = run(edited, limit)
        except NoReference as problem:
            reason = str(problem)
            if last is None:
                continue
            break
        if last is not None:
            change = difference(steps, last)
            if change < SETTLED:
                return Reference(steps, change, factor * unit, edits)
        last = steps
    if last is None:
        raise NoReference(reason)
    raise NoReference(f"did not settle: {change:.1e} ({reason})")


def difference(one: Sequence[Displacements], other: Sequence[Displacements]) -> float:
    """Largest difference of displacement over the largest displacement, step by step; the largest of those."""
    worst = 0.0
    for a, b in zip(one, other, strict=True):
        scale = max(float(np.linalg.norm(u)) for u in a.values())
        worst = max(worst, *(float(np.linalg.norm(a[n] - b[n])) / max(scale, 1e-300) for n in a.keys() & b.keys()))
    return worst


def edit(cards: Sequence[Card], stiffness: float, kind: str = "") -> tuple[list[Card], tuple[str, ...]]:
    """The deck for a reference run, and what was changed in words."""
    edits: dict[str, None] = {}
    plane = any(c.name == "ELEMENT" and c.options.get("TYPE", "").upper().startswith(PLANE) for c in cards)
    model, steps = _split(cards)
    tied = any(c.name == "SURFACE BEHAVIOR" and c.options["PRESSURE-OVERCLOSURE"].upper() == "TIED" for c in model)
    result: list[Card] = []
    for step in [model, *steps]:
        if step is not model and not any(card.name == "STATIC" for card in step):
            edits["a step that is not static"] = None
            continue
        for card in step:
            if card.name in OUTPUT:
                continue
            if card.name in FRICTION:
                if card.name == "FRICTION" and tied and step is model:
                    # a tied interaction takes its tangential stiffness from here
                    result.append(replace(card, data=(f"1.e30, {stiffness:.6e}",)))
                    continue
                edits["friction"] = None
                continue
            if card.name == "STEP":
                if "NLGEOM" in card.options:
                    edits["NLGEOM"] = None
                if "PERTURBATION" in card.options:
                    edits["PERTURBATION"] = None
                card = card.without("NLGEOM", "PERTURBATION", "INC")
                card = replace(card, options={**card.options, "INC": "1000"})
            elif card.name == "STATIC":
                card = Card("STATIC", {}, ("1., 1., 1.e-6",))
            elif card.name == "SURFACE BEHAVIOR":
                card = _behavior(card, stiffness)
            elif card.name == "CONTACT PAIR" and kind:
                card = replace(card, options={**card.options, "TYPE": kind})
            elif card.name == "END STEP":
                # the last increment of a step is written whatever the frequency
                frequency = {"FREQUENCY": "999999"}
                result.append(Card("NODE FILE", {**frequency, "OUTPUT": "2D"} if plane else frequency, ("U",)))
            result.append(card)
    return result, tuple(edits)


def _behavior(card: Card, stiffness: float) -> Card:
    law = card.options["PRESSURE-OVERCLOSURE"].upper()
    if law == "TIED":
        return replace(card, data=(f"{stiffness:.6e}",))
    # LINEAR: slope, tension at large gaps (node to surface only; small), and the size of the search zone's root
    return Card("SURFACE BEHAVIOR", {"PRESSURE-OVERCLOSURE": "LINEAR"}, (f"{stiffness:.6e}, 1.e-6",))


def _split(cards: Sequence[Card]) -> tuple[list[Card], list[list[Card]]]:
    model: list[Card] = []
    steps: list[list[Card]] = []
    for card in cards:
        if card.name == "STEP":
            steps.append([])
        (steps[-1] if steps else model).append(card)
    return model, steps


def _young(cards: Sequence[Card]) -> float:
    return max(float(c.data[0].split(",")[0]) for c in cards if c.name == "ELASTIC")


def _size(cards: Sequence[Card]) -> float:
    """Typical size of an element: of the box around all nodes, shared among the elements."""
    rows = [line.split(",") for card in cards if card.name == "NODE" for line in card.data]
    extent = np.ptp(np.array([[float(x or 0.0) for x in (*row[1:4], "0", "0")[:3]] for row in rows]), axis=0)
    extent = extent[extent > 1e-9 * extent.max()]
    count = sum(len(card.data) for card in cards if card.name == "ELEMENT")
    return float((np.prod(extent) / count) ** (1 / len(extent)))


def run(cards: Sequence[Card], limit: float) -> list[Displacements]:
    """Run CalculiX in a temporary folder and read the displacements at the end of each step."""
    steps = sum(card.name == "STEP" for card in cards)
    with tempfile.TemporaryDirectory() as folder:
        write(cards, Path(folder) / "deck.inp")
        try:
            done = subprocess.run(
                ["ccx", "deck"], cwd=folder, timeout=limit, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                errors="replace",
            )  # fmt: skip
        except subprocess.TimeoutExpired:
            raise NoReference(f"CalculiX ran past {limit:g} s") from None
        if done.returncode or "Job finished" not in done.stdout:
            raise NoReference(f"CalculiX stopped: {_complaint(done.stdout)}")
        found = displacements(Path(folder) / "deck.frd")
    if len(found) != steps:
        raise NoReference(f"{len(found)} results for {steps} steps")
    return found


def _complaint(output: str) -> str:
    lines = output.splitlines()
    for i, line in enumerate(lines):
        if "*ERROR" in line or "error" in line.lower():
            return " ".join(" ".join(lines[i : i + 2]).split())[:160]
    return "no message"
