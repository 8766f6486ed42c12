"""Pressures of round fits whose facets do not match, against closed forms: ``python bench/fits/run.py [--faceted]``.

Mean, largest and least error of the reported pressure at the contactor's nodes, with the lines of the certificate that warn
or fail. --faceted: the same with ``geometry = "faceted"`` beside it. Then a tapered hub against its meridian section, finely
meshed, and a bearing, pushed and turned.
"""

from __future__ import annotations

import argparse

import numpy as np
from exact import Layer

import abut
from models import bearing, fit, tapered_hub, turned

TWO = [Layer(1, 2, 1000.0), Layer(2, 3, 1000.0)]
SOFT = [Layer(1, 2, 1000.0), Layer(2, 2.5, 20.0), Layer(2.5, 3.5, 1000.0)]
HOT = [Layer(20, 40, 210e3), Layer(40, 60, 210e3, expansion=1.2e-5, hot=-150.0)]


def error(model: abut.Model, exact: np.ndarray) -> str:
    """In per cent, of all contacts together."""
    solution = abut.solve(model)
    found = [(c.pressure / p - 1.0)[np.isfinite(c.pressure)] for c, p in zip(solution.contacts, exact, strict=True)]
    errors = 100.0 * np.concatenate(found)
    means = " ".join(
        f"{100 * (np.nanmean(c.pressure) / p - 1):+.1f}" for c, p in zip(solution.contacts, exact, strict=True)
    )
    bad = [check.name for contact in solution.contacts for check in contact.checks if check.verdict in ("FAIL", "warn")]
    return f"mean {means:>6}  largest {errors.max():+.1f}  least {errors.min():+.1f}  {', '.join(dict.fromkeys(bad))}"


def cases() -> list[tuple[str, tuple[object, ...], dict[str, object]]]:
    """Title, arguments of ``fit`` and its options."""
    made: list[tuple[str, tuple[object, ...], dict[str, object]]] = []
    for cell in ("tri3", "quad4"):
        for facets, side in (
            ((8, 12), "inner"), ((20, 8), "inner"), ((20, 8), "outer"), ((8, 20), "inner"), ((16, 24), "inner"),
            ((24, 16), "outer"), ((24, 36), "inner"), ((36, 24), "inner"),
        ):  # fmt: skip
            made.append((f"rings {cell} {facets} {side}", ("rings", cell, TWO, facets, [0.01], side), {}))
        made.append((f"rings finite {cell} (8, 12)", ("rings", cell, TWO, (8, 12), [0.01]), {"kinematics": "finite"}))
        for facets, side in (((8, 20), "inner"), ((20, 8), "outer"), ((20, 8), "inner"), ((16, 24), "inner")):
            arguments = ("rings", cell, TWO, facets, [0.0], side, (1.0, 1.0))
            made.append((f"hydrostatic {cell} {facets} {side}", arguments, {}))
        made.append((f"soft middle {cell}", ("rings", cell, SOFT, (12, 18, 10), [0.01, 0.01], "outer"), {}))
        made.append((f"hot ring {cell}", ("rings", cell, HOT, (12, 18), [-0.02]), {}))
    for cell in ("hex8", "tet4"):
        for facets, side in (((8, 12), "inner"), ((12, 8), "outer"), ((8, 12), "outer"), ((16, 24), "inner")):
            made.append((f"tubes {cell} {facets} {side}", ("tubes", cell, TWO, facets, [0.01], side), {}))
        for ratio in (1.0, 1000.0, 0.001):
            layers = [Layer(1, 2, 1000.0), Layer(2, 3, 1000.0 * ratio)]
            side = "outer" if ratio < 1.0 else "inner"
            arguments = ("shells", cell, layers, (8, 12), [0.01], side)
            made.append((f"ball in a seat {cell} E ratio {ratio:g}", arguments, {}))
    return made


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--faceted", action="store_true", help='also with geometry = "faceted"')
    parser.add_argument("--only", default="", help="cases whose title contains this")
    options = parser.parse_args()
    for title, arguments, given in cases():
        if options.only in title:
            for geometry in ("faceted", "curved") if options.faceted else ("curved",):
                model, exact = fit(*arguments, **given, geometry=geometry)  # type: ignore[arg-type]
                print(f"{title:42} {geometry:8} {error(model, exact)}", flush=True)
    if options.only in "tapered hub":
        tapered_hubs()
    if options.only in "bearing":
        bearings()


def tapered_hubs() -> None:
    """Over the inner nine tenths of the height: at its ends the pressure rises too steeply for these meshes."""
    height, fine = reported(abut.solve(tapered_hub("quad8", (48, 48))), axis=1)
    order = np.argsort(height)
    for cell in ("hex8", "tet4", "wedge6"):
        for facets, side in (((8, 12), "shaft"), ((8, 12), "hub"), ((12, 8), "hub"), ((16, 24), "shaft")):
            z, p = reported(abut.solve(tapered_hub(cell, facets, side)), axis=2)
            errors = 100.0 * (p / np.interp(z, height[order], fine[order]) - 1.0)[np.abs(z - 0.5) < 0.45]
            numbers = f"mean {errors.mean():+.1f}  largest {errors.max():+.1f}  least {errors.min():+.1f}"
            print(f"tapered hub {cell} {facets} {side:6} {numbers}", flush=True)


def reported(solution: abut.Solution, axis: int) -> tuple[np.ndarray, np.ndarray]:
    """Places along an axis and pressures at the contactor's nodes."""
    contact = solution.contacts[0]
    used = (contact.contactor.nodes >= 0) & contact.covered[:, None]
    return contact.contactor.points[contact.contactor.nodes[used], axis], contact.pressure[used]


def bearings() -> None:
    for kinematics in ("small", "finite"):
        for around in ((24, 36), (36, 24), (48, 72), (36, 36), (144, 216)):
            solution = abut.solve(bearing("quad4", around, kinematics=kinematics))
            force, most = np.linalg.norm(solution.contacts[0].force), solution.contacts[0].max_pressure
            print(f"bearing {kinematics:6} {around!s:12} force {force:8.1f} N  largest pressure {most:7.1f} MPa")
    for cell, around in (
        ("quad4", (24, 36)),
        ("quad4", (36, 24)),
        ("quad4", (48, 72)),
        ("tri3", (24, 36)),
        ("tri3", (36, 24)),
    ):
        steps = abut.solve(turned(cell, around)).steps
        forces = [float(np.linalg.norm(step.contacts[0].force)) for step in steps]
        change = 100.0 * (max(forces) / min(forces) - 1.0)
        print(
            f"bearing turned {cell} {around!s:9} force {min(forces):.1f} to {max(forces):.1f} N, {change:.2f} %, "
            f"{sum(len(step.iterations) for step in steps)} iterations",
            flush=True,
        )


if __name__ == "__main__":
    main()
