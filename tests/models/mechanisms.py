"""Rigid bars joined by connectors, beside a block that deforms and has no part in it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

import abut
from abut.mesh.make import box, join, rectangle

Bar = tuple[Sequence[float], Sequence[float]]  # ends of its axis
Given = Mapping[str, Any] | None


def flat(
    bars: Mapping[str, Bar], connectors: Sequence[abut.Connector], given: Given = None, **options: Any
) -> abut.Model:
    """Bars of the width 1 in the plane, along x before they are turned; each with node sets of both its ends."""
    parts = {"block": rectangle((-60.0, -59.0), (0.0, 1.0), (1, 1))}
    for name, (start, end) in bars.items():
        along = np.subtract(end, start)
        length = float(np.linalg.norm(along))
        bar = rectangle((0.0, length), (-0.5, 0.5), (4, 2))
        turn = np.array([[along[0], -along[1]], [along[1], along[0]]]) / length
        parts[name] = replace(bar, points=bar.points @ turn.T + start)
    mesh = join(parts)
    ends = {f"{name} {k}": _at(mesh, end) for name, bar in bars.items() for k, end in enumerate(bar)}
    return _model(replace(mesh, node_sets=ends), list(bars), connectors, given, plane="strain", **options)


def solid(
    bars: Mapping[str, Bar], connectors: Sequence[abut.Connector], given: Given = None, **options: Any
) -> abut.Model:
    """Bars of square section, 1 by 1, in space, likewise."""
    parts = {"block": box((-60.0, -59.0), (0.0, 1.0), (0.0, 1.0), (1, 1, 1))}
    for name, (start, end) in bars.items():
        along = np.subtract(end, start)
        length = float(np.linalg.norm(along))
        one = along / length
        two = np.cross(one, np.eye(3)[np.abs(one).argmin()])
        two /= np.linalg.norm(two)
        bar = box((0.0, length), (-0.5, 0.5), (-0.5, 0.5), (3, 2, 2))
        parts[name] = replace(bar, points=bar.points @ np.array([one, two, np.cross(one, two)]) + start)
    mesh = join(parts)
    ends = {f"{name} {k}": _at(mesh, end) for name, bar in bars.items() for k, end in enumerate(bar)}
    return _model(replace(mesh, node_sets=ends), list(bars), connectors, given, **options)


def _at(mesh: abut.Mesh, place: Sequence[float]) -> np.ndarray:
    return np.flatnonzero(np.linalg.norm(mesh.points - np.array(place), axis=1) < 1e-9)


def _model(
    mesh: abut.Mesh,
    bars: Sequence[str],
    connectors: Sequence[abut.Connector],
    given: Given = None,
    **options: Any,
) -> abut.Model:
    """given: keys of single bars."""
    held = abut.Support("block.bottom", **dict.fromkeys("xyz"[: mesh.dim], 0.0))
    return abut.Model(
        mesh,
        [abut.Solid("block", abut.LinearElastic(1000.0, 0.3))],
        [held],
        rigid=[abut.Rigid(name, **(given or {}).get(name, {})) for name in bars],
        connectors=connectors,
        **options,
    )


def lever_and_block(kinematics: str, moment: float) -> abut.Model:
    """A rigid lever from a hinge at (0, 2), whose underside lies on a block between 9 and 10."""
    mesh = join(
        {"lever": rectangle((0.0, 10.0), (1.5, 2.5), (10, 2)), "block": rectangle((9.0, 10.0), (0.5, 1.5), (4, 4))}
    )
    return abut.Model(
        mesh,
        [abut.Solid("block", abut.LinearElastic(1000.0, 0.3))],
        [abut.Support("block.bottom", x=0, y=0)],
        contacts=[abut.Contact("block.top", "lever.bottom")],
        rigid=[abut.Rigid("lever")],
        connectors=[abut.Connector("h", "hinge", "lever", at=(0, 2), load=moment)],
        plane="strain",
        kinematics=kinematics,
    )
