"""What friction at large sliding remembers of a step: its integration points, looked at in new positions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from abut._core import couple_surfaces, slip_tangent
from abut.cells import MAX_FACET_NODES
from abut.contact.block_rows import CompressedRows
from abut.contact.coupling import CouplingOptions, cutting_arguments
from abut.contact.geometry import Smoothing
from abut.contact.moving_normals import MovingNormals
from abut.mesh.surface import Surface

Array = NDArray[np.float64]


@dataclass(frozen=True)
class SlipPoints:
    """Integration points (n of them) of the last converged step: constants of the next one, theory (G6).

    facet, target_facet: (n,) int32; weight: (n,) area; pressure, own, other: (n, 9) values of the facet-wise pressure
    functions and of the shape functions of the contactor's and the target's facet."""

    facet: NDArray[np.int32]
    target_facet: NDArray[np.int32]
    weight: Array
    pressure: Array
    own: Array
    other: Array

    @classmethod
    def of(
        cls,
        contactor: Surface,
        target: Surface,
        degree: int,
        options: CouplingOptions,
        across: Smoothing | None = None,
    ) -> SlipPoints:
        """Those of ``couple(contactor, target, degree, options, across=across)``."""
        raw = couple_surfaces(
            **cutting_arguments(contactor, target, np.arange(len(contactor)), options, across),
            degree=degree,
            vectorial=True,
            keep_points=True,
            gap_samples=False,
        )
        names = ("contactor_facet", "target_facet", "weight", "pressure", "contactor", "target")
        return cls(*(raw[f"point_{name}"] for name in names))

    @classmethod
    def from_array(cls, values: Array) -> SlipPoints:
        """From ``array``."""
        own, other = np.ascontiguousarray(np.rint(values[:, :2].T), dtype=np.int32)
        parts = (np.ascontiguousarray(part) for part in np.split(values[:, 3:], 3, axis=1))
        return cls(own, other, np.ascontiguousarray(values[:, 2]), *parts)

    @property
    def array(self) -> Array:
        """All of it, (n, 30), for a restart."""
        return np.column_stack([self.facet, self.target_facet, self.weight, self.pressure, self.own, self.other])

    def on(self, facets: NDArray[np.int64]) -> SlipPoints:
        """Those on some facets of the contactor."""
        keep = np.isin(self.facet, facets)
        parts = (self.weight, self.pressure, self.own, self.other)
        return SlipPoints(self.facet[keep], self.target_facet[keep], *(part[keep] for part in parts))

    def moments(self, n_facets: int) -> Array:
        """int H_k over what was covered, facet by facet, (9 n_facets,)."""
        row = MAX_FACET_NODES * self.facet[:, None] + np.arange(MAX_FACET_NODES)
        moment = (self.weight[:, None] * self.pressure).ravel()
        return np.bincount(row.ravel(), moment, MAX_FACET_NODES * n_facets).astype(float)


@dataclass(frozen=True)
class Past:
    """From where slip counts in a step. points: of the last state; shift: (n_tangential,) weighted slips that do not count,
    as points had not touched yet, theory (G20); late: points for functions that those of the last state do not cover."""

    points: SlipPoints
    shift: Array
    late: SlipPoints | None = None


@dataclass(frozen=True)
class SlipNow:
    """Weighted slips facet by facet, c components. value: (9 n_facets, c); by_points, by_normals: of 9 n_facets rows, blocks
    (n, c, dim), derivatives by points and by the nodal normals that differ."""

    value: Array
    by_points: CompressedRows
    by_normals: CompressedRows


def slip_now(points: SlipPoints, contactor: Surface, target: Surface, normals: MovingNormals) -> SlipNow:
    """Of theory (G6), at the positions of two surfaces over one array of points, normals being the contactor's: sum w H
    (x_C - x_T) . tau in 2D (c = 1), with tau the normal turned by a right angle; in 3D (c = 3) the part of x_C - x_T square
    to the normal. Derivatives by theory (T7)."""
    raw = slip_tangent(
        points_c=contactor.points,
        nodes_c=contactor.nodes,
        normals=normals.values,
        points_t=target.points,
        nodes_t=target.nodes,
        facet=points.facet,
        target_facet=points.target_facet,
        weight=points.weight,
        pressure=points.pressure,
        own=points.own,
        other=points.other,
        normal_numbers=normals.numbers,
        target_offset=0,
    )
    return SlipNow(raw["value"], raw["by_points"], raw["by_normals"])
