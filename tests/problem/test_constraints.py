"""Equations: exact changes of variables, held against supports that do the same and against statics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

import abut
from abut.errors import InputError, SingularModelError
from abut.mesh.make import join, rectangle, ring
from abut.problem.elimination import eliminate
from models.constrained import EXACT, SOFT, at, equal


@pytest.mark.parametrize("seed", range(5))
def test_elimination_spans_the_solutions(seed: int) -> None:
    """Against dense linear algebra: rows @ y = values for every z, and as many z as the rank leaves."""
    rng = np.random.default_rng(seed)
    rows = rng.standard_normal((12, 30)) * (rng.random((12, 30)) < 0.2)
    rows[8:] = rng.standard_normal((4, 8)) @ rows[:8]  # repeated
    y = rng.standard_normal((30, 2))
    done = eliminate(sp.csr_matrix(rows), rows @ y, [str(i) for i in range(12)])
    free, prescribed = done.free, done.prescribed
    size = np.abs(rows).max()
    assert np.abs(rows @ free.toarray()).max() < 1e-11 * size
    assert np.abs(rows @ prescribed - rows @ y).max() < 1e-11 * size
    assert np.linalg.matrix_rank(free.toarray()) == free.shape[1] == 30 - np.linalg.matrix_rank(rows)


def test_elimination_follows_chains_and_names_contradictions() -> None:
    links = sp.csr_matrix(np.eye(6, 7) - np.eye(6, 7, 1))
    done = eliminate(links, np.arange(6.0)[:, None], list("abcdef"))
    free, prescribed = done.free, done.prescribed
    assert free.shape == (7, 1)
    assert np.ptp(free.toarray()) == 0.0
    assert np.abs(links @ prescribed - np.arange(6.0)[:, None]).max() < 1e-14
    around = sp.vstack([links, sp.csr_matrix(np.eye(7)[:1] - np.eye(7)[2:3])])
    eliminate(around, np.append(np.arange(6.0), 1.0)[:, None], list("abcdefg"))  # 0 + 1 = 1: repeated
    with pytest.raises(SingularModelError, match=r"^a, b and g contradict each other: no"):
        eliminate(around, np.append(np.arange(6.0), 1.1)[:, None], list("abcdefg"))


def bar(cell: str = "quad8", **options: object) -> abut.Model:
    mesh = join({"bar": rectangle((0, 2), (0, 1), (5, 3), cell)})
    held = [abut.Support("bar.left", x=0), abut.Support("bar.bottom", y=0)]
    return abut.Model(mesh, [abut.Solid("bar", SOFT)], held, plane="strain", **options)


def test_an_end_moved_through_one_node() -> None:
    """All nodes of an end equal to one, which is moved: the same as moving the end, also its total force."""
    model = bar()
    end = [int(n) for n in model.mesh.nodes_of("bar.right")]
    sets = {"handle": np.array(end[:1])}
    moved = replace(
        model,
        mesh=replace(model.mesh, node_sets=sets),
        supports=[*model.supports],
        equations=[equal((n, "x"), (end[0], "x")) for n in end[1:]],
    )
    moved = replace(moved, supports=[*model.supports, abut.Support("handle", x=0.01)])
    whole = replace(model, supports=[*model.supports, abut.Support("bar.right", x=0.01)])
    ours, theirs = abut.solve(moved).steps[-1], abut.solve(whole).steps[-1]
    assert np.abs(ours.displacement - theirs.displacement).max() < EXACT * 0.01
    assert ours.reactions["bar.left"] == pytest.approx(theirs.reactions["bar.left"], rel=EXACT)
    assert ours.reactions["handle"][0] == pytest.approx(theirs.reactions["bar.right"][0], rel=EXACT)
    assert np.abs(ours.reaction).max() < EXACT * abs(ours.reactions["bar.left"][0])


def test_a_mean_displacement() -> None:
    """The mean of an end with the weights of a uniform traction: uniform strain, nu = 0."""
    model = replace(bar("quad4"), solids=[abut.Solid("bar", abut.LinearElastic(1000.0, 0.0))])
    end = model.mesh.nodes_of("bar.right")
    height = model.mesh.points[end, 1]
    weight = np.where((height == 0.0) | (height == 1.0), 1 / 6, 1 / 3)
    mean = abut.Equation(tuple(abut.Term(int(n), "x", w) for n, w in zip(end, weight)), 0.02)
    ramp_down = abut.Amplitude(((0.5, 1.0), (1.0, -1.0)))
    model = replace(model, equations=[replace(mean, amplitude=ramp_down)], solve=abut.SolveOptions(times=(0.5, 1.0)))
    for step, sign in zip(abut.solve(model).steps, (1.0, -1.0)):
        assert np.abs(step.displacement[:, 0] - sign * 0.01 * model.mesh.points[:, 0]).max() < EXACT * 0.02
        assert step.reactions["bar.left"][0] == pytest.approx(-sign * 10.0, rel=EXACT)


@pytest.mark.parametrize("cell", ["quad4", "tri6", "quad9"])
def test_periodic_faces_give_uniform_strain(cell: str) -> None:
    """u(right) - u(left) = F L and the like on top and bottom, corners repeated: strain and stress are uniform."""
    mesh = join({"body": rectangle((0, 1), (0, 1), (4, 4), cell)})
    slope = np.array([[1e-3, 4e-4], [4e-4, -2e-3]])
    rng = np.random.default_rng(0)
    inside = (np.abs(mesh.points - 0.5) < 0.49).all(axis=1)
    corner = np.isin(np.arange(len(mesh.points)), np.concatenate([b.nodes[:, :4].ravel() for b in mesh.blocks]))
    if cell == "quad4":  # keep quadratic edges straight
        mesh = replace(
            mesh, points=mesh.points + 0.05 * (inside & corner)[:, None] * rng.uniform(-1, 1, mesh.points.shape)
        )
    equations = []
    for axis in (0, 1):
        for far in np.flatnonzero(mesh.points[:, axis] == 1.0):
            near = at(mesh, "body", *np.where(np.arange(2) == axis, 0.0, mesh.points[far]))
            equations += [equal((int(far), "xy"[a]), (near, "xy"[a]), slope[a, axis]) for a in (0, 1)]
    mesh = replace(mesh, node_sets={"origin": np.array([at(mesh, "body", 0.0, 0.0)])})
    model = abut.Model(
        mesh, [abut.Solid("body", SOFT)], [abut.Support("origin", x=0, y=0)], plane="strain", equations=equations
    )
    step = abut.solve(model).steps[-1]
    assert np.abs(step.displacement - mesh.points @ slope.T).max() < EXACT * 1e-3
    mu, lam = 1000.0 / 2.6, 1000.0 * 0.3 / (1.3 * 0.4)
    stress = 2 * mu * slope + lam * np.trace(slope) * np.eye(2)
    assert np.abs(step.stress[:, [0, 1, 3]] - [stress[0, 0], stress[1, 1], stress[0, 1]]).max() < EXACT


def test_a_hinge_is_a_symmetry_plane() -> None:
    """Two mirrored cantilevers, hinged together at one point: by symmetry that point keeps its x, and no force crosses
    along y; a support at the point of one of them does the same."""
    left = rectangle((0, 1), (0, 0.5), (4, 2), "quad8")
    right = rectangle((1, 2), (0, 0.5), (4, 2), "quad8")
    mesh = join({"left": left, "right": right})
    a, b = at(mesh, "left", 1.0, 0.5), at(mesh, "right", 1.0, 0.5)
    model = abut.Model(
        mesh, [abut.Solid("left", SOFT), abut.Solid("right", SOFT)],
        [abut.Support("left.left", x=0, y=0), abut.Support("right.right", x=0, y=0)],
        [abut.Pressure("left.top", 1.0), abut.Pressure("right.top", 1.0)],
        plane="strain", equations=[equal((a, "x"), (b, "x")), equal((a, "y"), (b, "y"))],
    )  # fmt: skip
    alone = join({"left": left})
    alone = replace(alone, node_sets={"hinge": np.array([at(alone, "left", 1.0, 0.5)])})
    half = abut.Model(
        alone, [abut.Solid("left", SOFT)],
        [abut.Support("left.left", x=0, y=0), abut.Support("hinge", x=0)], [abut.Pressure("left.top", 1.0)], plane="strain",
    )  # fmt: skip
    ours, theirs = abut.solve(model).displacement, abut.solve(half).displacement
    assert np.abs(ours[mesh.nodes_of("left")] - theirs).max() < EXACT * np.abs(theirs).max()
    assert abs(ours[a, 1]) > 0.1 * np.abs(theirs).max()


@pytest.mark.parametrize("with_contact", [False, True])
def test_an_oblique_equation_is_an_oblique_support(with_contact: bool) -> None:
    """n . u = 0 at every node of a plane that is turned by 30 degrees, also under contact."""
    turn = np.array([[np.cos(np.pi / 6), -0.5], [0.5, np.cos(np.pi / 6)]])
    parts = {"lower": rectangle((0, 1), (0, 1), (3, 2), "quad8"), "upper": rectangle((0, 1), (1, 2), (4, 2), "quad8")}
    mesh = join(parts if with_contact else {"lower": parts["lower"]})
    mesh = replace(mesh, points=mesh.points @ turn.T)
    last = "upper" if with_contact else "lower"
    model = abut.Model(
        mesh, [abut.Solid(body, SOFT) for body in mesh.bodies],
        [abut.Support(f"{body}.left", normal=0) for body in mesh.bodies], [abut.Pressure(f"{last}.top", 5.0)],
        [abut.Contact(contactor="lower.top", target="upper.bottom")] if with_contact else [], plane="strain",
    )  # fmt: skip
    normal = turn @ [0.0, -1.0]
    terms = [
        (abut.Term(int(n), "x", 2 * normal[0]), abut.Term(int(n), "y", 2 * normal[1]))
        for n in mesh.nodes_of("lower.bottom")
    ]
    ours = abut.solve(replace(model, equations=[abut.Equation(pair) for pair in terms])).steps[-1]
    theirs = abut.solve(replace(model, supports=[*model.supports, abut.Support("lower.bottom", normal=0)])).steps[-1]
    assert np.abs(ours.displacement - theirs.displacement).max() < EXACT * np.abs(theirs.displacement).max()
    assert ours.reaction == pytest.approx(theirs.reaction, rel=EXACT)
    if with_contact:
        assert np.nanmax(np.abs(ours.contacts[0].pressure / 5.0 - 1.0)) < 1e-9


def test_repeated_equations_do_no_harm_and_contradictions_are_named() -> None:
    model = bar(solve=abut.SolveOptions(linear="auto"))
    far = [int(n) for n in model.mesh.nodes_of("bar.right")]
    near = int(model.mesh.nodes_of("bar.left")[0])
    base = [equal((far[0], "x"), (far[1], "x")), equal((far[1], "x"), (far[2], "x"))]
    load = [abut.Traction("bar.right", (1.0, 0.0))]
    once = abut.solve(replace(model, equations=base, loads=load)).displacement
    twice = abut.solve(replace(model, equations=[*base, base[0], equal((far[2], "x"), (far[0], "x"))], loads=load))
    assert np.abs(once - twice.displacement).max() < EXACT * np.abs(once).max()
    with pytest.raises(SingularModelError, match=r"equations\[0\], equations\[1\] and equations\[2\] contradict"):
        abut.solve(replace(model, equations=[*base, equal((far[2], "x"), (far[0], "x"), 0.1)]))
    with pytest.raises(SingularModelError, match=r"equations\[0\] contradicts what is prescribed at its points"):
        abut.solve(replace(model, equations=[abut.Equation((abut.Term(near, "x", 1.0),), 0.1)]))
    by_multigrid = abut.solve(replace(model, equations=base, loads=load, solve=abut.SolveOptions(linear="amg")))
    assert np.abs(once - by_multigrid.displacement).max() < 1e-7 * np.abs(once).max()


def test_bodies_joined_by_equations_move_together() -> None:
    """A body that only equations tie to another is held; without one of them it can turn."""
    mesh = join({"a": rectangle((0, 1), (0, 1), (2, 2), "quad4"), "b": rectangle((1, 2), (0, 1), (2, 2), "quad4")})
    model = abut.Model(
        mesh, [abut.Solid("a", SOFT), abut.Solid("b", SOFT)], [abut.Support("a.left", x=0, y=0)],
        [abut.Traction("b.right", (0.0, 1.0))], plane="strain",
    )  # fmt: skip
    top = (at(mesh, "a", 1.0, 1.0), at(mesh, "b", 1.0, 1.0))
    low = (at(mesh, "a", 1.0, 0.0), at(mesh, "b", 1.0, 0.0))
    joint = [equal((p, c), (q, c)) for p, q in (top, low) for c in "xy"]
    assert abut.solve(replace(model, equations=joint)).converged
    with pytest.raises(SingularModelError, match="body 'b'"):
        abut.solve(replace(model, equations=joint[:2]))


def test_bad_equations_are_refused() -> None:
    with pytest.raises(InputError, match="no term"):
        abut.Equation(())
    with pytest.raises(InputError, match="expected one of x, y, z"):
        abut.Term(0, "w", 1.0)
    with pytest.raises(InputError, match="node set or a point"):
        abut.Term(0.5, "x", 1.0)  # type: ignore[arg-type]


@pytest.mark.parametrize("kind", ["plane", "space"])
def test_supports_in_cylindrical_axes(kind):
    """A sector of a thick ring from 20 to 80 degrees, its ends held around the axis, its bore widened: Lame's
    u = A r + B / r. Radial forces around the bore sum up to those of the pressure that does it."""
    sector = ring((1.0, 2.0), (20.0, 80.0), cells=(6, 8))
    young, poisson, widened = 1000.0, 0.3, 0.01
    axes = abut.Axes("cylindrical")
    model = abut.Model(
        join({"ring": sector}),
        [abut.Solid("ring", abut.LinearElastic(young, poisson))],
        [
            abut.Support("ring.start", y=0, axes=axes),
            abut.Support("ring.end", y=0, axes=axes),
            abut.Support("ring.inner", x=widened if kind == "plane" else "0.01", axes=axes),
        ],
        plane="strain",
    )
    solution = abut.solve(model)
    radius = np.linalg.norm(model.mesh.points, axis=1)
    outer = (1.0 - 2.0 * poisson) * radius + 4.0 / radius  # stress-free at r = 2
    exact = widened * outer / ((1.0 - 2.0 * poisson) + 4.0)
    moved = np.einsum("nij,nj->ni", axes.frames(model.mesh.points), solution.displacement)
    assert moved[:, 0] == pytest.approx(exact, rel=2e-4)  # quadratic cells, six through the wall
    assert np.abs(moved[:, 1]).max() < 1e-5 * widened
    assert "ring.inner" in solution.steps[-1].reactions
