"""What speaks against a contactor that the user has named, by the rule of ``abut.contact.contactor_choice``."""

from __future__ import annotations

from dataclasses import replace

from abut.contact.contactor_choice import Choice, Side, choose
from abut.contact.sides import code, words
from abut.diagnosis.finding import Finding
from abut.errors import InputError
from abut.model import Contact, Model

CURES = {
    "softer": "swap contactor and target: the softer side should carry the pressure",
    "covered": "swap contactor and target, or end the facets of the contactor where the target ends",
    "edge": "swap contactor and target: the side whose edge presses should carry the pressure",
    "coarser": "swap contactor and target: the coarser side should carry the pressure",
}


def sides(model: Model, contact: Contact) -> list[Finding]:
    """Which side is the contactor, and advice to swap them where the pressure would gain by it."""
    where = f"contact '{contact.name}'"
    first, other = model.measured(contact)
    moduli = f"E/(1-nu^2) {first.modulus:.3g} (contactor) and {other.modulus:.3g}"
    summary = f"{moduli}, facets {first.size:.3g} and {other.size:.3g}"
    choice = choose(first, other)
    held = choice.rule == "rigid"  # the check of constraints says it
    if choice.clear and choice.contactor == 1 and not held and swap(model, contact, choice):
        what = f"contactor {words(contact.contactor)} {_against(choice, first, other)} ({summary})"
        return [Finding("advice", where, what, f"{CURES[choice.rule]}, or give surfaces = [...] and let abut choose")]
    return [Finding("info", where, summary)]


def swap(model: Model, contact: Contact, choice: Choice | None = None) -> str:
    """To swap the sides of a contact, in words; empty where the present contactor is clearly the right one, and where the
    model would be refused, or the same."""
    if contact.contactor == contact.target:
        return ""
    choice = choice or choose(*model.measured(contact))
    if choice.clear and choice.contactor == 0:
        return ""
    other = contact.forced(contact.target, contact.contactor)
    try:
        replace(model, contacts=[other if each is contact else each for each in model.contacts])
    except InputError:
        return ""
    return f"swap the sides (contactor = {code(contact.target)}, target = {code(contact.contactor)})"


def _against(choice: Choice, side: Side, other: Side) -> str:
    """What speaks against the contactor, after its name."""
    return {
        "softer": "is the stiffer side",
        "covered": f"has only {side.covered:.0%} of the area of its facets opposite the target, {other.covered:.0%} the "
        "other way round",
        "edge": "is a face on which an edge of the target presses",
        "coarser": f"is {other.size / side.size:.2g} times finer than its target",
    }[choice.rule]
