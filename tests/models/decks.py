"""Small decks that tests put together, and how they solve them."""

import abut
from abut.job.load import load_job

MESH = """*NODE, NSET=ALL
1, 0,0,0
2, 1,0,0
3, 1,1,0
4, 0,1,0
5, 0,0,1
6, 1,0,1
7, 1,1,1
8, 0,1,1
11, 0,0,1
12, 1,0,1
13, 1,1,1
14, 0,1,1
15, 0,0,2
16, 1,0,2
17, 1,1,2
18, 0,1,2
*ELEMENT, TYPE=C3D8, ELSET=LOW
1, 1,2,3,4,5,6,7,8
*ELEMENT, TYPE=C3D8, ELSET=HIGH
2, 11,12,13,14,15,16,17,18
"""
BRICKS = (
    MESH
    + """*ELSET, ELSET=EALL
LOW, HIGH
*NSET, NSET=BOTTOM, GENERATE
1, 4
*NSET, NSET=TOP, GENERATE
15, 18
*SURFACE, NAME=MASTER
1, S2
*SURFACE, NAME=SLAVE
2, S1
*MATERIAL, NAME=EL
*ELASTIC
1000., 0.
*DENSITY
2.
*EXPANSION
1.E-3
*SOLID SECTION, ELSET=EALL, MATERIAL=EL
"""
)
PAIR = """*SURFACE INTERACTION, NAME=I
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD
*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE
SLAVE, MASTER
"""
HELD = """*BOUNDARY
BOTTOM, 1, 3
ALL, 1, 2
"""
PUSH = """*STEP
*STATIC
*DLOAD
2, P2, 10.
*NODE PRINT, NSET=ALL
U
*END STEP
"""


def step(*lines, card="*STATIC"):
    return "\n".join(["*STEP", card, *lines, "*END STEP"]) + "\n"


def write(folder, text, name="deck.inp"):
    path = folder / name
    path.write_text(text)
    return path


def load(folder, text, *ignore):
    return load_job(write(folder, text), ignore=ignore)


def solve(folder, text, *ignore):
    solution = abut.solve(load(folder, text, *ignore).model)
    assert solution.converged
    return solution
