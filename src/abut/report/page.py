"""The report: one HTML file with everything in it, which opens without a network."""

from __future__ import annotations

import json
import math
import time
from collections.abc import Iterable, Sequence
from html import escape
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

import abut
from abut.diagnosis.advice import remedies, unsettled
from abut.diagnosis.cures import cure
from abut.io.versions import versions
from abut.report.arrays import Packer
from abut.report.carried import carried_tables
from abut.report.chart import Beside, Chart
from abut.report.contact_words import ZERO, centre, force, moment, number, on_bodies, place, vector
from abut.report.describe import tables
from abut.report.friction import HEAD, friction_history, friction_rows
from abut.report.lines import pressure_lines
from abut.report.modes import modes_tables
from abut.report.motion import paths
from abut.report.origin import Origin, comparison, ellipse
from abut.report.probes import charts, probe_table
from abut.report.quantities import extremes, largest_by_body
from abut.report.responses import response_charts, response_lines
from abut.report.scene import scene
from abut.report.still import still_page
from abut.report.times import time_axis
from abut.solution import ContactResult, Solution
from abut.types import Json

SCRIPTS = ("plots", "inflate", "parts", "arrows", "section", "sight", "vibration", "view", "report")
UNLIKE = 1.05  # contact force by area over the resultant, from which on both are shown
STYLES = ("libraries.css", "report.css")
STILL = ("report.css", "still.css")  # without the libraries


