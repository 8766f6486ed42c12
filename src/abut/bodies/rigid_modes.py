"""Rigid-body modes, and those that no constraint resists."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from abut.dofs import n_dofs
from abut.mesh.mesh import Mesh
from abut.types import Sparse

FREE = 1e-7  # resistance, relative to the strongest, below which a motion counts as free
SUPPORTED = 1e-2  # share of that which is enough of supports: they have no facets, and plates are thin at their edges


@dataclass(frozen=True)
class RigidModes:
    """modes: (dim n_points, 1, 3 or 6 per group) translations and rotations of each group of glued bodies, all of the
    size of a unit translation; groups: names of the bodies in each group."""

    modes: NDArray[np.float64]
    groups: tuple[tuple[str, ...], ...]
    per_group: int

    @property
    def together(self) -> NDArray[np.float64]:
        """(dim n_points, per_group) each body's own motions, those of all bodies added up: as they share no points, every
        body still has its own."""
        return np.asarray(self.modes.reshape(len(self.modes), -1, self.per_group).sum(axis=1))


def motions(x: NDArray[np.float64], axisymmetric: bool) -> NDArray[np.float64]:
    """Unit translations, then small turns about the axes, of points x (n, dim): (n, dim, 3 or 6); axisymmetric: of the
    shift along the axis alone, since nothing else leaves a ring unstrained, (n, dim, 1)."""
    n, dim = x.shape
    if axisymmetric:
        return np.broadcast_to(np.eye(dim)[:, 1:], (n, dim, 1)).copy()
    result = np.zeros((n, dim, 3 if dim == 2 else 6))
    result[:, :, :dim] = np.eye(dim)
    if dim == 2:
        result[:, 0, 2], result[:, 1, 2] = -x[:, 1], x[:, 0]
        return result
    for a in range(3):
        b, c = (a + 1) % 3, (a + 2) % 3
        result[:, b, 3 + a], result[:, c, 3 + a] = -x[:, c], x[:, b]
    return result


def rigid_modes(mesh: Mesh) -> RigidModes:
    """Rigid motions of every group of bodies that share nodes."""
    n, dim = mesh.points.shape
    names = list(mesh.bodies)
    member = np.zeros((len(names), n), dtype=bool)
    for i, name in enumerate(names):
        member[i, mesh.nodes_of(name)] = True
    shared = sp.csr_matrix(member.astype(np.int32) @ member.T.astype(np.int32))
    count, label = connected_components(shared, directed=False)
    per_group = 1 if mesh.axisymmetric else 3 if dim == 2 else 6
    modes = np.zeros((n, dim, per_group * count))
    groups = []
    for g in range(count):
        bodies = [names[i] for i in np.flatnonzero(label == g)]
        groups.append(tuple(bodies))
        nodes = np.flatnonzero(member[label == g].any(axis=0))
        x = mesh.points[nodes] - mesh.points[nodes].mean(axis=0)
        x = x / max(np.abs(x).max(), 1e-300)
        first = per_group * g
        modes[nodes, :, first : first + per_group] = motions(x, mesh.axisymmetric)
    return RigidModes(modes.reshape(n_dofs(n, dim), -1), tuple(groups), per_group)


def near_null(mesh: Mesh, rigid: RigidModes) -> NDArray[np.float64]:
    """(dim n_points, k) motions that strain bodies least, which multigrid must not lose: the rigid ones; of rings those of
    the plane, since shifts and turns of a section strain a ring little, but for near the axis."""
    return (rigid_modes(replace(mesh, axisymmetric=False)) if mesh.axisymmetric else rigid).together


def resistance_of_rows(rigid: RigidModes, rows: Sparse) -> NDArray[np.float64]:
    """Gram matrix of constraint rows, each scaled to a unit displacement."""
    if rows.shape[0] == 0:
        return np.zeros((rigid.modes.shape[1],) * 2)
    size = np.asarray(abs(rows).sum(axis=1)).ravel()
    motion = (rows @ rigid.modes) / np.maximum(size, 1e-300)[:, None]
    return np.asarray(motion.T @ motion) / rows.shape[0]


def free_motions(grams: Sequence[NDArray[np.float64]], supported: float = 1.0) -> NDArray[np.float64]:
    """Null vectors (n_modes, n_free) of the sum of all resistances. supported: share of what is enough of others that is
    enough of the first one, that of supports (``SUPPORTED`` where bodies that nothing holds are refused; a way to the
    solution needs them to hold as well as contact does: the benchmark "capstan-tri6")."""
    total = sum(grams)
    values, vectors = np.linalg.eigh(total + (1.0 / supported - 1.0) * grams[0])
    most = max(float(np.linalg.eigvalsh(total).max(initial=0.0)), 1e-300)
    return np.asarray(vectors[:, values < FREE * most])


def simple_motions(rigid: RigidModes, motion: NDArray[np.float64]) -> NDArray[np.float64]:
    """Shifts along the axes, then turns about them, both ways, of each group of bodies that takes part in a motion
    (n_modes,), and shifts of all of them together: (n_modes, k)."""
    parts = motion.reshape(-1, rigid.per_group)
    size = np.abs(parts).max(axis=1)
    order = [int(g) for g in np.argsort(-size) if size[g] > 0.1 * size.max()]
    shifts = {1: 1, 3: 2, 6: 3}[rigid.per_group]
    result = []
    for kinds in (range(shifts), range(shifts, rigid.per_group)):
        for groups in [[g] for g in order] + ([order] if kinds.start == 0 and len(order) > 1 else []):
            for kind in sorted(kinds, key=lambda k: -float(np.abs(parts[groups, k]).max())):
                one = np.zeros_like(parts)
                one[groups, kind] = np.sign(parts[groups, kind].sum()) or 1.0
                result += [one.ravel(), -one.ravel()]
    return np.stack(result, axis=1)


def describe(rigid: RigidModes, motions: NDArray[np.float64], one_way: bool = False) -> str:
    """Say which body is free to move and how, from the free motions (n_modes, n_free): a translation or rotation along an
    axis if one of them is, else the first. one_way: the sign of the motion matters."""
    pure = np.zeros(0) if one_way else _pure(motions)
    bodies, several, rotation, axis = _in_words(
        rigid, np.eye(len(motions))[pure[0]] if len(pure) else motions[:, 0], one_way
    )
    return f"{bodies} {'are' if several else 'is'} free to {'rotate' if rotation else 'translate'} {axis}"


def each_motion(rigid: RigidModes, motions: NDArray[np.float64]) -> list[tuple[str, NDArray[np.float64]]]:
    """Every one of the free motions in words, and itself (n_modes,): translations and rotations along axes first, then the
    rest."""
    pure = np.eye(len(motions))[:, _pure(motions)]
    rest, size, _ = np.linalg.svd(motions - pure @ (pure.T @ motions), full_matrices=False)
    result = []
    for motion in [*pure.T, *rest[:, size > 0.5].T]:
        bodies, _, rotation, axis = _in_words(rigid, motion)
        result.append((f"{'rotation' if rotation else 'translation'} of {bodies} {axis}", motion))
    return result


def _pure(motions: NDArray[np.float64]) -> NDArray[np.int64]:
    """Numbers of the single modes that are free."""
    return np.flatnonzero(np.linalg.norm(motions, axis=1) > 0.999)


def _in_words(rigid: RigidModes, motion: NDArray[np.float64], one_way: bool = False) -> tuple[str, bool, bool, str]:
    """The bodies that move, whether they are several, whether the motion is a rotation, and its axis."""
    parts = motion.reshape(-1, rigid.per_group)
    group = int(np.abs(parts).max(axis=1).argmax())
    members = parts[group]
    alike = [g for g, part in enumerate(parts) if np.abs(part - members).max() < 1e-9 * np.abs(members).max()]
    names = [" + ".join(f"'{name}'" for name in rigid.groups[g]) for g in alike]
    several = len(names) > 1
    bodies = f"bodies {', '.join(names)} together" if several else f"body {names[0]}"
    if rigid.per_group == 1:
        return bodies, several, False, f"along the axis {'-' if one_way and members[0] < 0.0 else ''}y"
    dim = 2 if rigid.per_group == 3 else 3
    shift, turn = members[:dim], members[dim:]
    if np.abs(shift).max() >= np.abs(turn).max():
        return bodies, several, False, f"along {_axis(shift, one_way)}"
    return bodies, several, True, f"about {'z' if dim == 2 else _axis(turn)}"


def _axis(vector: NDArray[np.float64], one_way: bool = False) -> str:
    """A direction in words, but for its sign unless ``one_way``."""
    vector = vector / np.linalg.norm(vector)
    largest = int(np.abs(vector).argmax())
    sign = np.sign(vector[largest])
    if abs(vector[largest]) > 0.999:
        return ("-" if one_way and sign < 0 else "") + "xyz"[largest]
    return "(" + ", ".join(f"{v if one_way else v / sign:.3g}" for v in vector) + ")"
