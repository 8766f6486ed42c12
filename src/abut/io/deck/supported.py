"""The cards abut knows: those it reads, those without effect on the result, those it must refuse and why."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace

from abut.errors import InputError, nearest
from abut.io.deck import mass_cards, spring_cards
from abut.io.deck.cards import Card, key
from abut.io.deck.elements import DASHPOTS, ELEMENTS, refusal
from abut.io.deck.output_cards import REQUESTS
from abut.io.deck.reasons import DeckError, Reasons
from abut.io.deck.refused import PARAMETERS, PROCEDURES, REFUSED, RUBBER

# Cards that are read, with the parameters that are read or change nothing in statics.
READ: dict[str, tuple[str, ...]] = {
    "NODE": ("NSET", "INPUT", "SYSTEM"),
    "ELEMENT": ("TYPE", "ELSET", "INPUT"),
    "NSET": ("NSET", "ELSET", "GENERATE", "INPUT", "UNSORTED", "INTERNAL", "FREQUENCY"),
    "ELSET": ("ELSET", "GENERATE", "INPUT", "UNSORTED", "INTERNAL", "FREQUENCY"),
    "SURFACE": ("NAME", "TYPE", "INTERNAL"),
    "MATERIAL": ("NAME",),
    "ELASTIC": ("TYPE",),
    "HYPERELASTIC": (
        "NEO HOOKE",
        "MOONEY-RIVLIN",
        "YEOH",
        "OGDEN",
        "ARRUDA-BOYCE",
        "POLYNOMIAL",
        "REDUCED POLYNOMIAL",
        "N",
    ),
    "PLASTIC": ("HARDENING",),
    "CYCLIC HARDENING": (),
    "DENSITY": (),
    "EXPANSION": ("TYPE", "ZERO"),
    "ORIENTATION": ("NAME", "SYSTEM", "DEFINITION", "LOCAL DIRECTIONS"),
    "DISTRIBUTION": ("NAME", "LOCATION", "TABLE", "INPUT"),
    **dict.fromkeys(
        ("BEAM SECTION", "BEAM GENERAL SECTION"),
        ("ELSET", "MATERIAL", "ORIENTATION", "SECTION", "OFFSET1", "OFFSET2", "NODAL THICKNESS"),
    ),
    "NODAL THICKNESS": (),
    "NORMAL": (),
    "SHELL SECTION": ("ELSET", "MATERIAL", "ORIENTATION", "OFFSET", "NODAL THICKNESS", "COMPOSITE"),
    "USER ELEMENT": ("TYPE", "NODES", "INTEGRATION POINTS", "MAXDOF"),
    "USER SECTION": ("ELSET", "MATERIAL", "CONSTANTS"),
    "MEMBRANE SECTION": ("ELSET", "MATERIAL", "ORIENTATION", "OFFSET", "NODAL THICKNESS"),
    "SOLID SECTION": ("ELSET", "MATERIAL", "ORIENTATION", "NODAL THICKNESS", "CONTROLS", "OFFSET"),
    "BOUNDARY": ("OP", "NAME", "AMPLITUDE", "TYPE", "LOAD CASE", "FIXED", "TIME DELAY", "SUBMODEL", "STEP"),
    "SUBMODEL": ("TYPE", "INPUT"),
    "CLOAD": ("OP", "NAME", "AMPLITUDE", "LOAD CASE", "TIME DELAY"),
    "DLOAD": ("OP", "NAME", "AMPLITUDE", "LOAD CASE", "TIME DELAY"),
    "DSLOAD": ("OP", "NAME", "AMPLITUDE", "LOAD CASE", "TIME DELAY"),
    "TEMPERATURE": ("OP", "AMPLITUDE", "TIME DELAY", "LINTEMP"),
    "INITIAL CONDITIONS": ("TYPE",),
    "AMPLITUDE": ("NAME", "TIME", "VALUE", "DEFINITION"),
    "CONTACT PAIR": ("INTERACTION", "TYPE", "ADJUST", "SMALL SLIDING", "CPSET", "MORTAR", "NO THICKNESS"),
    "SURFACE INTERACTION": ("NAME",),
    "FRICTION": ("ROUGH", "LAGRANGE", "ELASTIC SLIP", "SLIP TOLERANCE", "SHEAR TRACTION SLOPE"),
    "CHANGE FRICTION": ("INTERACTION",),
    "CHANGE SOLID SECTION": ("ELSET", "MATERIAL"),
    "CHANGE SURFACE BEHAVIOR": ("INTERACTION",),
    "SURFACE BEHAVIOR": ("PRESSURE-OVERCLOSURE", "PENALTY", "DIRECT", "AUGMENTED LAGRANGE", "NO SEPARATION"),
    "CONTACT": (),
    "CONTACT INCLUSIONS": ("ALL EXTERIOR",),
    "CONTACT PROPERTY ASSIGNMENT": (),
    "CONTACT INTERFERENCE": ("AMPLITUDE", "OP", "SHRINK", "TYPE"),
    "MODEL CHANGE": ("ADD", "REMOVE", "TYPE"),
    "CLEARANCE": ("MASTER", "SLAVE", "VALUE", "CPSET"),
    "TIE": ("NAME", "POSITION TOLERANCE", "ADJUST", "TYPE", "CYCLIC SYMMETRY", "NO THICKNESS", "NO ROTATION"),
    "SPRING": ("ELSET", "NONLINEAR"),
    "GAP": ("ELSET",),
    "MASS": ("ELSET",),
    "CYCLIC SYMMETRY MODEL": ("N", "TIE", "ELSET", "NGRAPH"),
    "SELECT CYCLIC SYMMETRY MODES": ("NMIN", "NMAX"),  # of steps that ask for modes; others have none
    "PRE-TENSION SECTION": ("SURFACE", "ELEMENT", "NODE"),
    "EQUATION": (),
    "MPC": (),
    "RIGID BODY": ("NSET", "ELSET", "REF NODE", "ROT NODE"),
    "COUPLING": ("CONSTRAINT NAME", "REF NODE", "SURFACE", "ORIENTATION", "INFLUENCE RADIUS"),
    "KINEMATIC": (),
    "DISTRIBUTING": ("COUPLING", "WEIGHTING METHOD"),
    "KINEMATIC COUPLING": ("REF NODE", "ORIENTATION"),
    "DISTRIBUTING COUPLING": ("ELSET",),
    "TRANSFORM": ("NSET", "TYPE"),
    "STEP": ("INC", "NAME", "AMPLITUDE", "UNSYMM", "SOLVER", "NLGEOM"),
    "STATIC": (
        "SOLVER",
        "DIRECT",
        "TIME RESET",
        "TOTAL TIME AT START",
        "STABILIZE",
        "ALLSDTOL",
        "FACTOR",
        "CONTINUE",
    ),
    "END STEP": (),
}

# Output, solver settings, and data that act in other kinds of analysis only: without effect on this result.
QUIET = (
    "HEADING", "PREPRINT", "PRINT", "RESTART", "NODE PRINT", "NODE FILE", "NODE OUTPUT", "EL PRINT", "EL FILE",
    "ELEMENT OUTPUT", "OUTPUT", "CONTACT PRINT", "CONTACT FILE", "CONTACT OUTPUT", "SECTION PRINT", "SECTION FILE",
    "ENERGY PRINT", "ENERGY FILE", "ENERGY OUTPUT", "INTEGRATED OUTPUT", "FILE FORMAT", "FILE OUTPUT", "MONITOR",
    "TIME POINTS", "CONTROLS", "CONTACT CONTROLS", "SOLVER CONTROLS", "SECTION CONTROLS",
    "CONDUCTIVITY", "SPECIFIC HEAT", "GAP CONDUCTANCE", "GAP HEAT GENERATION", "DAMPING", "CONTACT DAMPING", "DASHPOT",
    "PHYSICAL CONSTANTS", "VALUES AT INFINITY", "NO ANALYSIS", "DAMAGE INITIATION",
)  # fmt: skip

GENERATED = {  # nodes and elements that do not stand in the deck, or under numbers of their own
    key(name) for name in ("ELCOPY", "ELGEN", "NCOPY", "NFILL", "NGEN", "SYSTEM")
}
NEEDED = {  # leaving these out would leave no deck
    *GENERATED,
    key("MEMBRANE SECTION"),
}

AT_NODES = {  # types of elements -> key of *ELEMENT cards with them
    **dict.fromkeys(("DCOUP2D", "DCOUP3D"), "DCOUP"),  # the reference nodes of *DISTRIBUTING COUPLING
    mass_cards.CODE: mass_cards.ELEMENTS,
    **dict.fromkeys(("DASHPOT1", "DASHPOT2", "DASHPOTA"), DASHPOTS),  # without effect
}
WRITTEN = ("NODE", "ELEMENT", "NSET", "ELSET")  # cards whose parameters say what their numbers mean
RESTART = (
    "READ: the state at the end of an earlier run is not read; put the model and the steps of that run before these"
)
MAY_BE_OMITTED = {"NLGEOM"}  # parameters that are read, and may be left out all the same
COUPLINGS = {"COUPLING", "KINEMATIC", "DISTRIBUTING", "KINEMATICCOUPLING", "DISTRIBUTINGCOUPLING"}
LEFT_OUT = {
    "FRICTION",
    "CHANGEFRICTION",
    "CHANGESURFACEBEHAVIOR",
    "SPRING",
    "GAP",
    *COUPLINGS,
}  # cards that are read, and may be left out all the same
_READ = {key(name): {key(p) for p in parameters} for name, parameters in READ.items()}
_QUIET = {key(name) for name in QUIET}
_REFUSED = {key(name): (name, reason) for name, reason in REFUSED.items()}
_PROCEDURES = {key(name) for name in PROCEDURES}
STEP_PROCEDURES = _PROCEDURES | {"STATIC"}


def opens(card: str, parameters: Mapping[str, str | None]) -> bool:
    """Whether the file that INPUT names has lines of the card: not for what is refused, whatever stands in it."""
    code = key(parameters.get("TYPE") or "")
    supported = card != "ELEMENT" or code in ELEMENTS or code in spring_cards.NODES
    return supported and card != "SUBMODEL" and "INPUT" in _READ.get(card, ())


@dataclass(frozen=True)
class Sifted:
    """cards: those to read; quiet: titles of those without effect; ignored: what was left out because the user said so;
    plain: whether numbers of nodes and elements mean the same everywhere, and none are generated; requests: what is to be
    printed and written, with the number of its step, 0 outside."""

    cards: tuple[Card, ...]
    quiet: tuple[str, ...]
    ignored: tuple[str, ...]
    plain: bool
    requests: tuple[tuple[int, Card], ...] = ()


def sift(cards: Iterable[Card], reasons: Reasons, ignore: Collection[str] = ()) -> Sifted:
    """The cards to read. ``ignore`` names cards and parameters to leave out although they change the result; ``reasons``
    gets the cards, parameters and element types that abut does not honour.

    Raises InputError for names in ``ignore`` that are no card or must be read."""
    asked = {key(name.lstrip("*")) for name in ignore}
    asked |= {"CHANGEFRICTION"} if "FRICTION" in asked else set()
    asked |= {"KINEMATIC", "DISTRIBUTING"} if "COUPLING" in asked else set()
    left = _without_steps(tuple(cards), asked)
    _check_asked(ignore, left)
    static = any(card.key == "STATIC" for card in left if isinstance(card, Card))
    kept: list[Card] = []
    quiet: dict[str, None] = {}
    ignored: dict[str, list[str]] = {}
    found: dict[str, DeckError] = {}
    wanted: list[tuple[int, Card]] = []
    number = 0
    changing = ""  # what belongs to a *CHANGE ... card: *CHANGE SURFACE BEHAVIOR is followed by *SURFACE BEHAVIOR
    for card in left:
        number += isinstance(card, Card) and card.key == "STEP"
        if isinstance(card, Card) and card.key.startswith("CHANGE"):
            changing = card.key.removeprefix("CHANGE")
        if isinstance(card, Card) and card.key == changing and f"CHANGE{changing}" in asked:
            ignored.setdefault(card.title, []).append(str(card.place))
            changing = ""
        elif isinstance(card, _Step):
            ignored.setdefault(f"the step with {card.procedure.title}", []).append(str(card.procedure.place))
        elif card.key == "RESTART" and card.has("READ"):
            found.setdefault("RESTART READ", card.error(RESTART))
        elif card.key in _QUIET:
            quiet[card.title] = None
            if card.key in REQUESTS:
                wanted.append((number, card))
        elif card.key in _READ and not (card.key in LEFT_OUT and card.key in asked):
            _parameters(card, asked, ignored, found)
            code = key(card.get("TYPE") or "")
            if card.key == "ELEMENT" and code in AT_NODES:  # their node is all they have
                kept.append(replace(card, key=AT_NODES[code]))
                continue
            if card.key == "ELEMENT" and code in spring_cards.NODES:
                if spring_cards.CARD[code] not in asked:
                    kept.append(replace(card, key=spring_cards.ELEMENTS))
                continue
            if card.key == "ELEMENT" and code and code not in ELEMENTS:
                found.setdefault(f"ELEMENT {code}", card.error(refusal(code)))
                continue
            read = {
                name: value
                for name, value in card.parameters.items()
                if name in _READ[card.key] and name not in asked & MAY_BE_OMITTED
            }
            kept.append(Card(card.key, card.title, read, card.lines, card.place))
        elif card.key in asked:
            ignored.setdefault(card.title, []).append(str(card.place))
        else:
            _, reason = _REFUSED.get(card.key, ("", "abut does not know this card; take it out if it is not needed"))
            pointless = card.key in NEEDED or (card.key in _PROCEDURES and not static)
            found.setdefault(card.key, card.refusal(reason, "" if pointless else card.title[1:]))
    for what, error in found.items():
        reasons.add(error, defines=what.startswith("ELEMENT "))
    told = tuple(f"{what} ({_places(at)})" for what, at in ignored.items())
    return Sifted(tuple(kept), tuple(quiet), told, not GENERATED & found.keys(), tuple(wanted))


def _places(places: list[str]) -> str:
    return places[0] + (f" and {len(places) - 1} more" if len(places) > 1 else "")


@dataclass(frozen=True)
class _Step:
    """A step that is left out, for its procedure."""

    procedure: Card


def _without_steps(cards: tuple[Card, ...], asked: set[str]) -> tuple[Card | _Step, ...]:
    """Cards without the steps whose procedure the user leaves out; a ``_Step`` stands where one was."""
    result: list[Card | _Step] = []
    step: list[Card] | None = None
    for card in cards:
        if card.key == "STEP" and step is None:
            step = []
        if step is None:
            result.append(card)
            continue
        step.append(card)
        if card.key == "ENDSTEP":
            result += _step(step, asked)
            step = None
    return (*result, *_step(step or [], asked))


def _step(step: list[Card], asked: set[str]) -> list[Card | _Step]:
    for card in step:
        if card.key in _PROCEDURES:  # refused alone: what else the step holds goes with it
            return [_Step(card) if card.key in asked else card]
    return list(step)


def _parameters(card: Card, asked: set[str], ignored: dict[str, list[str]], found: dict[str, DeckError]) -> None:
    """Sort out the parameters that are not read."""
    for name, value in card.parameters.items():
        no = value is not None and key(value) == "NO"
        if name in _READ[card.key] and (no or name not in asked & MAY_BE_OMITTED):
            continue
        if name in asked:
            ignored.setdefault(f"{name} of {card.title}", []).append(str(card.place))
        else:
            rubber = card.key == "HYPERELASTIC"
            cure = "" if rubber or card.key in WRITTEN else name
            reason = PARAMETERS.get(
                (_name(card), name),
                RUBBER if rubber else "abut does not know this parameter; take it out if it is not needed",
            )
            found.setdefault(f"{card.key} {name}", card.refusal(f"{name}: {reason}", cure))


def _name(card: Card) -> str:
    return next(name for name in READ if key(name) == card.key)


def _check_asked(ignore: Collection[str], cards: tuple[Card | _Step, ...]) -> None:
    present = {card.key for card in cards if isinstance(card, Card)}
    parameters = {name for card in cards if isinstance(card, Card) for name in card.parameters}
    parameters |= {parameter for _, parameter in PARAMETERS} | MAY_BE_OMITTED
    for name in ignore:
        wanted = key(name.lstrip("*"))
        if wanted in _READ and wanted not in parameters | LEFT_OUT:
            raise InputError(f"--ignore {name}: abut reads *{name.upper()}, which cannot be left out")
        if wanted not in _REFUSED.keys() | present | parameters | _QUIET | LEFT_OUT:
            raise InputError(f"--ignore {name}: no such card{nearest(name.upper(), [*REFUSED, *LEFT_OUT, 'NLGEOM'])}")
