"""The contents of a deck as frozen records, with its node and element numbers and its units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from abut.io.deck.absence import Absence
from abut.io.deck.elements import ElementType
from abut.io.deck.gathered import Gathered
from abut.io.deck.mode_cards import Modes
from abut.io.deck.output_cards import Request
from abut.io.deck.pretension_record import PreTension
from abut.io.deck.reasons import Place
from abut.io.deck.thin_record import Thin

Numbers = NDArray[np.int64]
Behaviour = tuple[tuple[float, float], ...]  # pairs of overclosure and pressure


@dataclass(frozen=True)
class Block:
    """Elements of one type: ids (n,), nodes (n, k) node numbers; place: of the first card with them."""

    code: str
    type: ElementType
    ids: Numbers
    nodes: Numbers
    place: Place


@dataclass(frozen=True)
class Faces:
    """A surface as the deck gives it: (element numbers, face 1, 2, ... or 0 for every free face); or node numbers."""

    name: str
    place: Place
    faces: tuple[tuple[Numbers, int], ...] = ()
    nodes: Numbers | None = None

    @property
    def empty(self) -> bool:
        return not any(len(elements) for elements, _ in self.faces) if self.nodes is None else not len(self.nodes)


@dataclass(frozen=True)
class Hardening:
    """Of metal that yields. table: (plastic strain, yield stress); backstresses: (modulus, recall)."""

    table: tuple[tuple[float, float], ...]
    backstresses: tuple[tuple[float, float], ...]


@dataclass(frozen=True)
class Rubber:
    """kind, constants: as decks give them; volume: factors of (J - 1)^2, (J - 1)^4, ...; assumed: the first, as D1 is 0."""

    kind: str
    constants: tuple[float, ...]
    volume: tuple[float, ...]
    assumed: bool = False


Rows = tuple[tuple[float, tuple[float, ...]], ...]  # temperatures, growing, and what belongs to them


@dataclass(frozen=True)
class Elastic:
    """kind: "isotropic" (Young's modulus, Poisson's ratio), "engineering" (E1 E2 E3, nu12 nu13 nu23, G12 G13 G23) or
    "anisotropic" (21 entries of the stiffness); rows of these."""

    kind: str
    rows: Rows


NO_CONSTANTS = Elastic("isotropic", ((0.0, (0.0, 0.0)),))


@dataclass(frozen=True)
class Expansion:
    """rows: of one number, or three along the local directions; zero: the temperature from which they count."""

    rows: Rows = ((0.0, (0.0,)),)
    zero: float = 0.0


@dataclass(frozen=True)
class Orientation:
    """Local axes of a section: kind "rectangular" (a, b: along x and near y) or "cylindrical" (points of the axis)."""

    kind: str
    a: tuple[float, float, float]
    b: tuple[float, float, float]
    place: Place


@dataclass(frozen=True)
class Material:
    """elastic: of others than rubber."""

    name: str
    elastic: Elastic
    density: float
    expansion: Expansion
    place: Place
    rubber: Rubber | None = None
    hardening: tuple[tuple[float, Hardening], ...] = ()  # by temperature, growing
    weighed: bool = False  # the deck gives a density, be it 0

    @property
    def directed(self) -> bool:
        """Whether it matters how its axes lie."""
        return self.elastic.kind != "isotropic" or len(self.expansion.rows[0][1]) > 1


@dataclass(frozen=True)
class Layer:
    """Of a shell. orientation: None for the global axes."""

    thickness: float
    material: Material
    orientation: Orientation | None = None


@dataclass(frozen=True)
class Section:
    """name: the element set; thickness: of plane elements and shells, 0 where their nodes have one each; orientation: None
    for the global axes; offset: of a shell, its nodes from the mid-surface along the normal over the thickness. Of a beam:
    widths along the first direction, near ``axis``, and the second (``nodal``: those of its nodes), its nodes from the
    centre over these, its form (``mesh.thin.beams.OUTLINES``) and the walls of a hollow one, at its sides -1, -2, 1, 2.
    layers: of a shell, from its negative side, whose first one's material stands for all until they are solids."""

    name: str
    elements: Numbers
    material: Material
    thickness: float
    place: Place
    orientation: Orientation | None = None
    offset: float = 0.0
    widths: tuple[float, float] = (0.0, 0.0)
    axis: tuple[float, float, float] = (0.0, 0.0, -1.0)
    offsets: tuple[float, float] = (0.0, 0.0)
    form: str = "rectangle"
    walls: tuple[float, ...] = (0.0,) * 4
    layers: tuple[Layer, ...] = ()
    nodal: bool = False


