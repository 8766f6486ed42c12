"""A finite-strain material of one's own with a history: rubber that is softer after it was stretched (Mullins' effect).

python examples/own-material/softening_rubber.py
mpiexec -n 2 python examples/own-material/softening_rubber.py

Units: N, mm. Neo-Hooke's energy W = mu/2 (J^(-2/3) tr C - 3) + K/2 (J - 1)^2; the first part counts by a share that falls
with the largest value it ever had (Simo 1987): share = floor + (1 - floor) exp(-W_max / worn).
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

import abut
from abut.materials.material import Array, Evaluated, OwnMaterial
from abut.mesh.make import box, join
from abut.verify import material_tangent

PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))  # xx yy zz xy yz zx


def tensors(strain: Array) -> Array:
    """(n, 3, 3) of (n, 6), whose shear is doubled."""
    result = np.empty((len(strain), 3, 3))
    for s, (a, b) in enumerate(PAIRS):
        result[:, a, b] = result[:, b, a] = strain[:, s] * (1.0 if s < 3 else 0.5)
    return result


@dataclass(frozen=True)
class SofteningRubber(OwnMaterial):
    shear: float
    bulk: float
    floor: float = 0.4
    worn: float = 0.2
    modulus: float = 3.0  # about Young's modulus at rest, a scale
    fields = MappingProxyType({"largest_energy": slice(0, 1)})  # of the history, to be written

    def initial(self, n: int) -> Array:
        return np.zeros((n, 1))

    def evaluate_finite(self, strain: Array, history: Array) -> Evaluated:
        """Strain of Green and Lagrange in; second stress of Piola and Kirchhoff, its tangent and the new history out."""
        right = np.eye(3) + 2.0 * tensors(strain)
        inverse, jacobian = np.linalg.inv(right), np.sqrt(np.linalg.det(right))
        trace = np.trace(right, axis1=1, axis2=2)
        factor = self.shear * jacobian ** (-2.0 / 3.0)
        energy = 0.5 * (factor * trace - 3.0 * self.shear)
        grows = energy > history[:, 0]
        most = np.where(grows, energy, history[:, 0])
        fading = (1.0 - self.floor) * np.exp(-most / self.worn)
        share = self.floor + fading
        c = np.stack([inverse[:, a, b] for a, b in PAIRS], axis=1)
        one = np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
        shape = factor[:, None] * (one - trace[:, None] / 3.0 * c)
        push = self.bulk * jacobian * (jacobian - 1.0)
        stress = share[:, None] * shape + push[:, None] * c
        square = np.stack(
            [np.stack([0.5 * (inverse[:, i, k] * inverse[:, j, m] + inverse[:, i, m] * inverse[:, j, k])
                       for k, m in PAIRS], axis=1) for i, j in PAIRS], axis=1)  # fmt: skip
        outer = c[:, :, None] * c[:, None, :]
        mixed = one[:, None] * c[:, None, :] + c[:, :, None] * one
        third = (factor * trace / 3.0)[:, None, None]
        tangent = 2.0 * share[:, None, None] * (third * (outer / 3.0 + square) - factor[:, None, None] * mixed / 3.0)
        tangent += (self.bulk * jacobian * (2.0 * jacobian - 1.0))[:, None, None] * outer - 2.0 * push[
            :, None, None
        ] * square
        slope = np.where(grows, -fading / self.worn, 0.0)  # of the share by the energy, whose derivative is the shape
        tangent += slope[:, None, None] * shape[:, :, None] * shape[:, None, :]
        return stress, tangent, most[:, None]

    evaluate = evaluate_finite  # near rest they agree


def model(material: OwnMaterial) -> abut.Model:
    """A block of the material, pressed by a steel block, let go by half, and pressed again."""
    lower = box(x=(0, 1), y=(0, 1), z=(0, 0.5), cells=(5, 5, 3), cell="hex8")
    upper = box(x=(0.3, 0.7), y=(0.3, 0.7), z=(0.5, 0.8), cells=(3, 3, 2), cell="hex8")
    course = abut.Amplitude(((0.0, 0.0), (0.5, 1.0), (0.75, 0.5), (1.0, 1.0)))
    return abut.Model(
        join({"pad": lower, "punch": upper}),
        [abut.Solid("pad", material), abut.Solid("punch", abut.LinearElastic(210e3, 0.3))],
        [abut.Support("pad.bottom", x=0, y=0, z=0), abut.Support("punch.top", x=0, y=0, z=-0.15, amplitude=course)],
        contacts=[abut.Contact("punch.bottom", "pad.top")],
        solve=abut.SolveOptions(steps=8),
        kinematics="finite",
    )


def report(solution: abut.Solution) -> None:
    for step in solution.steps:
        largest = step.remembered["largest_energy"].max()
        print(f"time {step.factor:.3f}: force {step.contacts[0].force[2]:.6f} N, largest energy {largest:.6f}")


def main(team: object = None) -> int:
    material = SofteningRubber(shear=1.0, bulk=20.0)
    strain = np.random.default_rng(0).uniform(-0.1, 0.1, (20, 6))
    print(f"largest error of the material's tangent: {material_tangent(material, strain):.1e}")
    report(abut.solve(model(material), team=team))
    return 0


if __name__ == "__main__":
    if int(os.environ.get("OMPI_COMM_WORLD_SIZE", os.environ.get("PMI_SIZE", "1"))) > 1:
        from abut.parallel.team import lead

        raise SystemExit(lead(main))
    raise SystemExit(main())
