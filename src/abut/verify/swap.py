"""The second opinion: a model solved as it is and with the sides of its contacts swapped. Where they differ one is wrong."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from abut.analysis import solve
from abut.contact.sides import words
from abut.errors import ConvergenceError, InputError
from abut.mesh.surface import Surface
from abut.model import Contact, Model
from abut.model.side_choice import OF_FRICTION
from abut.report.chart import Chart
from abut.report.lines import Line, pressure_lines
from abut.solution import ContactResult, Solution

LIMIT = 0.1  # of the largest pressure: two resolved solutions differ by a few per cent of it inside the contact
FORCE = 0.02  # of the forces by size
PRESSED = 1e-3  # of the largest pressure: less is none
Array = NDArray[np.float64]


@dataclass(frozen=True)
class Comparison:
    """One contact in both solutions, as it is first. sides: contactor; force: (dim,) on the side named first; pressure:
    largest; area: in contact. Differences: of the forces over the forces by size; local: the largest of the pressures at
    the nodes of both surfaces inside the contact, mean: root mean square there, both over the largest pressure, NaN where
    no node has pressed neighbours only."""

    contact: str
    first: str
    contactors: tuple[str, str]
    force: tuple[Array, Array]
    pressure: tuple[float, float]
    area: tuple[float, float]
    of_force: float
    local: float
    mean: float

    @property
    def passed(self) -> bool:
        """Whether both agree within ``FORCE`` and ``LIMIT``."""
        return self.of_force <= FORCE and not self.local > LIMIT


@dataclass(frozen=True)
class Swap:
    """Both solutions, what was compared, curves of the pressures, and why the sides of some contacts stayed (by name)."""

    solutions: tuple[Solution, Solution]
    comparisons: tuple[Comparison, ...]
    charts: tuple[Chart, ...]
    left: dict[str, str]

    @property
    def passed(self) -> bool:
        """Whether all contacts agree."""
        return all(each.passed for each in self.comparisons)


def swap(model: Model, tell: Callable[[str], None] = lambda _: None) -> Swap:
    """Solve a model as it is and with the sides swapped of all contacts that can be. tell: gets what is being done.

    Raises InputError where no contact can be swapped, ConvergenceError where one of the two does not converge."""
    other, left = swapped(model)
    solutions = []
    for each, how in ((model, "as it is"), (other, "with the sides swapped")):
        tell(f"solving {how}")
        solution = solve(each)
        if not solution.converged:
            raise ConvergenceError(f"the model {how} did not converge: {solution.steps[-1].reason or 'see abut run'}")
        solutions.append(solution)
    one, two = solutions
    turned = [(a, b) for a, b in zip(one.contacts, two.contacts) if a.name not in left]
    comparisons = tuple(_compared(model, a, b) for a, b in turned)
    charts = tuple(chart for a, b in turned for chart in _charts(a, b))
    return Swap((one, two), comparisons, charts, left)


def swapped(model: Model) -> tuple[Model, dict[str, str]]:
    """The model with the sides of its contacts swapped, and why those of some contacts were not, by name. Raises InputError
    where none can be."""
    contacts: list[Contact] = []
    left: dict[str, str] = {}
    for contact in model.contacts:
        other = contact.forced(contact.target, contact.contactor)
        why = _stays(model, contact, [other if each is contact else each for each in model.contacts])
        if why:
            left[contact.name] = why
        contacts.append(contact if why else other)
    if len(left) == len(contacts):
        reasons = "; ".join(f"'{name}': {why}" for name, why in left.items()) or "it has no contact"
        raise InputError(f"verify --swap: no contact of the model can be swapped ({reasons})")
    return replace(model, contacts=contacts), left


def _stays(model: Model, contact: Contact, contacts: list[Contact]) -> str:
    """Why the sides of a contact cannot be swapped, empty where they can."""
    if contact.contactor == contact.target:
        return "a surface on itself"
    if contact.chosen == OF_FRICTION:
        return "its friction goes with the points of its contactor"
    if np.isinf(model.measured(contact)[1].modulus):
        return f"{words(contact.target)} is rigid or held"
    try:
        replace(model, contacts=contacts)
    except InputError as error:
        return str(error)
    return ""


def _compared(model: Model, one: ContactResult, two: ContactResult) -> Comparison:
    contact = next(c for c in model.contacts if c.name == one.name)
    forces = one.force, two.force if contact.turned else -two.force  # two's is on its contactor, one's target
    size = max(float(np.linalg.norm(c.contactor_forces, axis=1).sum()) for c in (one, two))
    peak = max(one.max_pressure, two.max_pressure, 1e-300)
    off = np.concatenate([_differences(one, two, peak), _differences(two, one, peak)])
    return Comparison(
        one.name,
        words(contact.named[0]),
        (words(contact.contactor), words(contact.target)),
        forces,
        (one.max_pressure, two.max_pressure),
        (one.area, two.area),
        float(np.abs(forces[0] - forces[1]).max() / max(size, 1e-300)),
        float(off.max()) if len(off) else float("nan"),
        float(np.sqrt((off**2).mean())) if len(off) else float("nan"),
    )


def _differences(one: ContactResult, two: ContactResult, peak: float) -> Array:
    """Of the pressures over the largest, at the nodes of one's contactor, two's target, all of whose facets are pressed in
    both solutions all over (n,)."""
    own, other = one.pressure, _on_contactor(one, two)
    nodes, used = one.contactor.nodes, one.contactor.nodes >= 0
    least = np.where(used, np.minimum(own, np.nan_to_num(other, nan=np.inf)), np.inf)
    bare = used & ((np.nan_to_num(one.share) < 0.5) | np.isnan(other))
    open_facet = (least < PRESSED * peak).any(axis=1) | bare.any(axis=1)
    at_edge = np.zeros(len(one.contactor.points), dtype=bool)
    at_edge[nodes[open_facet][used[open_facet]]] = True
    inside = used & ~at_edge[np.maximum(nodes, 0)]
    return np.asarray(np.abs(own - other)[inside] / peak)


def _on_contactor(one: ContactResult, two: ContactResult) -> Array:
    """The pressure that two has on its target at the facets of one's contactor, (n_facets, 9); NaN where it has no such
    facet."""
    place = {code: i for i, code in enumerate(_codes(two.target))}
    found = np.array([place.get(code, -1) for code in _codes(one.contactor)], dtype=np.int64)
    return np.where(found[:, None] >= 0, two.target_pressure[np.maximum(found, 0)], np.nan)


def _codes(surface: Surface) -> list[tuple[int, int]]:
    return list(zip(surface.cells.tolist(), surface.local.tolist()))


AS_IT_IS, SWAPPED = "as it is", "sides swapped"


def _charts(one: ContactResult, two: ContactResult) -> list[Chart]:
    """Both pressures along the interface: in 2D each on its own contactor, in 3D on cuts of one's."""
    carried = replace(one, gap=np.where(one.contactor.nodes >= 0, _on_contactor(one, two), np.nan), friction=None)
    lines = pressure_lines(carried)
    label = "distance from the largest pressure"
    if one.contactor.dim == 2 and lines and (others := pressure_lines(replace(two, friction=None))):
        line, other = lines[0], others[0]
        at = _along(line, other.points)
        x = np.concatenate([line.distance, at])
        order = np.argsort(x, kind="stable")
        series = {
            AS_IT_IS: np.concatenate([line.pressure, np.full(len(at), np.nan)])[order],
            SWAPPED: np.concatenate([np.full(len(line.distance), np.nan), other.pressure])[order],
        }
        return [Chart(f"{one.name}: pressure along the contact", label, x[order], series)]
    return [
        Chart(f"{one.name}: pressure {line.label}", label, line.distance, {AS_IT_IS: line.pressure, SWAPPED: line.gap})
        for line in lines
    ]


def _along(line: Line, points: Array) -> Array:
    """Distance along a line where it passes nearest to points (n, 2)."""
    return np.array([-line.distance_from(point)[0] + line.distance[0] for point in points])
