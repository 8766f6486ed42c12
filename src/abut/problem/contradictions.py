"""What is said where supports and other constraints contradict each other."""

from __future__ import annotations

from collections.abc import Sequence

from abut.errors import SingularModelError

NAMED = 6  # constraints named in an error


def at_node(names: Sequence[str], where: str) -> SingularModelError:
    """Of supports that give a node different displacements in one direction. names: of each, alike where they are on one
    group."""
    what, known = "different displacements in one direction", sorted(set(names))
    if len(names) == 1:
        return SingularModelError(f"{names[0]} contradicts itself {where}: it prescribes {what}; leave out a component")
    who = listed(known) if len(known) > 1 else known[0].replace("support", "supports", 1)
    return SingularModelError(f"{who} contradict each other {where}: they prescribe {what}; take one of them out")


def among(names: Sequence[str]) -> str:
    """Of constraints on several points, each once."""
    if len(names) == 1:
        return (
            f"{names[0]} contradicts what is prescribed at its points: no displacement meets both; take one of them out"
        )
    return f"{listed(names)} contradict each other: no displacement meets all; take one of them out"


def listed(names: Sequence[str]) -> str:
    """Two or more names in a sentence."""
    if len(names) > NAMED:
        names = [*names[:NAMED], f"{len(names) - NAMED} more"]
    return f"{', '.join(names[:-1])} and {names[-1]}"
