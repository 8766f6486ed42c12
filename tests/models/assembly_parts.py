"""What random assemblies are made of: bodies, contacts, supports and loads, drawn from a generator."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

import abut
from abut.mesh import make
from abut.mesh.make.block import PLANE_CELLS

Rng = np.random.Generator
CELLS = {
    2: ("tri3", "tri6", "quad4", "quad8", "quad9"),
    3: ("tet4", "tet10", "hex8", "hex20", "hex27", "wedge6", "wedge15"),
}
assert CELLS[2] == PLANE_CELLS


@dataclass
class Parts:
    """What an assembly is made of so far."""

    rng: Rng
    meshes: dict[str, abut.Mesh] = field(default_factory=dict)
    supports: list[abut.Support] = field(default_factory=list)
    loads: list[abut.Pressure | abut.Force | abut.BodyForce] = field(default_factory=list)
    contacts: list[abut.Contact] = field(default_factory=list)
    rigid: list[abut.Rigid] = field(default_factory=list)
    spins: list[tuple[str, str, str]] = field(default_factory=list)

    def size(self, low: float, high: float) -> float:
        """A number whose magnitude is drawn evenly."""
        return float(np.exp(self.rng.uniform(np.log(low), np.log(high))))

    def chance(self, share: float) -> bool:
        return bool(self.rng.random() < share)

    def count(self, low: int, high: int) -> int:
        return int(self.rng.integers(low, high + 1))

    def cell(self, dim: int) -> str:
        return str(self.rng.choice(CELLS[dim]))

    def clearance(self, size: float, tight: float = 0.3) -> float:
        """Nothing, a gap between bodies of some size, or with the chance ``tight`` an overlap."""
        kind = self.rng.random()
        if kind < tight:
            return -self.size(1e-5, 1e-2) * size
        return self.size(1e-5, 3e-2) * size if kind < 0.8 else 0.0

    def add(self, name: str, mesh: abut.Mesh, **surfaces: Callable[[NDArray[np.float64]], NDArray[np.bool_]]) -> None:
        """A body; ``surfaces``: parts of its surface "round", by where the middle of a facet lies."""
        if surfaces:
            whole = mesh.surface("round")
            corners = np.where(whole.nodes[:, :2, None] >= 0, whole.points[whole.nodes[:, :2]], np.nan)
            middle = np.nanmean(corners, axis=1)
            own = {k: mesh.surfaces["round"][where(middle)] for k, where in surfaces.items()}
            mesh = replace(mesh, surfaces={**mesh.surfaces, **own})
        self.meshes[name] = mesh

    def node(self, name: str, label: str, at: tuple[float, ...]) -> str:
        """The node of a body that is nearest to a place, as a set."""
        mesh = self.meshes[name]
        nearest = np.array([np.abs(mesh.points - np.array(at)).max(axis=1).argmin()])
        self.meshes[name] = replace(mesh, node_sets={**mesh.node_sets, label: nearest})
        return f"{name}.{label}"

    def stop_spin(self, name: str, centre: tuple[float, float], radius: float) -> None:
        """Two points of a roller, one over the other, go sideways together."""
        x, y = centre
        one, other = (
            self.node(name, label, (x, y + r)) for label, r in (("above", 0.5 * radius), ("under", -0.5 * radius))
        )
        self.spins.append((one, other, "x"))

    def hold(self, on: str, **components: float) -> None:
        self.supports.append(abut.Support(on, **components))

    def touch(self, contactor: str, target: str, **options: Any) -> None:
        self.contacts.append(abut.Contact(contactor=contactor, target=target, name=f"c{len(self.contacts)}", **options))

    def meet(self, one: str, other: str, **options: Any) -> None:
        """As ``touch``, with the sides drawn."""
        self.touch(*((one, other) if self.chance(0.5) else (other, one)), **options)

    def model(self, plane: str | None) -> abut.Model:
        mesh = make.join(self.meshes)
        rigid = {body.body for body in self.rigid}
        solids = [
            abut.Solid(body, abut.LinearElastic(self.size(300.0, 3e4), self.rng.uniform(0.0, 0.4)))
            for body in mesh.bodies
            if body not in rigid
        ]
        equations = [
            abut.Equation((abut.Term(one, component, 1.0), abut.Term(other, component, -1.0)))
            for one, other, component in self.spins
        ]
        return abut.Model(
            mesh, solids, self.supports, self.loads, self.contacts, plane, equations=equations, rigid=self.rigid
        )


def plane_of(parts: Parts) -> str:
    return "strain" if parts.chance(0.5) else "stress"


def press(parts: Parts, body: str, up: int) -> None:
    """Load a block or plate down, evenly, askew, by its weight or by some of them; component ``up`` is the height."""
    dim = 3 if up == 2 else 2
    down = np.zeros(dim)
    down[up] = -parts.size(0.01, 10.0)
    kinds = parts.rng.choice(["pressure", "askew", "weight"], size=parts.count(1, 2), replace=False)
    if "pressure" in kinds:
        parts.loads.append(abut.Pressure(f"{body}.top", -down[up]))
    if "weight" in kinds:
        parts.loads.append(abut.BodyForce(tuple(down), on=body))
    if "askew" in kinds:
        side = ["left", "right"][parts.count(0, 1)]
        parts.loads.append(abut.Force(f"{body}.{side}", tuple(0.3 * down)))
        if len(kinds) == 1:
            parts.loads.append(abut.Pressure(f"{body}.top", float(-0.3 * down[up] * parts.rng.uniform(0.2, 2.0))))


def keep_upright(parts: Parts, body: str, x: float, y: float) -> None:
    """Hold a plane block sideways: at a side, so that it cannot turn, or at one node, or, where nothing pushes it that way,
    not at all."""
    kind = parts.rng.random()
    if kind < 0.4:
        parts.hold(f"{body}.left", x=0.0)
    elif kind < 0.8:
        parts.hold(parts.node(body, "pinned", (x, y)), x=0.0)
