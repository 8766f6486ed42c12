"""Meshes that are one cell thick."""

from __future__ import annotations

import numpy as np
import pytest

from abut.mesh import make
from abut.mesh.one_layer import one_layer


@pytest.mark.parametrize("cell", ["hex8", "hex20", "wedge6", "wedge15", "tet4", "tet10"])
def test_by_layers(cell: str) -> None:
    """With two layers every cell has a corner in the middle one, but those at the rim."""
    for layers in (1, 2):
        mesh = make.box([0, 9], [0, 9], [0, 1], cells=[9, 9, layers], cell=cell)
        assert one_layer(mesh, np.ones(mesh.n_cells, dtype=bool)) == (layers == 1)


def test_nearly_all_cells_that_count() -> None:
    """A plate of 100 cells on a block of 64, of which the block alone is no layer, the plate alone is one."""
    plate = make.box([0, 9], [0, 9], [1, 2], cells=[10, 10, 1], cell="hex8")
    block = make.box([0, 9], [0, 9], [0, 1], cells=[4, 4, 4], cell="hex8")
    mesh = make.join({"plate": plate, "block": block})
    assert not one_layer(mesh, np.ones(mesh.n_cells, dtype=bool))
    of_plate = np.zeros(mesh.n_cells, dtype=bool)
    of_plate[mesh.bodies["plate"]] = True
    assert one_layer(mesh, of_plate)
    assert not one_layer(mesh, ~of_plate)
    assert not one_layer(mesh, np.zeros(mesh.n_cells, dtype=bool))


def test_never_in_2d() -> None:
    mesh = make.rectangle([0, 9], [0, 1], cells=[9, 1])
    assert not one_layer(mesh, np.ones(mesh.n_cells, dtype=bool))
