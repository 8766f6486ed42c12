"""The table of docs/verification/features.md: of every table of a job file its keys, closed forms, page, and what
`abut check` and the report know of it. python docs/make/features.py"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any

from abut.benchmarks import BENCHMARKS
from abut.errors import AbutError
from abut.job import load_job
from abut.job.schema import JobFile
from abut.model import Model
from abut.report.describe import tables
from page import DOCS, write_table

PAGE = DOCS / "verification" / "features.md"
HEADER = ["table", "keys", "closed forms", "page", "picture", "`abut check`", "report"]
APART = ("schema", "parameters", "mesh", "model", "materials", "solids", "solve", "output")  # what every job has
MADE_OF = {
    "sectors": ("ring-sector", "sector-fit"),
    "fields": ("mapped-temperature", "submodel"),
    "stops": ("stop",),
    "start": ("start-plastic", "start-holds", "start-fit"),
    "steps": (),
}  # no records of a model: benchmarks
KIND = {  # all are modes of a model
    "frequencies": "Frequencies",
    "buckling": "Buckling",
    "harmonic": "Harmonic",
    "transient": "Transient",
}
JOB = """schema = 1
[model]
plane = "strain"
[mesh.bodies.block]
kind = "rectangle"
x = [0, 1]
y = [0, 1]
cells = [2, 2]
[materials.steel]
kind = "linear-elastic"
young = 1000.0
poisson = 0.3
[[solids]]
body = "block"
material = "steel"
[[supports]]
on = "block.bottom"
x = 0
y = 0
"""
WRONG = {  # one entry of each table that cannot be met
    "fields": '[fields.hot]\nfile = "nowhere.vtu"\narray = "T"\n',
    "supports": '[[supports]]\non = "nowhere"\nx = 0\n',
    "loads": '[[loads]]\nkind = "pressure"\non = "nowhere"\nvalue = 1\n',
    "contacts": '[[contacts]]\ncontactor = "nowhere"\ntarget = "block.top"\n',
    "equations": '[[equations]]\nterms = [{ on = "nowhere", component = "x", coefficient = 1 }]\n',
    "sectors": '[[sectors]]\nside = "nowhere"\nother = "block.top"\nsectors = 3\n',
    "rigid": '[[rigid]]\nbody = "nowhere"\n',
    "rotations": '[[rotations]]\non = "nowhere"\nangle = 1\ncentre = [0, 0]\n',
    "couplings": '[[couplings]]\nname = "c"\non = "nowhere"\n',
    "connectors": '[[connectors]]\nname = "c"\nkind = "hinge"\non = "nowhere"\n',
    "preloads": '[[preloads]]\nname = "b"\nbody = "nowhere"\nforce = 1\n',
    "springs": '[[springs]]\nname = "s"\non = "nowhere"\nx = 1\n',
    "holds": '[[holds]]\non = "nowhere"\nx = 0\n',
    "stops": '[[stops]]\non = "nowhere"\ndirection = [1, 0]\ndistance = 1\n',
    "removals": '[[removals]]\nbody = "nowhere"\nuntil = 0.5\n',
    "penetrations": '[[penetrations]]\ncontact = "nowhere"\nsource = "block.top"\nvalue = 1\n',
    "probes": '[[probes]]\nname = "p"\non = "nowhere"\n',
    "steps": '[[steps]]\nname = "a"\n[[steps]]\nname = "a"\n',
    "start": '[[steps]]\nname = "a"\n[[steps]]\nname = "b"\n[start]\nresults = "nowhere"\ntime = "nowhere"\n',
    "frequencies": "[frequencies]\ncount = 0\n",
    "buckling": "[buckling]\ncount = 0\n",
    "harmonic": "[frequencies]\n[harmonic]\nbetween = [2, 1]\n",
    "transient": "[frequencies]\n[transient]\nperiod = 0\n",
}


def names() -> list[str]:
    """Tables of a job file, but for those that every job has."""
    every = JobFile.model_json_schema(by_alias=True)["properties"]
    return [name for name in every if name not in APART]


@cache
def models() -> Mapping[str, Model]:
    return {name: benchmark.model(0) for name, benchmark in BENCHMARKS.items()}


def _records(model: Model, name: str) -> list[Any]:
    found = list(getattr(model, "modes" if name in KIND else name, ()))
    return [record for record in found if name not in KIND or type(record).__name__ == KIND[name]]


def closed_forms(name: str) -> list[str]:
    """Benchmarks whose models have it, the fewest others first."""
    if name in MADE_OF:
        return [one for one in MADE_OF[name] if one in BENCHMARKS]
    if name == "supports":
        return [one for one, model in models().items() if any(s.axes is not None for s in model.supports)]
    having = {one: model for one, model in models().items() if _records(model, name)}
    return sorted(having, key=lambda one: sum(bool(_records(having[one], other)) for other in WRONG))


def keys(name: str) -> list[str]:
    """Keys of a table in the schema, `kind` of loads among them."""
    return sorted(_keys(JobFile.model_json_schema(by_alias=True), name))


def _keys(schema: Mapping[str, Any], name: str) -> set[str]:
    def below(part: Any) -> Iterator[str]:
        if isinstance(part, list):
            for item in part:
                yield from below(item)
        elif isinstance(part, dict):
            if "$ref" in part:
                yield from below(schema["$defs"][part["$ref"].rsplit("/", 1)[1]])
            elif "properties" in part:
                yield from part["properties"]
            for word in ("items", "anyOf", "oneOf", "allOf", "additionalProperties"):
                yield from below(part.get(word))

    return set(below(schema["properties"][name]))


def sections(name: str) -> list[tuple[str, str, bool]]:
    """Page and heading of what shows it in an example, and whether there is a picture."""
    entry = re.compile(rf"^\[{{1,2}}{re.escape(name)}(\.\w+)?\]{{1,2}}", re.MULTILINE)
    found = []
    for page in (DOCS / "job.md", DOCS / "probes.md"):
        text = page.read_text(encoding="utf-8").split("<!-- begin table job-keys -->")[0]
        for part in re.split(r"^(?=#{1,3} [A-Z])", text, flags=re.MULTILINE):
            code = "".join(re.findall(r"```toml\n(.*?)```", part, re.DOTALL))
            if entry.search(code):
                found.append((page.name, part.split("\n", 1)[0].lstrip("# "), "](pictures/" in part))
    return found


def told(name: str) -> str:
    """What `abut check` says of an entry that cannot be met: the table it names."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "job.toml"
        path.write_text(JOB + WRONG[name], encoding="utf-8")
        try:
            load_job(path)
        except AbutError as error:
            found = re.search(rf"\b{name.rstrip('s')}\w*", str(error))
            return found[0] if found else ""
    return ""


def in_report(name: str) -> str:
    """Title of the report's table of them, of the first closed form."""
    stands = {"stops": "rigid", "sectors": "equations", "fields": "", "start": "", "steps": ""}.get(name, name)
    of = closed_forms(name)
    if not stands or not of:
        return {"fields": "note", "start": "note", "steps": "what acts"}.get(name, "")
    model = models()[of[0]]
    kinds = {type(record).__name__ for record in _records(model, stands)}
    return next((str(t["title"]) for t in tables(model) for row in t["rows"] if row[0] in kinds), "")


def row(name: str) -> list[str]:
    shown = sections(name)
    page, heading, _ = next((one for one in shown if one[2]), shown[0] if shown else ("", "", False))
    anchor = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
    some = closed_forms(name)
    return [
        f"`{name}`",
        str(len(keys(name))),
        ", ".join(f"`{one}`" for one in some[:3]) + (f" and {len(some) - 3} more" if len(some) > 3 else ""),
        f"[{heading}](../{page}#{anchor})" if page else "",
        "yes" if any(one[2] for one in shown) else "",
        told(name),
        in_report(name),
    ]


def main() -> None:
    write_table(PAGE, "features", HEADER, [row(name) for name in names()])


if __name__ == "__main__":
    main()
