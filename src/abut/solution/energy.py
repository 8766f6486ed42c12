"""Energy over a load step of a model with friction, plastic flow or finite kinematics."""

from __future__ import annotations

from dataclasses import dataclass, replace

ENERGY = 1e-8  # limit of the error of the balance
ROUNDED = 1e-5  # the same at most: of large models by iterative solvers, and where far motions leave no more digits


@dataclass(frozen=True)
class Energy:
    """Where the energy of one load step comes from and where it goes, theory (R10), (G13): loads + supports + contact =
    stored + friction + plastic + dashpots + stepping + stabilisation. Force times length; in 2D per unit thickness, in
    axisymmetric models of the whole turn.

    loads: work of loads and of heat; supports: of supports, equations and rigid bodies that move; contact: of pressures on
    the bodies, where interference grows or gaps close or open within the step, and of tractions on what only comes closer;
    stored: change of the strain energy, of materials that do not tell it the work of their stresses;
    friction: that friction takes with the traction at the end of the step, as ``FrictionResult.work``; stepping: what the
    work of a traction that grows in proportion over the step differs from that, of second order in the step; with finite
    kinematics also what the mean stresses of the step do beyond what is stored.
    size: what errors are compared with, the sum of all nodal forces of stresses times displacements by size; left: what
    displacements in double precision and the tolerance of equilibrium may leave open; elastic: strain energy at the end,
    with finite kinematics only; earlier: with them, and after flow, the largest size of the steps before;
    stabilisation: what a drag takes on the way of a step that it leads, theory (G24); plastic: what plastic flow
    takes, with what hardening keeps of it, theory (Y11);
    flowed: the same since the beginning; dashpots: what these dissipate, force at the end of the step times way;
    unexplained: what no stable way of equilibria explains where positive, theory (G25); None where that cannot be said.
    """

    loads: float
    supports: float
    contact: float
    stored: float
    friction: float
    stepping: float
    size: float
    left: float
    elastic: float | None = None
    earlier: float = 0.0
    stabilisation: float = 0.0
    plastic: float = 0.0
    flowed: float = 0.0
    unexplained: float | None = None
    dashpots: float = 0.0

    @property
    def error(self) -> float:
        """What is missing in the balance, over the size."""
        missing = self.loads + self.supports + self.contact - self.stored - self.friction - self.stepping
        missing -= self.stabilisation + self.plastic + self.dashpots
        return abs(missing) / self.size

    @property
    def jumped(self) -> float:
        """What no stable way of equilibria explains, beyond what tolerances and pressures leave open (these do no work where
        contact is the same at both ends), over the work of the step; 0 for none. Of a step that hardly does any beside those
        before, all is rounding."""
        if self.unexplained is None:
            return 0.0
        beyond = max(self.unexplained - self.left - abs(self.contact), 0.0)
        least = max(ROUNDED * self.size, ENERGY * self.earlier, 1e-300)
        return beyond / max(abs(self.loads), abs(self.stored + self.plastic), least)

    @property
    def limit(self) -> float:
        """Of the error: what is left, but for fixed shares of the size at least and at most; where the steps before did far
        more, at most a share of that. A body that contact alone holds rocks within the tolerance of forces, which is much
        beside a step in which hardly anything else moves."""
        return max(ENERGY, min(self.left / self.size, max(ROUNDED, ENERGY * self.earlier / self.size)))

    def limit_beside(self, most: float) -> float:
        """The same where other steps of the run, before or after, have a size of up to ``most``: before the first touch
        what equilibrium leaves open is much beside the work of a step, but nothing beside the run."""
        if self.elastic is None and not self.flowed:
            return self.limit
        return replace(self, earlier=max(self.earlier, most)).limit
