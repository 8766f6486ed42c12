"""A report.html, read back, and shown by a browser."""

from __future__ import annotations

import base64
import json
import re
import shutil
import subprocess
import zlib
from html.parser import HTMLParser
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

# Where abut was built without the libraries of the report there is nothing that a browser would draw.
INTERACTIVE = files("abut.report").joinpath("static", "libraries.js").is_file()
BROWSER = (
    next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if INTERACTIVE
    else None
)


class Page(HTMLParser):
    """What a report holds: the text of the page, its data, addresses it refers to, tags."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.text, self.tags, self.addresses, self.data, self.arrays = "", [], [], "", ""
        self.inside, self.packed = "", b""
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = dict(attrs)
        self.tags.append(tag)
        here = [values[key] or "" for key in ("src", "href") if key in values]
        self.addresses += [address for address in here if not address.startswith("data:image/png;base64,")]
        self.inside = values.get("id") or tag if tag in ("script", "style") else ""

    def handle_endtag(self, tag: str) -> None:
        self.inside = ""

    def handle_data(self, data: str) -> None:
        if self.inside == "data":
            self.data += data
        elif self.inside == "arrays":
            self.arrays += data
        elif self.inside not in ("script", "style"):
            self.text += data

    def unpack(self, place: dict[str, Any]) -> np.ndarray:
        """An array of the page, from its place there."""
        self.packed = self.packed or zlib.decompress(base64.b64decode(self.arrays), -15)
        own = np.frombuffer(self.packed, np.uint8)[4 * place["at"] : 4 * (place["at"] + place["count"])]
        return np.ascontiguousarray(own.reshape(4, -1).T).view("<" + place["type"]).ravel()

    @property
    def scene(self) -> dict[str, Any]:
        return json.loads(self.data)["scene"]


def in_browser(path: Path) -> dict[str, str]:
    """The data-* attributes of the root element after headless Chromium has shown a page."""
    assert BROWSER is not None
    flags = [
        "--headless=new",
        "--no-sandbox",
        "--enable-unsafe-swiftshader",
        "--use-gl=angle",
        "--use-angle=swiftshader",
    ]
    flags += ["--virtual-time-budget=8000", "--window-size=1000,700", f"--user-data-dir={path.parent / 'profile'}"]
    done = subprocess.run(
        [BROWSER, *flags, "--dump-dom", path.as_uri()], capture_output=True, text=True, timeout=120, check=False
    )
    head = re.search(r"<html[^>]*>", done.stdout)
    assert head, done.stderr[-2000:]
    return dict(re.findall(r'data-(\w+)="([^"]*)"', head.group(0)))
