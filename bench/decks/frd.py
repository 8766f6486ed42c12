"""Displacements from CalculiX's result file (.frd, ASCII).

Fixed columns, as its manual has them: a block begins with "    1P" or "  100C" lines, "-4" names the field, "-1" rows carry
a node in 10 columns and values in 12 each, "-3" ends the block.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

Displacements = dict[int, np.ndarray]


def displacements(path: Path) -> list[Displacements]:
    """{node: (ux, uy, uz)} for each increment written, first to last."""
    result: list[Displacements] = []
    current: Displacements | None = None
    with path.open(encoding="ascii", errors="replace") as file:
        for line in file:
            key = line[:5].strip()
            if key == "-4":
                current = {} if line[5:9] == "DISP" else None
            elif key == "-3":
                if current is not None:
                    result.append(current)
                current = None
            elif key == "-1" and current is not None:
                # rows come as " -1" + node (10 columns) + values (12 columns each)
                current[int(line[3:13])] = np.array([float(line[i : i + 12]) for i in (13, 25, 37)])
    return result
