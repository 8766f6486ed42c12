"""abut mesh: the parts of a CAD file to a mesh and a job file, by Gmsh where it is installed."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from abut.cli.terminal import show
from abut.errors import InputError

if TYPE_CHECKING:
    from abut.parts import Meshed

DONE = 0


def add_mesh(commands: Any) -> None:
    """Add the command to the parser's ``commands``."""
    mesh = commands.add_parser(
        "mesh",
        help="a CAD file (STEP) to a mesh and a job file to start from",
        description="Mesh the solids of a STEP, BREP or IGES file with the program Gmsh, which has to be installed: bodies\n"
        "and faces named, finer where parts touch, curved quadratic tetrahedra, checked. Beside the mesh a job file is\n"
        "written, to run as it is and to edit.",
        epilog="examples:\n  abut mesh bracket.step --size 4\n  abut run bracket.toml\n"
        "  abut mesh joint.step --size 4 --contact-size 1 --names lug,fork,pin --hold fork.zmin --press lug.zmax=20",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    mesh.add_argument("source", type=Path, help="the CAD file (.step, .stp, .brep, .iges)")
    mesh.add_argument("--size", type=float, required=True, metavar="S", help="edges of cells, length")
    mesh.add_argument(
        "--contact-size", type=float, metavar="S", help="the same where parts touch (default: half of --size)"
    )
    mesh.add_argument(
        "--reach",
        type=float,
        metavar="GAP",
        help="faces this far apart count as touching (default: half of --contact-size)",
    )
    mesh.add_argument("--cell", default="tet10", help="tet10 (curved, default) or tet4")
    mesh.add_argument("--unit", default="mm", help="of the mesh: mm (default), m or in")
    mesh.add_argument("--names", default="", metavar="A,B,...", help="names of the solids, in the file's order")
    mesh.add_argument(
        "--hold", action="append", default=[], metavar="SURFACE", help="of the job: held; may be repeated"
    )
    mesh.add_argument(
        "--press", action="append", default=[], metavar="SURFACE=P", help="of the job: a pressure; may be repeated"
    )
    mesh.add_argument(
        "--output",
        type=Path,
        metavar="JOB",
        help="the job file (.toml); the mesh lies beside it (default: as the CAD file)",
    )
    mesh.add_argument("--replace", action="store_true", help="overwrite a job file that is there already")
    mesh.add_argument("--gmsh", default="gmsh", metavar="PATH", help="the program, by name or path")
    mesh.add_argument("--quiet", action="store_true", help="print errors only")
    mesh.add_argument("--debug", action="store_true", help="print the traceback of an internal error")
    mesh.set_defaults(command=_mesh)


def _mesh(arguments: argparse.Namespace) -> int:
    from abut.io.atomic import write_text
    from abut.parts import Sizes, mesh_parts, starting_job

    sizes = Sizes(arguments.size, arguments.contact_size, arguments.cell, arguments.unit)
    job = arguments.output or arguments.source.with_suffix(".toml")
    if job.suffix.lower() != ".toml":
        raise InputError(f"--output: {job}: expected a job file (.toml)")
    if job.exists() and not arguments.replace:
        raise InputError(f"{job} is there already; give --output another name, or --replace to overwrite it")
    press = dict(_pressure(text) for text in arguments.press)
    names = [name.strip() for name in arguments.names.split(",")] if arguments.names else []
    say = (lambda text: None) if arguments.quiet else show
    mesh = job.with_suffix(".msh")
    meshed = mesh_parts(
        arguments.source, mesh, sizes, names=names, reach=arguments.reach, program=arguments.gmsh, tell=say
    )
    start = starting_job(meshed, mesh.name, arguments.source.name, sizes.unit, arguments.hold, press)
    write_text(job, start.text)
    for text in (*_summary(meshed), *start.chosen, *meshed.notes, f"written: {mesh}, {job}; go on with abut run {job}"):
        say(text)
    return DONE


def _pressure(text: str) -> tuple[str, float | None]:
    """SURFACE or SURFACE=PRESSURE."""
    name, equals, value = text.partition("=")
    try:
        return name, float(value) if equals else None
    except ValueError:
        raise InputError(f"--press: {text!r}: expected SURFACE=PRESSURE with a number") from None


def _summary(meshed: Meshed) -> list[str]:
    mesh = meshed.mesh
    lines = [
        f"body '{name}': {len(mesh.bodies[name])} cells, surfaces {', '.join(surfaces)}"
        for name, surfaces in meshed.surfaces_by_body.items()
    ]
    for pair in meshed.touching:
        low, high = pair.gap
        lines.append(f"'{pair.bodies[0]}' and '{pair.bodies[1]}' touch, gap {low:.2g} to {high:.2g}")
    lines.append(
        f"{mesh.n_cells} cells, {len(mesh.points)} points, none inverted; smallest scaled Jacobian {meshed.worst:.2g}"
    )
    return lines
