"""What CalculiX answers for a deck with stiff contact.

abut's contact has no penetration, and it refuses what it does not do unless told to ignore it (``abut run --ignore``). So a
deck is edited before CalculiX runs it: what abut ignores is taken out (NLGEOM, steps that are not static), contact pressure
becomes linear over penetration, and friction over slip while it sticks, with a stiffness that is raised tenfold until the
displacements stay (to ``SETTLED``), and all displacements are written at the end of each step. Where the deck's kind of
contact does not settle, CalculiX's mortar contact is tried. Everything else is left as it is.
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from cards import Card, read, write
from frd import Displacements, displacements

TYPES = ("", "MORTAR")
EXAMPLES = Path("/usr/share/doc/calculix-ccx-test/examples/test")
SETTLED = 1e-3  # change of displacement over the largest one, when the contact stiffness is raised tenfold
STIFF = (1e1, 1e2, 1e3, 1e4, 1e5, 1e6)  # contact stiffness times element size over Young's modulus
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
# Residual and correction over their averages at which an iteration ends; CalculiX's own are 5e-3 and 1e-2.
TIGHT = Card("CONTROLS", {"PARAMETERS": "FIELD"}, ("1.e-6, 1.e-4",))
# Analyses that abut does not do; to ignore one leaves its step out.
PROCEDURES = (
    "FREQUENCY", "DYNAMIC", "MODAL DYNAMIC", "HEAT TRANSFER", "COUPLED TEMPERATURE-DISPLACEMENT",
    "UNCOUPLED TEMPERATURE-DISPLACEMENT", "STEADY STATE DYNAMICS", "BUCKLE", "COMPLEX FREQUENCY",
)  # fmt: skip
EXPANDED = ("CPS", "CPE", "CAX", "S3", "S4", "S6", "S8", "M3D", "B3", "T3D")  # whose own nodes "OUTPUT=2D" has


class NoReference(Exception):
    """CalculiX gives no result to compare with; the text says why."""


@dataclass(frozen=True)
class Reference:
    """Displacements at the end of each step; ``change``: what the last rise of stiffness still did, over the largest
    displacement; ``stiffness``: force per area and length; ``kind``: type of the contact pairs, "" as in the deck."""

    steps: list[Displacements]
    change: float
    stiffness: float
    kind: str


def decks(folder: Path = EXAMPLES, having: Collection[str] = ("CONTACT PAIR",)) -> dict[str, Path]:
    """Decks with one of these cards, by name."""
    found = {}
    for path in sorted([*folder.glob("*.inp"), *folder.glob("*.inp.gz")]):
        if any(card.name in having for card in read(path)):
            found[path.name.split(".")[0]] = path
    return found


def reference(path: Path, ignore: Collection[str] = (), limit: float = 600.0, kind: str = "") -> Reference:
    """Run CalculiX with stiffer and stiffer contact, without the cards and parameters in ``ignore``. ``kind`` replaces the
    type of the contact pairs (MORTAR, ...).

    Raises NoReference where it cannot be run, does not converge, or does not settle."""
    if shutil.which("ccx") is None:
        raise NoReference("CalculiX (ccx) is not installed")
    cards = read(path)
    unit = _young(cards) / _size(cards)
    last: list[Displacements] | None = None
    reason, change = "", np.inf
    for factor in STIFF:
        try:
            steps = run(edit(cards, factor * unit, ignore, kind), limit)
        except NoReference as problem:
            reason = str(problem)
            if last is None:
                continue
            break
        if last is not None:
            change = difference(steps, last)
            if change < SETTLED:
                return Reference(steps, change, factor * unit, kind)
        last = steps
    if last is None or not np.isfinite(change):
        raise NoReference(reason)
    raise NoReference(f"changes by {change:.1%} when contact is made ten times stiffer{reason and '; then ' + reason}")


def difference(one: Sequence[Displacements], other: Sequence[Displacements]) -> float:
    """Largest difference of displacement over the largest displacement, step by step; the largest of those."""
    worst = 0.0
    for a, b in zip(one, other, strict=True):
        scale = max(float(np.linalg.norm(u)) for u in a.values())
        worst = max(worst, *(float(np.linalg.norm(a[n] - b[n])) / max(scale, 1e-300) for n in a.keys() & b.keys()))
    return worst


def edit(cards: Sequence[Card], stiffness: float, ignore: Collection[str] = (), kind: str = "") -> list[Card]:
    """The deck for a reference run."""
    own = any(c.name == "ELEMENT" and c.options.get("TYPE", "").upper().startswith(EXPANDED) for c in cards)
    model, steps = _split(cards)
    result: list[Card] = []
    tied = False
    for step in [model, *(s for s in steps if not any(card.name in ignore for card in s if card.name in PROCEDURES))]:
        for card in step:
            if card.name == "SURFACE INTERACTION":
                tied = False
            if card.name == "SURFACE BEHAVIOR":
                tied = card.options.get("PRESSURE-OVERCLOSURE", "").upper() == "TIED"
                card = Card(
                    "SURFACE BEHAVIOR",
                    {"PRESSURE-OVERCLOSURE": "TIED" if tied else "LINEAR"},
                    # slope; tension at large gaps, of node to surface contact only: none to speak of
                    (f"{stiffness:.6e}" if tied else f"{stiffness:.6e}, 1.e-6",),
                )
            elif card.name == "FRICTION" and tied:  # a tied interaction takes its tangential stiffness from here
                card = replace(card, data=(f"1.e30, {stiffness:.6e}",))
            elif card.name == "FRICTION" and "FRICTION" not in ignore:
                card = replace(card, data=(f"{card.data[0].split(',')[0]}, {stiffness:.6e}",))
            elif card.name in (*OUTPUT, "CONTROLS", *ignore):
                continue
            elif card.name == "STEP":
                card = card.without("INC")
                card = replace(card, options={**card.options, "INC": "1000"})
            elif card.name == "STATIC":
                result.append(TIGHT)
                period = (card.data[0].split(",") if card.data else [])[1:2]
                length = float(period[0]) if period and period[0].strip() else 1.0
                card = Card("STATIC", {}, (f"{length!r}, {length!r}, {1e-6 * length!r}",))
            elif card.name == "CONTACT PAIR" and kind:
                card = replace(card, options={**card.options, "TYPE": kind})
            elif card.name == "END STEP":
                # the last increment of a step is written whatever the frequency
                frequency = {"FREQUENCY": "999999"}
                result.append(Card("NODE FILE", {**frequency, "OUTPUT": "2D"} if own else frequency, ("U",)))
            result.append(card.without(*ignore))
    return result


def _split(cards: Sequence[Card]) -> tuple[list[Card], list[list[Card]]]:
    model: list[Card] = []
    steps: list[list[Card]] = []
    for card in cards:
        if card.name == "STEP":
            steps.append([])
        (steps[-1] if steps else model).append(card)
    return model, steps


def _young(cards: Sequence[Card]) -> float:
    return max((float(c.data[0].split(",")[0]) for c in cards if c.name == "ELASTIC"), default=1.0)


def _size(cards: Sequence[Card]) -> float:
    """Typical size of an element: of the box around all nodes, shared among the elements."""
    rows = [line.split(",") for card in cards if card.name == "NODE" for line in card.data]
    extent = np.ptp(
        np.array([[float(x.strip() or 0.0) for x in (*row[1:4], "0", "0", "0")[:3]] for row in rows]), axis=0
    )
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
