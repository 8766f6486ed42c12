"""Descriptions of the keys of a job file of what joins points, as ``abut.job.key_descriptions``."""

from __future__ import annotations

JOINING: dict[str, dict[str, str]] = {
    "CouplingTable": {
        "name": "a name of your choice, for loads on it and its results",
        "on": "name of the surface or node set whose points are coupled",
        "kind": "kinematic: the points follow the reference as a rigid body; distributing: the reference has their mean "
        "motion, and its force and moment are spread over them, which stiffens nothing",
        "reference": "point that translations, forces and moments refer to; left out: the mean of the points [length]",
        "follow": "kinematic: displacements in which the points follow; left out: all. In some only, kinematics finite "
        "needs rotations that are prescribed as 0",
        "weights": "distributing on a node set: weight of each point, in the order of their numbers; left out: all the "
        "same. On a surface the area counts",
        "radius": "points farther than this from the reference, undeformed, are left out; left out: all take part [length]",
        "axes": "local axes at each undeformed point, whose first, second and third direction x, y and z of follow are",
        "mirrors": "distributing, of half and quarter models: normals of the planes of symmetry, which the reference lies "
        "on; loads at it are those on the modelled part",
        "x": "translation of the reference point along x; left out: free [length]",
        "y": "translation of the reference point along y; left out: free [length]",
        "z": "translation of the reference point along z; left out: free [length]",
        "rx": "rotation about x; left out: free [radian]",
        "ry": "rotation about y; left out: free [radian]",
        "rz": "rotation about z (in 2D the only one); left out: free [radian]",
        "amplitudes": "of single components, { y = [...], rz = [...] }: pairs of time and factor; others follow amplitude",
        "supports": "node sets, surfaces or bodies that it holds: forces on their points are in forces.csv "
        "by these names, too",
    },
    "ConnectorTable": {
        "name": "a name of your choice, for results",
        "kind": "hinge: turns about its axis; slider: travels along it; cylindrical: both; universal: about axis and axis2; "
        "ball: turns all ways; slot: travels along the axis and turns all ways; between points: straight, plane, "
        "distance, mean-turn; in 2D no cylindrical, universal, ball, plane",
        "on": "name of the rigid body or coupling, whose motions and forces relative to to are reported; between points: of "
        "a surface or node set",
        "to": "another one, which the axis turns with; left out: the ground",
        "at": "where the joint is, undeformed; left out: the reference of on [length]",
        "axis": "direction of the axis, undeformed, of any length; none of ball, straight, plane, distance, nor in 2D of "
        "hinge and mean-turn",
        "axis2": "universal: axis on the side of on, perpendicular to axis",
        "limits2": "the same of the second free motion: the turn of cylindrical, turn2 of universal",
        "limits": "lower and upper limit of the free motion, which begins at 0; either may be inf [radian, or length]",
        "motion": "prescribed free motion [radian, or length]",
        "load": "moment or force along the free motion [force length, or force]",
        "stiffness": "of a spring along the free motion, free of force at 0 [force length / radian, or force/length]",
    },
    "SectorTable": {
        "side": "surface or node set: the side whose nodes move as their partners on the other one, turned by one sector",
        "other": "the other side, meshed alike",
        "sectors": "how many make up the whole turn, 2 or more",
        "axis": "direction of the axis, of any length; left out: z; none in 2D",
        "origin": "a point of the axis; left out: zero [length]",
    },
}
