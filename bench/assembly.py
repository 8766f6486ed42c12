"""Stiffness of 40 x 40 x 40 hex8 cells: abut against scikit-fem, side by side on one core, as a ratio of medians.

python bench/assembly.py [--cells N] [--repeat R]
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import time
from collections.abc import Callable

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np
import skfem
from skfem.helpers import ddot, sym_grad, trace
from skfem.models.elasticity import lame_parameters

from abut.bodies.assemble import respond, stiffness
from abut.bodies.solids import Solids
from abut.materials.elastic import LinearElastic
from abut.materials.plastic import Plastic
from abut.materials.rubber import MooneyRivlin
from abut.mesh.make import box

YOUNG, POISSON = 210e3, 0.3


def with_scikit_fem(n: int) -> object:
    """The same stiffness by scikit-fem, with the form and quadrature of its own elasticity examples."""
    mesh = skfem.MeshHex.init_tensor(*[np.linspace(0, 1, n + 1)] * 3)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementHex1()), intorder=3)
    lam, mu = lame_parameters(YOUNG, POISSON)

    @skfem.BilinearForm
    def form(u, v, _):
        e, d = sym_grad(u), sym_grad(v)
        return lam * trace(e) * trace(d) + 2.0 * mu * ddot(e, d)

    return form.assemble(basis)


def seconds(call: Callable[[], object], repeat: int) -> float:
    """Median time of a call."""
    times = []
    for _ in range(repeat):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def least(calls: list[Callable[[], object]], repeat: int) -> list[tuple[float, float]]:
    """Least processor time of each of several calls, in turn, so that other work on the machine disturbs all alike:
    without that of the system, which is for memory that other programs have left, and with it."""
    times = []
    for _ in range(repeat):
        for call in calls:
            start = resource.getrusage(resource.RUSAGE_SELF)
            call()
            end = resource.getrusage(resource.RUSAGE_SELF)
            own = end.ru_utime - start.ru_utime
            times.append((own, own + end.ru_stime - start.ru_stime))
    each = [times[i :: len(calls)] for i in range(len(calls))]
    return [(min(own for own, _ in of_call), min(whole for _, whole in of_call)) for of_call in each]


def nonlinear(n: int, elastic: Solids, repeat: int) -> None:
    """Force and tangent of metal that yields at every point, at the end of a step that began without strain, and of rubber,
    and the stiffness of the same cells, patterns known before."""
    mesh = elastic.mesh
    moved = 0.01 * mesh.points * [1.0, -0.5, -0.5] + 0.002 * np.sin(3.0 * mesh.points[:, [1, 2, 0]])
    metal, rubber = Plastic(YOUNG, POISSON, 300.0, 1000.0), MooneyRivlin(c10=1.0, c01=0.5, bulk=1000.0)
    back = Plastic(YOUNG, POISSON, 300.0, 1000.0, backstresses=[(20e3, 100.0)])
    for law, kinematics in ((metal, "small"), (metal, "finite"), (back, "small"), (back, "finite"), (rubber, "finite")):
        for rule in ("full", "b-bar"):
            bodies = Solids(mesh, {"body": law}, integration={"body": rule}, kinematics=kinematics)
            before = respond(bodies, np.zeros_like(moved)).history
            linear, both = least(
                [
                    lambda: stiffness(elastic),
                    lambda bodies=bodies, before=before: respond(bodies, moved, history=before),
                ],
                repeat,
            )
            name = "Armstrong-Frederick" if law is back else type(law).__name__
            print(
                f"{n**3} hex8 {rule}, {name}, {kinematics}: stiffness {linear[0]:.2f} s, force and tangent "
                f"{both[0]:.2f} s: {both[0] / linear[0]:.2f} (with the system's time {both[1] / linear[1]:.2f})"
            )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cells", type=int, default=40, help="cells along each side")
    parser.add_argument("--repeat", type=int, default=3)
    arguments = parser.parse_args()
    n = arguments.cells
    mesh = box(cells=(n, n, n))
    material = {"body": LinearElastic(YOUNG, POISSON)}
    solids = Solids(mesh, material)
    ours = seconds(lambda: stiffness(Solids(mesh, material)), arguments.repeat)
    nonlinear(n, solids, arguments.repeat)
    theirs = seconds(lambda: with_scikit_fem(n), 1)
    print(f"{n**3} hex8: abut {ours:.2f} s (pattern and values), scikit-fem {theirs:.2f} s, ratio {theirs / ours:.0f}")


if __name__ == "__main__":
    main()
