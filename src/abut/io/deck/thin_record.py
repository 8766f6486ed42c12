"""What stands for a node of a shell, beam or truss once these are solids."""

from __future__ import annotations

from dataclasses import dataclass

HALF = 1e-9  # of the thickness: a node halfway


@dataclass(frozen=True)
class Thin:
    """Nodes of solids that stand for a node of a shell: its displacement is their mean, over the thickness, its turn that of
    the line from the first to the last, ``along`` the unit vector from the former to the latter and ``apart`` their
    distance; of a knot, whose turn is that of a coupling, None. inner: the nodes between them, which stay on that line where
    they are held, but for their motion along it where the thickness is not ``rigid``, and the share of the last in where
    they are. weights: of the nodes in the mean, which add up to 1; all alike where left out. stretch: by which their mean
    displacement is multiplied along the global axes."""

    nodes: tuple[int, ...]
    along: tuple[float, float, float] | None = None
    apart: float = 0.0
    inner: tuple[tuple[int, float], ...] = ()
    weights: tuple[float, ...] = ()
    rigid: bool = True
    stretch: tuple[float, float, float] = (1.0, 1.0, 1.0)

    @property
    def own(self) -> tuple[int, ...]:
        """The nodes over the thickness or in the section, without others that the mean takes."""
        return self.nodes if self.along is None else (self.nodes[0], *(n for n, _ in self.inner), self.nodes[-1])

    @property
    def middle(self) -> int:
        """The node halfway between them, 0 where there is none."""
        return next((node for node, share in self.inner if abs(share - 0.5) < HALF), 0)

    @property
    def shares(self) -> tuple[tuple[int, float], ...]:
        """The nodes, and the weight of each in the mean."""
        return tuple(zip(self.nodes, self.weights or (1.0 / len(self.nodes),) * len(self.nodes)))
