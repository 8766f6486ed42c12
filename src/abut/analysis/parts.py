"""One step from the parts in which it was taken, where it had to be halved."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields, replace

from abut.solution import ContactResult, Energy, Step
from abut.solution.contacts import worst


def whole(parts: Sequence[Step]) -> Step:
    """The step at the end of the last of its parts: what happened within it is added up, and every check is that of the
    worst part."""
    last = parts[-1]
    if len(parts) == 1:
        return last
    contacts = tuple(_contact([part.contacts[i] for part in parts]) for i in range(len(last.contacts)))
    iterations = tuple(row for part in parts for row in part.iterations)
    return replace(last, contacts=contacts, iterations=iterations, energy=_energy([part.energy for part in parts]))


def _contact(parts: Sequence[ContactResult]) -> ContactResult:
    last, rubbed = parts[-1], [part.friction for part in parts if part.friction is not None]
    checks = tuple(
        worst([other for part in parts for other in part.checks if other.name == check.name]) for check in last.checks
    )
    if not rubbed:
        return replace(last, checks=checks)
    friction = replace(
        rubbed[-1],
        slip=sum((result.slip for result in rubbed[:-1]), rubbed[-1].slip),
        work=sum(result.work for result in rubbed),
        work_per_area=sum((result.work_per_area for result in rubbed[:-1]), rubbed[-1].work_per_area),
    )
    return replace(last, checks=checks, friction=friction)


def _energy(parts: Sequence[Energy | None]) -> Energy | None:
    known = [part for part in parts if part is not None]
    if not known:
        return None
    last, told = ("elastic", "unexplained"), [part.unexplained for part in known if part.unexplained is not None]
    total = {f.name: sum(getattr(part, f.name) for part in known) for f in fields(Energy) if f.name not in last}
    most = {name: max(getattr(part, name) for part in known) for name in ("size", "earlier")}
    return Energy(**{**total, **most, "elastic": known[-1].elastic, "unexplained": max(told, default=None)})