@dataclass(frozen=True)
class Friction:
    """value: coefficient, "rough", or pairs of pressure and coefficient; changes: steps, and coefficients from there on."""

    value: float | str | tuple[tuple[float, float], ...] = 0.0
    changes: tuple[tuple[int, float], ...] = ()


NO_FRICTION = Friction()


@dataclass(frozen=True)
class Pair:
    """A contact pair or tie. overclosure: HARD, LINEAR, ...; adjust: a distance, "all" for every gap, node numbers, or None;
    clearance: given for all of the surface, None for that of the mesh; is_tie: of *TIE, with its position tolerance (None:
    the default, that of Abaqus where parameters are its); behaviour: of its overclosure, where that has numbers; bilateral:
    NO SEPARATION; changing: its law is another one later; span: first step and, if it ends, that before which it does."""

    name: str
    slave: str
    master: str
    tied: bool
    overclosure: str
    adjust: float | str | Numbers | None
    clearance: float | None
    place: Place
    friction: Friction = NO_FRICTION
    is_tie: bool = False
    tolerance: float | None = None
    of_abaqus: bool = False
    behaviour: Behaviour = ()
    bilateral: bool = False
    changing: bool = False
    span: tuple[int, int | None] | None = None


@dataclass(frozen=True)
class GeneralContact:
    """Contact of all exterior surfaces; overclosure and friction as for a pair."""

    overclosure: str
    place: Place
    friction: Friction = NO_FRICTION
    behaviour: Behaviour = ()

    @property
    def tied(self) -> bool:
        """Whether what touches is glued."""
        return self.overclosure == "TIED"


@dataclass(frozen=True)
class Equation:
    """Terms (node, direction 1..3, of nodes of shells 4..6 for turns, coefficient), whose sum is zero."""

    terms: tuple[tuple[int, int, float], ...]
    place: Place


@dataclass(frozen=True)
class RigidBody:
    """nodes, or elements, of the body; reference and turning node (turning node 0: turns are directions 4..6 of the
    reference node; reference node 0: none is named, which ``references.with_references`` makes up for)."""

    nodes: Numbers
    elements: Numbers
    reference: int
    turning: int
    place: Place


@dataclass(frozen=True)
class Coupling:
    """Nodes, or those of a surface ("": none), that move with a reference node: as a rigid body in ``directions`` 1..6, or
    freely with its motion as their mean (distributing), by weights (n,) of the nodes or, None, by area; more: others of the
    same reference; weighted: it is a *DISTRIBUTING COUPLING; radius: beyond which nodes are left out; orientation: axes of
    ``directions`` 1..3, rectangular, None for the global ones; thin: it stands for a node of a shell or beam."""

    name: str
    distributing: bool
    reference: int
    surface: str
    nodes: Numbers
    directions: frozenset[int]
    weights: NDArray[np.float64] | None
    place: Place
    more: tuple[Coupling, ...] = ()
    weighted: bool = False
    radius: float | None = None
    orientation: Orientation | None = None
    thin: bool = False


@dataclass(frozen=True)
class Transform:
    """Axes of their own for boundary conditions and forces at nodes: kind "R" (a on x', b near y') or "C" (a, b on the
    axis)."""

    nodes: Numbers
    kind: str
    a: tuple[float, float, float]
    b: tuple[float, float, float]
    place: Place


@dataclass(frozen=True)
class Spring:
    """Springs of one type and law. name: the element set; elements (n,) numbers; ends (n, 1 or 2) nodes; directions: of
    SPRING1, SPRING2 and GAPUNI the one they act in, 1..3; law: a stiffness, or pairs of elongation and force, which are per
    stiffness where ``rigid``: of one that yields next to nothing."""

    name: str
    code: str
    elements: Numbers
    ends: Numbers
    directions: tuple[int, ...]
    law: float | tuple[tuple[float, float], ...]
    place: Place
    rigid: bool = False

    @property
    def title(self) -> str:
        """The card that has the law."""
        return "*GAP" if self.code == "GAPUNI" else "*SPRING"


@dataclass(frozen=True)
class CyclicSymmetry:
    """Sectors in the whole turn, the surfaces that meet (slave is master turned by one sector), two points of the axis."""

    sectors: float
    slave: str
    master: str
    a: tuple[float, float, float]
    b: tuple[float, float, float]
    place: Place


