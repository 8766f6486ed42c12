"""Cells with unknowns of their own that a user's physics adds: incompatible modes, which bend where quad4 locks."""

from __future__ import annotations

import numpy as np
import pytest

import abut
from abut.mesh.make import join, rectangle
from models.incompatible import IncompatibleModes

YOUNG, LENGTH, HEIGHT, EDGE = 2000.0, 10.0, 1.0, 3.0  # of the largest stress, at the edges


def bent(cells: int, poisson: float = 0.3, modes: bool = True) -> tuple[abut.Step, np.ndarray, np.ndarray]:
    """A bar of one layer of quad4 under pure bending, stress 2 EDGE y / HEIGHT along it; its nodes; its last unknowns,
    four a cell."""
    material = abut.LinearElastic(YOUNG, poisson)
    model = abut.Model(
        join({"bar": rectangle((0.0, LENGTH), (-HEIGHT / 2.0, HEIGHT / 2.0), (cells, 1), "quad4")}),
        [abut.Solid("bar", material, integration="full")],
        [abut.Support("bar.left", x=0.0, y=0.0)],
        [abut.Traction("bar.right", lambda x: np.column_stack([2.0 * EDGE * x[:, 1] / HEIGHT, 0.0 * x[:, 0]]))],
        plane="stress",
        physics=[IncompatibleModes(material)] if modes else [],
    )
    saved: list[abut.solution.Saved] = []
    step = abut.solve(model, on_step=lambda _, end: saved.append(end)).steps[-1]
    return step, model.mesh.points, saved[-1].state.unknowns[-4 * cells :].reshape(cells, 4)


@pytest.mark.parametrize("poisson", [0.0, 0.3])
@pytest.mark.parametrize("cells", [1, 4])
def test_one_layer_bends(cells: int, poisson: float) -> None:
    """u_x = k x y, u_y = -k x^2 / 2 at the nodes, k = 2 sigma / (E h), however long cells are: rectangles with these modes
    have all states of pure bending (Wilson and others 1973). The modes of 1 - xi^2 across are k a^2 / 8 (a: length of
    a cell), those of 1 - eta^2 across nu k h^2 / 8 (contraction); along there are none."""
    step, place, found = bent(cells, poisson)
    k, size = 2.0 * EDGE / (YOUNG * HEIGHT), LENGTH / cells
    exact = np.column_stack([k * place[:, 0] * place[:, 1], -0.5 * k * place[:, 0] ** 2])
    assert step.displacement == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())
    assert step.reactions["bar.left"] == pytest.approx([0.0, 0.0], abs=1e-9 * EDGE)
    assert step.balance_error <= step.balance_limit
    modes = np.tile([0.0, k * size**2 / 8.0, 0.0, poisson * k * HEIGHT**2 / 8.0], (cells, 1))
    assert found == pytest.approx(modes, abs=1e-9 * k * size**2)


def test_without_them_it_locks() -> None:
    """Cells a long and h high resist by shear: stiffer by 1 + (1 - nu) / 2 (a / h)^2 over 1 - nu^2."""
    poisson, cells = 0.3, 4
    exact = EDGE * LENGTH**2 / (YOUNG * HEIGHT)
    stiffer = (1.0 + 0.5 * (1.0 - poisson) * (LENGTH / cells / HEIGHT) ** 2) / (1.0 - poisson**2)
    tip = -bent(cells, poisson, modes=False)[0].displacement[:, 1].min()
    assert tip == pytest.approx(exact / stiffer, rel=1e-9)
