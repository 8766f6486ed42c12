"""Formulas as MathML, which browsers draw by themselves: no script, no network, at building and at reading."""

from __future__ import annotations

import re
from typing import Any

from docutils import nodes
from docutils.utils.math import MathError
from docutils.utils.math.latex2mathml import tex2mathml
from sphinx.application import Sphinx
from sphinx.util import logging

TAG = re.compile(r"\\tag\{([^}]*)\}")
SPELLINGS = {r"\lt": "<", r"\gt": ">", r"\dots": r"\ldots", r"\cr": r"\\", r"\Big": ""}  # GitHub's, to docutils'
WORD = re.compile(r"\\[a-zA-Z]+")
DIGITS = re.compile(r"\\frac(\d)(\d)")  # docutils would read one number


def convert(formula: str, place: nodes.Node, block: bool) -> str:
    """LaTeX to MathML; what cannot be converted is a warning, which stops a strict build."""
    plain = WORD.sub(lambda m: SPELLINGS.get(m[0], m[0]), DIGITS.sub(r"\\frac{\1}{\2}", formula))
    try:
        return str(tex2mathml(plain, as_block=block))
    except MathError as error:
        logging.getLogger(__name__).warning("formula %r: %s", formula, error, location=place)
        return f"<code>{formula}</code>"


def visit_inline(writer: Any, node: nodes.math) -> None:
    writer.body.append(convert(node.astext(), node, False))
    raise nodes.SkipNode


def visit_block(writer: Any, node: nodes.math_block) -> None:
    """A displayed formula, with its label at the right-hand side as in ``\\tag{F1}``."""
    tags = TAG.findall(node.astext())
    label = f'<span class="eqno">({tags[0]})</span>' if tags else ""
    anchor = f' id="eq-{tags[0].lower()}"' if tags else ""
    formula = convert(TAG.sub("", node.astext()).strip(), node, True)
    writer.body.append(f'<div class="formula"{anchor}>{formula}{label}</div>\n')
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict[str, Any]:
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
