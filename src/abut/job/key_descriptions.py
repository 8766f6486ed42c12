"""Descriptions of the keys of a job file, for the JSON Schema (editors show it) and the reference page.

A unit stands at the end in square brackets: force, length, mass, time and temperature are the user's own."""

from __future__ import annotations

from abut.job.joining_keys import JOINING
from abut.job.material_keys import OF_MATERIALS
from abut.job.passing_keys import PASSING
from abut.job.run_keys import RUN
from abut.types import Json

ANYWHERE = {  # keys that mean the same in every table
    "on": "name of the surface",
    "amplitude": "pairs of time and factor; linear between them, constant outside; left out: the load step's time, 0 to 1",
    "name": "a name of your choice, used in messages and results",
    "x": "displacement along x; left out: free [length]",
    "y": "displacement along y; left out: free [length]",
    "z": "displacement along z (3D only); left out: free [length]",
}

MEANINGS: dict[str, dict[str, str]] = {
    "JobFile": {
        "schema": "version of this format, always 1",
        "parameters": 'numbers by name, or expressions of those above; any value of the job may be a text "= ..." of them; '
        "abut run --set NAME=VALUE changes them",
        "fields": "values of result files, by the name that they have in expressions of supports and loads",
        "mesh": "where the mesh comes from: a file, or bodies made by abut",
        "model": "what kind of model it is",
        "materials": "materials by name",
        "solids": "the material of each body",
        "supports": "prescribed displacements",
        "loads": "pressures, tractions, forces and the like; each has a kind",
        "contacts": "pairs of surfaces that may touch, or are tied",
        "equations": "linear equations between displacements",
        "sectors": "cyclic symmetry: one of alike sectors is modelled",
        "rigid": "bodies that move as a whole",
        "couplings": "points that move with a reference point, which carries forces and moments",
        "connectors": "joints between reference points of rigid bodies and couplings: hinges, sliders and others",
        "preloads": "bolts that are tightened: sections of bodies whose sides are drawn together",
        "springs": "springs to the ground, between points, and beds under surfaces",
        "holds": "supports that come or go on the way",
        "removals": "bodies that go on the way, and may come back",
        "stops": "rigid planes that surfaces run against",
        "penetrations": "fluids under pressure that enter contacts wherever these are open",
        "rotations": "surfaces, node sets and bodies that turn about an axis; not with small kinematics",
        "probes": "points, lines and sets of nodes whose results are listed for every step",
        "steps": "parts of the time, one after the other, whose names stand for times",
        "start": "the steps of another job, with which this one begins",
        "frequencies": "natural frequencies of the assembly as it is loaded at the end of a step",
        "buckling": "linear buckling: factors of the stresses at the end of the last step; kinematics small",
        "harmonic": "steady vibrations under loads that go as a cosine, over frequency, from the modes of [frequencies]",
        "transient": "vibrations over time under loads that change quickly, from the modes of [frequencies]",
        "solve": "load steps, linear solver, iterations",
        "output": "where the results go, and which of them are written",
    },
    "MeshTable": {
        "file": "mesh file beside the job file (.msh, .vtu, or .inp, of which the mesh alone is read)",
        "bodies": "bodies meshed by abut, by name",
        "shells": "groups of surface cells in the file that are shells, by name",
        "beams": "groups of lines in the file that are beams, by name",
    },
    "ShellTable": {
        "thickness": "of the shell, > 0 [length]",
        "offset": "of the mesh from the middle of the shell along the normal, over the thickness: 0.5 on the positive side",
        "layers": "how thick layers are beside each other, from the negative side: each becomes a body, NAME-layer1 etc.",
        "membrane": "cells hinged at their nodes, which carry forces in the surface and no moments",
    },
    "BeamTable": {
        "widths": "of a rectangular section along its first direction and along the second, tangent x first, > 0 [length]",
        "direction": "near which the first direction lies",
        "offsets": "of the mesh from the middle of the section along both, over the widths (the diameter)",
        "radius": "of a round section, in place of widths, > 0 [length]",
        "wall": "thickness of the wall of a box or a pipe [length]; left out: solid",
    },
    "BodyTable": {"kind": "the generator; the further keys are its arguments"},
    "ModelTable": {
        "plane": "2D only: plane strain, plane stress, or axisymmetric (x is the radius, y the axis)",
        "kinematics": "small displacements and strains, or finite ones: balance of forces in the deformed configuration; "
        "small-strain: linear bodies whose strains and turns are small, contact where they have moved to, however far",
    },
    **OF_MATERIALS,
    "SolidTable": {
        "body": "name of the body in the mesh; one table may leave it out: every body that no other table names",
        "material": "name of the material",
        "temperature": "uniform change of temperature that strains the body [temperature]",
        "initial_stress": "stress that the undeformed body has, xx yy zz xy (3D: xx yy zz xy yz zx), numbers or expressions "
        "of position; axisymmetric: radial, axial, hoop, shear [force per area]",
        "integration": "how elements integrate their stiffness: full, reduced, b-bar or mixed; the last two do not lock "
        "near Poisson's ratio 0.5 (b-bar: F-bar with kinematics finite; mixed: pressures of each cell's own, tet10: shared "
        "at corners); auto: full, but where cells would lock b-bar (quad4, hex8), mixed, or in plastic bodies reduced "
        "(quad8, hex20)",
    },
    "SupportTable": {
        "on": "name of the surface or node set",
        "x": "displacement along x, a number or an expression; left out: free [length]",
        "y": "displacement along y, a number or an expression; left out: free [length]",
        "z": "displacement along z (3D only), a number or an expression; left out: free [length]",
        "rx": "turn about x of nodes of shells and beams, a number or an expression; left out: free [radian]",
        "ry": "turn about y of nodes of shells and beams, a number or an expression; left out: free [radian]",
        "rz": "turn about z of nodes of shells and beams, a number or an expression; left out: free [radian]",
        "normal": "displacement along the surface's own outward normal, instead of x, y, z [length]",
        "axes": "local axes, along whose first, second and third direction x, y and z then are, at each undeformed node",
    },
    "AxesTable": {
        "kind": "rectangular: the same everywhere; cylindrical: radial, around the axis, along it; spherical: radial, east, "
        "north; in 2D both are radial and around the origin",
        "origin": "a point on the axis, or the centre; left out: the origin [length]",
        "axis": "direction of the axis, in 3D; left out: z",
        "x": "rectangular: first direction; left out: x",
        "xy": "rectangular, 3D: a vector in the plane of the first two, on the side of the second; left out: y",
    },
    "PressureTable": {
        "kind": "pressure on a surface",
        "value": "positive into the body, a number or an expression [force/length^2]",
        "follows": "but for small kinematics: along the normal and on the area of the deformed surface, or (false) of the "
        "undeformed one, as a dead load; the other loads are dead",
    },
    "TractionTable": {
        "kind": "traction on a surface",
        "value": "vector, a number or an expression for each axis [force/length^2]",
        "axes": "local axes, along whose directions the components are, at each undeformed point",
    },
    "ForceTable": {
        "kind": "total force, spread evenly over a surface, or at the reference of a rigid body or coupling",
        "on": "name of the surface, rigid body or coupling",
        "value": "vector; plane models: per unit thickness, axisymmetric: of the full circumference [force]",
        "bearing": "of a surface such as a bore: not evenly, but as a pin brings it, a pressure on the half that the force "
        "presses on, over the cosine of the angle",
    },
    "MomentTable": {
        "kind": "moment on a rigid body or coupling, about axes that keep their direction",
        "on": "name of the rigid body or coupling",
        "value": "three components, in 2D one: [500]; plane models: per unit thickness [force*length]",
    },
    "GravityTable": {
        "kind": "acceleration that acts on the density",
        "value": "vector [length/time^2]",
        "on": "name of the body; left out: all bodies",
    },
    "CentrifugalTable": {
        "kind": "force of a rotation on the density, with distances from the axis of the undeformed bodies",
        "speed": "angular speed [radian/time]",
        "axis": "direction of the axis; left out in 2D (z; axisymmetric: y)",
        "through": "a point of the axis; left out: the origin [length]",
        "on": "name of the body; left out: all bodies",
        "amplitude": "of the force: the square of that of the speed",
    },
    "MidForceTable": {
        "axes": "local axes, along whose directions the components are, at each undeformed point",
        "kind": "the same force at each node of a set",
        "on": "name of the node set or surface",
        "value": "vector at each node; plane models: per unit thickness, axisymmetric: of the full circumference [force]",
        "moment": "vector at each node of shells and beams [force length]",
    },
    "TemperatureTable": {
        "kind": "change of temperature, which strains bodies by their expansion",
        "on": "name of the node set or body",
        "value": "change at the nodes, a number or an expression, adds to that of the solid [temperature]",
    },
    "EquationTable": {
        "terms": "terms of the sum that is prescribed",
        "value": "what the sum of coefficient times displacement equals [length]",
        "supports": "node sets, surfaces or bodies that it supports: its forces are in forces.csv by these names",
    },
    "TermTable": {
        "on": "node set of one node, or a point's number",
        "component": "axis of the displacement",
        "coefficient": "its factor in the sum",
    },
    "RotationTable": {
        "on": "name of the surface, node set or body, all of whose points turn",
        "angle": "counterclockwise seen against the axis; follows the amplitude [radians]",
        "centre": "a point of the axis [length]",
        "axis": "direction of the axis, of any length; 3D only",
    },
    "RigidTable": {
        "body": "name of the body in the mesh; it needs no solid",
        "reference": "point that translations and moments refer to; left out: the body's centre [length]",
        "x": "translation of the reference point along x; left out: free [length]",
        "y": "translation of the reference point along y; left out: free [length]",
        "z": "translation of the reference point along z; left out: free [length]",
        "rx": "rotation about x, small; with kinematics finite a component of the rotation vector; left out: free [radian]",
        "ry": "the same about y; left out: free [radian]",
        "rz": "the same about z (in 2D the only one); left out: free [radian]",
        "amplitudes": "of single components, { y = [...], rz = [...] }: pairs of time and factor; others follow amplitude",
        "density": "of its cells, for frequencies and vibrations [mass/volume]",
    },
    **JOINING,
    "SpringTable": {
        "on": "name of the surface or node set",
        "to": "node set at the other end, of as many nodes; left out: the ground",
        "x": "stiffness along x of the whole, or pairs of displacement and force; linear between, and on beyond "
        "[force/length]",
        "y": "the same along y [force/length]",
        "z": "the same along z [force/length]",
        "normal": "the same along the outward normal of a surface: positive displacements press the bed [force/length]",
        "point": "with along: a point fixed in space, at the other end of springs from every node of on [length]",
        "along": "with to or point: the same along the line between both ends, of the lengthening [force/length]",
        "per_area": "of a surface: all these per area (force/length^3, force/length^2)",
        "weak": "only there to keep loose parts in place: the certificate judges its force",
        "dashpot": "a dashpot: x to along are of speeds over the time of the run [force time/length], tables of speed and "
        "force",
    },
    **PASSING,
    "StopTable": {
        "direction": "of the motion that is stopped, of any length; axisymmetric: along the axis",
        "distance": "from where the surface reaches farthest to the plane, 0 or more [length]",
        "name": "of its contact and its body, for results; left out: stop and the name of the surface",
    },
    "PenetrationTable": {
        "contact": "name of the contact, of which both surfaces feel the fluid wherever it gets",
        "source": "where the fluid comes from: a surface or node set that meets one of the contact's sides, or a point, "
        "whose nearest node counts",
        "value": "pressure of the fluid, > 0; it gets through what is open, and what is pressed by less [force/length^2]",
        "name": "a name of your choice, for results; left out: that of the contact",
    },
    "PreloadTable": {
        "name": "a name of your choice, used in messages and results",
        "body": "name of the body, which abut cuts open at the cells next to a plane",
        "point": "a point of the plane, with normal; left out: the middle of the body's thinnest part, away from contacts "
        "[length]",
        "normal": "direction of the tension, of any length; left out: along the body, or across the surface",
        "surface": "in place of body: a surface between the cells of a body, all the way through",
        "force": "tension of what is modelled (half of it for half a bolt; axisymmetric: of the full circumference) [force]",
        "shortening": "in place of force: how far the two sides are drawn over each other [length]",
        "lock": "time from which on the shortening stays what the force has made of it; left out: never",
    },
    "ContactTable": {
        "name": "a name of your choice; left out: both surfaces, A-B",
        "surfaces": "the two sides, [A, B], each a surface or body, or a list of them: abut chooses which one is the "
        "contactor, and says so; forces are those on A",
        "contactor": "in place of surfaces, with target: the side that carries the pressure (slave), whatever abut would "
        "choose",
        "target": "the side opposite (master), or a list, of which the nearest counts everywhere",
        "kind": "contact; tied in all directions; bilateral: never opens, slides freely",
        "pressure": "pressure space; auto is dual along the edge of contact and P1 inside, ties and kinematics finite take "
        "P1 or P2",
        "law": "complementarity is exact; the constraint function smooths the edge of contact and that of stick; a table "
        "of points is soft contact, without friction",
        "epsilon": "smoothing of the constraint function, over the square of a reference pressure (of friction: its root)",
        "method": "node-to-segment methods are for comparison only",
        "integration": "quadrature on segments",
        "offset": "added to the gap; negative: interference [length]",
        "auto": "contact detection: find the pairs of bodies whose facets face each other; with kinematics finite every two "
        "bodies, and each with itself",
        "bodies": "with auto: look at these bodies only; left out: all of them",
        "reach": "with auto: the largest gap; left out: half the sum of the two facets' sizes [length]",
        "friction": "Coulomb's coefficient, a number or an expression, or pairs of pressure and coefficient (linear "
        'between, constant outside), or "rough" where nothing slips; left out: none',
        "friction_amplitude": "pairs of time (0 to 1) and factor of the coefficient; left out: it is constant",
        "geometry": "curved: gaps are those between the smooth surfaces for which flat facets stand; faceted: those between "
        "the facets; flat surfaces do not differ",
        "adjust": "initial gaps and overlaps up to this size count as zero, before the offset is added [length]",
        "since": "time from which on it acts; a tie holds the surfaces together as they are then",
        "until": "time up to which it acts; left out: to the end",
        "released": "time at which the forces that it had then are gone, in a straight line; left out: at once",
    },
    "OverclosureTable": {
        "points": "pairs of overclosure [length] and pressure [force per area] that increase from pressure 0 on; linear "
        "between, and on with the last slope",
    },
    "IntegrationTable": {
        "rule": "Gauss points, or Newton-Cotes points as in the paper",
        "points": "points for each direction of a segment; auto: as many as make it exact",
    },
    **RUN,
}


def meaning(table: str, key: str) -> str:
    """What ``key`` of ``table`` (the name of its record in ``abut.job.schema``) means; empty where nobody said."""
    return MEANINGS.get(table, {}).get(key) or ANYWHERE.get(key, "")


def describe(schema: Json, root: str) -> Json:
    """The JSON Schema with the meaning of every key as its description, in place; ``root``: name of the whole record."""
    for name, table in {root: schema, **schema["$defs"]}.items():
        for key, entry in table.get("properties", {}).items():
            if text := meaning(name, key):
                entry["description"] = text
    return schema
