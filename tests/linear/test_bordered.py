"""A stiffness whose continuous pressures stay unknowns: the same operator, the same solutions, few entries."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

import abut
from abut.bodies.assemble import stiffness, stiffness_at_rest
from abut.bordered import Bordered, eliminated, with_border
from abut.linear import static_condensation
from abut.mesh.make import box, join
from abut.problem.backend import Serial
from abut.problem.constraints import Constraints

WEIGHTS = np.array([3.0, 1e9, -0.5, 0.0, 1e-30])


def made(weights: np.ndarray = WEIGHTS) -> Bordered:
    """A positive definite matrix with a border."""
    rng = np.random.default_rng(0)
    parts = rng.normal(size=(12, 12))
    matrix = sp.csr_matrix(parts @ parts.T + 20.0 * np.eye(12))
    return Bordered(matrix, sp.csr_matrix(rng.normal(size=(len(weights), 12))), weights)


def test_operator() -> None:
    """What else is asked of a stiffness is that of the whole matrix."""
    b, rng = made(WEIGHTS[[0, 2, 3]]), np.random.default_rng(1)
    dense = b.matrix.toarray() + b.rows.T.toarray() @ np.diag(b.weight) @ b.rows.toarray()
    v, basis = rng.normal(size=(12, 2)), sp.csr_matrix(rng.normal(size=(12, 4)))
    more = sp.csr_matrix(rng.normal(size=(12, 12)))
    small = b.within(basis, (basis.T @ b.matrix @ basis).tocsr())
    for found, wanted in (
        (b.tocsr().toarray(), dense),
        (b.diagonal(), dense.diagonal()),
        (b @ v, dense @ v),
        (b @ v[:, 0], dense @ v[:, 0]),
        ((b @ basis).toarray(), dense @ basis.toarray()),
        ((more + b).T @ v, (dense + more).T @ v),
        ((b - more) @ v, (dense - more) @ v),
        ((b + b - 0.5 * b) @ v, 1.5 * dense @ v),
        (sum([b, b]) @ v, 2.0 * dense @ v),
        (small @ v[:4], basis.T.toarray() @ dense @ basis.toarray() @ v[:4]),
    ):
        np.testing.assert_allclose(found, wanted, rtol=1e-12, atol=1e-12 * abs(dense).max())
    assert eliminated(b.matrix) is b.matrix
    assert with_border(b.matrix) == (b.matrix, 0)


@pytest.mark.parametrize("weights", [WEIGHTS, np.zeros(3)])
def test_whole_has_the_same_solution(weights: np.ndarray) -> None:
    """For weights of either sign, none, and next to none; against elimination in the other order, (A + R^T w R)^-1 by the
    formula of Sherman, Morrison and Woodbury, which a weight of 1e9 does not hurt."""
    b = made(weights)
    f = np.random.default_rng(2).normal(size=12)
    matrix, more = with_border(b)
    assert more == len(weights)
    assert abs(matrix - matrix.T).max() == 0.0
    x = np.linalg.solve(matrix.toarray(), np.r_[f, np.zeros(more)])[:12]
    a, r = b.matrix.toarray(), b.rows.toarray()
    y, s = np.linalg.solve(a, f), np.linalg.solve(a, r.T)
    wanted = y - s @ np.linalg.solve(np.eye(more) + np.diag(weights) @ r @ s, weights * (r @ y))
    np.testing.assert_allclose(x, wanted, rtol=0, atol=1e-10 * abs(wanted).max())
    # scaled: no entry is larger than those of A, whatever the weight
    assert abs(matrix[12:]).max() <= 1.0001 * abs(b.matrix.diagonal()).max()


SMALL = abut.LinearElastic(200.0, 0.3), abut.LinearElastic(3.0, 0.4999)
FINITE = abut.Hencky(200.0, 0.3), abut.NeoHooke(shear=1.0, bulk=2000.0)


def pad(friction: float = 0.3, laws: tuple[object, object] = SMALL, kinematics: str = "small") -> abut.Model:
    """Rubber on a steel block, pressed down and aside."""
    mesh = join({
        "steel": box((-0.5, 1.5), (-0.5, 1.5), (-0.5, 0), (3, 3, 1), "hex8"),
        "rubber": box((0, 1), (0, 1), (0, 0.5), (3, 3, 2), "tet10"),
    })  # fmt: skip
    return abut.Model(
        mesh,
        [
            abut.Solid("steel", laws[0]),
            abut.Solid("rubber", laws[1], integration="mixed"),
        ],
        [abut.Support("steel.bottom", x=0.0, y=0.0, z=0.0), abut.Support("rubber.top", x=0.01, y=0.0, z=-0.02)],
        contacts=[abut.Contact("rubber.bottom", "steel.top", friction=friction)],
        kinematics=kinematics,
        solve=abut.SolveOptions(linear="direct", steps=2),
    )


def condensed(_: pytest.MonkeyPatch) -> None:
    """By static condensation, as it is."""


def sparse(patch: pytest.MonkeyPatch) -> None:
    """By the sparse saddle point."""
    patch.setattr(static_condensation, "LARGEST", 0)


@pytest.mark.parametrize(
    ("model", "way"),
    [
        (pad(0.0), condensed),
        (pad(0.0), sparse),
        (pad(), condensed),
        (pad(), sparse),
        (pad(0.3, FINITE, "finite"), sparse),
    ],
)
def test_solutions_are_those_of_the_eliminated_matrix(
    model: abut.Model, way: Callable[[pytest.MonkeyPatch], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    """To what remains after Newton's method: both matrices stand for the same equations. Forces of rubber whose bulk modulus
    is 5000 times that of shear lose that many digits."""
    way(monkeypatch)
    bordered, made = list[int](), Bordered.whole

    def counted(matrix: Bordered) -> sp.csr_matrix:
        bordered.append(len(matrix.weight))
        return made(matrix)

    monkeypatch.setattr(Bordered, "whole", counted)
    kept = abut.solve(model)
    assert set(bordered) == {4 * 4 * 3}  # corners of the rubber
    bordered.clear()

    def without_border(self: Serial, constraints: Constraints) -> object:
        return eliminated(constraints.reduced(self.matrix))

    monkeypatch.setattr(Serial, "reduce", without_border)
    other = abut.solve(model)
    assert not bordered
    assert kept.converged
    assert other.converged
    size = abs(other.displacement).max()
    np.testing.assert_allclose(kept.displacement, other.displacement, rtol=0, atol=1e-8 * size)
    one, two = kept.contacts[0], other.contacts[0]
    np.testing.assert_allclose(one.force, two.force, rtol=0, atol=1e-6 * abs(np.asarray(two.force)).max())
    assert len(kept.steps[-1].iterations) == len(other.steps[-1].iterations)


def test_entries() -> None:
    """A corner's row couples the nodes of the 24 cells about it, 65 of them inside and 3 components: 2 * 195 + 1 entries of
    the whole matrix for every 24 displacements, which have some 80 each. Eliminated there are seven times as many."""
    mesh = box(cells=(6,) * 3, cell="tet10")
    model = abut.Model(
        mesh, [abut.Solid("body", abut.LinearElastic(3.0, 0.499))], [abut.Support("bottom", x=0.0, y=0.0, z=0.0)]
    )
    assert model.integration(model.solids[0]) == "mixed"
    border = stiffness_at_rest(model.deformable)
    entries = stiffness(replace(model, solids=[replace(model.solids[0], integration="full")]).deformable).nnz
    assert with_border(border)[0].nnz < 1.25 * entries
    assert eliminated(border).nnz > 5.0 * entries
