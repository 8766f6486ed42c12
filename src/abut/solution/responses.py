"""How an assembly answered loads that change quickly: amplitudes over frequency, or displacements over time."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from abut.brief import brief
from abut.solution.contacts import Check

HARMONIC, TRANSIENT = "harmonic", "transient"
AXIS = {HARMONIC: "frequency", TRANSIENT: "time"}
LEFT_OUT = 1e-2
UNKNOWN = "bodies move as a whole without resistance, and have no static answer to compare with"
Numbers = NDArray[Any]  # real or complex


@dataclass(frozen=True)
class ResponseAt:
    """What a probe reads. name: its; points: (n, dim); nodes: (n,) or None; displacement: (m, n, dim), complex of what is
    harmonic: amplitude and phase of exp(i omega t)."""

    name: str
    points: NDArray[np.float64]
    nodes: NDArray[np.int64] | None
    displacement: Numbers

    __repr__ = brief


@dataclass(frozen=True)
class ResponseResult:
    """Changes of the state at the end of the last load step.

    kind: "harmonic" or "transient"; at: (m,) frequencies in cycles per time, or times; coordinates: (m, n) of the modes,
    complex where harmonic, without what is added for those left out; damping: (n,) shares of critical damping; largest: (m,)
    the largest displacement of any node, of all phases where harmonic; probes: by probe of the model; fields: (k, n_points,
    dim) displacements at ``fields_at`` (k,).

    left_out: largest error by modes that are left out, relative to the static displacement of what is loaded, theory (J11);
    NaN where there is none.
    """

    kind: str
    at: NDArray[np.float64]
    coordinates: Numbers
    damping: NDArray[np.float64]
    largest: NDArray[np.float64]
    probes: tuple[ResponseAt, ...]
    fields_at: NDArray[np.float64]
    fields: Numbers
    left_out: float

    __repr__ = brief

    @property
    def certificate(self) -> tuple[Check, ...]:
        """What modes beyond those found would have changed."""
        unknown = UNKNOWN if np.isnan(self.left_out) else ""
        return (
            Check("", f"{self.kind} response: modes left out", self.left_out, LEFT_OUT,
                  "most that further modes change, over the static displacement of what is loaded", unknown=unknown),
        )  # fmt: skip


def labels(results: Sequence[ResponseResult]) -> list[str]:
    """A name for each: its kind, with a number from the second of a kind on."""
    kinds = [result.kind for result in results]
    again = [kinds[:i].count(kind) for i, kind in enumerate(kinds)]
    return [f"{kind}{f'_{before + 1}' if before else ''}" for kind, before in zip(kinds, again)]
