"""Many damaged inputs through the command line's own entry, in processes that may crash without harm.

Every input is made from a number alone, so that a failure can be made again: ``python tests/fuzz/run.py --only NUMBER``.
"""

from __future__ import annotations

import json
import os
import queue
import random
import subprocess
import sys
import threading
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from fuzz.mutate import damaged, damaged_job

SEEDS = Path(__file__).parent / "seeds"
PATIENCE = 60.0  # seconds for one input
MEMORY = 6 << 30  # address space of a process, bytes, most of which libraries reserve without using
ALLOWED = (0, 2, 3, 4)


@dataclass(frozen=True)
class Input:
    """Files of one case, name -> bytes; ``run``: the one given to ``abut run``; ``kind`` for the statistics."""

    kind: str
    files: dict[str, bytes]
    run: str


@dataclass(frozen=True)
class Result:
    """status: exit status of the command, None where the process died or hung; problem: what is wrong, or ""."""

    number: int
    kind: str
    status: int | None
    problem: str


def make(seed: int, number: int) -> Input:
    """The input with this number: a job, a mesh of any format, or a deck, damaged."""
    chance = random.Random(f"{seed} {number}")
    jobs = [SEEDS / "solid.toml", SEEDS / "plane.toml"]
    meshes = sorted([*SEEDS.glob("*.msh"), *SEEDS.glob("*.vtu")])
    decks = sorted(SEEDS.glob("*.inp")) if _reads_decks() else []
    source = chance.choice([*jobs * 4, *meshes, *decks * 2])
    if source.suffix == ".toml":
        texts = [path.read_text() for path in jobs]
        text = damaged_job(source.read_text(), texts, chance)
        return Input("job", {"job.toml": text.encode("utf-8", "surrogateescape")}, "job.toml")
    others = [path.read_bytes() for path in meshes + decks if path.suffix == source.suffix]
    data = damaged(source.read_bytes(), others, chance)
    name = f"mesh{source.suffix}"
    if source.suffix == ".inp":
        return Input(".inp", {"deck.inp": data}, "deck.inp")
    job = (SEEDS / f"{source.name.split('-')[0].split('.')[0]}-mesh.toml").read_text().replace("mesh.msh", name)
    return Input(source.suffix, {"job.toml": job.encode(), name: data}, "job.toml")


def _reads_decks() -> bool:
    import importlib.util

    return importlib.util.find_spec("abut.io.deck") is not None


def run_all(numbers: Sequence[int], seed: int, folder: Path) -> Iterator[Result]:
    """Run the inputs with these numbers one after the other; a process that dies or hangs is replaced by a fresh one."""
    left = list(numbers)
    while left:
        died = None
        for result in _run_in_process(tuple(left), seed, folder):
            left.remove(result.number)
            died = result.status is None
            yield result
        if died is None:
            raise RuntimeError("the worker process does not start")


def _run_in_process(numbers: Sequence[int], seed: int, folder: Path) -> Iterator[Result]:
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join([str(Path(__file__).parents[1]), *sys.path]),
        "OMP_NUM_THREADS": "1",
        "MKL_NUM_THREADS": "1",
    }
    command = [sys.executable, "-m", "fuzz.worker", str(seed), str(folder)]
    with open(folder / "stderr.txt", "wb") as errors:
        process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=errors, env=environment
        )
    assert process.stdin is not None
    assert process.stdout is not None
    process.stdin.write(" ".join(map(str, numbers)).encode())
    process.stdin.close()
    lines: queue.Queue[bytes] = queue.Queue()
    reader = threading.Thread(target=_pass_on, args=(process.stdout, lines), daemon=True)
    reader.start()
    try:
        for number in numbers:
            try:
                line = lines.get(timeout=PATIENCE)
            except queue.Empty:
                yield Result(number, make(seed, number).kind, None, f"no end after {PATIENCE:.0f} s")
                return
            if not line:
                process.wait()
                said = (folder / "stderr.txt").read_text(errors="replace")[-2000:]
                yield Result(number, make(seed, number).kind, None, f"died with {process.returncode}: {said}")
                return
            yield Result(**json.loads(line))
    finally:
        process.kill()
        process.wait()
        process.stdout.close()


def _pass_on(stream: object, lines: queue.Queue[bytes]) -> None:
    for line in stream:  # type: ignore[attr-defined]
        lines.put(line)
    lines.put(b"")
