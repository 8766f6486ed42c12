"""*SUBMODEL of a deck: which nodes take their displacements from the result file of another run."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from abut.io.deck.cards import Card, key, of
from abut.io.deck.mesh_cards import MeshCards
from abut.io.deck.reasons import Reasons


def submodels(cards: Sequence[Card], mesh: MeshCards, folder: Path, reasons: Reasons) -> dict[int, str]:
    """The result file of each node that a card names; ``reasons`` gets what is wrong with them."""
    found: dict[int, str] = {}
    for card in of(cards, "SUBMODEL"):
        with reasons.gathered():
            if key(card.get("TYPE", "NODE") or "") != "NODE":
                raise card.error(f"TYPE={card.get('TYPE')}: only displacements of nodes are read; give TYPE=NODE")
            path = folder / card.need("INPUT")
            if path.suffix.lower() != ".frd":
                raise card.error(f"INPUT={path.name}: expected the .frd file of the global model")
            if not path.exists():
                raise card.error(f"INPUT={path.name}: no such file; run the global model first, with *NODE FILE, U")
            for line in card.lines:
                for i, text in enumerate(line.fields):
                    if text:
                        found |= dict.fromkeys(mesh.node_sets.resolve(line, i, "node").tolist(), str(path))
    return found