def page(solution: Solution, origin: Origin, beside: Beside | None = None) -> str:
    """The whole report as text of an HTML file. beside: another solution of the same problem, compared with this one."""
    of_bodies, arrays = extremes(solution), Packer()
    picture = scene(solution, of_bodies=of_bodies)
    data = {
        "scene": arrays.all(picture.data),
        "convergence": _convergence(solution),
        "history": _history(solution),
        "lines": _lines(solution, origin),
        "probes": _charts([*charts(solution), *response_charts(solution)]),
        "paths": _charts(paths(solution)),
        "beside": _charts(beside.charts if beside else ()),
    }
    libraries = _libraries()
    parts = {
        "title": escape(origin.title),
        "style": "\n".join(map(_static, STYLES)) if libraries else "".join(map(_static, STILL)),
        "head": _head(solution, origin),
        "reduced": "".join(f"<p class=note>To keep this file small, {escape(text)}.</p>" for text in picture.reduced),
        "certificate": _certificate(solution),
        "comparison": _comparison(solution, origin),
        "trouble": _trouble(solution),
        "probes": _probes(solution),
        "beside": "" if beside is None else _beside(beside),
        "contacts": "".join(_table(*t) for t in modes_tables(solution)) + _contacts(solution) + _rigid(solution),
        "bodies": _table(*largest_by_body(solution, of_bodies), _all_steps(solution)),
        "model": "".join(_table(t["head"], t["rows"], t["title"]) for t in tables(solution.model)),
        "run": _run(solution),
        "job": f"<pre>{escape(origin.text)}</pre>" if origin.text else "<p class=note>The model came from Python.</p>",
        "data": json.dumps(data, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c"),
        "arrays": arrays.text if libraries else "",
        "libraries": f"<script>{libraries}</script>" if libraries else "",
        "scripts": f"<script>{''.join(_static(f'{name}.js') for name in SCRIPTS)}</script>" if libraries else "",
    }
    first, *rest = _static("report.html").split("{{")
    text = [first]
    for piece in rest:
        name, after = piece.split("}}", 1)
        text += [parts[name], after]
    return "".join(text) if libraries else still_page("".join(text), {**data, "scene": picture.data})


def _all_steps(solution: Solution) -> str:
    return "At the nodes of each body" + (", of all steps" if len(solution.steps) > 1 else "")


def _static(name: str) -> str:
    return files("abut.report").joinpath("static", name).read_text(encoding="utf-8")


def _libraries() -> str:
    """three.js and uPlot, "" where they were not to be had when abut was built."""
    try:
        return _static("libraries.js")
    except FileNotFoundError:
        return ""


def _head(solution: Solution, origin: Origin) -> str:
    failed = [check for check in solution.certificate if not check.passed]
    theory = [row for row in comparison(solution, origin.expected) if not row["passed"]]
    if not solution.converged:
        good, verdict = (
            False,
            f"Not converged at step {solution.steps[-1].number}{_reached(solution)}: what follows is the last state.",
        )
    elif not solution.complete:
        good, verdict = False, f"Stopped after step {len(solution.steps)}{_reached(solution)}: there are steps left."
    elif failed:
        names = ", ".join(f"{c.contact}: {c.name}" if c.contact else c.name for c in failed)
        good, verdict = False, f"Converged, but {len(failed)} of {len(solution.certificate)} checks fail: {names}."
    elif theory:
        good, verdict = False, f"Converged, but different from theory: {', '.join(r['quantity'] for r in theory)}."
    else:
        warns = [f"{c.contact}: {c.name}" if c.contact else c.name for c in solution.certificate if c.warns]
        but = f", with a warning of {', '.join(warns)}" if warns else ""
        good, verdict = True, f"Converged, and all {len(solution.certificate)} checks pass{but}."
    facts = [("unknowns", f"{solution.dofs:,}".replace(",", " ")), ("solver", solution.solver)]
    if solution.contacts:
        ties = {contact.name for contact in solution.model.contacts if contact.kind == "tied"}
        touching = [c for c in solution.contacts if c.name not in ties] or solution.contacts
        top = max(touching, key=lambda c: c.max_pressure)
        most = max(touching, key=lambda c: float(np.linalg.norm(c.force)))
        end = " at the end" if len(solution.steps) > 1 else ""
        carried = max(c.force_by_area for c in touching)
        resultant = float(np.linalg.norm(most.force))
        by_area = [("contact force by area" + end, number(carried))] if carried > UNLIKE * resultant else []
        facts = [
            ("largest pressure" + end, number(top.max_pressure)),
            ("resultant of contact" + end if by_area else "contact force" + end, _size(resultant, carried)),
            *by_area,
            ("contact area" + end, number(sum(c.area for c in touching))),
            *facts,
        ]
        shown = {c.name for c in touching}
        before = max(c.max_pressure for step in solution.steps for c in step.contacts if c.name in shown)
        if before > top.max_pressure:
            facts.insert(0, ("largest pressure of all steps", number(before)))
    facts.append(("seconds", f"{sum(solution.timings.values()):.3g}"))
    chips = "".join(f"<div><b>{escape(value)}</b><span>{name}</span></div>" for name, value in facts)
    mark = "✓" if good else "✗"
    return (
        f"<h1>{escape(origin.title)}</h1>"
        f'<p class="verdict {"good" if good else "bad"}"><i>{mark}</i>{escape(verdict)}</p><div class=facts>{chips}</div>'
    )


def _size(value: float, scale: float) -> str:
    return number(value if value > ZERO * scale else 0.0)


def _reached(solution: Solution) -> str:
    times = [step.factor for step in solution.steps if step.converged]
    return f", time {solution.model.solve.said(times[-1])} reached" if times else ""


def _certificate(solution: Solution) -> str:
    rows = [
        [
            _mark(check.verdict),
            escape(check.contact or "whole model"),
            escape(check.name),
            "unknown" if check.unknown else f"{check.value:.2e}",
            f"{check.limit:.2e}",
            escape(f"{check.meaning}; unknown: {check.unknown}" if check.unknown else check.meaning)
            + _cure(cure(check, solution)),
        ]
        for check in solution.certificate
    ]
    return _table(["", "contact", "check", "value", "limit", "meaning"], rows, raw=True)


def _cure(text: str) -> str:
    return f"<br><b>Cure:</b> {escape(text)}" if text else ""


def _mark(verdict: str) -> str:
    return f"<span class={verdict.lower()}>{verdict}</span>"


def _comparison(solution: Solution, origin: Origin) -> str:
    rows = [
        [
            _mark("pass" if row["passed"] else "FAIL"),
            escape(row["quantity"]),
            f"{row['value']:.7g}",
            escape(row["expected"]),
            "" if row["deviation"] is None else f"{100 * row['deviation']:+.2g} %",
            escape(row["source"]),
        ]
        for row in comparison(solution, origin.expected)
    ]
    if not rows:
        return ""
    known = [solution.contacts[0].name] if solution.contacts else []
    known += ["probes"] if any(name.startswith("probe.") for name in origin.expected) else []
    head = ["", f"of {escape(' and '.join(known))}", "computed", "theory", "deviation", "source"]
    return "<section><h2>Compared with theory</h2>" + _table(head, rows, raw=True) + "</section>"


def _contacts(solution: Solution) -> str:
    rows = [
        [
            c.name,
            force(c),
            number(c.force_by_area),
            number(c.max_pressure),
            number(c.area),
            number(c.max_penetration),
            f"{c.active} of {c.multipliers}",
            f"{100 * c.covered_share:.3g} %",
        ]
        for c in solution.contacts
    ]
    head = [
        "contact",
        "force on the side named first",
        "by area",
        "largest pressure",
        "area",
        "penetration",
        "active",
        "covered",
    ]
    text = _table(head, rows, "At the end of the last step") + _statistics(solution) if rows else ""
    rubbing = friction_rows(solution)
    return text + (_table(HEAD, rubbing, "Friction") if rubbing else "")


def _statistics(solution: Solution) -> str:
    """Where the pressure is, and where the resultant acts; columns that say something only."""
    columns = {
        "contact": [c.name for c in solution.contacts],
        "largest pressure at": [place(c) for c in solution.contacts],
        "mean": [number(c.statistics.mean) for c in solution.contacts],
        "95th percentile": [number(c.statistics.percentile_95) for c in solution.contacts],
        "largest where less than half covered": [number(c.statistics.partly_covered) for c in solution.contacts],
        "centre of pressure": [centre(c) for c in solution.contacts],
        "moment about the origin": [moment(c) for c in solution.contacts],
        "force on bodies of the side named second": [on_bodies(c) for c in solution.contacts],
    }
    shown = {head: cells for head, cells in columns.items() if not set(cells) <= {"none", ""}}
    return _table(
        list(shown), zip(*shown.values()), "Pressure over the loaded area, and its resultant on the side named first"
    )


def _rigid(solution: Solution) -> str:
    rows = [
        [name, *(vector(v) for v in (r.displacement, r.rotation, r.force, r.moment))]
        for name, r in solution.steps[-1].rigid.items()
    ]
    head = ["rigid body, coupling", "displacement", "rotation", "force on it", "moment about its reference"]
    carried = "".join(_table(*table) for table in carried_tables(solution))
    return (_table(head, rows) if rows else "") + carried


def _beside(beside: Beside) -> str:
    return (
        f"<section><h2>{escape(beside.title)}</h2><p>{escape(beside.text)}</p>{_table(beside.head, beside.rows)}"
        '<div class="plots" id="beside"></div></section>'
    )


def _probes(solution: Solution) -> str:
    """The section of probes and responses, empty without any; plots follow the table."""
    table, lines = probe_table(solution), response_lines(solution)
    if table is None and not lines:
        return ""
    read = "" if table is None else _table(table["head"], table["rows"], table["title"])
    text = read + "".join(f"<p>{escape(line)}</p>" for line in lines)
    return f'<section><h2>{"Response" if lines else "Probes"}</h2>{text}<div class="plots" id="probes"></div></section>'


def _trouble(solution: Solution) -> str:
    """What a reader must know first: where a run did not converge and what helps, and what was left out of a deck."""
    text = ""
    if not solution.converged:
        last = solution.steps[-1].iterations[-1]
        places = [f"{place}; nodes {_some(place.nodes)}" for place in unsettled(solution.steps[-1])]
        where = places or [f"no single facets: the residual of equilibrium is {last.residual:.1e} of the forces"]
        text += (
            f"<section><h2>Not converged</h2><p>Where:</p>{_list(where)}<p>What to try, the most likely first:</p>"
            f"{_list(map(str, remedies(solution)), 'ol')}</section>"
        )
    elif advice := remedies(solution):
        listed = _list(map(str, advice), "ol")
        text += f"<section><h2>Contact is narrow for its facets</h2><p>What to try:</p>{listed}</section>"
    if solution.ignored:
        text += f"<section><h2>Omitted from the deck, as asked</h2>{_list(solution.ignored)}</section>"
    return text


def _some(nodes: NDArray[np.int64]) -> str:
    return ", ".join(map(str, nodes[:20].tolist())) + (f", ... ({len(nodes)} in all)" if len(nodes) > 20 else "")


def _list(items: Iterable[str], kind: str = "ul") -> str:
    return f"<{kind}>" + "".join(f"<li>{escape(item)}</li>" for item in items) + f"</{kind}>"


def _run(solution: Solution) -> str:
    timings = [[name, f"{seconds:.3g} s"] for name, seconds in solution.timings.items()]
    stamp = time.strftime("%Y-%m-%d %H:%M")
    return (
        f"<div class=columns><div>{_table(['stage', 'time'], timings)}</div>"
        f"<div>{_table(['version', ''], [[k, v] for k, v in versions().items()])}</div></div>"
        f"{_list(solution.notes)}<p class=note>Written by abut {abut.__version__}, {stamp}.</p>"
    )


def _table(head: Sequence[str], rows: Iterable[Sequence[str]], title: str = "", raw: bool = False) -> str:
    text = (lambda cell: cell) if raw else escape
    body = "".join("<tr>" + "".join(f"<td>{text(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    names = "".join(f"<th>{text(name)}</th>" for name in head)
    heading = f"<h3>{escape(title)}</h3>" if title else ""
    return f"{heading}<div class=wide><table><thead><tr>{names}</tr></thead><tbody>{body}</tbody></table></div>"


def _plain(values: Iterable[float] | NDArray[np.float64]) -> list[float | None]:
    """Numbers for a plot: seven digits, None where there is none."""
    return [float(f"{value:.7g}") if math.isfinite(value) else None for value in values]


def _convergence(solution: Solution) -> Json:
    rows = [row for step in solution.steps for row in step.iterations]
    return {
        "step": [row.step for row in rows],
        "residual": _plain(row.residual for row in rows),
        "contact": _plain(row.contact_residual for row in rows),
        "active": [row.active for row in rows],
        "changed": [row.changed for row in rows],
        "slipping": [row.slipping for row in rows if row.slipping is not None],
    }


def _history(solution: Solution) -> Json:
    names = [contact.name for contact in solution.contacts]
    each = [[step.contacts[i] for step in solution.steps] for i in range(len(names))]
    return {
        **time_axis(solution),
        "contacts": [
            {
                "name": name,
                "force": _plain(float(np.linalg.norm(c.force)) for c in values),
                "by_area": _plain(c.force_by_area for c in values),
                "area": _plain(c.area for c in values),
                "pressure": _plain(c.max_pressure for c in values),
                "friction": _friction(values),
            }
            for name, values in zip(names, each)
        ],
    }


def _friction(steps: Sequence[ContactResult]) -> Json | None:
    found = friction_history([contact.friction for contact in steps])
    return None if found is None else {name: _plain(values) for name, values in found.items()}


def _charts(some: Sequence[Chart]) -> list[Json]:
    return [
        {
            "title": chart.title,
            "label": chart.label,
            "x": _plain(chart.x),
            "series": [{"label": name, "values": _plain(values)} for name, values in chart.series.items()],
        }
        for chart in some
    ]


def _lines(solution: Solution, origin: Origin) -> list[Json]:
    theory = ellipse(origin.expected)
    result = []
    for index, contact in enumerate(solution.contacts):
        for line in pressure_lines(contact):
            distance, reference = line.distance, None
            if theory and index == 0 and len(theory[2]) == line.points.shape[1]:
                peak, half, centre = theory
                distance = line.distance_from(np.array(centre))
                reference = peak * np.sqrt(np.maximum(1.0 - (distance / half) ** 2, 0.0))
            result.append(
                {
                    "contact": contact.name,
                    "label": line.label,
                    "zero": "the largest pressure" if reference is None else "the centre of contact",
                    "distance": _plain(distance),
                    "pressure": _plain(line.pressure),
                    "gap": _plain(line.opening),
                    "traction": None if line.traction is None else _plain(line.traction),
                    "limit": None if line.limit is None else _plain(line.limit),
                    "theory": None if reference is None else _plain(reference),
                }
            )
    return result
