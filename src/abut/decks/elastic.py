"""Elastic materials of a deck: by direction, and over the temperature."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from abut.axes import Axes
from abut.io.deck.groups import Piece
from abut.io.deck.reasons import DeckError
from abut.io.deck.record import Deck, Elastic, Expansion, Orientation, Rows
from abut.materials.anisotropic import ORDER, Anisotropic, LocalElastic, Orthotropic
from abut.materials.elastic import LinearElastic
from abut.materials.temperature import OverTemperature

IN_PLANE = 1e-9  # component out of the plane over the length that is none


def elastic_law(deck: Deck, piece: Piece, dim: int) -> LinearElastic | LocalElastic | OverTemperature:
    """Of a body. Raises InputError for constants that no material has."""
    material, orientation = piece.section.material, piece.section.orientation
    elastic, expansion = material.elastic, material.expansion
    axes = None if orientation is None else local_axes(orientation, dim)
    if len(elastic.rows) == 1 and len(expansion.rows) == 1:
        return _one(elastic, expansion, elastic.rows[0][0], axes, material.density)
    several = [rows for rows in (elastic.rows, expansion.rows) if len(rows) > 1]
    temperatures = sorted({temperature for rows in several for temperature, _ in rows})
    laws = [_one(elastic, expansion, t, axes, material.density) for t in temperatures]
    return OverTemperature(temperatures, laws, initial_temperature(deck, piece), expansion.zero)


def initial_temperature(deck: Deck, piece: Piece) -> float:
    """Temperature of a body at the beginning."""
    rows = [nodes for block in deck.blocks for nodes in block.nodes[np.isin(block.ids, piece.elements)]]
    found = {deck.initial.get(int(node), 0.0) for nodes in rows for node in nodes}
    if len(found) > 1:
        raise DeckError(
            piece.section.place,
            f"*INITIAL CONDITIONS: the body begins with temperatures from {min(found):g} to {max(found):g}; where its "
            "constants depend on the temperature it must begin with one: let it warm in a step of its own",
        )
    return found.pop() if found else 0.0


def _one(
    elastic: Elastic, expansion: Expansion, temperature: float, axes: Axes | None, density: float
) -> LinearElastic | LocalElastic:
    """At a temperature."""
    swelling = between(expansion.rows, temperature)
    given = swelling[0] if len(swelling) == 1 else swelling
    if elastic.kind == "isotropic":
        young, poisson = between(elastic.rows, temperature)
        if len(swelling) == 1:
            return LinearElastic(young, poisson, density, swelling[0])
        shear = young / (2.0 + 2.0 * poisson)
        return Orthotropic((young,) * 3, (poisson,) * 3, (shear,) * 3, axes=axes, expansion=given, density=density)
    if elastic.kind == "anisotropic":
        return Anisotropic(between(elastic.rows, temperature), axes=axes, expansion=given, density=density)
    known = dict(elastic.rows)
    if len(known) == 1 or temperature in known:
        values = known.get(temperature, elastic.rows[0][1])
        return Orthotropic(values[:3], values[3:6], values[6:], axes=axes, expansion=given, density=density)
    each = tuple((t, _constants(Orthotropic(v[:3], v[3:6], v[6:]))) for t, v in elastic.rows)
    return Anisotropic(between(each, temperature), axes=axes, expansion=given, density=density)


def _constants(law: Orthotropic) -> tuple[float, ...]:
    return tuple(float(law.stiffness[ORDER[i], ORDER[j]]) for j in range(6) for i in range(j + 1))


def between(rows: Rows, temperature: float) -> tuple[float, ...]:
    """Linear in the temperature, constant beyond."""
    at = [t for t, _ in rows]
    values = np.array([v for _, v in rows])
    return tuple(float(np.interp(temperature, at, column)) for column in values.T)


def local_axes(given: Orientation, dim: int) -> Axes:
    """Axes of an orientation. Raises InputError for those that leave the plane of a model of two dimensions."""
    if dim == 3:
        if given.kind == "rectangular":
            return Axes(x=given.a, xy=given.b)
        along = np.subtract(given.b, given.a)
        return Axes("cylindrical", origin=given.a, axis=tuple(along.tolist()))
    if given.kind == "cylindrical":
        along = np.subtract(given.b, given.a)
        if _apart(along[:2], along) or along[2] < 0.0:
            raise DeckError(given.place, "*ORIENTATION: the axis of a plane model's directions must be z, upwards")
        return Axes("cylindrical", origin=given.a[:2])
    third = np.cross(given.a, given.b)
    if _apart(third[:2], third) or third[2] < 0.0:
        raise DeckError(
            given.place,
            "*ORIENTATION: the third direction must be z in a plane model; give a and b in the plane, b to the left",
        )
    return Axes(x=given.a[:2])


def _apart(part: Sequence[float] | np.ndarray, whole: np.ndarray) -> bool:
    return bool(np.linalg.norm(part) > IN_PLANE * np.linalg.norm(whole))
