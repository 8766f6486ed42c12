"""Tables of docs/verification agree with the code: some of their cells computed anew, to the printed digits."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "docs" / "make"))

import ccx_friction  # noqa: E402
import inf_sup as constants  # noqa: E402
import methods  # noqa: E402
import pressure  # noqa: E402
from abut.mesh.make import join, rectangle  # noqa: E402
from abut.verify import inf_sup  # noqa: E402
from page import agrees, read_table  # noqa: E402

BETAS = {(r["cells"], r["pressure"], r["target"]): r for d in ("2d", "3d") for r in read_table(constants.PAGE, d)}


def test_printed_digits() -> None:
    """The comparison itself can fail."""
    assert agrees("0.807", 0.8072)
    assert not agrees("0.807", 0.8077)
    assert agrees("9.3e-02", 0.0934)
    assert not agrees("9.3e-02", 0.0942)
    assert agrees("0.60 %", 0.604)
    assert not agrees("< 1e-10", 2e-10)
    assert not agrees("0.807", float("nan"))


def test_every_pair_has_its_rows() -> None:
    cells = (*constants.PLANE, *constants.SOLID)
    wanted = {(c, p, t) for c in cells for p in constants.pressures(c) for t in constants.TARGETS}
    assert set(BETAS) == wanted


@pytest.mark.parametrize("dim", [2, 3])
def test_summary_follows_from_the_rows(dim: int) -> None:
    rows = [list(row.values()) for row in read_table(constants.PAGE, f"{dim}d")]
    printed = [list(row.values()) for row in read_table(constants.PAGE, f"summary-{dim}d")]
    assert printed == constants.summary(rows, dim)


@pytest.mark.parametrize(
    ("cell", "pressure", "target", "n"),
    [
        *((cell, pressure, "half", 4) for cell in constants.PLANE for pressure in constants.pressures(cell)),
        *(("quad4", pressure, "three quarters", 8) for pressure in constants.pressures("quad4")),
        *((cell, "P2", "matching", 8) for cell in ("quad8", "quad9", "tri6")),
        *((cell, pressure, "matching", 2) for cell in constants.SOLID for pressure in ("P0", "P1", "nodes, one pass")),
        *((cell, "P2", "half", 2) for cell in ("hex20", "hex27", "tet10")),
        *((cell, "dual-P1", "three quarters", 16) for cell in ("quad8", "tri6")),
        ("hex20", "dual-P1", "half", 4),
    ],
)
def test_inf_sup_constants(cell: str, pressure: str, target: str, n: int) -> None:
    level = constants.measure(cell, pressure, [(n, int(n * constants.TARGETS[target]))]).levels[0]
    printed = BETAS[cell, pressure, target][str(n)]
    assert agrees(printed, level.trace), (printed, level.trace)


@pytest.mark.parametrize(
    ("cell", "pressure", "target"),
    [
        ("quad4", "P0", "matching"),
        ("quad4", "P1", "half"),
        ("quad8", "dual-P1", "half"),
        ("quad4", "nodes, two passes", "half"),
    ],
)
def test_inf_sup_rows(cell: str, pressure: str, target: str) -> None:
    """Whole rows, with the verdict."""
    result = constants.measure(cell, pressure, constants.sizes(cell, target))
    computed = dict(zip(constants.header(2), constants.row(cell, pressure, target, result)))
    assert computed == BETAS[cell, pressure, target]


def test_constant_of_the_problem_itself() -> None:
    """No pair has more than (2 tanh 1)^1/2, which the constant pressure attains (h^2 of the matching P1 mesh: 1e-3)."""
    bound = np.sqrt(2.0 * np.tanh(1.0))
    betas = [float(row[str(n)]) for row in BETAS.values() for n in (4, 8) if row[str(n)]]
    assert max(betas) <= bound + 5e-4
    assert inf_sup(constants.model("quad9", "P1", 8, 8)).levels[0].trace == pytest.approx(bound, abs=1e-3)


def test_inf_sup_constant_does_not_depend_on_units() -> None:
    model = constants.model("quad8", "P2", 4, 2)
    levels = [
        inf_sup(replace(model, mesh=replace(model.mesh, points=unit * model.mesh.points))).levels[0]
        for unit in (1.0, 1e-6, 1e3)
    ]
    assert [v.trace for v in levels[1:]] == pytest.approx([levels[0].trace] * 2, rel=1e-9)
    assert [v.mesh for v in levels[1:]] == pytest.approx([levels[0].mesh] * 2, rel=1e-9)


def test_facets_covered_in_part() -> None:
    """The target ends within a contactor facet. Pressure counts only where there is contact, and multipliers with little
    support follow others, so that the pair stays above what counts as weak."""
    for share in (0.1, 0.5, 0.7):
        parts = {
            "lower": rectangle(cells=(8, 8), cell="quad8"),
            "upper": rectangle(x=(0.0, (5.0 + share) / 8.0), y=(1.0, 2.0), cells=(6, 8), cell="quad8"),
        }
        model = replace(constants.model("quad8", "P2", 1, 1), mesh=join(parts))
        assert inf_sup(model).levels[0].trace > 0.3


def test_patch_errors() -> None:
    printed = {row["cells"]: row for row in read_table(methods.PAGE, "patch")}
    assert set(printed) == set(methods.CELLS)
    for cell in ("quad4", "quad8", "hex8"):
        for name, method in methods.METHODS.items():
            for quantity, value in zip(("pressure", "force", "displacement"), methods.patch_errors(cell, method)):
                text = printed[cell].get(f"{name}: {quantity}")
                assert text is None or agrees(text, value), (cell, name, quantity, text, value)


def test_methods_take_their_constants_from_the_other_page() -> None:
    assert [list(row.values()) for row in read_table(methods.PAGE, "inf-sup")] == methods.infsup_rows()


@pytest.mark.parametrize(
    ("contactor", "name"), [*(("block", name) for name in methods.LAWS), ("cylinder", "nodes, one pass")]
)
def test_hertz_errors(contactor: str, name: str) -> None:
    rows = {(r["cells"], r["contactor"], r["method"]): r for r in read_table(methods.PAGE, "hertz")}
    value = 100.0 * methods.hertz_error(methods.hertz_solution("quad8", contactor, name, 0))
    printed = rows["quad8", contactor, name][methods.HERTZ_HEADER[3]]
    assert agrees(printed, value), (printed, value)


def test_integration_without_segments() -> None:
    printed = [list(row.values()) for row in read_table(methods.PAGE, "facets")]
    for facets, row in zip(methods.FACETS, printed, strict=True):
        if row[0].startswith("line"):
            assert methods.facet_row(*facets) == row
        else:
            assert methods.facet_row(*facets, points=(2,)) == [*row[:4], row[-1]]


@pytest.mark.long
@pytest.mark.parametrize(
    ("table", "key", "row"),
    [
        ("line", ("quad4", "6", "default"), lambda: pressure.line_row("quad4", 6, "default")),
        ("line", ("quad8", "6", "default"), lambda: pressure.line_row("quad8", 6, "default")),
        ("line", ("quad8", "6", "P2"), lambda: pressure.line_row("quad8", 6, "P2")),
        ("ball", ("tet4", "block", "default"), lambda: pressure.ball_row("tet4", "block", "default")),
        ("axis", ("tri3", "10", "default"), lambda: pressure.axis_row("tri3", 10, "default")),
        ("square", ("default",), lambda: pressure.square_row("default")),
        ("flat", ("quad4", "block", "default"), lambda: pressure.flat_row("quad4", "block", "default")),
        ("bent", ("hex8",), lambda: pressure.bent_row("hex8")),
        ("bent", ("quad8",), lambda: pressure.bent_row("quad8")),
        ("rim", ("error over change",), pressure.rim_row),
    ],
)
def test_reported_pressure(table: str, key: tuple[str, ...], row: Callable[[], list[str]]) -> None:
    rows = [list(r.values()) for r in read_table(pressure.PAGE, table)]
    (printed,) = (r for r in rows if tuple(r[: len(key)]) == key)
    for text, value in zip(printed, row(), strict=True):
        number = value.removesuffix(" %")
        same = text == value
        assert same or agrees(text, float(number)), (table, key, text, value)


def test_rates_are_those_of_the_benchmarks() -> None:
    assert [list(r.values()) for r in read_table(pressure.PAGE, "rates")] == pressure.rate_rows()


@pytest.mark.long
def test_friction_beside_calculix() -> None:
    """What the page says of abut, and that CalculiX is no further away than the text has it."""
    printed = read_table(methods.PAGE, "friction")
    for row, own in zip(printed, ccx_friction.by_abut(), strict=True):
        assert agrees(row["abut, N m"], float(own[1]))
        assert agrees(row["2 pi r^2 L mu p, N m"], float(own[2]))
        assert float(row["CalculiX, N m"]) == pytest.approx(float(own[1]), rel=0.025)
