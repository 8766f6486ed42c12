"""Pressures that are continuous are unknowns beside displacements: what `abut check` foresees, where "auto" takes them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import abut
from abut.bodies import factor_memory
from abut.bodies.assemble import stiffness_at_rest
from abut.bordered import with_border
from abut.diagnosis.cost import Foreseen, foresee
from abut.linear.cost_model import of_stiffness
from abut.mesh.make import box, join
from abut.mesh.mesh import Mesh
from abut.model.locking import STIFF, locking
from abut.problem.constraints import supports


def block(poisson: float, integration: str = "auto", n: int = 4) -> abut.Model:
    """A clamped cube of rubber beside one of steel, of hexahedra."""
    mesh = join({"pad": box(cells=(n,) * 3, cell="tet10"), "steel": box((2, 3), cells=(2,) * 3, cell="hex8")})
    return abut.Model(
        mesh,
        [
            abut.Solid("pad", abut.LinearElastic(3.0, poisson), integration=integration),
            abut.Solid("steel", abut.LinearElastic(200e3, 0.3)),
        ],
        [abut.Support(f"{body}.bottom", x=0, y=0, z=0) for body in ("pad", "steel")],
        [abut.Pressure("pad.top", 0.01)],
    )


def taken(model: abut.Model) -> str:
    """How its rubber is integrated."""
    return model.integration(model.solids[0])


@pytest.mark.parametrize("poisson", [0.45, 0.489, 0.49, 0.495, 0.4979, 0.498, 0.4985, 0.4999, 0.499999])
def test_auto_begins_where_the_line_does(poisson: float) -> None:
    """Nowhere is full integration taken that the certificate then finds too stiff, nor mixed where it would not be."""
    told = [one for one in locking(block(poisson, "full")) if one.stiffness > STIFF]
    assert taken(block(poisson)) == ("mixed" if told else "full")
    assert not locking(block(poisson))


def foreseen(model: abut.Model) -> Foreseen:
    """Of a run."""
    return foresee(model, supports(model), ())


def test_estimate_knows_the_matrix() -> None:
    """Its entries, as assembled; memory as measured with PARDISO on one core: 432 MB for 26460 displacements, 900 for
    56862 (to half as much again)."""
    mesh: Mesh = box(cells=(6,) * 3, cell="tet10")
    model = abut.Model(
        mesh, [abut.Solid("body", abut.LinearElastic(3.0, 0.499))], [abut.Support("bottom", x=0, y=0, z=0)]
    )
    free = np.flatnonzero(np.repeat(mesh.points[:, 2] > 0, 3))
    entries = with_border(stiffness_at_rest(model.deformable))[0].nnz * len(free) / mesh.points.size
    assert of_stiffness(mesh, len(free), model.integrations.wide).entries == pytest.approx(entries, rel=0.15)
    for n, megabytes in ((26460, 432), (56862, 900)):
        assert factor_memory.WIDE.megabytes(n) == pytest.approx(megabytes, rel=0.5)


def test_estimates_of_a_run() -> None:
    """`abut check` says a little more of what is mixed, and nothing else of what is not."""
    wide, full, steel = foreseen(block(0.499)), foreseen(block(0.499, "full")), foreseen(block(0.3))
    assert full.megabytes < wide.megabytes < 1.5 * full.megabytes
    assert full.stages["solve"] < wide.stages["solve"] < 3.0 * full.stages["solve"]
    assert (steel.megabytes, steel.stages) == (full.megabytes, full.stages)


def test_bodies_that_do_not_exist() -> None:
    """Are told as before, whatever stands in front of them."""
    model = block(0.499)
    with pytest.raises(abut.InputError, match="other"):
        replace(model, solids=[*model.solids, abut.Solid("other", abut.LinearElastic(3.0, 0.499))])
