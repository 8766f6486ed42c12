"""Solutions for PyVista, which is optional (``pip install abut[picture]``): data to work with, or a quick picture."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from abut import checks
from abut.cells import CELLS
from abut.errors import InputError
from abut.mesh.mesh import Mesh
from abut.solution import Solution, Step
from abut.solution.grids import CONTACTOR, TARGET, Grid, contact_grid, largest_pressure, point_fields, vectors
from abut.types import Foreign

FIELDS = {
    "pressure": "pressure", "gap": "gap", "traction": "traction", "slip": "total_slip", "von Mises": "von_mises",
    "displacement": "displacement",
}  # fmt: skip
OF_FRICTION = ("traction", "slip")
ON_CONTACTS = ("pressure", "gap", *OF_FRICTION)


def to_pyvista(solution: Solution, step: int = -1) -> Foreign:
    """Bodies and contacts of a step as a ``pyvista.MultiBlock``.

    Parameters
    ----------
    solution : Solution
        What is converted.
    step : int
        Index into ``solution.steps``.

    Returns
    -------
    pyvista.MultiBlock
        Blocks ``bodies`` (one grid for each body) and ``contacts`` (for each contact the grids ``contactor`` and
        ``target``); quadratic cells stay quadratic. Points of bodies have displacement (n, 3) [length], stress (n, 6: xx
        yy zz xy yz zx) and von_mises (n,) [force per area]; points of contacts pressure, multiplier and gap (NaN where
        there is none), displacement, contact_force (of the mesh's point ``node``: points of that number repeat it), with
        friction traction, slip, total_slip, friction_status, friction_work and total_friction_work; cells status and
        side, as in ``contact_*.vtu``.

    Raises
    ------
    InputError
        Without PyVista, or where there is no such step.

    Examples
    --------
    >>> import abut
    >>> from abut.mesh import make
    >>> bar = abut.Model(
    ...     make.join({"bar": make.rectangle([0, 2], [0, 1], cells=[2, 1])}),
    ...     plane="stress",
    ...     solids=[abut.Solid("bar", abut.LinearElastic(100.0, 0.3))],
    ...     supports=[abut.Support("bar.left", x=0), abut.Support("bar.bottom", y=0)],
    ...     loads=[abut.Traction("bar.right", (1.0, 0.0))],
    ... )
    >>> data = abut.to_pyvista(abut.solve(bar))
    >>> float(data["bodies"]["bar"]["displacement"][:, 0].max().round(6))  # stress over stiffness, times the length
    0.02
    """
    checks.instance(solution, Solution, "to_pyvista", "a solution (abut.Solution)")
    pyvista = _pyvista()
    state = _step(solution, step)
    bodies = pyvista.MultiBlock()
    for name in solution.model.mesh.bodies:
        bodies.append(_grid(pyvista, _body(solution.model.mesh, name, state)), name)
    contacts = pyvista.MultiBlock()
    for contact in state.contacts:
        sides = pyvista.MultiBlock()
        for name, side in (("contactor", CONTACTOR), ("target", TARGET)):
            sides.append(_grid(pyvista, contact_grid(state, contact, (side,))), name)
        contacts.append(sides, contact.name)
    result = pyvista.MultiBlock()
    result.append(bodies, "bodies")
    result.append(contacts, "contacts")
    return result


def plot(
    solution: Solution, what: str = "pressure", step: int = -1, scale: float = 1.0, path: str | Path | None = None
) -> Foreign:
    """Show a solution in a window, or write it to a picture.

    Parameters
    ----------
    solution : Solution
        What is shown.
    what : str
        "pressure", "gap", with friction the size of the tangential "traction" or of the "slip" in all steps (on the
        contactors, bodies as ghosts); "von Mises" or "displacement" (on the bodies).
    step : int
        Index into ``solution.steps``.
    scale : float
        Factor of the displacements.
    path : str or Path, optional
        The picture file; without one a window opens.

    Returns
    -------
    pyvista.Plotter
        The plotter.

    Raises
    ------
    InputError
        Without PyVista, for an unknown quantity or step, for one of friction where no contact has any, and where the
        file cannot be written.
    """
    checks.instance(solution, Solution, "plot", "a solution (abut.Solution)")
    checks.choice(what, "plot: what", tuple(FIELDS))
    checks.finite(scale, "plot: scale")
    if path is not None:
        checks.path(path, "plot: path")
    pyvista = _pyvista()
    data = to_pyvista(solution, step)
    plotter = pyvista.Plotter(off_screen=path is not None, window_size=(1280, 860))
    plotter.background_color = "white"
    on_contacts = what in ON_CONTACTS
    rubbing = [c.name for c in _step(solution, step).contacts if what not in OF_FRICTION or c.friction is not None]
    if on_contacts and not rubbing:
        raise InputError(f"plot: what: {what!r} needs a contact with friction, and there is none")
    largest = _largest(data, what, _step(solution, step))
    colours = {
        "scalars": FIELDS[what],
        "cmap": "inferno" if what == "pressure" else "viridis",
        "clim": (0.0, largest) if largest > 0.0 else None,
        "scalar_bar_args": {"title": what, "color": "black", "vertical": True},
        "nan_color": "#cfd4da",
    }
    for body in data["bodies"]:
        mesh = _deformed(body, scale)
        if on_contacts:
            plotter.add_mesh(mesh, color="#aab6c4", opacity=0.25)
        else:
            plotter.add_mesh(mesh, **colours)
        plotter.add_mesh(mesh.extract_feature_edges(35), color="#333333", line_width=1)
    for sides in [data["contacts"][name] for name in rubbing] if on_contacts else ():
        plotter.add_mesh(_deformed(sides["contactor"], scale), line_width=6, lighting=False, **colours)
    if solution.model.dim == 2:
        plotter.view_xy()
    if path is None:
        plotter.show()
    else:
        _screenshot(plotter, Path(path))
    return plotter


def _screenshot(plotter: Foreign, path: Path) -> None:
    try:
        plotter.screenshot(path)
    except (OSError, ValueError) as error:
        raise InputError(
            f"cannot write the picture {path}: {error}; give a .png file in a folder that exists"
        ) from None


def _pyvista() -> Foreign:
    try:
        import pyvista
    except ImportError:
        raise InputError("pictures need PyVista, which is not installed: pip install 'abut[picture]'") from None
    return pyvista


def _step(solution: Solution, step: int) -> Step:
    count = len(solution.steps)
    if isinstance(step, bool) or not isinstance(step, int) or not -count <= step < count:
        raise InputError(f"step: expected an index into the {count} steps, {-count}..{count - 1}, got {step!r}")
    return solution.steps[step]


def _body(mesh: Mesh, name: str, step: Step) -> Grid:
    """The cells of a body over its own points."""
    parts = mesh.cells_of(name)
    nodes = mesh.nodes_of(name)
    number = np.full(len(mesh.points), -1)
    number[nodes] = np.arange(len(nodes))
    return Grid(
        mesh.points[nodes],
        tuple((kind, number[cells]) for kind, cells, _ in parts),
        {key: values[nodes] for key, values in point_fields(step).items()},
        {},
    )


def _grid(pyvista: Foreign, grid: Grid) -> Foreign:
    result = pyvista.UnstructuredGrid(
        np.concatenate([np.insert(nodes, 0, nodes.shape[1], axis=1).ravel() for _, nodes in grid.blocks]),
        np.concatenate([np.full(len(nodes), CELLS[kind].vtk, np.uint8) for kind, nodes in grid.blocks]),
        vectors(grid.points),
    )
    for name, values in grid.point_data.items():
        result.point_data[name] = values
    for name, values in grid.cell_data.items():
        result.cell_data[name] = values
    return result


def _deformed(grid: Foreign, scale: float) -> Foreign:
    """The grid as a surface of flat pieces, moved by its displacement."""
    surface = grid.extract_surface(nonlinear_subdivision=2, algorithm="dataset_surface")
    surface = surface if surface.n_cells else grid.copy()
    surface.points = surface.points + scale * surface.point_data["displacement"]
    return surface


def _largest(data: Foreign, what: str, step: Step) -> float:
    """The upper end of the colours; of pressures that of nodes which the target covers well enough."""
    if what == "pressure":
        return largest_pressure([step])
    grids = [sides["contactor"] for sides in data["contacts"]] if what in ON_CONTACTS else list(data["bodies"])
    largest = 0.0
    for grid in (each for each in grids if FIELDS[what] in each.point_data):
        values = np.asarray(grid.point_data[FIELDS[what]])
        sizes = np.linalg.norm(values, axis=1) if values.ndim == 2 else values
        largest = max(largest, float(np.nanmax(np.nan_to_num(sizes), initial=0.0)))
    return largest if math.isfinite(largest) else 0.0
