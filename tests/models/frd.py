"""A reader of .frd files for tests, by the columns that CalculiX GraphiX's manual gives; not by what abut writes."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray


@dataclass
class Frd:
    """nodes: number -> place; cells: number -> (type, group, nodes); names: of groups; datasets by (increment, name): the
    components, and number -> values."""

    nodes: dict[int, NDArray[np.float64]] = field(default_factory=dict)
    cells: dict[int, tuple[int, int, list[int]]] = field(default_factory=dict)
    names: dict[int, str] = field(default_factory=dict)
    times: dict[int, float] = field(default_factory=dict)
    datasets: dict[tuple[int, str], tuple[list[str], dict[int, list[float]]]] = field(default_factory=dict)
    whole: bool = False


def read(path: Path) -> Frd:
    """Fixed columns: the key in 2 to 3, a node's number in 4 to 13, then 12 for each value."""
    result, block, increment, number = Frd(), "", 0, 0
    components: list[str] = []
    values: dict[int, list[float]] = {}
    promised = {"2C": 0, "3C": 0}
    for line in path.read_text(encoding="ascii").splitlines():
        key = line[1:3]
        if line[:6].strip() in ("2C", "3C"):
            block = line[:6].strip()
            promised[block] = int(line[24:36])
        elif line.startswith("    1UMAT"):
            result.names[int(line[9:14])] = line[14:]
        elif line.startswith("    1PSTEP"):
            increment = int(line[36:48])
        elif line.startswith("  100C"):
            block, values, components = "100C", {}, []
            result.times[increment] = float(line[12:24])
            count = int(line[24:36])
        elif key == "-4":
            name, expected = line[5:13].strip(), int(line[13:18])
            result.datasets[increment, name] = components, values
        elif key == "-5":
            components.append(line[5:13].strip())
        elif key == "-1" and block == "2C":
            result.nodes[int(line[3:13])] = np.array(_numbers(line))
        elif key == "-1" and block == "3C":
            number = int(line[3:13])
            result.cells[number] = int(line[13:18]), int(line[23:28]), []
        elif key == "-2" and block == "3C":
            result.cells[number][2].extend(int(line[at : at + 10]) for at in range(3, len(line), 10))
        elif key == "-1":
            number = int(line[3:13])
            values[number] = _numbers(line)
        elif key == "-2":
            values[number].extend(_numbers(line))
        elif key == "-3" and block == "100C":
            assert len(values) == count
            assert len(components) == expected
        elif line == " 9999":
            result.whole = True
    assert promised == {"2C": len(result.nodes), "3C": len(result.cells)}
    return result


def _numbers(line: str) -> list[float]:
    return [float(line[at : at + 12]) for at in range(13, len(line), 12)]
