"""A job file to start from: steel parts, contact wherever they touch, held at one end and pressed at the other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from abut.errors import InputError, nearest
from abut.job.convert import toml
from abut.parts.assembly import OUTSIDE, Meshed, facing_name
from abut.types import Json

STEEL = {"mm": 210e3, "m": 210e9, "in": 30.5e6}  # N/mm^2, N/m^2, psi
STRESS = {"mm": "MPa", "m": "Pa", "in": "psi"}
PRESSED = 1e-4  # pressure over Young's modulus where none is given
WEAK = (
    1e-6  # stiffness of weak springs over Young's modulus times size: a thousandth of a load moves a part by its size
)


@dataclass(frozen=True)
class StartingJob:
    """The text of a job file, and what in it was chosen, in words."""

    text: str
    chosen: tuple[str, ...] = field(default=())


def starting_job(
    meshed: Meshed, mesh_file: str, source: str, unit: str, hold: Sequence[str] = (),
    press: Mapping[str, float | None] | None = None,
) -> StartingJob:  # fmt: skip
    """A job file of a meshed CAD file.

    Parameters
    ----------
    meshed : Meshed
        From ``mesh_parts``.
    mesh_file, source : str
        The mesh's name as the job refers to it; the CAD file's.
    unit : str
        "mm", "m" or "in".
    hold : sequence of str
        Surfaces held in all directions; empty: the end of the lowest z, or y, or x.
    press : mapping of str to float, optional
        Surfaces and the pressure on each [stress]; empty: the end opposite the one that is held.

    Returns
    -------
    StartingJob
        The text, and what was chosen.

    Raises
    ------
    InputError
        For surfaces that the mesh does not have.
    """
    surfaces, chosen = meshed.mesh.surfaces, []
    press = press or {}
    for option, names in (("--hold", hold), ("--press", press)):
        for name in names:
            if name not in surfaces:
                raise InputError(f"{option}: no surface named {name!r} in the mesh{nearest(name, surfaces)}")
    ends = _ends(meshed)
    if not hold and ends:
        hold = [ends[0]]
        chosen.append(f"held at '{ends[0]}'; another with --hold SURFACE")
    if not press and ends:
        press = {ends[1]: None}
        chosen.append(f"pressed at '{ends[1]}'; another with --press SURFACE=PRESSURE")
    loads = {name: PRESSED * STEEL[unit] if value is None else value for name, value in press.items()}
    table = _table(meshed, mesh_file, unit, hold, loads)
    head = [
        f"# Made by abut mesh from {source}: lengths in {unit}, stresses in {STRESS[unit]}.",
        "# Everything here is a beginning: give the parts their materials, supports, loads and friction.",
        "# Surfaces:",
    ]
    head += [f"#   {', '.join(names)}" for names in meshed.surfaces_by_body.values()]
    head += [f"# {text}" for text in chosen]
    return StartingJob("\n".join(head) + "\n" + toml(table), tuple(chosen))


def _ends(meshed: Meshed) -> tuple[str, str] | None:
    """The plane surfaces farthest apart along z, else y, else x."""
    mesh = meshed.mesh
    for axis, letter in ((2, "z"), (1, "y"), (0, "x")):
        low = [name for name in mesh.surfaces if name.endswith(f".{letter}min")]
        high = [name for name in mesh.surfaces if name.endswith(f".{letter}max")]
        if low and high:
            place = {name: float(mesh.points[mesh.nodes_of(name), axis].mean()) for name in (*low, *high)}
            area = {name: len(mesh.surfaces[name]) for name in place}  # of several as low the largest
            return (
                min(low, key=lambda name: (round(place[name], 9), -area[name])),
                max(high, key=lambda name: (round(place[name], 9), area[name])),
            )
    return None


def _table(meshed: Meshed, mesh_file: str, unit: str, hold: Sequence[str], loads: Mapping[str, float]) -> Json:
    bodies = list(meshed.mesh.bodies)
    held = {name.rsplit(".", 1)[0] for name in hold}
    table: Json = {
        "schema": 1,
        "mesh": {"file": mesh_file},
        "materials": {"steel": {"kind": "linear-elastic", "young": STEEL[unit], "poisson": 0.3}},
        "solids": [{"body": name, "material": "steel"} for name in bodies],
        "supports": [{"on": name, "x": 0.0, "y": 0.0, "z": 0.0} for name in hold],
        "loads": [{"kind": "pressure", "on": name, "value": value} for name, value in loads.items()],
        "contacts": [
            {"name": f"{a}-{b}", "surfaces": [facing_name(a, b), facing_name(b, a)]}
            for a, b in (pair.bodies for pair in meshed.touching)
        ],
        "springs": [
            {"name": f"{name}-loose", "on": f"{name}.{OUTSIDE}", "weak": True}
            | dict.fromkeys("xyz", float(f"{WEAK * STEEL[unit] * meshed.diagonals[name]:.2g}"))
            for name in bodies
            if name not in held
        ],
    }
    return {key: value for key, value in table.items() if value}
