"""Contact by interior points, with friction or without: pressures and gaps positive, tractions and slips inside their cones.

Each function of a contact has a pressure and a gap whose product goes to zero, theory (V17) to (V20); no row is ever
released, so that intermediate active sets do not matter. With friction it has two vectors in second-order cones, too: the
bound and the traction (mu p, t), and beside it (|v|, v), both of which the solution puts on the boundary where it slips,
and the second to zero where it sticks: theory (R8). Without friction there are no such cones, and the problem is convex."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from abut.linear.solver import Prepared, Solve
from abut.nonlinear.cones import Scaling, depth, longest, mirrored, product, quotient, scaling, times
from abut.nonlinear.laws import barely_covered
from abut.nonlinear.repeated_solutions import solutions
from abut.nonlinear.settings import Settings
from abut.nonlinear.softness import softness
from abut.problem.laws import LawRows
from abut.problem.linearised import NOTHING
from abut.problem.pair import Pair
from abut.solution.state import State

Vector = NDArray[np.float64]
Numbers = NDArray[np.int64]


@dataclass(frozen=True)
class Manner:
    """How bold steps are. boundary: share of the way to it; central: what the smallest product keeps of the mean of all;
    least: share of the mean product that is aimed at, at least; correctors: of Gondzio's at most, for products of pressures
    and gaps alone."""

    boundary: float
    central: float
    least: float = 0.0
    correctors: int = 0


@dataclass(frozen=True)
class Programme:
    """A load step on all functions of all pairs that are not tied, of those with a target opposite: ``on`` (n_functions,).
    normal: (k,) their pressures' numbers; scale: (k,) gap per pressure; rubs: (r,) functions with friction; along:
    (r, d - 1) their tractions' numbers, -1 where there is none; idle: numbers of multipliers that carry nothing, and of
    what does not act."""

    solver: Prepared
    on: NDArray[np.bool_]
    normal: Numbers
    scale: Vector
    rubs: Numbers
    along: Numbers
    idle: Numbers
    softness: float
    settings: Settings

    @classmethod
    def of(cls, solver: Prepared, settings: Settings) -> Programme:
        system, first, normal, along = solver.system, 0, [], []
        width = max((pair.index.shape[1] for pair in system.pairs if pair.frictional), default=1) - 1
        for pair in system.pairs:
            if not pair.decided:
                beside = np.full((len(pair.space), width), -1)
                if pair.frictional:
                    beside = np.where(pair.index[:, 1:] >= 0, pair.index[:, 1:] + first, -1)
                normal.append(first + np.arange(len(pair.space)))
                along.append(beside)
            first += len(pair)
        numbers, tangents, bare = np.concatenate(normal), np.concatenate(along), barely_covered(system)
        on, none = ~bare[numbers], numbers[:0]
        numbers, tangents = numbers[on], tangents[on]
        programme = cls(
            solver,
            on,
            numbers,
            system.scale[numbers],
            np.arange(len(numbers)),
            tangents,
            none,
            softness(solver),
            settings,
        )
        holds = programme.bound(np.ones(len(numbers)))[0] > 0.0
        nothing = bare if system.forgotten is None else bare | system.forgotten
        without = np.append(nothing | system.away, False)
        without[tangents[~holds]] = True
        tangents = np.where(without[tangents], -1, tangents)
        rubs = np.flatnonzero(holds & (tangents >= 0).any(axis=1))
        return replace(programme, rubs=rubs, along=tangents[rubs], idle=np.flatnonzero(without[:-1]))

    def bound(self, pressure: Vector) -> tuple[Vector, Vector]:
        """Of the tractions of ``rubs`` under pressures (k,), and its derivative."""
        system, first, parts = self.solver.system, 0, []
        everywhere = np.zeros(len(self.on))
        everywhere[self.on] = pressure
        for pair in system.pairs:
            if not pair.decided:
                own = everywhere[first : first + len(pair.space)]
                parts.append(_bound(pair, system.factors, own, self.settings.interior.steepest))
                first += len(pair.space)
        bound, slope = (np.concatenate(values) for values in zip(*parts))
        return bound[self.on][self.rubs], slope[self.on][self.rubs]

    def tangential(self, values: Vector) -> Vector:
        """Values (n,) of all multipliers along the tangents of ``rubs``, (r, d - 1); zero where there is none."""
        return np.where(self.along >= 0, values[np.maximum(self.along, 0)], 0.0)

    def active(self, here: Interior) -> NDArray[np.bool_]:
        """(n,) multipliers whose gap goes faster than the pressure, theory (V20), and those that are closed in any case."""
        result = self.solver.system.tied
        result[self.normal] = here.closing > here.opening
        return result

    def undecided(self, here: Interior) -> NDArray[np.bool_]:
        """(n,) multipliers that are neither closing nor opening: pressures that neither stay nor go to nothing."""
        result = np.zeros(len(here.state.multipliers), dtype=bool)
        near = self.settings.interior.worth
        result[self.normal] = (here.closing > near - 1.0) & (here.closing < -near)
        return result


def _bound(pair: Pair, factors: Vector, pressure: Vector, steepest: float) -> tuple[Vector, Vector]:
    if not pair.frictional:
        return np.zeros(len(pressure)), np.zeros(len(pressure))
    limit = pair.friction(factors)
    return (steepest * pressure, np.full(len(pressure), steepest)) if limit.rough else limit.at(pressure)


@dataclass(frozen=True)
class Interior:
    """state: displacements and multipliers, pressures positive and tractions within their bounds; gap: (k,) positive, as
    pressures, which gaps are to be; slip: (r, d) inside its cone, as pressures, its last components what slips are to be;
    length: of the last step; opening, closing: (k,) d g / g and d p / p of the last predictor."""

    state: State
    gap: Vector
    slip: Vector
    opening: Vector
    closing: Vector
    length: float = 1.0


@dataclass(frozen=True)
class _Near:
    """An ``Interior`` point and what follows from it. gaps, slips: by displacements, as pressures."""

    programme: Programme
    here: Interior
    gaps: Vector
    slips: Vector

    @cached_property
    def pressure(self) -> Vector:
        return self.here.state.multipliers[self.programme.normal]

    @cached_property
    def traction(self) -> Vector:
        """(r, d): bound, and traction."""
        bound, _ = self.programme.bound(self.pressure)
        return np.column_stack([bound, self.programme.tangential(self.here.state.multipliers)])

    @cached_property
    def slope(self) -> Vector:
        return self.programme.bound(self.pressure)[1]

    @cached_property
    def scaled(self) -> Scaling:
        return scaling(self.here.slip, self.traction)

    @cached_property
    def mean(self) -> float:
        """Mean product."""
        products = [self.here.gap * self.pressure, np.einsum("rd,rd->r", self.here.slip, self.traction)]
        return float(np.concatenate(products).mean())

    @cached_property
    def soft(self) -> Vector:
        """(r, d, d) slip by traction, W^2."""
        return np.einsum("rij,rjk->rik", self.scaled.matrix, self.scaled.matrix)

    @cached_property
    def unbalanced(self) -> Vector:
        return self.programme.solver.system.unbalanced(self.here.state)

    @cached_property
    def solve(self) -> Solve:
        """Solutions with the rows here, whatever the products that are aimed at."""
        system = self.programme.solver.system
        rows = system.rows(_by_pairs(self.programme, np.zeros(len(self.here.state.multipliers)), _softening(self)))
        return solutions(self.programme.solver, rows, self.here.state, self.programme.settings.accuracy)

    @property
    def missed(self) -> float:
        """Largest difference between what gaps and slips are and what they are to be."""
        off = [np.abs(self.gaps - self.here.gap), np.abs(self.slips - self.here.slip[:, 1:]).ravel()]
        return float(np.concatenate(off).max(initial=0.0))


def near(programme: Programme, here: Interior) -> _Near:
    """Gaps and slips at a point."""
    system = programme.solver.system
    gap = system.gap(here.state) / system.scale
    return _Near(programme, here, gap[programme.normal], programme.tangential(gap))


def begin(programme: Programme, state: State) -> Interior:
    """The starting point: one solution with softness everywhere, theory (V17), tractions at most halfway to their bounds."""
    system = programme.solver.system
    soft = np.where(system.tied, 0.0, programme.softness * system.scale)
    soft[programme.idle] = system.scale[programme.idle]
    gap = system.gap(state)
    gap[programme.idle] = 0.0
    rows = system.rows(_by_pairs(programme, -gap - soft * state.multipliers, sp.diags(-soft, format="csr")))
    du, dp = solutions(programme.solver, rows, state, programme.settings.accuracy)(
        system.unbalanced(state), rows.residual
    )
    multipliers = state.multipliers + dp
    size = max(float(np.abs(multipliers[programme.normal]).mean()), NOTHING)
    pressure = np.maximum(multipliers[programme.normal], 0.0) + size
    multipliers[programme.normal] = pressure
    drag, (bound, _) = programme.tangential(multipliers), programme.bound(pressure)
    length = np.linalg.norm(drag, axis=1)
    drag *= np.minimum(1.0, 0.5 * bound / np.maximum(length, NOTHING))[:, None]
    there = programme.along >= 0
    multipliers[programme.along[there]] = drag[there]
    multipliers[programme.idle] = 0.0
    traction = np.column_stack([bound, drag])
    product_of_both = programme.softness * size**2
    slip = mirrored(traction) * (product_of_both / depth(traction))[:, None]
    start = replace(state, unknowns=state.unknowns + du, multipliers=multipliers)
    gaps, none = np.full(len(pressure), programme.softness * size), np.zeros(len(pressure))
    return Interior(start, gaps, slip, none, none)


@dataclass(frozen=True)
class _Step:
    """What one whole step changes: of unknowns and multipliers, and of each quantity."""

    unknowns: Vector
    multipliers: Vector
    pressure: Vector
    gap: Vector
    traction: Vector
    slip: Vector

    def length(self, at: _Near) -> float:
        """How many of it until the boundary."""
        cones = longest(at.traction, self.traction), longest(at.here.slip, self.slip)
        return min(_positive(at.pressure, self.pressure), _positive(at.here.gap, self.gap), *cones)


def iterate(at: _Near, manner: Manner) -> Interior:
    """One iteration, theory (V18), (V19): Mehrotra's predictor and corrector, with the coupling of bound and pressure, and
    Gondzio's."""
    here, mean = at.here, at.mean
    first = _direction(at, np.zeros_like(at.pressure), np.zeros_like(here.slip))
    length = min(1.0, first.length(at))
    products = [
        (here.gap + length * first.gap) * (at.pressure + length * first.pressure),
        np.einsum("rd,rd->r", here.slip + length * first.slip, at.traction + length * first.traction),
    ]
    foreseen = max(float(np.concatenate(products).mean()), 0.0)
    aim = float(np.clip((foreseen / max(mean, NOTHING)) ** 3, manner.least, 1.0)) * mean
    of_cones = np.zeros_like(here.slip)
    of_cones[:, 0] = aim
    if len(of_cones):
        of_cones -= product(times(at.scaled.inverse, first.slip), times(at.scaled.matrix, first.traction))
    step = _bolder(at, aim - first.gap * first.pressure, of_cones, aim, manner.correctors)
    length = min(1.0, manner.boundary * step.length(at))
    for _ in range(4 * at.programme.settings.newton.patience):
        if _central(at, step, length, manner.central):
            break
        length *= 0.5
    state = replace(
        here.state,
        unknowns=here.state.unknowns + length * step.unknowns,
        multipliers=here.state.multipliers + length * step.multipliers,
    )
    return Interior(
        state, here.gap + length * step.gap, here.slip + length * step.slip,
        first.gap / here.gap, first.pressure / at.pressure, length,
    )  # fmt: skip


