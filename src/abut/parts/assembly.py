"""mesh_parts: the solids of a CAD file as one mesh with named bodies, faces and touching faces."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from abut import checks
from abut.cells import CELLS
from abut.errors import InputError
from abut.io.atomic import write_file
from abut.io.names import is_file
from abut.mesh.integrals import chunks
from abut.mesh.mesh import Mesh
from abut.mesh.shapes import cell_shapes
from abut.parts.geometry import Part, body_names, face_names, groups_of, read_listing, shared_faces
from abut.parts.program import find_gmsh, run_script
from abut.parts.scripts import Sizes, listing, meshing
from abut.parts.step_names import solid_names
from abut.parts.touching import Touching, touching

FORMATS = (".step", ".stp", ".brep", ".iges", ".igs")
OUTSIDE = "all"  # the surface of everything outside of a body: body.all


@dataclass(frozen=True)
class Meshed:
    """A meshed CAD file: the mesh as abut reads it, pairs of touching bodies, the boxes' diagonals by body [length], the
    smallest scaled Jacobian (1 is best), and what is worth knowing."""

    mesh: Mesh
    touching: tuple[Touching, ...]
    diagonals: dict[str, float]
    worst: float
    notes: tuple[str, ...]

    @property
    def surfaces_by_body(self) -> dict[str, list[str]]:
        """Names of surfaces: those that touch first."""
        names = sorted(self.mesh.surfaces, key=lambda name: ".to-" not in name)
        return {body: [name for name in names if name.startswith(f"{body}.")] for body in self.mesh.bodies}


def facing_name(body: str, other: str) -> str:
    """The surface of a body's faces that touch another."""
    return f"{body}.to-{other}"


def mesh_parts(
    source: Path, target: Path, sizes: Sizes, *, names: Sequence[str] = (), reach: float | None = None,
    program: str = "gmsh", tell: Callable[[str], None] = lambda text: None,
) -> Meshed:  # fmt: skip
    """Mesh a CAD file and write it as a Gmsh file (.msh), checked.

    Parameters
    ----------
    source, target : Path
        STEP, BREP or IGES; the mesh.
    sizes : Sizes
        Edges, cells, unit.
    names : sequence of str, optional
        Of the bodies, in the file's order.
    reach : float, optional
        Largest gap of faces that touch [length]; left out: half of the size at contact.
    program : str
        Gmsh, by name or path.
    tell : callable
        Is told what is going on.

    Returns
    -------
    Meshed
        The mesh and what was found.

    Raises
    ------
    InputError
        Where Gmsh is missing or fails, the file holds no solids, cells are inverted, or the mesh cannot be written.
    """
    reach = 0.5 * sizes.at_contact if reach is None else checks.positive(reach, "--reach")
    if source.suffix.lower() not in FORMATS:
        raise InputError(f"{source}: expected a CAD file ({', '.join(FORMATS)})")
    if not is_file(source):
        raise InputError(f"CAD file {source} does not exist")
    gmsh = find_gmsh(program)
    with tempfile.TemporaryDirectory(prefix="abut-mesh-") as folder:
        here = Path(folder)
        copy = here / f"part{source.suffix.lower()}"  # a name that no script can stumble over
        try:
            shutil.copyfile(source, copy)
        except OSError as error:
            raise InputError(f"cannot read {source}: {error.strerror}") from None
        tell("finding the faces that touch")
        printed = _run(gmsh, here / "first.geo", listing(copy.name, sizes))
        parts = read_listing(printed)
        bodies = body_names(parts, names, solid_names(source))
        _refuse_glued(parts)
        found = touching(Mesh.read(here / "first.msh"), {p.tag: n for p, n in zip(parts, bodies)}, reach)
        surfaces = _surfaces(parts, bodies, found)
        fine = sorted({face for pair in found for side in pair.faces for face in side})
        tell("making the mesh")
        _run(gmsh, here / "mesh.geo", meshing(copy.name, sizes, _tags(parts, bodies), surfaces, fine))
        mesh = _checked(here / "mesh.msh", sizes)
        write_file(target, lambda temporary: _copied(here / "mesh.msh", temporary))
    diagonals = {name: part.size for part, name in zip(parts, bodies)}
    return Meshed(mesh, found, diagonals, _worst(mesh), _notes(bodies, found))


def _run(gmsh: str, script: Path, text: str) -> str:
    script.write_text(text, encoding="utf-8")
    return run_script(gmsh, script, script.with_suffix(".msh"))


def _tags(parts: Sequence[Part], bodies: Sequence[str]) -> dict[str, int]:
    return {name: part.tag for part, name in zip(parts, bodies)}


def _refuse_glued(parts: Sequence[Part]) -> None:
    if shared := shared_faces(parts):
        raise InputError(
            f"abut mesh: {len(shared)} faces belong to two solids, which are one piece there; export the parts of the "
            "assembly as separate solids (without fragments, partitions or imprints)"
        )


def _surfaces(parts: Sequence[Part], bodies: Sequence[str], found: Sequence[Touching]) -> dict[str, list[int]]:
    """Faces by name, those that touch by pair, and all of each body."""
    result: dict[str, list[int]] = {}
    for part, body in zip(parts, bodies):
        result |= groups_of(face_names(part, body))
        result[f"{body}.{OUTSIDE}"] = [face.tag for face in part.faces]
    for pair in found:
        for side in (0, 1):
            result[facing_name(pair.bodies[side], pair.bodies[1 - side])] = list(pair.faces[side])
    return result


def _checked(path: Path, sizes: Sizes) -> Mesh:
    """The mesh as it is read; of cells that are inverted says what to change."""
    try:
        return Mesh.read(path)
    except InputError as error:
        why = str(error).replace(f"{path}: ", "")
        tries = "--contact-size and --size smaller, or --cell tet4" if sizes.cell == "tet10" else "--size smaller"
        raise InputError(f"abut mesh: what Gmsh has made is no sound mesh ({why}); try {tries}") from None


def _copied(source: Path, target: Path) -> None:
    shutil.copyfile(source, target)


def _worst(mesh: Mesh) -> float:
    """The smallest scaled Jacobian at corners."""
    return min(
        float(cell_shapes(kind, mesh.points[nodes[:, : CELLS[kind].corners]])[0].min())
        for kind, nodes, _ in chunks(mesh)
    )


def _notes(bodies: Sequence[str], found: Sequence[Touching]) -> tuple[str, ...]:
    """Bodies that touch nothing."""
    met = {name for pair in found for name in pair.bodies}
    alone = [name for name in bodies if name not in met]
    if not alone or len(bodies) == 1:
        return ()
    return (
        f"{', '.join(alone)}: no face within reach of another body; give --reach if there is a gap that is to close",
    )
