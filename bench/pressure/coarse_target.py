"""Hertz's line: a coarse cylinder is the target under a finer block, with facets as they are and for the smooth surface, and
the side that abut takes is the contactor.

python bench/pressure/coarse_target.py [RATIO]: of Young's moduli, cylinder over block, 3 by default (steel on aluminium).
"""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import abut

sys.path.insert(0, str(Path(__file__).parents[1] / "sides"))
from problems import line


def main() -> None:
    ratio = float(sys.argv[1]) if len(sys.argv) > 1 else 3.0
    for cell in ("quad4", "tri3"):
        for sizes in ((8, 24), (16, 40)):
            case = line((cell, cell), ratio, sizes)
            model, found = case.forced(1), []
            for geometry in ("faceted", "curved"):
                one = replace(model, contacts=[replace(model.contacts[0], geometry=geometry)])
                found.append(f"{geometry} {100.0 * case.error(abut.solve(one)):.1f} %")
            own = case.model()
            found.append(f"{own.contacts[0].contactor} as contactor {100.0 * case.error(abut.solve(own)):.1f} %")
            print(f"{cell} {sizes} largest error {', '.join(found)}", flush=True)


if __name__ == "__main__":
    main()