def _bolder(at: _Near, products: Vector, of_cones: Vector, aim: float, correctors: int) -> _Step:
    """The step to products, and those of Gondzio's correctors that make it longer: outliers are led back towards ``aim``."""
    settings, gap, pressure = at.programme.settings.interior, at.here.gap, at.pressure
    step = _direction(at, products, of_cones)
    for _ in range(correctors):
        length = min(1.0, step.length(at))
        far = min(1.0, length + settings.farther)
        reached = (pressure + far * step.pressure) * (gap + far * step.gap)
        change = np.clip(reached, settings.worth * aim, aim / settings.worth) - reached
        following = products + np.maximum(change, -aim / settings.worth)
        corrected = _direction(at, following, of_cones)
        if min(1.0, corrected.length(at)) < length + settings.worth * settings.farther:
            break
        products, step = following, corrected
    return step


def _central(at: _Near, step: _Step, length: float, share: float) -> bool:
    """Whether all stay inside after a step of some length, and no product is far smaller than the mean of all."""
    pressure, slip = at.pressure + length * step.pressure, at.here.slip + length * step.slip
    traction = at.traction + length * step.traction
    traction[:, 0] = at.programme.bound(pressure)[0]  # which need not be linear
    inside = depth(traction)
    if len(inside) and (inside.min() <= 0.0 or depth(slip).min() <= 0.0):
        return False
    products = np.concatenate([(at.here.gap + length * step.gap) * pressure, np.sqrt(depth(slip) * inside)])
    return bool(products.min() >= share * products.mean())


