"""Which bodies the tables [[solids]] of a job are about."""

from __future__ import annotations

from abut.errors import InputError
from abut.job.schema import JobFile, SolidTable
from abut.mesh.mesh import Mesh


def solid_bodies(file: JobFile, mesh: Mesh) -> list[tuple[int, SolidTable, str]]:
    """Number, table and body of each solid: where a table names no body all that no other table names, in the order of the
    mesh.

    Raises InputError where two tables leave it out, and where nothing is left."""
    named = {table.body for table in file.solids} | {table.body for table in file.rigid}
    rest = [body for body in mesh.bodies if body not in named]
    open_ = [i for i, table in enumerate(file.solids) if table.body is None]
    if len(open_) > 1:
        raise InputError(f"solids[{open_[1]}].body: missing; only one table, here solids[{open_[0]}], may leave it out")
    if open_ and not rest:
        raise InputError(
            f"solids[{open_[0]}].body: missing, and other tables name every body; name one, or take this out"
        )
    return [
        (i, table, body)
        for i, table in enumerate(file.solids)
        for body in ([table.body] if table.body is not None else rest)
    ]
