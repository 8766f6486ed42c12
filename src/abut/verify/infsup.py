"""The numerical inf-sup test (Chapelle and Bathe 1993; El-Abbasi and Bathe 2001, eq. 11) of a contact interface."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
import scipy.sparse as sp
import scipy.sparse.linalg as spla
from numpy.typing import NDArray

from abut.cells import MAX_FACET_NODES
from abut.contact.coupling import surface_degree
from abut.contact.geometry import full_moments
from abut.contact.pressure_space import DUAL, DUAL_P1
from abut.errors import InputError, nearest
from abut.linear import direct
from abut.mesh.surface import Surface
from abut.model import LAWS, Model
from abut.problem.constraints import Constraints, supports
from abut.problem.contact_pairs import pairs, with_plain_functions
from abut.problem.pair import Pair
from abut.types import Sparse
from abut.verify.cell_pressures import mixed_products
from abut.verify.norms import facet_scale, h1_matrix, trace_norm
from abut.verify.trace import trace_space

DENSE = 2500  # multipliers up to which all eigenvalues are found
SHIFT = 1e-6  # takes the singularity of spurious modes out of the iterative path
SPURIOUS = 1e-6  # beta below which a mode is felt by no displacement
FALLING = 0.2  # beta ~ h^p with p above this falls with the mesh
WEAK = 0.23  # half of what the weakest stable pair has
STABLE_PAIRS = "stable pairs have 0.46 to 1.25"

Norm = Callable[[NDArray[np.float64]], NDArray[np.float64]]  # squared, as its matrix times the pressures
Closed = Callable[[NDArray[np.float64]], NDArray[np.bool_]]  # of points (n, dim)


@dataclass(frozen=True)
class InfSupLevel:
    """One mesh: ``space``, what was measured; number of multipliers, typical facet size h (length), the inf-sup constant in
    both pressure norms
    (``trace``: H^-1/2; ``mesh``: h M), and how many pressures no displacement feels (beta below 1e-6; among more
    multipliers than ``DENSE`` no more than two are looked for). cells: the constant of contact pressures (``trace``) and
    the pressures of mixed cells (L2) together, theory (P8); None without such cells, where pressures are more than
    ``DENSE``, and of axisymmetric bodies."""

    contact: str
    space: str
    multipliers: int
    size: float
    trace: float
    mesh: float
    spurious: int
    cells: float | None = None


@dataclass(frozen=True)
class InfSup:
    """Levels from coarse to fine; ``rate``: p in beta ~ h^p between the two finest (None for one level); ``stable`` and
    ``verdict`` in words."""

    levels: tuple[InfSupLevel, ...]
    rate: float | None
    stable: bool
    verdict: str


def inf_sup(models: Model | Sequence[Model], contact: str | None = None, closed: Closed | None = None) -> InfSup:
    """Inf-sup constant of a contact of one model, or its trend over refinements (coarse to fine).

    beta^2 is the smallest eigenvalue of B S^-1 B^T q = beta^2 T q, with S the H1 matrix of all bodies on the displacements
    that supports leave free and T the pressure norm, theory (P7), (P8); the length in both norms is the contactor's (3D: the
    root of its area), so that the unit of length does not matter. ``closed``: at which points contact is closed, so that
    "dual-P1" takes the ordinary functions there; left out, it has dual functions everywhere. Raises InputError for models
    without contact,
    with a tied pair, or where supports hold everything.
    """
    sequence = [models] if isinstance(models, Model) else list(models)
    if not sequence:
        raise InputError("inf-sup: no model given")
    levels = tuple(_level(model, contact, closed) for model in sequence)
    rate, last = _rate(levels, [level.trace for level in levels]), levels[-1]
    if last.spurious:
        return InfSup(levels, rate, False, f"fails: {last.spurious} spurious pressure modes")
    if rate is not None and rate > FALLING:
        return InfSup(levels, rate, False, f"fails: beta falls with the mesh like h^{rate:.2f}")
    if last.trace < WEAK:
        return InfSup(levels, rate, False, f"weak: beta = {last.trace:.3f} ({STABLE_PAIRS})")
    verdict = _beside_cells(levels) or f"stable: beta = {last.trace:.3f} ({STABLE_PAIRS})"
    return InfSup(levels, rate, verdict.startswith("stable"), verdict)


def _rate(levels: Sequence[InfSupLevel], values: Sequence[float]) -> float | None:
    """The power of the facets' size with which values fall between the two finest levels; None where there is one, or
    where one of them is zero."""
    if len(levels) < 2 or min(values[-2:]) <= SPURIOUS:
        return None
    return float(np.log(values[-2] / values[-1]) / np.log(levels[-2].size / levels[-1].size))


def _beside_cells(levels: Sequence[InfSupLevel]) -> str:
    """The verdict on contact whose pressures alone are stable, together with those of cells; empty where there are none."""
    values = [level.cells for level in levels if level.cells is not None]
    if len(values) < len(levels):
        return ""
    if values[-1] < SPURIOUS:
        return "fails: pressures of contact and cells together that no displacement feels"
    rate = _rate(levels, values)
    if rate is not None and rate > FALLING:
        return f"fails: beta of contact and cells together falls with the mesh like h^{rate:.2f}"
    return (
        f"stable: beta = {levels[-1].trace:.3f} ({STABLE_PAIRS}), together with the pressures of cells {values[-1]:.3f}"
    )


def _level(model: Model, contact: str | None, closed: Closed | None) -> InfSupLevel:
    names = [c.name for c in model.contacts]
    if not names:
        raise InputError("inf-sup: the model has no contact; add one ([[contacts]])")
    if contact is not None and contact not in names:
        raise InputError(f"inf-sup: no contact named {contact!r}{nearest(contact, names)}")
    wanted = next(c for c in model.contacts if c.name == (contact or names[0]))
    if wanted.kind == "tied":
        raise InputError(f"inf-sup: contact '{wanted.name}' is tied; the test is for the normal pressure of a contact")
    if wanted.frictional:  # the pressure alone, in the space that friction takes
        space = DUAL if wanted.pressure in ("auto", DUAL_P1) else wanted.pressure
        wanted = replace(wanted, friction=0.0, friction_amplitude=None, law=LAWS[0], pressure=space)
    constraints = supports(model)
    if constraints.free.shape[1] == 0:
        raise InputError("inf-sup: supports hold every displacement (rigid bodies only); leave some free")
    built = [p for p in pairs(replace(model, contacts=[wanted]), constraints) if len(p)]
    if not built:
        raise InputError(f"inf-sup: no pressure of contact '{wanted.name}' moves anything; let its bodies deform")
    built = [_where_closed(p, model, constraints, closed) for p in built]
    length = _length(built[0].contactor)
    scalar = h1_matrix(model.mesh, length)
    full = constraints.free.T @ sp.kron(scalar, sp.eye(model.dim), format="csr") @ constraints.free
    operator = sp.vstack([p.operator for p in built]).tocsr()
    mesh, trace = _pressure_norms(built, length)
    if operator.shape[0] <= DENSE:
        by_mesh, by_trace = _all_values(full, operator, mesh, trace)
    else:
        by_mesh, by_trace = _smallest_values(full, operator, mesh, trace)
    return InfSupLevel(
        contact=wanted.name,
        space=_measured(built[0]),
        multipliers=operator.shape[0],
        size=built[0].size,
        trace=_root(by_trace),
        mesh=_root(by_mesh),
        spurious=int((by_mesh < SPURIOUS**2).sum()),
        cells=_with_cells(full, operator, trace, model, constraints),
    )


def _with_cells(full: Sparse, operator: Sparse, trace: Norm, model: Model, constraints: Constraints) -> float | None:
    """As in ``InfSupLevel``."""
    n, found = operator.shape[0], mixed_products(model.deformable, DENSE - operator.shape[0])
    if found is None:
        return None
    divergence, mass = found
    both = sp.vstack([operator, divergence @ constraints.free], format="csr")
    compliance = both @ direct.factorized(full, definite=True)(both.T.toarray())
    norm = scipy.linalg.block_diag(trace(np.eye(n)), mass)
    values = scipy.linalg.eigh(compliance + compliance.T, norm + norm.T, eigvals_only=True)
    return _root(values)


def _where_closed(built: Pair, model: Model, constraints: Constraints, closed: Closed | None) -> Pair:
    if closed is None or built.space.name != DUAL_P1:
        return built
    return with_plain_functions(model, built, constraints, closed(built.contactor.points[built.space.node]))


def _measured(built: Pair) -> str:
    """The space in words: of "dual-P1" the facets decide which functions there are."""
    name = built.space.name
    if name != DUAL_P1:
        return name
    kept = (
        abs(built.space.transfer - built.space.plain).max(axis=1).toarray().reshape(-1, MAX_FACET_NODES).max(axis=1)
        == 0.0
    )
    plain = int((kept & (built.coupling.segments > 0)).sum())
    if not plain:
        return f"{name}, dual functions everywhere"
    return f"{name}, ordinary functions on {plain} of {int((built.coupling.segments > 0).sum())} facets"


def _length(surface: Surface) -> float:
    """Length of a curve (a meridian, axisymmetric), root of the area of a surface."""
    return float(full_moments(replace(surface, axisymmetric=False), 0).sum() ** (1.0 / (surface.dim - 1)))


def _root(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(max(values.min(), 0.0)))


def _pressure_norms(built: Sequence[Pair], length: float) -> tuple[Sparse, Norm]:
    """T as h M (sparse) and as the trace norm (a function), block by block for both passes of a two-pass method."""
    masses, norms, starts = [], [], np.cumsum([0, *(len(p) for p in built)])
    for p in built:
        surface, degree = p.contactor, p.coupling.degree
        areas = full_moments(surface, 0)[:, 0]
        divisions = 2 * surface_degree(surface) if len(p) <= DENSE else surface_degree(surface)
        share = np.clip(p.coupling.covered / areas, 0.0, 1.0)
        own_mass = p.coupling.mass if p.coupling.mass.any() else None
        space = trace_space(surface, degree, share, divisions, length, own_mass)
        mass = space.pressure_mass if own_mass is None else own_mass
        blocks = sp.block_diag(list(mass * facet_scale(surface, areas)[:, None, None]), format="csr")
        masses.append(p.space.transfer.T @ blocks @ p.space.transfer)
        norms.append(trace_norm(space, p.space.transfer, length, 1e-5 if len(p) <= DENSE else 1e-3))

    def trace(q: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.concatenate([norm(q[a:b]) for norm, a, b in zip(norms, starts, starts[1:])])

    return sp.block_diag(masses, format="csr"), trace


def _all_values(
    full: Sparse, operator: Sparse, mesh: Sparse, trace: Norm
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    solved = direct.factorized(full, definite=True)(operator.T.toarray())
    compliance = operator @ solved
    compliance = 0.5 * (compliance + compliance.T)
    norm = trace(np.eye(len(compliance)))
    by_mesh = scipy.linalg.eigh(compliance, mesh.toarray(), eigvals_only=True)
    return by_mesh, scipy.linalg.eigh(compliance, 0.5 * (norm + norm.T), eigvals_only=True)


def _smallest_values(
    full: Sparse, operator: Sparse, mesh: Sparse, trace: Norm, count: int = 2
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Lanczos on the inverse: one factorisation of [S, -B^T; B, shift T_h] serves both norms."""
    n, m = full.shape[0], operator.shape[0]
    saddle = sp.bmat([[full, -operator.T], [-operator, -SHIFT * mesh]], format="csr")
    solve = direct.factorized(saddle)

    def inverse(r: NDArray[np.float64]) -> NDArray[np.float64]:
        return -solve(np.concatenate([np.zeros(n), r.ravel()]))[n:]

    shape = (m, m)
    inverted = spla.LinearOperator(shape, matvec=inverse, dtype=float)
    dummy = spla.LinearOperator(shape, matvec=lambda q: q, dtype=float)  # only its shape is used
    results = []
    for norm in (mesh, spla.LinearOperator(shape, matvec=lambda q: trace(q.ravel()), dtype=float)):
        start = np.random.default_rng(0).standard_normal(m)
        values, q = spla.eigsh(dummy, k=count, M=norm, sigma=0.0, OPinv=inverted, v0=start, tol=1e-3)
        # Values converge with the square of that. The shift is in h M: what it adds to the Rayleigh quotient goes again.
        added = SHIFT * np.einsum("ij,ij->j", q, mesh @ q) / np.einsum("ij,ij->j", q, norm @ q)
        results.append(np.sort(values - added))
    by_mesh, by_trace = results
    return by_mesh, by_trace if by_mesh.min() >= SPURIOUS**2 else np.minimum(by_trace, by_mesh.min())
