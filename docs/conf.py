"""The documentation site: `make docs` builds it into build/docs, with warnings as errors."""

from __future__ import annotations

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).with_name("site")))

import abut

project = "abut"
author = "The abut developers"
project_copyright = "The abut developers, BSD-3-Clause"
version = release = abut.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "mathml", "equations", "reference"]
exclude_patterns = ["make", "site"]
source_suffix = {".md": "markdown"}
suppress_warnings = [
    "ref.python"
]  # names in signatures stand as in the code: Coupling is of a model, and of two surfaces
nitpicky = False  # annotations name NumPy's types, which have no pages here

myst_enable_extensions = ["dollarmath", "deflist", "fieldlist"]
myst_heading_anchors = 4  # as GitHub makes them
myst_links_external_new_tab = False

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # signatures are written by reference.py, as they stand in the code
add_module_names = False
napoleon_google_docstring = False
napoleon_use_rtype = False  # what is returned in one paragraph
maximum_signature_line_length = 88

highlight_language = "text"

html_theme = "furo"
html_title = f"abut {version}"
html_static_path = ["site/static"]
html_css_files = ["abut.css"]
html_math_renderer = "mathml"
html_show_sphinx = False
html_copy_source = False
html_show_sourcelink = False
