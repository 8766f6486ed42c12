"""Picture of docs/report.md: python docs/make/report_picture.py [CHROMIUM] (half a minute; needs Chromium)."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import abut
from abut.job import load_job
from page import DOCS

JOB = DOCS.parent / "examples" / "pin-lug" / "job.toml"
SIZE = (1440, 1240)
NAMES = ("chromium", "chromium-browser", "google-chrome")
LOADING = 60_000  # ms of the page's own time until it is taken


def browser() -> str:
    """The browser's path. Raises SystemExit where there is none."""
    found = sys.argv[1:] or [path for path in map(shutil.which, NAMES) if path]
    if not found:
        raise SystemExit(f"none of {', '.join(NAMES)} found: give a path")
    return found[0]


def photograph(page: Path, picture: Path) -> None:
    """A window's worth of a page, drawn without a graphics card."""
    command = [
        browser(), "--headless", "--no-sandbox", "--hide-scrollbars", "--use-gl=angle", "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader", f"--window-size={SIZE[0]},{SIZE[1]}", f"--virtual-time-budget={LOADING}",
        f"--user-data-dir={page.parent / 'profile'}", f"--screenshot={picture}", page.as_uri(),
    ]  # fmt: skip
    subprocess.run(command, check=True, timeout=300, stderr=subprocess.DEVNULL)


def main() -> None:
    job = load_job(JOB)
    solution = abut.solve(job.model, print)
    with tempfile.TemporaryDirectory() as folder:
        page = Path(folder) / f"{JOB.parent.name}.html"  # its title
        abut.write_report(solution, page)
        photograph(page, DOCS / "pictures" / "report.png")


if __name__ == "__main__":
    main()
