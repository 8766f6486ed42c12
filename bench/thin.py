"""Time of shells beside solids of as many unknowns, and of modes beside linear solves, from decks:

    python bench/thin.py [--dofs 50000,200000] [--modes 50000,150000] [--shells S8R,S4]

A square plate, clamped all round, thickness over length 1:100, under pressure, beside a cube of C3D20R (of C3D8I beside
S4) held below; solvers as chosen by default. dofs are those of the mesh that is solved, as in the run's summary. Prints
seconds of processor time (so that other processes count little; set OMP_NUM_THREADS=1) from the model in memory to
stresses in memory, and their ratio; of modes the time of a run with twenty modes less that of one without, over the
latter's, and over that of a run with the direct solver, whose factors modes are made of.
"""

from __future__ import annotations

import argparse
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from itertools import product
from pathlib import Path
from time import process_time

import abut
from abut.job import load_job


def plate(n: int, kind: str) -> str:
    """A deck of n x n shells of the unit square."""
    quadratic = kind.startswith("S8")
    step = 2 if quadratic else 1
    m = step * n + 1
    number = [[i * m + j + 1 for j in range(m)] for i in range(m)]
    nodes = [
        f"{number[i][j]}, {i / (m - 1)!r}, {j / (m - 1)!r}, 0."
        for i, j in product(range(m), repeat=2)
        if not (quadratic and i % 2 and j % 2)
    ]
    around = (
        ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
        if quadratic
        else ((0, 0), (1, 0), (1, 1), (0, 1))
    )
    cells = [
        ", ".join(map(str, (i * n + j + 1, *(number[step * i + a][step * j + b] for a, b in around))))
        for i, j in product(range(n), repeat=2)
    ]
    rim = sorted({number[i][j] for i, j in product(range(m), repeat=2) if {i, j} & {0, m - 1}})
    return deck(nodes, kind, cells, "*SHELL SECTION, ELSET=ALL, MATERIAL=STEEL\n0.01", rim, "1, 6", "P")


def cube(n: int, kind: str) -> str:
    """A deck of n^3 bricks of the unit cube."""
    step = 2 if kind == "C3D20R" else 1
    m = step * n + 1
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    ends = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    around = [(step * a, step * b, step * c) for a, b, c in corners]
    if step == 2:
        around += [tuple(corners[p][d] + corners[q][d] for d in range(3)) for p, q in ends]

    def number(i: int, j: int, k: int) -> int:
        return (i * m + j) * m + k + 1

    nodes = [
        f"{number(*at)}, {at[0] / (m - 1)!r}, {at[1] / (m - 1)!r}, {at[2] / (m - 1)!r}"
        for at in product(range(m), repeat=3)
        if step == 1 or sum(x % 2 for x in at) < 2
    ]
    cells = [
        ", ".join(
            map(
                str,
                ((i * n + j) * n + k + 1, *(number(step * i + a, step * j + b, step * k + c) for a, b, c in around)),
            )
        ).replace(", ", ",\n", 0)
        for i, j, k in product(range(n), repeat=3)
    ]
    low = [number(i, j, 0) for i, j in product(range(m), repeat=2) if step == 1 or not (i % 2 and j % 2)]
    return deck(
        nodes, kind, list(map(broken, cells)), "*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL", low, "1, 3", "P2", top(n)
    )


def top(n: int) -> str:
    """The set of the elements that are pressed: the uppermost ones."""
    return "*ELSET, ELSET=PRESSED\n" + "\n".join(str((i * n + j) * n + n) for i, j in product(range(n), repeat=2))


def broken(row: str) -> str:
    """A row of numbers in lines of at most ten."""
    numbers = row.split(", ")
    return ",\n".join(", ".join(numbers[k : k + 10]) for k in range(0, len(numbers), 10))


def deck(
    nodes: list[str],
    kind: str,
    cells: list[str],
    section: str,
    held: list[int],
    motions: str,
    face: str,
    more: str = "",
) -> str:
    """The text of a static step; face: the pressure's label."""
    return "\n".join(
        [
            "*NODE", *nodes, f"*ELEMENT, TYPE={kind}, ELSET=ALL", *cells, "*NSET, NSET=HELD", *map(str, held),
            *([more] if more else []), "*MATERIAL, NAME=STEEL", "*ELASTIC", "210000., 0.3", "*DENSITY", "7.85e-9", section,
            "*STEP", "*STATIC", "*BOUNDARY", f"HELD, {motions}", "*DLOAD",
            f"{'PRESSED' if more else 'ALL'}, {face}, 0.001", "*END STEP", "",
        ]
    )  # fmt: skip


def read(folder: str, text: str) -> abut.Model:
    path = Path(folder) / "deck.inp"
    path.write_text(text)
    return load_job(path).model


def timed(model: abut.Model) -> tuple[float, abut.Solution]:
    """Seconds of processor time, and the solution."""
    start = process_time()
    solution = abut.solve(model)
    return process_time() - start, solution


def sized(folder: str, make: object, kind: str, per_cell: float, power: float, dofs: int) -> abut.Model:
    return read(folder, make(max(round((dofs / per_cell) ** (1.0 / power)), 2), kind))


def shells(folder: str, kinds: list[str], sizes: list[int]) -> Iterator[str]:
    yield "| shell | dofs | s | solver | solid | dofs | s | solver | ratio |"
    yield "|---" * 9 + "|"
    for kind, dofs in product(kinds, sizes):
        thin, beside = sized(folder, plate, kind, 21.0, 2, dofs), "C3D20R" if kind.startswith("S8") else "C3D8I"
        solid = sized(folder, cube, beside, 12.0 if beside == "C3D20R" else 3.0, 3, dofs)
        (a, of), (b, other) = timed(thin), timed(solid)
        first, second = (f"{s.dofs} | {t:.2f} | {s.solver}" for s, t in ((of, a), (other, b)))
        yield f"| {kind} | {first} | {beside} | {second} | {a / b:.2f} |"


def modes(folder: str, sizes: list[int]) -> Iterator[str]:
    yield "| model | dofs | linear s | direct s | 20 modes s | modes over linear | modes over direct |"
    yield "|---" * 7 + "|"
    for (make, kind, per_cell, power), dofs in product(((plate, "S8R", 21.0, 2), (cube, "C3D20R", 12.0, 3)), sizes):
        model = sized(folder, make, kind, per_cell, power, dofs)
        (a, of), (b, _) = timed(model), timed(replace(model, modes=[abut.Frequencies(20)]))
        c = (
            a
            if of.solver.startswith("direct")
            else timed(replace(model, solve=replace(model.solve, linear="direct")))[0]
        )
        yield f"| {kind} | {of.dofs} | {a:.2f} | {c:.2f} | {b - a:.2f} | {(b - a) / a:.2f} | {(b - a) / c:.2f} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--dofs", default="50000,200000", help="of shells and solids, none where empty")
    parser.add_argument("--modes", default="50000,150000", help="of models whose modes are found, none where empty")
    parser.add_argument("--shells", default="S8R,S4", help="kinds of elements")
    given = parser.parse_args()
    sizes, more = ([int(n) for n in text.split(",") if n] for text in (given.dofs, given.modes))
    with tempfile.TemporaryDirectory() as folder:
        for line in shells(folder, given.shells.split(","), sizes) if sizes else ():
            print(line, flush=True)
        for line in modes(folder, more) if more else ():
            print(line, flush=True)


if __name__ == "__main__":
    main()
