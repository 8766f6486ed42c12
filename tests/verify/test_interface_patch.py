"""The patch test of a user's own interfaces: exact where theory says so, on any meshes, and it can fail."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.errors import InputError
from abut.mesh.make import box, join, rectangle, ring
from abut.mesh.mesh import Mesh
from abut.verify import interface_patch
from models.patch import ROTATION, model, two_blocks
from models.split import split_base

SOLID = ((2, 3, 2), (3, 2, 2))


def bare(mesh: Mesh, contactor: str, target: str, plane: str | None = "strain", **contact: object) -> abut.Model:
    """A model of which the patch test needs no more than meshes and a pair."""
    return abut.Model(
        mesh,
        [abut.Solid(body, abut.LinearElastic(200.0, 0.1)) for body in mesh.bodies],
        contacts=[abut.Contact(contactor=contactor, target=target, **contact)],
        plane=plane if mesh.dim == 2 else None,
    )


def overlap(cell: str, turned: float = 0.0, *, swap: bool = False, rotate: bool = False) -> abut.Model:
    """Two boxes (or rectangles) of which neither covers the other, one ``turned`` in the plane by degrees."""
    pair = ("upper.bottom", "lower.top") if swap else ("lower.top", "upper.bottom")
    if cell in ("quad4", "quad8", "quad9", "tri3", "tri6"):
        parts = {
            "lower": rectangle((0.2, 1), (0, 1), (4, 3), cell),
            "upper": rectangle((0.43, 1.4), (1, 2), (5, 3), cell),
        }
        return bare(join(parts), *pair)
    lower, upper = box((0, 1), (0, 1), (0, 1), (3, 3, 2), cell), box((0.3, 1.4), (-0.2, 0.6), (1, 2), (4, 3, 2), cell)
    c, s = np.cos(np.deg2rad(turned)), np.sin(np.deg2rad(turned))
    upper = replace(upper, points=upper.points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]))
    mesh = join({"lower": lower, "upper": upper})
    return bare(replace(mesh, points=mesh.points @ ROTATION.T) if rotate else mesh, *pair)


COARSE, FINE = (1, 1, 1), (10, 10, 2)
PATCHES: dict[str, Callable[[], abut.Model]] = {
    **{f"{a} on {b}, turned": lambda a=a, b=b: model(two_blocks(a, b, SOLID))
       for a, b in (("hex8", "hex20"), ("tet10", "wedge6"), ("hex27", "tet4"))},
    **{f"overlap of {cell}": lambda cell=cell: overlap(cell)
       for cell in ("hex8", "hex20", "tet10", "quad4", "quad8", "quad9", "tri3", "tri6")},
    **{f"overlap of {cell}, other contactor": lambda cell=cell: overlap(cell, swap=True)
       for cell in ("hex8", "tet4", "quad4", "quad8", "quad9", "tri3", "tri6")},
    **{f"overlap of {cell} by 30 degrees": lambda cell=cell: overlap(cell, 30.0) for cell in ("hex8", "hex20", "tet10")},
    **{f"overlap of {cell}, turned in space": lambda cell=cell: overlap(cell, rotate=True)
       for cell in ("hex8", "hex20", "tet10")},
    **{f"T-junctions, below {below}": lambda below=below: split_base(below) for below in (False, True)},
    **{f"{plane}: {a} on {b}": lambda p=plane, a=a, b=b: replace(
           model(two_blocks(a, b, ((5, 3), (7, 3))), rotate=False), plane=p)
       for plane in ("strain", "stress", "axisymmetric")
       for a, b in (("quad4", "quad8"), ("tri6", "quad9"), ("tri3", "tri3"))},
    **{f"overlap of {cell}, axisymmetric": lambda cell=cell: replace(overlap(cell), plane="axisymmetric")
       for cell in ("quad4", "quad8", "tri6")},
    **{f"{cell}, {name} contactor": lambda cell=cell, cells=cells: model(two_blocks(cell, cell, cells, distort=0.1))
       for cell in ("hex8", "hex20", "tet10") for name, cells in (("coarse", (COARSE, FINE)), ("fine", (FINE, COARSE)))},
    "tied": lambda: model(two_blocks("hex8", "hex8", SOLID), kind="tied"),
    "offset and smooth law": lambda: model(two_blocks("hex8", "hex8", SOLID), offset=0.1, law="constraint-function"),
    "dual": lambda: model(two_blocks("hex8", "hex8", SOLID), pressure="dual"),
    "in nanometres": lambda: scaled(overlap("quad8"), 1e-9),
    "in micrometres": lambda: scaled(overlap("hex8", 30.0), 1e6),
}  # fmt: skip


def scaled(built: abut.Model, factor: float) -> abut.Model:
    return replace(built, mesh=replace(built.mesh, points=built.mesh.points * factor))


@pytest.mark.parametrize("name", PATCHES)
def test_patch_of_own_interfaces(name: str) -> None:
    """Uniform pressure and linear displacement lie in the spaces, whatever the meshes: exact to rounding times the
    condition of the equations, which grows with the contrast of sizes: 1e-8."""
    (result,) = interface_patch(PATCHES[name]())
    assert result.flat
    assert max(result.pressure, result.displacement) < 1e-8
    assert max(result.force_balance, result.moment_balance) < 1e-12
    assert result.passed


def test_slivers_at_the_rim_keep_the_pressure() -> None:
    """Contactor facets of which a few per cent face the target would determine their outer multipliers badly: those follow
    their neighbours (theory P5), and the pressure keeps its digits."""
    (result,) = interface_patch(overlap("hex20", swap=True))
    assert result.displacement < 1e-10
    assert result.pressure < 1e-8


def test_patch_can_fail() -> None:
    mesh = two_blocks("hex8", "hex8", SOLID)
    for wrong in ({"integration": abut.Integration("gauss", 1)}, {"method": "node-to-segment"}):
        (result,) = interface_patch(model(mesh, **wrong))
        assert not result.passed
        assert result.pressure > 1e-2
        assert result.force_balance < 1e-12


def test_patch_of_every_contact() -> None:
    """Two contacts in a stack are tested one by one, the other one open meanwhile."""
    parts = {str(i): rectangle((0, 1), (i, i + 1), (3 + i, 2), "quad8") for i in range(3)}
    built = bare(join(parts), "0.top", "1.bottom", name="low")
    built = replace(built, contacts=[*built.contacts, abut.Contact(contactor="1.top", target="2.bottom", name="high")])
    results = interface_patch(built)
    assert [r.contact for r in results] == ["low", "high"]
    assert all(r.passed and r.flat for r in results)


def test_curved_and_radial_interfaces_are_only_balanced() -> None:
    """Concentric rings; and, round an axis, an interface along it: a uniform radial stress is no equilibrium there."""
    rings = join(
        {
            "inner": ring(radii=(1, 2), cells=(2, 8), cell="quad8"),
            "outer": ring(radii=(2, 3), cells=(2, 12), cell="quad8"),
        }
    )
    sleeve = join(
        {"inner": rectangle((1, 2), (0, 1), (3, 4), "quad8"), "outer": rectangle((2, 3), (0, 1), (3, 5), "quad8")}
    )
    for built in (bare(rings, "inner.outer", "outer.inner"), bare(sleeve, "inner.right", "outer.left", "axisymmetric")):
        (result,) = interface_patch(built)
        assert not result.flat
        assert result.pressure is result.displacement is None
        assert result.passed


def test_patch_refuses() -> None:
    built = model(two_blocks("quad4", "quad4", ((5, 3), (7, 3))))
    with pytest.raises(InputError, match="no contact to test; add one"):
        interface_patch(replace(built, contacts=[]))
    two_pass = replace(built.contacts[0], method="node-to-segment-two-pass")
    with pytest.raises(InputError, match="pressure is not unique; take another method"):
        interface_patch(replace(built, contacts=[two_pass]))
    with pytest.raises(InputError, match=r"no facet of .* faces"):
        interface_patch(replace(built, contacts=[abut.Contact(contactor="lower.top", target="upper.top")]))
