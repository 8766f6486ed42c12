"""Couplings: points of a surface or node set that move with a reference point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.axes import Axes
from abut.bodies.loads import area_weights
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.model.conditions import COMPONENTS, TURNS, Amplitude, History, Rigid, check_motion
from abut.model.consistency import check_supported

KINDS = ("kinematic", "distributing")
AT_MEAN = 1e-9  # of the points' extent: a reference that is their mean
AT_RADIUS = 1e-9  # of a radius: what rounding may move a point by
IN_LINE = 1e-6  # of their extent: how far points may lie off a line and still be on it


@dataclass(frozen=True)
class Coupling:
    """Points of a surface or node set that move with a reference point.

    Loads on it: ``Force`` and ``Moment`` by its name.

    Parameters
    ----------
    name : str
        Of the coupling.
    on : str
        A surface or node set.
    kind : str
        "kinematic": the points follow the reference as a rigid body, or in the displacements ``follow`` only.
        "distributing": it has their mean motion, and its force and moment are spread over them, which stiffens nothing
        (theory (F13)).
    reference : (dim,) of float, optional
        The point [length]; the mean of the points where left out.
    follow : sequence of str, optional
        Of "x", "y", "z".
    weights : sequence of float, optional
        Of a "distributing" one on a node set, one for each point in the order of their numbers; left out: evenly, on a
        surface by area.
    radius : float, optional
        Points farther than this from the reference, undeformed, are left out [length]; all take part where left out.
    axes : Axes, optional
        Local axes at each point, undeformed, of ``follow``: "x", "y", "z" are then their first, second and third direction.
    mirrors : sequence of str, optional
        Of a "distributing" one in a half or quarter model: of "x", "y", "z", the normals of the planes of symmetry, all of
        which the reference lies on. Loads at it are those on the modelled part.
    x, y, z : float, optional
        Prescribed displacement of the reference [length]; free where left out.
    rx, ry, rz : float, optional
        Prescribed rotation [radian]; free where left out.
    amplitude : Amplitude, optional
        Of all these over time.
    amplitudes : mapping of str to Amplitude
        Of some of them, by name.
    supports : sequence of str
        Node sets, surfaces or bodies that it holds: the forces on their points count among the reactions by these names,
        too.

    Raises
    ------
    InputError
        For values that are no such things, or do not go together.

    Examples
    --------
    >>> import abut
    >>> head = abut.Coupling("head", "bolt.end", reference=(0, 0, 90))
    >>> bent = abut.Moment("head", (0, 2e4, 0))
    """

    name: str
    on: str
    kind: str = "kinematic"
    reference: tuple[float, ...] | None = None
    follow: tuple[str, ...] | None = None
    weights: tuple[float, ...] | None = None
    radius: float | None = None
    axes: Axes | None = None
    mirrors: tuple[str, ...] | None = None
    x: float | None = None
    y: float | None = None
    z: float | None = None
    rx: float | None = None
    ry: float | None = None
    rz: float | None = None
    amplitude: History = None
    amplitudes: Mapping[str, Amplitude] = field(default_factory=dict)
    supports: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        where = f"coupling '{self.name}'"
        object.__setattr__(self, "supports", checks.names(self.supports, f"{where}: supports"))
        checks.text(self.name, f"{where}: name")
        checks.choice(self.kind, f"{where}: kind", KINDS)
        check_motion(self, where)
        if self.follow is not None:
            letters = tuple(self.follow) if isinstance(self.follow, str) else self.follow  # type: ignore[unreachable]
            object.__setattr__(self, "follow", checks.listed(letters, f"{where}: follow", "components"))
            for component in self.follow or ("",):
                checks.choice(component, f"{where}: follow", COMPONENTS)
            if self.distributing:
                raise InputError(f'{where}: follow goes with kind = "kinematic"; take it out')
        if self.weights is not None:
            weights = tuple(
                checks.finite(value, f"{where}: weights")
                for value in checks.listed(self.weights, f"{where}: weights", "numbers")
            )
            if not self.distributing or not weights or min(weights) < 0.0 or not any(weights):
                raise InputError(f'{where}: weights go with kind = "distributing" and are >= 0, not all of them 0')
            object.__setattr__(self, "weights", weights)
        self._check_extent(where)

    def _check_extent(self, where: str) -> None:
        """Radius, axes and mirrors."""
        if self.radius is not None:
            checks.positive(self.radius, f"{where}: radius")
            if self.reference is None:
                raise InputError(f"{where}: radius is the distance from the reference; give reference")
        if self.axes is not None and self.follow is None:
            raise InputError(f"{where}: axes are those of follow; give follow, or take axes out")
        if self.mirrors is None:
            return
        letters = tuple(self.mirrors) if isinstance(self.mirrors, str) else self.mirrors  # type: ignore[unreachable]
        object.__setattr__(self, "mirrors", checks.listed(letters, f"{where}: mirrors", "components"))
        for component in self.mirrors or ("",):
            checks.choice(component, f"{where}: mirrors", COMPONENTS)
        if not self.distributing:
            raise InputError(
                f'{where}: mirrors goes with kind = "distributing"; prescribe the motions that symmetry holds as 0'
            )
        if self.reference is None:
            raise InputError(f"{where}: mirrors: the reference lies on the planes of symmetry; give reference")
        held = next((name for name in self.given if name not in symmetric(self.mirrors, (*COMPONENTS, *TURNS))), None)
        if held is not None:
            raise InputError(f"{where}: {held} is 0 by the symmetry of mirrors; leave it out")

    @property
    def distributing(self) -> bool:
        """Whether the reference has the mean motion of the points."""
        return self.kind == KINDS[1]

    @property
    def given(self) -> tuple[str, ...]:
        """Names of the components that are prescribed."""
        return tuple(name for name in (*COMPONENTS, *TURNS) if getattr(self, name) is not None)

    def history(self, name: str) -> History:
        """Of the component ``name``."""
        return self.amplitudes.get(name, self.amplitude)

    def partial(self, mesh: Mesh) -> bool:
        """Whether points follow in some displacements only."""
        return self.follow is not None and set(self.follow) != set(COMPONENTS[: mesh.dim])

    def shares(self, mesh: Mesh) -> NDArray[np.float64]:
        """Weight of each point, (n,), their sum 1."""
        nodes = self.nodes(mesh)
        weights = np.ones(len(nodes))
        if self.distributing and self.weights is not None:
            weights = np.array(self.weights)[np.searchsorted(mesh.nodes_of(self.on), nodes)]
        elif self.distributing and self.on in mesh.surfaces:
            weights = area_weights(mesh.surface(self.on))[nodes]
        return weights / weights.sum()

    def nodes(self, mesh: Mesh) -> NDArray[np.int64]:
        """Sorted numbers of the points, (n,): of ``on``, within the radius."""
        nodes = mesh.nodes_of(self.on).astype(np.int64)
        if self.radius is None or self.reference is None:
            return nodes
        away = np.linalg.norm(mesh.points[nodes] - np.array(self.reference), axis=1)
        return np.asarray(nodes[away <= self.radius * (1.0 + AT_RADIUS)])


def symmetric(mirrors: Sequence[str], components: Sequence[str]) -> tuple[str, ...]:
    """Of the components of a motion, "x" to "rz", those that planes of symmetry with the normals ``mirrors`` leave: along
    each plane, and turns about its normal."""
    return tuple(c for c in components if all((c[-1] == normal) == c.startswith("r") for normal in mirrors))


def check_couplings(mesh: Mesh, couplings: Sequence[Coupling], rigid: Sequence[Rigid], finite: bool) -> None:
    """Raise InputError for names and places that do not exist or are taken, for components that plane models lack, and for
    motions that only small displacements allow."""
    exist = ("y",) if mesh.axisymmetric else ("x", "y", "rz") if mesh.dim == 2 else (*COMPONENTS, *TURNS)
    taken: set[str] = set()
    owner: dict[int, str] = {}
    if couplings:
        owner |= moving_points(mesh, rigid, ())
    for i, coupling in enumerate(couplings):
        where = f"couplings[{i}]"
        checks.known(coupling.on, [*mesh.surfaces, *mesh.node_sets], f"{where}.on", "surface or node set")
        _check_name(mesh, coupling, taken, where)
        check_supported(mesh, coupling.supports, f"{where}.supports")
        for name in coupling.given:
            if name not in exist and getattr(coupling, name):
                plane = "axisymmetric" if mesh.axisymmetric else "2D"
                raise InputError(f"{where}.{name}: the model is {plane}; leave {name} out")
        if coupling.reference is not None and len(coupling.reference) != mesh.dim:
            raise InputError(f"{where}.reference: expected {mesh.dim} numbers, got {len(coupling.reference)}")
        for key, letters in (("follow", coupling.follow), ("mirrors", coupling.mirrors)):
            if mesh.dim == 2 and "z" in (letters or ()):
                raise InputError(f"{where}.{key}: the model is 2D; leave z out")
        if coupling.axes is not None:
            coupling.axes.check(mesh.dim, where)
        count = len(mesh.nodes_of(coupling.on))
        if coupling.weights is not None and len(coupling.weights) != count:
            raise InputError(
                f"{where}.weights: expected {count} numbers, one for each point, got {len(coupling.weights)}"
            )
        nodes = coupling.nodes(mesh)
        _check_points(mesh, coupling, nodes, where)
        if not coupling.distributing and not coupling.partial(mesh):
            shared = next((n for n in nodes.tolist() if n in owner), None)
            if shared is not None:
                raise InputError(
                    f"{where}.on: point {shared} of '{coupling.on}' belongs to {owner[shared]} too; take it out of one of "
                    "them"
                )
            owner |= dict.fromkeys(nodes.tolist(), f"coupling '{coupling.name}'")
        if finite:
            _check_finite(mesh, coupling, where)


def moving_points(mesh: Mesh, rigid: Sequence[Rigid], couplings: Sequence[Coupling]) -> dict[int, str]:
    """The points that rigid bodies and kinematic couplings move as a whole, and which of them does, in words."""
    moved: dict[int, str] = {}
    for body in rigid:
        moved |= dict.fromkeys(_points(mesh, body.body).tolist(), f"rigid body '{body.body}'")
    for coupling in couplings:
        if not coupling.distributing and not coupling.partial(mesh):
            moved |= dict.fromkeys(coupling.nodes(mesh).tolist(), f"coupling '{coupling.name}'")
    return moved


def _points(mesh: Mesh, body: str) -> NDArray[np.int64]:
    """Sorted numbers of a body, whatever else has its name."""
    return np.unique(np.concatenate([cells.ravel() for _, cells, _ in mesh.cells_of(body)]))


def _check_name(mesh: Mesh, coupling: Coupling, taken: set[str], where: str) -> None:
    if coupling.name in taken:
        raise InputError(f"{where}.name: '{coupling.name}' is used twice; give each coupling its own name")
    for what, names in (("surface", mesh.surfaces), ("node set", mesh.node_sets), ("body", mesh.bodies)):
        if coupling.name in names:
            raise InputError(
                f"{where}.name: '{coupling.name}' is a {what} of the mesh; give the coupling a name of its own"
            )
    taken.add(coupling.name)


def _check_points(mesh: Mesh, coupling: Coupling, nodes: NDArray[np.int64], where: str) -> None:
    """That a radius leaves points that carry weight, and that planes of symmetry have them on one side."""
    if not len(nodes) or coupling.shares(mesh).sum() <= 0.0 or not np.isfinite(coupling.shares(mesh)).all():
        every = np.linalg.norm(mesh.points[mesh.nodes_of(coupling.on)] - np.array(coupling.reference), axis=1)
        raise InputError(
            f"{where}.radius: no point of '{coupling.on}' that carries weight lies within {coupling.radius:g} of the "
            f"reference, the nearest at {every.min(initial=np.inf):g}; give a larger radius, or another reference"
        )
    if mesh.axisymmetric and coupling.mirrors:
        raise InputError(
            f"{where}.mirrors: references of axisymmetric models move along the axis only; take mirrors out"
        )
    for normal in coupling.mirrors or ():
        axis = COMPONENTS.index(normal)
        away = mesh.points[nodes, axis] - np.array(coupling.reference)[axis]
        slight = IN_LINE * np.ptp(mesh.points[nodes], axis=0).max(initial=0.0)
        if away.min() < -slight and away.max() > slight:
            raise InputError(
                f"{where}.mirrors: points of '{coupling.on}' lie on both sides of the plane through the reference with the "
                f"normal {normal}, which is no plane of symmetry then; move the reference, or take '{normal}' out"
            )


def _check_finite(mesh: Mesh, coupling: Coupling, where: str) -> None:
    """What takes equations that finite turns would bend."""
    if coupling.mirrors:
        raise InputError(f'{where}.mirrors: halves need small turns; use kinematics = "small", or model the whole')
    turns = TURNS if mesh.dim == 3 else TURNS[2:]
    upright = all(getattr(coupling, name) == 0.0 for name in turns) or mesh.axisymmetric
    if coupling.partial(mesh) and not upright:
        raise InputError(
            f"{where}.follow: points that follow in some displacements only need small turns; let them follow in all, "
            f'prescribe {", ".join(f"{name} = 0" for name in turns)}, or use kinematics = "small"'
        )
    if not coupling.distributing or not coupling.given or mesh.axisymmetric:
        return
    if any(name in TURNS for name in coupling.given) or not _at_mean(mesh, coupling):
        raise InputError(
            f"{where}: a mean motion can be prescribed with small turns only, but for translations at the mean of the "
            'points; give a force or moment, use kind = "kinematic", or kinematics = "small"'
        )


def _at_mean(mesh: Mesh, coupling: Coupling) -> bool:
    points = mesh.points[coupling.nodes(mesh)]
    if coupling.reference is None:
        return True
    away = np.array(coupling.reference) - coupling.shares(mesh) @ points
    return bool(np.linalg.norm(away) <= AT_MEAN * np.ptp(points, axis=0).max(initial=0.0))


def in_line(points: NDArray[np.float64]) -> bool:
    """Whether points (n, 3) lie on a line, about which nothing turns them."""
    sizes = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return len(points) < 3 or bool(sizes[1] <= IN_LINE * sizes[0])
