"""The program abut, as ``python -m abut.cli``: what ``python -m abut`` is."""

from __future__ import annotations

import runpy

if __name__ == "__main__":
    runpy.run_module("abut", run_name="__main__")
