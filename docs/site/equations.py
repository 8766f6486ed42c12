"""Labels such as (F6), wherever a page or a docstring cites them, lead to the equation."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx

from mathml import TAG

CITED = re.compile(r"\(([FSQPLV]\d+)\)")
NOT_WITHIN = (nodes.reference, nodes.literal, nodes.literal_block, nodes.math, nodes.math_block, nodes.title)


def homes(source: Path) -> dict[str, str]:
    """Label -> page of the theory that has the equation."""
    return {
        label: f"theory/{page.stem}"
        for page in (source / "theory").glob("*.md")
        for label in TAG.findall(page.read_text(encoding="utf-8"))
    }


def link(app: Sphinx, doctree: nodes.document, page: str) -> None:
    known = homes(Path(app.srcdir))
    for text in list(doctree.findall(nodes.Text)):
        if any(isinstance(parent, NOT_WITHIN) for parent in _parents(text)):
            continue
        pieces: list[nodes.Node] = []
        end = 0
        for match in CITED.finditer(text):
            label = match[1]
            if label not in known:
                continue
            home = app.builder.get_relative_uri(page, known[label])
            target = f"{home}#eq-{label.lower()}"
            pieces += [nodes.Text(text[end : match.start()]), nodes.reference("", match[0], refuri=target)]
            end = match.end()
        if pieces:
            text.parent.replace(text, [*pieces, nodes.Text(text[end:])])


def _parents(node: nodes.Node) -> list[nodes.Node]:
    found = []
    while node.parent is not None:
        node = node.parent
        found.append(node)
    return found


def setup(app: Sphinx) -> dict[str, Any]:
    app.connect("doctree-resolved", link)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
