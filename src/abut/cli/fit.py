"""abut fit: constants of rubber from tests."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from abut.cli.terminal import show
from abut.errors import InputError

DONE = 0
NAMES = ("neo-hooke", "mooney-rivlin", "yeoh", "ogden", "arruda-boyce")
KINDS = {
    "uniaxial": "tension or pressure along one direction",
    "planar": "a wide strip that keeps its width",
    "biaxial": "a sheet pulled alike in two directions",
}


def add_fit(commands: Any) -> None:
    """Add the command to the parser's ``commands``."""
    fit = commands.add_parser(
        "fit",
        help="constants of rubber from tests",
        description="Fit the constants of a law for rubber to tests, and print it as a table for a job file. A test is a\n"
        "CSV file with a line of names, stretch (or strain) and stress, and rows of numbers: force by undeformed area.",
        epilog="examples:\n  abut fit yeoh --uniaxial tension.csv --planar shear.csv\n"
        "  abut fit ogden --terms 2 --biaxial balloon.csv --plot fit.html >> job.toml",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    fit.add_argument("law", choices=NAMES, help="the law")
    for kind, what in KINDS.items():
        fit.add_argument(
            f"--{kind}",
            type=Path,
            action="append",
            default=[],
            metavar="FILE",
            help=f"{what}; may be given several times",
        )
    fit.add_argument("--terms", type=int, default=3, metavar="N", help="of ogden: 1, 2 or 3 (default)")
    fit.add_argument("--bulk", type=float, metavar="K", help="bulk modulus; the tests do not tell it")
    fit.add_argument("--poisson", type=float, default=0.4995, help="at rest, in place of --bulk (default 0.4995)")
    fit.add_argument("--name", default="rubber", help="of the table")
    fit.add_argument("--plot", type=Path, metavar="FILE", help="write tests and fit as a page (.html)")
    fit.add_argument("--debug", action="store_true", help="print the traceback of an internal error")
    fit.set_defaults(command=_fit)


def _fit(arguments: argparse.Namespace) -> int:
    from abut.io.atomic import write_text
    from abut.job.convert import material_table, toml
    from abut.materials.fitting import fit
    from abut.materials.rubber_tests import read_test, stable_range
    from abut.report.fit_page import fit_page

    files = [(kind, path) for kind in KINDS for path in getattr(arguments, kind)]
    if not files:
        raise InputError("fit: no tests; give --uniaxial, --planar or --biaxial with a CSV file")
    if arguments.bulk is not None and not 0.0 < arguments.bulk < float("inf"):
        raise InputError(f"--bulk: expected a number > 0, got {arguments.bulk!r}")
    if not 0.0 <= arguments.poisson < 0.5:
        raise InputError(f"--poisson: expected 0 <= nu < 0.5, got {arguments.poisson!r}")
    if arguments.plot is not None and arguments.plot.suffix.lower() != ".html":
        raise InputError(f"--plot: {arguments.plot}: expected a name that ends in .html")
    tests = [read_test(path, kind) for kind, path in files]
    found = fit(arguments.law, tests, arguments.terms, arguments.bulk, arguments.poisson)
    lines = [f"abut fit {arguments.law}: shear modulus at rest {found.energy.shear:.5g}"]
    for (kind, path), test, error in zip(files, tests, found.errors):
        low, high = float(test.stretch.min()), float(test.stretch.max())
        lines.append(
            f"{path.name}: {kind}, stretch {low:.4g} to {high:.4g}, error {100.0 * error:.3g} % of the largest stress"
        )
    for kind in KINDS:
        low, high = stable_range(found.energy, kind)
        lines.append(f"{kind}: stable for stretches {low:.3g} to {high:.3g}")
        for (own, path), test in zip(files, tests):
            if own == kind and not (low <= test.stretch.min() and test.stretch.max() <= high):
                lines.append(f"{path.name}: WARNING: not stable all over the test; take another law or fewer terms")
    show(*(f"# {line}" for line in lines), sep="\n")
    show(toml({"materials": {arguments.name: material_table(found.material)}}), end="")
    if arguments.plot is not None:
        write_text(arguments.plot, fit_page(arguments.law, [path.name for _, path in files], tests, found))
    return DONE
