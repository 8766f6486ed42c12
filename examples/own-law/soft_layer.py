"""A contact law of one's own: a soft layer between two blocks, whose pressure is in proportion to how far it is squeezed.

python examples/own-law/soft_layer.py

Units: N, mm. The blocks are steel; the layer stands for paint or a gasket that is too thin to be meshed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import abut
from abut.contact.laws import LawResult, LawState
from abut.mesh.make import join, rectangle
from abut.verify import law_tangents


@dataclass(frozen=True)
class SoftLayer:
    stiffness: float  # pressure per overclosure, N/mm3

    def evaluate(self, jump: np.ndarray, traction: np.ndarray, state: LawState) -> LawResult:
        closed = jump < 0.0
        return LawResult(
            residual=traction + np.where(closed, self.stiffness * jump, 0.0),
            by_jump=np.where(closed, self.stiffness, 0.0)[:, :, None],
            by_traction=np.ones_like(jump)[:, :, None],
            closed=closed[:, 0],
        )


def pressed(law: SoftLayer, pressure: float = 10.0, young: float = 210e3) -> abut.Solution:
    """Two blocks of height 1 under an even pressure, with the layer between them; nothing holds them sideways."""
    lower = rectangle(x=[0, 2], y=[0, 1], cells=[7, 4], cell="quad4")
    upper = rectangle(x=[0, 2], y=[1, 2], cells=[5, 3], cell="quad4")
    mesh = join({"lower": lower, "upper": upper})
    steel = abut.LinearElastic(young=young, poisson=0.0)
    return abut.solve(
        abut.Model(
            mesh,
            [abut.Solid("lower", steel), abut.Solid("upper", steel)],
            [abut.Support("lower.bottom", y=0), abut.Support("lower.left", x=0), abut.Support("upper.left", x=0)],
            [abut.Pressure("upper.top", pressure)],
            [abut.Contact("upper.bottom", "lower.top", law=law)],
            plane="stress",
        )
    )


if __name__ == "__main__":
    law = SoftLayer(stiffness=1e5)
    jump, traction = np.array([[-0.01], [0.02]]), np.array([[5.0], [0.0]])
    print(f"largest error of the law's derivatives: {law_tangents(law, jump, traction):.1e}")
    solution = pressed(law)
    top = solution.displacement[solution.model.mesh.nodes_of("upper.top"), 1].mean()
    print(f"the top sinks by {-top:.6e} mm; two blocks and a layer in a row: {10.0 * (2.0 / 210e3 + 1.0 / 1e5):.6e} mm")
