"""abut convert: a deck to a job file with its mesh, a mesh to another format."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from abut.cli.run import add_ignore, add_set
from abut.cli.terminal import show
from abut.errors import InputError

DONE = 0
JOB = ".toml"


def add_convert(commands: Any) -> None:
    """Add the command to the parser's ``commands``."""
    convert = commands.add_parser(
        "convert",
        help="a deck to a job file with its mesh, a mesh to VTU, a job to one without parameters",
        description="Convert an Abaqus or CalculiX deck (.inp) to a job file (.toml) and a mesh beside it (.vtu),\n"
        "a mesh (.inp, .msh, .vtu) to VTU with its names, or a job to one of numbers alone and its mesh.",
        epilog="examples:\n  abut convert deck.inp job.toml\n  abut convert punch.msh punch.vtu\n"
        "  abut convert pin.toml pin-tight.toml --set clearance=0.01",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    convert.add_argument("source", type=Path, help="deck, mesh or job")
    convert.add_argument("target", type=Path, help="job file (.toml) or mesh (.vtu)")
    add_ignore(convert)
    add_set(convert)
    convert.add_argument("--quiet", action="store_true", help="print errors only")
    convert.add_argument("--debug", action="store_true", help="print the traceback of an internal error")
    convert.set_defaults(command=_convert)


def _convert(arguments: argparse.Namespace) -> int:
    from abut.job.convert import write_job
    from abut.job.load import DECK, load_job
    from abut.job.parameters import read_settings
    from abut.mesh.mesh import Mesh
    from abut.mesh.write import write_mesh

    source, target = arguments.source, arguments.target
    written = [target]
    notes: list[str] = []
    settings = read_settings(arguments.set)
    if target.suffix.lower() == ".vtu" and source.suffix.lower() == JOB:
        mesh = load_job(source, settings=settings).model.mesh
        write_mesh(target, mesh)
        notes += mesh.notes
    elif settings and source.suffix.lower() != JOB:
        raise InputError(f"{source}: --set is for job files with [parameters]; decks and meshes have none")
    elif target.suffix.lower() == ".vtu":
        mesh = Mesh.read(source)
        write_mesh(target, mesh)
        notes += mesh.notes
    elif target.suffix.lower() != ".toml":
        raise InputError(f"{target}: expected a job file (.toml) or a mesh (.vtu) to write")
    elif source.suffix.lower() not in (DECK, JOB):
        raise InputError(f"{source}: only decks ({DECK}) and jobs become job files; a mesh becomes a .vtu")
    elif source.resolve() == target.resolve():
        raise InputError(f"{target}: is the job that is read; give another name to write")
    else:
        job = load_job(source, ignore=arguments.ignore, soft=arguments.soft_contact, settings=settings)
        written = write_job(target, job)
        notes += [*(f"ignored: {what}" for what in job.ignored), *job.notes]
    if not arguments.quiet:
        show(*notes, sep="\n", end="\n" if notes else "")
        show(f"written: {', '.join(map(str, written))}")
    return DONE
