"""Pressures that are continuous make the stiffness wide: what `abut check` foresees, and up to where "auto" takes them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

import abut
from abut.bodies import factor_memory
from abut.bodies.assemble import stiffness
from abut.bodies.factor_memory import AFFORDED, affordable
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
    """Its entries, as assembled; seconds and memory as measured with PARDISO on one core: 722 MB for 13872 displacements,
    1472 for 26460 (to a factor of three), more than ten times as long as with full integration."""
    mesh: Mesh = box(cells=(6,) * 3, cell="tet10")
    model = abut.Model(
        mesh, [abut.Solid("body", abut.LinearElastic(3.0, 0.499))], [abut.Support("bottom", x=0, y=0, z=0)]
    )
    free = np.flatnonzero(np.repeat(mesh.points[:, 2] > 0, 3))
    entries = stiffness(model.deformable)[free][:, free].nnz
    assert of_stiffness(mesh, len(free), model.integrations.wide).entries == pytest.approx(entries, rel=0.35)
    assert of_stiffness(mesh, len(free)).entries < 0.3 * entries
    for n, megabytes in ((13872, 722), (26460, 1472)):
        assert factor_memory.WIDE.megabytes(n) == pytest.approx(megabytes, rel=0.2)


def test_estimates_of_a_run() -> None:
    """`abut check` says more of what is mixed, and nothing else of what is not."""
    wide, full, steel = foreseen(block(0.499)), foreseen(block(0.499, "full")), foreseen(block(0.3))
    assert wide.megabytes > full.megabytes
    assert wide.stages["solve"] > full.stages["solve"]
    assert (steel.megabytes, steel.stages) == (full.megabytes, full.stages)


def test_large_models_stay_with_full_integration(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where memory does not allow for mixed cells; the certificate tells that they lock, a note why. Those asked for remain,
    and a Poisson's ratio of 0.5, which has no other."""
    n = block(0.499).mesh.points.size
    monkeypatch.setattr(factor_memory, "AFFORDED", 0.5 * factor_memory.WIDE.megabytes(n))
    model = block(0.499)
    assert taken(model) == "full"
    assert model.integrations.too_wide == ["pad"]
    assert taken(block(0.499, "mixed")) == taken(block(0.5)) == "mixed"
    assert not block(0.45).integrations.too_wide
    solution = abut.solve(model)
    assert [line.verdict for line in solution.certificate if line.name == "locking"] == ["warn"]
    assert any("stiff" in note and "GB" in note for note in solution.notes)


def largest(share: float) -> int:
    """Displacements up to which "auto" takes mixed cells for a share of them."""
    counts: NDArray[np.int64] = np.arange(1000, 2_000_000, 1000)
    return int(max(n for n in counts.tolist() if affordable(n, share)))


def test_a_run_never_needs_absurd_memory() -> None:
    """Whatever "auto" takes, its direct solver needs no more than is afforded; bodies of which a little is rubber may be
    larger, but end, too, since they would have had multigrid."""
    little, half, whole = (largest(share) for share in (0.02, 0.5, 1.0))
    assert whole < half < little < 400_000
    assert whole > 50_000
    assert factor_memory.WIDE.megabytes(whole) <= AFFORDED < factor_memory.WIDE.megabytes(whole + 1000)


def test_bodies_that_do_not_exist() -> None:
    """Are told as before, whatever stands in front of them."""
    model = block(0.499)
    with pytest.raises(abut.InputError, match="other"):
        replace(model, solids=[*model.solids, abut.Solid("other", abut.LinearElastic(3.0, 0.499))])
