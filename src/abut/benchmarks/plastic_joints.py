"""Joints of metal that yields: a press fit pulled out, a lug let go, a bolted stack pulled apart."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from abut.analysis import solve
from abut.benchmarks.preloads import BOLT, FORCE, LENGTH, SLEEVE, YOUNG, sleeve
from abut.benchmarks.record import Benchmark, Reference
from abut.materials.elastic import LinearElastic
from abut.materials.plastic import Plastic
from abut.mesh.make import join, rectangle, ring
from abut.mesh.mesh import Mesh
from abut.model import Amplitude, Contact, Equation, Force, Model, NodalForce, Solid, SolveOptions, Support, Term
from abut.solution import Solution, Step
from abut.types import Array

YIELD, HARDENING, PULLED = 110.0, 21e3, 9000.0  # of the bolt; what pulls the stack apart
SPRINGS = (
    "two springs, the sleeve's E A / L = 1.68e6 and the bolt's 4.2e5, which falls to an eleventh from 11 000 N on "
    "(E H / (E + H))"
)
UNIFORM = "stresses are uniform; what is locked gives a millionth"


def bolt_forces() -> tuple[float, float, float]:
    """Of the bolt when the stack is pulled by PULLED, and when it is let go; and how far the head has moved at the end."""
    stiff, around = YOUNG * BOLT / LENGTH, YOUNG * SLEEVE / LENGTH
    soft = stiff * HARDENING / (YOUNG + HARDENING)
    first = (YIELD * BOLT - FORCE) / stiff  # the head's way to first yield
    way = first + (PULLED - (stiff + around) * first) / (soft + around)
    pulled = YIELD * BOLT + soft * (way - first)
    back = PULLED / (stiff + around)
    return pulled, pulled - stiff * back, way - back


def _at(solution: Solution, time: float) -> Step:
    """The step that ends at a time."""
    return next(step for step in solution.steps if abs(step.factor - time) < 1e-9)


def _stack() -> Benchmark:
    there_and_back = Amplitude(((0.5, 0.0), (0.75, 1.0), (1.0, 0.0)))

    def model(level: int) -> Model:
        whole = sleeve("small", PULLED, cells=2**level)
        bolt = Solid("bolt", Plastic(YOUNG, 0.0, YIELD, HARDENING))
        return replace(
            whole,
            solids=[bolt, *(solid for solid in whole.solids if solid.body != "bolt")],
            loads=[replace(load, amplitude=there_and_back) for load in whole.loads],
            solve=SolveOptions(steps=8),
        )

    def measure(solution: Solution) -> dict[str, float]:
        locked, pulled, last = (_at(solution, time) for time in (0.5, 0.75, 1.0))
        carried = next(contact for contact in last.contacts if contact.name == "sleeve")
        moved = [float(step.rigid["head"].displacement[1]) for step in (locked, last)]
        return {
            "tension when pulled": pulled.preloads["bolt"].tension,
            "tension at the end": last.preloads["bolt"].tension,
            "force on the sleeve at the end": abs(float(carried.force[1])),
            "way of the head": moved[1] - moved[0],
        }

    pulled, left, way = bolt_forces()
    return Benchmark(
        "plastic-stack",
        "bolt in a sleeve, tightened to 10 000 N, locked, pulled apart by 9000 N, beyond its yield, and let go",
        model,
        measure,
        {
            "tension when pulled": Reference(pulled, 1e-5, SPRINGS, UNIFORM),
            "tension at the end": Reference(left, 1e-5, SPRINGS, UNIFORM),
            "force on the sleeve at the end": Reference(left, 1e-5, SPRINGS, UNIFORM),
            "way of the head": Reference(way, 1e-4, SPRINGS, UNIFORM),
        },
    )


BORE, RIM, HIGH, FRICTION = 50.0, 100.0, 5.0, 0.1  # of the hub
PULL = 0.2  # how far the shaft is pulled; shear of the hub takes .01 of it
TWO_EQUATIONS = (
    "elastic shaft of radius 50, hub to 100, yield stress 300, coefficient .1: equilibrium along the radius and along the "
    "axis alone, von Mises, 120 quadratic cells"
)


def _alike(mesh: Mesh) -> list[Equation]:
    """Both ends of the hub move alike, as those of a slice of a long one."""
    low, high = (mesh.nodes_of(f"hub.{end}") for end in ("bottom", "top"))
    low, high = (nodes[np.argsort(mesh.points[nodes, 0])] for nodes in (low, high))
    held = mesh.nodes_of("hub.right")  # along the axis
    return [
        Equation((Term(int(above), axis, 1.0), Term(int(below), axis, -1.0)))
        for below, above in zip(low, high, strict=True)
        for axis in ("x", "y")
        if axis == "x" or below not in held
    ]


def _pulled_out(interference: float, pressure: float) -> Benchmark:
    """A slice of a long fit, whose hub is held by its rim; the shear of friction makes it yield a little more."""

    def model(level: int) -> Model:
        n = 2**level
        parts = {
            "shaft": rectangle((0.0, BORE), (0.0, HIGH), (4 * n, 1), "quad8"),
            "hub": rectangle((BORE, RIM), (0.0, HIGH), (12 * n, 1), "quad8"),
        }
        mesh = join(parts)
        fitted, late = Amplitude(((0.0, 0.0), (0.5, 1.0))), Amplitude(((0.5, 0.0), (1.0, 1.0)))
        ends = [Support(f"shaft.{end}", y=PULL, amplitude=late) for end in ("bottom", "top")]
        return Model(
            mesh,
            [Solid("shaft", LinearElastic(210e3, 0.3)), Solid("hub", Plastic(210e3, 0.3, 300.0))],
            [*ends, Support("hub.right", y=0)],
            contacts=[Contact("hub.left", "shaft.right", offset=-interference, amplitude=fitted, friction=FRICTION)],
            plane="axisymmetric",
            equations=_alike(mesh),
            solve=SolveOptions(steps=10),
        )

    def measure(solution: Solution) -> dict[str, float]:
        contact, last, area = solution.contacts[0], solution.steps[-1], 2.0 * np.pi * BORE * HIGH
        pull = sum(float(last.reactions[f"shaft.{end}"][1]) for end in ("bottom", "top"))
        pressed = float(contact.force_by_area)
        return {
            "pressure while pulled": pressed / area,
            "pull over the area": pull / area,
            "pull over coefficient and pressing force": pull / (FRICTION * pressed),
        }

    reason = "quadratic cells, 12 through the wall; flow depends on the way, in 10 steps here and 40 there"
    return Benchmark(
        f"plastic-press-fit-pulled-{interference:g}",
        f"press fit that yields, radial interference {interference:g}, pulled out against friction",
        model,
        measure,
        {
            "pressure while pulled": Reference(pressure, 5e-3, TWO_EQUATIONS, reason),
            "pull over the area": Reference(FRICTION * pressure, 5e-3, TWO_EQUATIONS, reason),
            "pull over coefficient and pressing force": Reference(1.0, 1e-9, "Coulomb's law", "rounding"),
        },
    )


HOLE, EYE, SHANK, PLAY, PINNED = 10.0, 22.0, 44.0, 0.02, 2500.0  # of half a lug; the force of the pin
STEEL = LinearElastic(210e3, 0.3)
LET_GO = "what is there under load, less what an elastic lug does under the pin's forces"
NEVER = 1e9  # a yield stress: the same cells as those of metal
NOT_BACK = "unloading is elastic: nothing yields back"


def _lug(around: int, through: int) -> Mesh:
    """Half of a lug by its plane of symmetry y = 0: round about the hole, with a shank toward -x that is as wide."""
    polar = rectangle((0.0, 1.0), (0.0, 180.0), (through, around), "quad8")
    share, angle = polar.points[:, 0] ** 1.3, polar.points[:, 1]
    turn = np.deg2rad(angle)
    along = np.interp(angle, [90.0, 150.0], [0.0, -SHANK])
    rim = np.column_stack(
        [np.where(angle <= 90.0, EYE * np.cos(turn), along),
         np.where(angle <= 90.0, EYE * np.sin(turn), np.interp(angle, [150.0, 180.0], [EYE, 0.0]))]
    )  # fmt: skip
    hole = HOLE * np.column_stack([np.cos(turn), np.sin(turn)])
    points = hole + share[:, None] * (rim - hole)
    facets, middle = polar.surfaces["right"], 180.0 * (np.arange(around) + 0.5) / around
    names = {"hole": polar.surfaces["left"], "rim": facets[middle < 150.0], "shank": facets[middle > 150.0]}
    names |= {"front": polar.surfaces["bottom"], "back": polar.surfaces["top"]}
    return replace(polar, points=points, surfaces=names)


def _pinned(level: int) -> Model:
    n = 2**level
    half = ring((0.2 * HOLE, HOLE - PLAY), (0.0, 180.0), (PLAY, 0.0), (5 * n, 30 * n))
    there_and_back = Amplitude(((0.0, 0.0), (0.5, 1.0), (1.0, 0.0)))
    symmetry = [Support(f"{body}.{line}", y=0) for body, line in SYMMETRY]
    return Model(
        join({"lug": _lug(24 * n, 8 * n), "pin": half}),
        [Solid("lug", Plastic(STEEL.young, STEEL.poisson, 300.0, 1000.0)), Solid("pin", STEEL)],
        [Support("lug.shank", x=0), *symmetry],
        [Force("pin.inner", (PINNED, 0.0), there_and_back)],
        [Contact("lug.hole", "pin.outer")],
        plane="strain",
        solve=SolveOptions(steps=10),
    )


SYMMETRY = (("lug", "front"), ("lug", "back"), ("pin", "start"), ("pin", "end"))


def _elastic(whole: Solution) -> Solution:
    """The lug without yield under the forces that the contact puts on its hole at half time; the pin is taken away."""
    model, contact = whole.model, _at(whole, 0.5).contacts[0]
    mesh, forces = model.mesh, np.zeros_like(model.mesh.points)
    forces[contact.contactor.node_ids] += contact.contactor_forces
    forces[contact.target.node_ids] += contact.target_forces
    hole = mesh.nodes_of("lug.hole")
    sets = {f"at {node}": np.array([node]) for node in hole}
    return solve(
        replace(
            model,
            mesh=replace(mesh, node_sets=sets),
            solids=[Solid("lug", Plastic(STEEL.young, STEEL.poisson, NEVER)), Solid("pin", STEEL)],
            supports=[*model.supports, Support("pin.start", x=0)],
            loads=[NodalForce(f"at {node}", tuple(forces[node])) for node in hole],
            contacts=(),
            solve=SolveOptions(),
        )
    )


def _oval(mesh: Mesh, moved: Array) -> tuple[float, float]:
    """How much longer along the load and how much wider across it the hole is."""
    front, back, top = (
        int(np.argmin(np.linalg.norm(mesh.points - (HOLE * np.array(at)), axis=1)))
        for at in ((1.0, 0.0), (-1.0, 0.0), (0.0, 1.0))
    )
    return float(moved[front, 0] - moved[back, 0]), float(2.0 * moved[top, 1])


def _let_go() -> Benchmark:
    def measure(solution: Solution) -> dict[str, float]:
        loaded, last, mesh = _at(solution, 0.5), solution.steps[-1], solution.model.mesh
        elastic = _elastic(solution).displacement
        left = _oval(mesh, last.displacement)
        foreseen = _oval(mesh, loaded.displacement - elastic)
        lines = [float(last.reactions[f"lug.{line}"][1]) for line in ("front", "back")]
        once = float(np.abs(loaded.reactions["lug.front"]).max())
        nodes = mesh.nodes_of("lug")
        off = loaded.displacement[nodes] - elastic[nodes] - last.displacement[nodes]
        return {
            "longer along the load, over what is foreseen": left[0] / foreseen[0],
            "wider across it, over what is foreseen": left[1] / foreseen[1],
            "elsewhere": float(np.abs(off).max()) / left[0],
            "forces across the plane of symmetry": sum(lines) / once,
        }

    return Benchmark(
        "plastic-lug",
        "lug and pin loaded beyond yield and let go: an oval hole, residual stresses",
        _pinned,
        measure,
        {
            "longer along the load, over what is foreseen": Reference(1.0, 1e-9, LET_GO, NOT_BACK),
            "wider across it, over what is foreseen": Reference(1.0, 1e-9, LET_GO, NOT_BACK),
            "elsewhere": Reference(0.0, 1e-9, f"{LET_GO}, at all nodes, over the hole's lengthening", NOT_BACK),
            "forces across the plane of symmetry": Reference(
                0.0, 1e-9, "balance of half the lug, over the force across its front under load", "rounding"
            ),
        },
    )


BENCHMARKS = (_stack(), *(_pulled_out(*pair) for pair in ((0.15, 205.926), (0.30, 238.059))), _let_go())
