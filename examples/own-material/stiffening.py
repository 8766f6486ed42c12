"""A material of one's own: rubber-like stiffening, whose shear modulus grows with the strain, pressed by a rigid-like block.

python examples/own-material/stiffening.py

Units: N, mm. Strains are small; stress = K tr(e) 1 + 2 G (1 + c |dev e|^2) dev e.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

import abut
from abut.materials.material import Evaluated, OwnMaterial
from abut.mesh.make import box, join
from abut.verify import material_tangent

MEAN = np.outer([1, 1, 1, 0, 0, 0], [1, 1, 1, 0, 0, 0]) / 3.0  # takes the mean of the normal strains
DEVIATOR = (np.eye(6) - MEAN) * [1, 1, 1, 0.5, 0.5, 0.5]  # and the rest, with tensor shear strains
TWICE = np.array([1, 1, 1, 2, 2, 2])  # shear counts twice in |dev e|^2


@dataclass(frozen=True)
class Stiffening(OwnMaterial):
    bulk: float
    shear: float
    growth: float
    modulus: float = 3.0  # about Young's modulus at rest, a scale

    def evaluate(self, strain: np.ndarray, history: np.ndarray) -> Evaluated:
        deviator = strain @ DEVIATOR.T
        factor = 2.0 * self.shear * (1.0 + self.growth * (deviator**2 @ TWICE))[:, None]
        stress = 3.0 * self.bulk * strain @ MEAN.T + factor * deviator
        change = 4.0 * self.shear * self.growth * deviator[:, :, None] * (deviator * TWICE @ DEVIATOR)[:, None, :]
        return stress, 3.0 * self.bulk * MEAN + factor[:, :, None] * DEVIATOR + change, history


def pressed(material: OwnMaterial, depth: float = 0.02) -> abut.Solution:
    """A block of the material, pressed down by a steel block."""
    lower = box(x=(0, 1), y=(0, 1), z=(0, 0.5), cells=(6, 6, 3), cell="hex8")
    upper = box(x=(0.3, 0.7), y=(0.3, 0.7), z=(0.5, 0.8), cells=(4, 4, 2), cell="hex8")
    mesh = join({"pad": lower, "punch": upper})
    return abut.solve(
        abut.Model(
            mesh,
            [abut.Solid("pad", material), abut.Solid("punch", abut.LinearElastic(210e3, 0.3))],
            [abut.Support("pad.bottom", x=0, y=0, z=0), abut.Support("punch.top", x=0, y=0, z=-depth)],
            contacts=[abut.Contact("punch.bottom", "pad.top")],
            solve=abut.SolveOptions(steps=2),
        )
    )


if __name__ == "__main__":
    material = Stiffening(bulk=5.0, shear=1.0, growth=200.0)
    strain = np.random.default_rng(0).uniform(-0.05, 0.05, (20, 6))
    print(f"largest error of the material's tangent: {material_tangent(material, strain):.1e}")
    for growth in (0.0, 200.0):
        solution = pressed(Stiffening(5.0, 1.0, growth))
        rows = [len(step.iterations) for step in solution.steps]
        print(f"growth {growth:.0f}: force {solution.contacts[0].force[2]:.5f} N, iterations {rows}")