def _direction(at: _Near, of_gaps: Vector, of_cones: Vector) -> _Step:
    """The step to products that are those told, but for the products of the steps' own parts."""
    here = at.here
    shift = of_gaps / at.pressure
    slip = -here.slip
    if len(here.slip):
        slip = slip + times(at.scaled.matrix, quotient(at.scaled.middle, of_cones))
    du, dp = at.solve(at.unbalanced, _left(at, shift, here.slip + slip))
    pressure = dp[at.programme.normal]
    traction = np.column_stack([at.slope * pressure[at.programme.rubs], at.programme.tangential(dp)])
    gap = shift - here.gap - here.gap / at.pressure * pressure
    return _Step(du, dp, pressure, gap, traction, slip - times(at.soft, traction))


def _left(at: _Near, shift: Vector, slip: Vector) -> Vector:
    """Residual of gap + d gap = shift - (g / p) dp and slip + d slip = that told - W^2 (mu dp, dt), (n,)."""
    programme, here, system = at.programme, at.here, at.programme.solver.system
    rubbed = programme.scale[programme.rubs]
    residual = -system.gap(here.state)
    for a in range(programme.along.shape[1]):
        present = programme.along[:, a] >= 0
        residual[programme.along[present, a]] += (rubbed * slip[:, 1 + a])[present]
    residual[programme.normal] += programme.scale * shift
    residual[programme.idle] = (-system.scale * here.state.multipliers)[programme.idle]
    return residual


