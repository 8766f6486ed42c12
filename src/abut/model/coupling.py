"""Couplings: points of a surface or node set that move with a reference point."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from abut import checks
from abut.bodies.loads import area_weights
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.model.conditions import COMPONENTS, TURNS, Amplitude, History, Rigid, check_motion

KINDS = ("kinematic", "distributing")
AT_MEAN = 1e-9  # of the points' extent: a reference that is their mean
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
    x, y, z : float, optional
        Prescribed displacement of the reference [length]; free where left out.
    rx, ry, rz : float, optional
        Prescribed rotation [radian]; free where left out.
    amplitude : Amplitude, optional
        Of all these over time.
    amplitudes : mapping of str to Amplitude
        Of some of them, by name.

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
    x: float | None = None
    y: float | None = None
    z: float | None = None
    rx: float | None = None
    ry: float | None = None
    rz: float | None = None
    amplitude: History = None
    amplitudes: Mapping[str, Amplitude] = field(default_factory=dict)

    def __post_init__(self) -> None:
        where = f"coupling '{self.name}'"
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
        nodes = mesh.nodes_of(self.on)
        weights = np.ones(len(nodes))
        if self.distributing and self.weights is not None:
            weights = np.array(self.weights)
        elif self.distributing and self.on in mesh.surfaces:
            weights = area_weights(mesh.surface(self.on))[nodes]
        return weights / weights.sum()


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
        for name in coupling.given:
            if name not in exist and getattr(coupling, name):
                plane = "axisymmetric" if mesh.axisymmetric else "2D"
                raise InputError(f"{where}.{name}: the model is {plane}; leave {name} out")
        if coupling.reference is not None and len(coupling.reference) != mesh.dim:
            raise InputError(f"{where}.reference: expected {mesh.dim} numbers, got {len(coupling.reference)}")
        if mesh.dim == 2 and "z" in (coupling.follow or ()):
            raise InputError(f"{where}.follow: the model is 2D; leave z out")
        nodes = mesh.nodes_of(coupling.on)
        if coupling.weights is not None and len(coupling.weights) != len(nodes):
            raise InputError(
                f"{where}.weights: expected {len(nodes)} numbers, one for each point, got {len(coupling.weights)}"
            )
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
            moved |= dict.fromkeys(mesh.nodes_of(coupling.on).tolist(), f"coupling '{coupling.name}'")
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


def _check_finite(mesh: Mesh, coupling: Coupling, where: str) -> None:
    """What takes equations that finite turns would bend."""
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
    points = mesh.points[mesh.nodes_of(coupling.on)]
    if coupling.reference is None:
        return True
    away = np.array(coupling.reference) - coupling.shares(mesh) @ points
    return bool(np.linalg.norm(away) <= AT_MEAN * np.ptp(points, axis=0).max(initial=0.0))


def in_line(points: NDArray[np.float64]) -> bool:
    """Whether points (n, 3) lie on a line, about which nothing turns them."""
    sizes = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
    return len(points) < 3 or bool(sizes[1] <= IN_LINE * sizes[0])
