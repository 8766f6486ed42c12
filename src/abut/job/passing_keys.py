"""Descriptions of the keys of a job file: what comes or goes on the way."""

from __future__ import annotations

PASSING: dict[str, dict[str, str]] = {
    "HoldTable": {
        "on": "name of the surface, node set or body",
        "name": "for results; left out: that of on",
        "x": "displacement along x, that of the undeformed mesh; stay: wherever it is at since; left out: free [length]",
        "y": "the same along y [length]",
        "z": "the same along z [length]",
        "since": "time from which on it acts",
        "reached": "time at which displacements are what is prescribed; left out: until, or the end",
        "until": "time up to which it acts; left out: to the end",
        "released": "time at which its force is gone; left out: the end",
        "amplitude": "of x, y, z over time; left out: from 0 at since to 1 at reached",
    },
    "RemovalTable": {
        "body": "name of the body, which deforms",
        "until": "time up to which it is there; 0: it is not there at the start",
        "released": "time at which the forces that it exerts are gone; left out: at once",
        "since": "time from which on it is there again, without stress, where its nodes are then; left out: never",
        "strained": "true: it is back as it was laid out, strained by all the displacement of its nodes",
    },
}