def _softening(at: _Near) -> sp.csr_matrix:
    """The derivative of these rows by the multipliers, (n, n)."""
    programme, here, soft = at.programme, at.here, at.soft
    n, scale = len(here.state.multipliers), programme.scale
    at_rubs, rubbed = programme.normal[programme.rubs], scale[programme.rubs]
    entries = [(programme.normal, programme.normal, -scale * here.gap / at.pressure)]
    there = programme.along >= 0
    for a in range(programme.along.shape[1]):
        row, present = programme.along[:, a], there[:, a]
        entries.append((row[present], at_rubs[present], (-rubbed * soft[:, 1 + a, 0] * at.slope)[present]))
        for b in range(programme.along.shape[1]):
            both = present & there[:, b]
            entries.append((row[both], programme.along[both, b], (-rubbed * soft[:, 1 + a, 1 + b])[both]))
    entries.append((programme.idle, programme.idle, -programme.solver.system.scale[programme.idle]))
    row, column, value = (np.concatenate(parts) for parts in zip(*entries))
    return sp.csr_matrix((value, (row, column)), shape=(n, n))


def _by_pairs(programme: Programme, residual: Vector, by_pressure: sp.csr_matrix) -> list[LawRows]:
    """Rows of all multipliers that see minus their own gap or slip; those ``idle`` see their own traction alone."""
    system, laws, first = programme.solver.system, [], 0
    idle = np.zeros(len(residual), dtype=bool)
    idle[programme.idle] = True
    for pair in system.pairs:
        here = slice(first, first := first + len(pair))
        unused = idle[here]
        laws.append(
            LawRows(
                residual=residual[here],
                closed=np.ones(len(pair), dtype=bool),
                by_gap=_diagonal(np.where(unused, 0.0, -1.0)),
                by_pressure=by_pressure[here, here],
                at_points=False,
                decoupled=unused,
                symmetric=not pair.frictional,
            )
        )
    return laws


def _diagonal(values: Vector) -> sp.csr_matrix:
    matrix = sp.diags(values, format="csr")
    matrix.eliminate_zeros()
    return matrix


def _positive(values: Vector, steps: Vector) -> float:
    falling = steps < 0.0
    return float((values[falling] / -steps[falling]).min(initial=np.inf))
