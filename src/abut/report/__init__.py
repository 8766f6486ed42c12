"""The report of a run: one HTML file with an interactive picture, the certificate and plots (``docs/report.md``)."""

from __future__ import annotations

from pathlib import Path

from abut import checks
from abut.io.atomic import write_file
from abut.report.chart import Beside, Chart
from abut.report.origin import Origin, read_origin
from abut.report.page import page
from abut.solution import Solution

__all__ = ["Beside", "Chart", "Origin", "read_origin", "write_report"]


def write_report(
    solution: Solution, path: str | Path, origin: Origin | None = None, beside: Beside | None = None
) -> Path:
    """Write the report of a solution to one HTML file.

    Where abut was built without three.js and uPlot the picture and the plots are images.

    Parameters
    ----------
    solution : Solution
        What is reported.
    path : str or Path
        The file.
    origin : abut.report.Origin, optional
        The name and text of the job, and reference values.
    beside : abut.report.Beside, optional
        Another solution that it is compared with.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    InputError
        Where the file cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> import abut
    >>> from abut.mesh import make
    >>> bar = abut.Model(
    ...     make.join({"bar": make.rectangle([0, 2], [0, 1], cells=[2, 1])}),
    ...     plane="stress",
    ...     solids=[abut.Solid("bar", abut.LinearElastic(100.0, 0.3))],
    ...     supports=[abut.Support("bar.left", x=0), abut.Support("bar.bottom", y=0)],
    ...     loads=[abut.Traction("bar.right", (1.0, 0.0))],
    ... )
    >>> with TemporaryDirectory() as folder:
    ...     abut.write_report(abut.solve(bar), f"{folder}/bar.html").name
    'bar.html'
    """
    checks.instance(solution, Solution, "write_report", "a solution (abut.Solution)")
    path = checks.path(path, "write_report: path")
    if origin is not None:
        checks.instance(origin, Origin, "write_report: origin", "an origin (abut.report.Origin)")
    if beside is not None:
        checks.instance(beside, Beside, "write_report: beside", "another solution (abut.report.Beside)")
    data = page(solution, origin or Origin(path.stem), beside).encode(
        "utf-8", "backslashreplace"
    )  # names of files may be no text

    def write(temporary: Path) -> None:
        temporary.write_bytes(data)

    write_file(path, write)
    return path