@dataclass(frozen=True)
class Prescribed:
    """A value at keys: (node, direction) for supports and forces, (element, face) for pressures, (node,) for temperatures,
    (number of a pair, 0) for the overlap that contact allows; a temperature's ``vector`` begins with its slope along the
    normal of shells; face 0 with ``vector``: gravity on the element, or a centrifugal force, a point of whose axis and its
    direction it has. amplitude: name, or "" for the ramp; frozen: of a support, held where it is as the step begins;
    imaginary: a quarter of a period ahead; step: of the run of the global model that has the displacement, 0 for none."""

    kind: str  # boundary | force | pressure | gravity | centrifugal | temperature | interference | shrink
    numbers: Numbers
    directions: tuple[int, ...]
    value: float
    amplitude: str
    place: Place
    vector: tuple[float, ...] = (0.0, 0.0, 0.0)
    frozen: bool = False
    imaginary: bool = False
    step: int = 0


@dataclass(frozen=True)
class Increments:
    """Of a *STATIC step, times: the first one, the longest one; fixed: all are as the first (DIRECT); stabilized."""

    first: float
    longest: float
    fixed: bool
    stabilized: bool = False


@dataclass(frozen=True)
class Step:
    """period: its length on the time axis; new: kinds whose earlier values end (OP=NEW); finite: NLGEOM; total: the total
    time at its beginning, which amplitudes with TIME=TOTAL TIME go by."""

    number: int
    period: float
    values: tuple[Prescribed, ...]
    new: frozenset[str]
    place: Place
    increments: Increments
    finite: bool = False
    total: float = 0.0


@dataclass(frozen=True)
class Amplitude:
    points: tuple[tuple[float, float], ...]
    total: bool  # times count from the beginning of the analysis


@dataclass(frozen=True)
class Deck:
    """A whole deck. nodes (n,) sorted; points (n, 3); sets and surfaces by name as the deck first spells it; fixed: supports
    outside the steps; initial: node -> temperature; quiet, ignored: see ``supported.Sifted``; small_sliding: a contact pair
    asks for it; thicknesses: at nodes of shells and plane elements, and of beams along both directions; normals: of shells
    at (element, node); thin: what stands for the nodes of shells once they are expanded; modes: what the last step asks for
    beside; absences: of elements that go, or come; layers: of shells of several the solids, from the negative side; hinges:
    (m, 2) nodes that hinges join within a body; stresses: of elements before the first step, one or those at integration
    points; submodels: files of nodes."""

    path: str
    nodes: Numbers
    points: NDArray[np.float64]
    blocks: tuple[Block, ...]
    node_sets: Mapping[str, Numbers]
    element_sets: Mapping[str, Numbers]
    surfaces: Mapping[str, Faces]
    sections: tuple[Section, ...]
    pairs: tuple[Pair, ...]
    general: GeneralContact | None
    equations: tuple[Equation, ...]
    rigid: tuple[RigidBody, ...]
    transforms: tuple[Transform, ...]
    cyclic: tuple[CyclicSymmetry, ...]
    pretension: tuple[PreTension, ...]
    fixed: tuple[Prescribed, ...]
    initial: Mapping[int, float]
    amplitudes: Mapping[str, Amplitude]
    steps: tuple[Step, ...]
    notes: tuple[str, ...]
    quiet: tuple[str, ...]
    ignored: tuple[str, ...]
    small_sliding: bool = False
    couplings: tuple[Coupling, ...] = ()
    springs: tuple[Spring, ...] = ()
    thicknesses: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    normals: Mapping[tuple[int, int], tuple[float, float, float]] = field(default_factory=dict)
    thin: Mapping[int, Thin] = field(default_factory=dict)
    requests: tuple[Request, ...] = ()
    modes: Modes | None = None
    absences: tuple[Absence, ...] = ()
    layers: Mapping[int, tuple[int, ...]] = field(default_factory=dict)
    hinges: Numbers = field(default_factory=lambda: np.empty((0, 2), np.int64))
    gathered: tuple[Gathered, ...] = ()
    stresses: Mapping[int, tuple[tuple[float, ...], ...]] = field(default_factory=dict)
    submodels: Mapping[int, str] = field(default_factory=dict)

    @property
    def references(self) -> frozenset[int]:
        """Reference and turning nodes of rigid bodies and couplings."""
        bodies = [node for body in self.rigid for node in (body.reference, body.turning)]
        return frozenset([*bodies, *(coupling.reference for coupling in self.couplings)])
