"""Free rigid-body modes: set to zero in the mean where loads do no work on them, theory (V14)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from abut.bodies.rigid_modes import SUPPORTED, RigidModes, describe, each_motion, free_motions, simple_motions
from abut.errors import SingularModelError
from abut.model import Frequencies, Model
from abut.problem.constraints import Constraints
from abut.problem.neutral_motions import Neutral, beyond
from abut.types import Array, Sparse

NO_WORK = 1e-9  # of loads on a unit motion, over the sum of their sizes: rounding
TOGETHER = 1e-6  # share of a body's motion in a free one from which on it takes part
CURE = "add a support, or a symmetry plane (normal = 0)"


@dataclass(frozen=True)
class FreeModeSprings:
    """Springs to the ground on as many free displacements as there are motions: by equilibrium they carry nothing.

    motions: (dim n_points, m) orthonormal; columns: (m,) free displacements with a spring, stiffness: (m,) of the springs;
    gram: (n_modes, n_modes) their resistance; notes: what is held, in words; noise: share of the forces that facets put on
    motions which nothing else resists, 0 where there are none: these are not among ``motions``.
    """

    motions: NDArray[np.float64]
    columns: NDArray[np.int64]
    stiffness: NDArray[np.float64]
    gram: NDArray[np.float64]
    notes: tuple[str, ...] = ()
    noise: float = 0.0

    def __len__(self) -> int:
        return len(self.columns)

    def added_to(self, matrix: Sparse) -> Sparse:
        """The stiffness on the free displacements, (n_free, n_free) CSR, with the springs."""
        if not len(self):
            return matrix
        springs = sp.csr_matrix((self.stiffness, (self.columns, self.columns)), shape=matrix.shape)
        return matrix + springs

    def force(self, free: NDArray[np.float64]) -> float:
        """Largest force in a spring at free displacements (n_free,)."""
        return float(np.abs(self.stiffness * free[self.columns]).max(initial=0.0))

    def forces(self, free: NDArray[np.float64]) -> NDArray[np.float64]:
        """Of the springs on the free displacements, (n_free,)."""
        result = np.zeros_like(free)
        np.add.at(result, self.columns, self.stiffness * free[self.columns])
        return result

    def without_motions(self, displacement: NDArray[np.float64]) -> NDArray[np.float64]:
        """The displacement (dim n_points,) with no share of the motions, whatever displacements carry the springs."""
        return np.asarray(displacement - self.motions @ (self.motions.T @ displacement))


def floats_of(model: Model) -> bool:
    """Whether bodies of a model may float: its frequencies are asked for, with those of rigid motions, which are zero."""
    return any(isinstance(wanted, Frequencies) for wanted in model.modes)


def free_mode_springs(
    rigid: RigidModes,
    resistances: Sequence[NDArray[np.float64]],
    constraints: Constraints,
    stiffness: Sparse,
    loads: Sequence[NDArray[np.float64]],
    neutral: Neutral | None = None,
    settled: Array | None = None,
    floats: bool = False,
) -> FreeModeSprings:
    """Hold the rigid motions that nothing resists, where that takes no force, or none but what facets put on them.

    resistances: Gram matrices of supports and all contact, closed; constraints: the change of variables;
    stiffness: (n_free, n_free); loads: nodal forces (dim n_points,), at the end of each load step; neutral: motions that
    contact resists by its facets alone; settled: where bodies move far (n_modes, k) motions that loads bring to rest: there
    something else holds the neutral ones (``held_motions``); floats: bodies that nothing touches or loads may do so.
    Raises SingularModelError for a motion on which loads do work, and for a body that nothing touches or loads.
    """
    motions = free_motions(resistances, SUPPORTED)
    if neutral is not None and settled is not None:
        motions = beyond(motions, np.concatenate([neutral.motions, settled], axis=1))
    elif neutral is not None and any(
        _work(rigid, *each, loads)[1] is not None for each in _independent(rigid, motions)
    ):
        # what facets resist may look free: by chance they resist some mean of it, with loaded bodies, hardly at all
        motions = beyond(motions, neutral.motions[:, neutral.noise > NO_WORK])
    resisted = _resisted(resistances, motions)
    notes: list[str] = []
    for groups, modes in _independent(rigid, motions):
        size, worst = _work(rigid, groups, modes, loads)
        if worst is not None:
            raise SingularModelError(
                f"{describe(rigid, worst, one_way=True)}{_others(modes)}: neither a support nor contact constrains it, "
                f"and the loads act in that direction; {CURE}"
            )
        if size == 0.0 and not floats and len(groups) == 1 and modes.shape[1] == rigid.per_group:
            raise SingularModelError(
                f"{describe(rigid, modes)}{_others(modes)}: neither a support nor contact constrains it, and no load acts "
                f"on it; {CURE}"
            )
        notes += [
            f"{text}: unconstrained, and the loads do no work on it; its mean rigid-body motion is set to zero; no reaction "
            "arises"
            for text, _ in each_motion(rigid, modes)
        ]
    if neutral is None or not neutral.motions.shape[1]:
        return replace(_springs(rigid, motions, constraints, stiffness, tuple(notes)), noise=resisted)
    _require_faint(rigid, neutral, loads)
    faint = neutral.beside(motions)
    notes += [
        f"{text}: contact resists it by its facets alone; it is held in the mean, and the certificate has the force"
        for text, _ in each_motion(rigid, faint)
    ]
    tight, soft = (_springs(rigid, axes, constraints, stiffness, ()) for axes in (motions, faint))
    noise = float(neutral.noise.max(initial=0.0)) if faint.shape[1] else 0.0
    if settled is not None:
        return replace(tight, gram=tight.gram + soft.gram, notes=tuple(notes), noise=max(noise, resisted))
    return replace(
        tight,
        columns=np.concatenate([tight.columns, soft.columns]),
        stiffness=np.concatenate([tight.stiffness, (noise**2 or 1.0) * soft.stiffness]),
        gram=tight.gram + soft.gram,
        notes=tuple(notes),
        noise=max(noise, resisted),
    )


def _resisted(resistances: Sequence[Array], motions: Array) -> float:
    """Share of their forces that contact may put on motions (n_modes, m) that it hardly resists, as facets of round surfaces
    do: the root of the resistance, which is a mean of squares, bounds it."""
    total = sum(resistances)
    most = float(np.linalg.eigvalsh(total).max(initial=0.0))
    share = float(np.linalg.eigvalsh(motions.T @ total @ motions).max(initial=0.0))
    return float(np.sqrt(max(share, 0.0) / most)) if most > 0.0 else 0.0


def _require_faint(rigid: RigidModes, neutral: Neutral, loads: Sequence[Array]) -> None:
    """Raises SingularModelError where loads do more work on a neutral motion than facets may."""
    for load in loads:
        work = neutral.motions.T @ (rigid.modes.T @ load)
        driven = np.abs(work) > np.maximum(neutral.noise, NO_WORK) * float(np.abs(load).sum())
        if driven.any():
            worst = int(np.where(driven, np.abs(work), 0.0).argmax())
            motion = np.sign(work[worst]) * neutral.motions[:, worst]
            raise SingularModelError(
                f"{describe(rigid, motion[:, None], one_way=True)}: contact without friction glides that way, and the loads "
                f"act in that direction; {CURE}, or friction"
            )


def _springs(
    rigid: RigidModes, motions: NDArray[np.float64], constraints: Constraints, stiffness: Sparse, notes: tuple[str, ...]
) -> FreeModeSprings:
    m = motions.shape[1]
    if not m:
        none = np.zeros(0)
        gram = np.zeros((rigid.modes.shape[1],) * 2)
        return FreeModeSprings(np.zeros((len(rigid.modes), 0)), none.astype(np.int64), none, gram)
    whole = rigid.modes @ motions
    moved = constraints.coordinates(whole)
    columns = np.sort(scipy.linalg.qr(moved.T, mode="r", pivoting=True)[1][:m]).astype(np.int64)
    resisted = constraints.coordinates(rigid.modes)[columns]
    diagonal = np.asarray(stiffness.diagonal())
    unit = float(np.median(diagonal)) if len(diagonal) else 1.0  # rigid bodies have no stiffness of their own
    return FreeModeSprings(
        motions=np.asarray(scipy.linalg.qr(whole, mode="economic")[0], dtype=np.float64),
        columns=columns,
        stiffness=np.where(diagonal[columns] > 0.0, diagonal[columns], unit),
        gram=np.asarray(resisted.T @ resisted) / m,
        notes=notes,
    )


def _independent(rigid: RigidModes, motions: NDArray[np.float64]) -> list[tuple[Array, NDArray[np.float64]]]:
    """Free motions (n_modes, m) sorted by the groups of bodies that move together: group numbers and motions of each."""
    n = len(rigid.groups)
    share = (motions @ motions.T).reshape(n, rigid.per_group, n, rigid.per_group)
    coupled = np.abs(share).max(axis=(1, 3)) > TOGETHER
    _, label = connected_components(sp.csr_matrix(coupled), directed=False)
    result = []
    for number in np.unique(label):
        groups = np.flatnonzero(label == number)
        inside = np.repeat(label == number, rigid.per_group)
        basis, size, _ = np.linalg.svd(np.where(inside[:, None], motions, 0.0), full_matrices=False)
        modes = basis[:, size > 0.5]  # projections of an orthonormal basis: ones and zeros
        if modes.shape[1]:
            result.append((groups, modes))
    return result


def _work(
    rigid: RigidModes, groups: NDArray[np.int64], motions: NDArray[np.float64], loads: Sequence[NDArray[np.float64]]
) -> tuple[float, NDArray[np.float64] | None]:
    """Size of the loads on some groups of bodies, and the motion (n_modes, 1) on which they do work, if there is one."""
    modes = (rigid.per_group * groups[:, None] + np.arange(rigid.per_group)).ravel()
    touched = np.abs(rigid.modes[:, modes]).max(axis=1) > 0.0
    largest = 0.0
    for load in loads:
        size = float(np.abs(load[touched]).sum())
        work = motions.T @ (rigid.modes.T @ load)
        if np.abs(work).max() > NO_WORK * size:
            worst = motions @ work / np.linalg.norm(work)
            plain = simple_motions(rigid, worst)
            free = np.linalg.norm(plain - motions @ (motions.T @ plain), axis=0) < TOGETHER
            driven = plain.T @ (rigid.modes.T @ load) > NO_WORK * size
            return size, plain[:, free & driven][:, :1] if (free & driven).any() else worst[:, None]
        largest = max(largest, size)
    return largest, None


def _others(motions: NDArray[np.float64]) -> str:
    return f" (and {motions.shape[1] - 1} more rigid-body modes)" if motions.shape[1] > 1 else ""
