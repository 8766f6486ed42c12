"""How to correct what makes a line of the certificate fail: one sentence each."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from abut.analysis.loaded_area import LOADED
from abut.cells import CELLS
from abut.contact.contactor_choice import FINER, Choice, choose
from abut.contact.coupling import surface_degree
from abut.contact.geometry import facet_sizes
from abut.contact.sides import words
from abut.diagnosis.common_ends import presses_at_common_end
from abut.diagnosis.contactor import swap
from abut.model import LAWS, METHODS, Contact
from abut.model.contact import SECOND
from abut.model.locking import locking
from abut.solution import Check, ContactResult, Solution
from abut.solution.flow import GO_ON
from abut.solution.modes import BUCKLING, FREQUENCIES
from abut.solution.stress_error import ContactStressError

EITHER = Choice(1, "alike", False)  # whatever else speaks for the present contactor
OF_NARROW = {"overlap", "oscillation", "largest pressure"}  # lines that the mesh does not mend at a sharp edge
UNSETTLED = {"complementarity", "friction cone", "slip direction", "sticking", "friction work"}
SINGULAR_HINT = "check the units of Young's moduli, loads and mesh, and constrain every body by supports of its own"


def cure(check: Check, solution: Solution) -> str:
    """What to change so that a failed check passes, or one that warns does no more, a sentence; empty for the others."""
    if check.passed and not check.warns:
        return ""
    if check.name == "stress error":
        return _stress_error(solution)
    if check.name == "model balance" and (few := _few_digits(solution)):
        return few
    if check.name.partition(":")[0] in (FREQUENCIES, BUCKLING):
        return OF_MODES[check.name.partition(": ")[2]]
    if check.name.endswith("response: modes left out"):
        return "ask for more modes (frequencies.count), up to about twice the highest frequency that shakes"
    if check.name == "locking":
        return "; ".join(one.cure for one in locking(solution.model))
    if not check.contact:
        return MODEL[check.name]
    if check.name in UNSETTLED and not solution.converged:
        taken = len(solution.steps[-1].iterations)
        if taken < solution.model.solve.max_iterations:
            return "the step did not converge: what is advised for that mends this line, too"
    name = check.contact.removesuffix(SECOND)
    contact = next(c for c in solution.model.contacts if c.name == name)
    result = next(c for c in solution.contacts if c.name == check.contact)
    choice = EITHER if check.name == "contactor's edges" else None
    at_edge = any(one.name == "sharp edge" and one.contact == check.contact for one in solution.certificate)
    line = "sharp edge" if at_edge and check.name in OF_NARROW else check.name
    sides = swap(solution.model, contact, choice)
    if line == "pressure error" and not choose(*solution.model.measured(contact)).clear:
        sides = ""  # finer facets on both sides will do more than the other of two alike
    return OF_CONTACT[line](contact, result, sides)


def cures(solution: Solution) -> tuple[tuple[Check, str], ...]:
    """Every failed check with its cure."""
    return tuple((check, cure(check, solution)) for check in solution.certificate if not check.passed)


OF_MODES = {
    "residual": f"{SINGULAR_HINT}; very thin or very unlike parts leave fewer digits",
    "orthogonality": "ask for a few modes more or less, so that the last one is none of a group of equal ones",
    "missing modes": "ask for more modes (count); where many are equal some are easily missed",
}
MODEL = {
    "model balance": f'solve again with solve.linear = "direct"; if it stays, {SINGULAR_HINT}',
    "energy balance": 'solve again with solve.linear = "direct"; if it stays, raise solve.max_iterations',
    "load steps": "what friction does depends on the load steps by about this share: give more of them (solve.steps = 40), "
    "until the result stays",
    "stabilisation": "bodies jumped to another equilibrium, which a note dates: forces there are right, what happens "
    "on the way is not told. To follow it prescribe a displacement instead of the force; hold what is loose by a support",
    "jumps": "bodies jumped to another equilibrium in the steps named, or Newton's method found one that they do not come "
    "to: give more steps (solve.steps = 40) until results before and after stay; to follow what is between, prescribe a "
    "displacement instead of the force",
    "free rigid-body modes": "add a support, or a symmetry plane (normal = 0), that constrains the mode named in the notes",
    "strain": "check the units of Young's moduli, pressures and mesh: strains of this size are beyond linear elasticity",
    "stress error": "refine where the field stress_error is large, and round sharp inner corners, where stresses have "
    "no limit",
    "hourglass": 'give the strip two cells across, or integration = "full" for its body (in decks B32 '
    "for B32R); means over its sections are right",
    "bodies apart": "couple them: a contact for each of these pairs of bodies, or `auto = true`; if they are "
    "meant to be one, tie them or let them share nodes",
    "plastic strain": 'with small kinematics: kinematics = "finite"; with finite: check loads and yield stress, strains of '
    "this size stretch cells to more than twice their length",
    "limit load": GO_ON,
    "volume change": "smaller cells where it is, or mixed ones (quad9, tri6, hex27, tet10: integration = 'mixed'); in a law "
    "of your own check that stresses have the bulk modulus of its `linear`",
    "preload": "what is loaded at the section of a preload carries none of it: tighten before the loads come, in steps of "
    "their own, and let the section cut all of one body",
    "loose bolts": "tighten the bolt more, or load it less: a bolt carries no compression",
    "weak springs": "hold what the weak springs hold by a support, a contact, a tie or friction; if they only keep a part "
    "in place, make them weaker",
    "rotation": 'kinematics = "finite": lengths change by half the square of a turn that is taken for small',
    "response": "check that what is moved or loaded touches another body or a support: signs and units of motions and "
    "loads, gaps, names of contacts; `abut check` names gaps that stay open",
}


def _few_digits(solution: Solution) -> str:
    """Where no more is left of the balance than displacements in double precision leave, theory (V14); else empty."""
    step = max(solution.steps, key=lambda step: step.balance_error / step.balance_limit)
    if step.balance_error * step.reference_force > step.rounding:
        return ""
    share = step.rounding / max(float(np.abs(step.load).max()), float(np.abs(step.reaction).max()), 1e-300)
    return (
        f"displacements in double precision leave forces of {step.rounding:.2g} open here, {share:.0e} of those that act: "
        "parts are too thin for their length, or too unlike in stiffness, and results as wrong. Make thin parts thicker "
        "with a Young's modulus that keeps E t^3, or shorter"
    )


def _stress_error(solution: Solution) -> str:
    known = [step.stress_error for step in solution.steps if step.stress_error is not None]
    coarse = max(known, key=lambda e: e.energy).coarse
    where = MODEL["stress error"]
    if not coarse:
        return where
    worst: dict[str, ContactStressError] = {}
    for near in coarse:
        worst.setdefault(near.body, near)
    sizes = ", ".join(f"{e.wanted:.2g} (now {e.size:.2g}) in '{e.body}'" for e in worst.values())
    return f"for 5 %, cells where bodies touch of about {sizes}; {where}"


def _balance(contact: Contact, result: ContactResult, sides: str) -> str:
    return 'leave `integration` and `method` out, and solve with solve.linear = "direct"'


def _penetration(contact: Contact, result: ContactResult, sides: str) -> str:
    if contact.law == LAWS[1]:
        return f'law = "complementarity", an epsilon below {contact.epsilon:g}, or finer facets where they touch'
    return "raise solve.max_iterations: the contact status is not final; else refine where the surfaces touch"


def _overlap(contact: Contact, result: ContactResult, sides: str) -> str:
    return "refine both surfaces where they touch, until contact is two facets wide"


def _faceting(contact: Contact, result: ContactResult, sides: str) -> str:
    return (
        "use cells of second order, finer facets round the curve, or as many facets on both sides: their chords differ by "
        "too much for this load"
    )


def _tension(contact: Contact, result: ContactResult, sides: str) -> str:
    if contact.pressure != "auto":
        return f'pressure = "auto" in place of "{contact.pressure}"'
    return "refine at the edge of contact, where the pressure ends within a facet"


def _complementarity(contact: Contact, result: ContactResult, sides: str) -> str:
    if contact.law == LAWS[1]:
        return 'law = "complementarity", or raise solve.max_iterations: the contact law is not met yet'
    return "raise solve.max_iterations: the contact law is not met yet"


def _oscillation(contact: Contact, result: ContactResult, sides: str) -> str:
    if contact.method != METHODS[0]:
        return f"leave method out: {contact.method} rings from node to node where meshes differ"
    if contact.pressure != "auto":
        return f'pressure = "auto": "{contact.pressure}" can alternate from facet to facet'
    fine = float(np.median(facet_sizes(result.contactor)) / np.median(facet_sizes(result.target)))
    if fine * FINER < 1.0:
        way = f"{sides}, or refine the target" if sides else "refine the target"
        return f"{way}: the contactor's facets are {fine:.2g} of the target's in size"
    refine = "refine both surfaces where they touch" + (f", or {sides}" if sides else "")
    if not contact.adjust:
        return refine
    return (
        f"where adjust = {contact.adjust:g} ends within the contact it leaves a step that carries a peak: choose it larger "
        f"than all gaps that close, or leave it out; else {refine}"
    )


def _resolution(contact: Contact, result: ContactResult, sides: str) -> str:
    text = f"refine {words(contact.contactor)} where it touches: contact needs three facets to each side of its middle"
    if surface_degree(result.contactor) == 1 and presses_at_common_end(result):
        text += (
            "; it presses alone at an end common to both sides: where that is a clamp up to which they lie on each other, "
            "straight cells that bend cut into each other beside it and press there falsely: take cells of second order, "
            "or cells half as long on both sides"
        )
    return text


def _sharp_edge(contact: Contact, result: ContactResult, sides: str) -> str:
    swap = f"{sides}: the side whose edge presses should carry the pressure; or " if sides else ""
    return (
        f"{swap}round the edge over three facets of those that touch; else read forces, and what is some facets off: finer "
        "facets make its pressure larger, without limit"
    )


def _pressure_error(contact: Contact, result: ContactResult, sides: str) -> str:
    loaded = np.nanmax(result.pressure, axis=1) > LOADED * result.max_pressure
    if not loaded.any():  # not any more, at the end of the run
        loaded = np.ones_like(loaded)
    size = float(np.median(facet_sizes(result.contactor)[loaded]))
    first = result.contactor.dim == 3 and bool((result.contactor.kinds == CELLS["tri3"].code).any())
    higher = ", and cells of second order take off more than that" if first else ""
    way = f"{sides}, or " if sides else ""
    return (
        f"{way}refine both surfaces where they touch: facets of half the size ({0.5 * size:.2g}) halve the error{higher}; "
        "but round the edges of sharp bodies, where pressure has no limit"
    )


def _largest(contact: Contact, result: ContactResult, sides: str) -> str:
    swap = f", or {sides}" if sides else ""
    return (
        "the largest pressure is that of a single point: refine both surfaces there; round the edge of a body that "
        f"presses{swap}, or read the pressure beside it"
    )


def _edges(contact: Contact, result: ContactResult, sides: str) -> str:
    way = f"{sides}, or round" if sides else "round"
    return (
        f"{way} the edge of {words(contact.contactor)} over two facets: it pushes along the normal of its own face, not of "
        "what it touches"
    )


def _sides(contact: Contact, result: ContactResult, sides: str) -> str:
    return f"{sides or 'refine the target'}, or give surfaces = [...] in place of contactor and target: abut chooses"


def _moments(contact: Contact, result: ContactResult, sides: str) -> str:
    return "leave `integration` out; on curved facets refine, or let both sides have the same facets"


def _bare(contact: Contact, result: ContactResult, sides: str) -> str:
    return f"{sides + ', or ' if sides else ''}end the facets of the contactor where the target ends"


def _removed(contact: Contact, result: ContactResult, sides: str) -> str:
    return (
        "check that these two surfaces face each other, and name only the facets of the contactor that may touch, none that "
        "supports constrain"
    )


def _twice(contact: Contact, result: ContactResult, sides: str) -> str:
    return (
        "two contacts press the same facets: leave them out of one, or name both targets in one contact, of which the "
        "nearest counts; one contact alone: make the mesh of its target sound, whose facets overlap"
    )


def _friction(contact: Contact, result: ContactResult, sides: str) -> str:
    return "raise solve.max_iterations: stick and slip are not final"


def _left_out(contact: Contact, result: ContactResult, sides: str) -> str:
    swap = f", or {sides}" if sides else ""
    return (
        f"shorter steps, so that less of the target comes under the contactor's edge in each; or round that edge{swap}"
    )


def _sliding(contact: Contact, result: ContactResult, sides: str) -> str:
    return (
        'kinematics = "finite", or "small-strain" where bodies are linear: contact then follows them; with small kinematics '
        "it stays where it was at first"
    )


def _softening(contact: Contact, result: ContactResult, sides: str) -> str:
    return f'law = "complementarity", which has no such gap, or an epsilon far below {contact.epsilon:g} (by default 1e-12)'


def _carries(contact: Contact, result: ContactResult, sides: str) -> str:
    return (
        "check signs and units of what should bring the bodies together, and `offset` (an interference is negative); facets "
        "of curved surfaces stand off each other by their bulge, which finer ones or cells of second order make smaller"
    )


OF_CONTACT: dict[str, Callable[[Contact, ContactResult, str], str]] = {
    "force balance": _balance,
    "moment balance": _balance,
    "penetration": _penetration,
    "overlap": _overlap,
    "faceting": _faceting,
    "tension": _tension,
    "complementarity": _complementarity,
    "oscillation": _oscillation,
    "resolution": _resolution,
    "sharp edge": _sharp_edge,
    "pressure error": _pressure_error,
    "largest pressure": _largest,
    "contactor's edges": _edges,
    "sides": _sides,
    "facet moments": _moments,
    "loaded area without target": _bare,
    "force at the target's edge": _bare,
    "removed multipliers": _removed,
    "covered twice": _twice,
    "friction cone": _friction,
    "slip direction": _friction,
    "sticking": _friction,
    "friction work": _friction,
    "friction left out": _left_out,
    "carries": _carries,
    "softening": _softening,
    "sliding": _sliding,
}
