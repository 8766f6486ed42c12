"""Geometry and mesh of the pin-lug example (needs the gmsh package; the mesh is committed, so running the job does not).

A quarter of a lug with a round head and of its pin: symmetric about y = 0 (the load acts along x) and about the middle of
the thickness, z = 0. Units: mm. The pin is smaller than the hole by 0.1 in radius and already touches it at x > 0.
"""

from __future__ import annotations

from pathlib import Path

import gmsh

HOLE, PIN, HEAD, HALF_THICKNESS, SHANK, OVERHANG = 10.0, 9.9, 22.0, 8.0, 45.0, 6.0
FINE, COARSE = 0.72, 3.5


def surfaces_where(body: int, test) -> list[int]:
    """Surfaces of a volume for whose bounding box the test holds."""
    found = []
    for _, tag in gmsh.model.getBoundary([(3, body)], oriented=False):
        if test(*gmsh.model.getBoundingBox(2, tag)):
            found.append(tag)
    return found


def main() -> None:
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add("pin-lug")
    occ = gmsh.model.occ
    head = occ.addCylinder(0, 0, 0, 0, 0, HALF_THICKNESS, HEAD)
    shank = occ.addBox(-SHANK, -HEAD, 0, SHANK, 2 * HEAD, HALF_THICKNESS)
    hole = occ.addCylinder(0, 0, 0, 0, 0, HALF_THICKNESS, HOLE)
    lug, _ = occ.fuse([(3, head)], [(3, shank)])
    lug, _ = occ.cut(lug, [(3, hole)])
    lug, _ = occ.cut(lug, [(3, occ.addBox(-200, -200, -1, 400, 200, 100))])
    shift = HOLE - PIN  # touching at x > 0
    pin = occ.addCylinder(shift, 0, 0, 0, 0, HALF_THICKNESS + OVERHANG, PIN)
    pin, _ = occ.cut([(3, pin)], [(3, occ.addBox(-200, -200, -1, 400, 200, 100))])
    # Only the part of the pin within the lug and a little beyond can touch: cut its surface there.
    disc = occ.addDisk(shift, 0, HALF_THICKNESS + 1.0, PIN, PIN)
    occ.fragment(pin, [(2, disc)])
    occ.synchronize()
    volumes = [tag for _, tag in gmsh.model.getEntities(3)]
    lug_tag = max(volumes, key=lambda t: occ.getMass(3, t))
    pins = [t for t in volumes if t != lug_tag]
    e = 1e-3
    names: dict[str, list[int]] = {
        "hole": surfaces_where(lug_tag, lambda a, b, c, d, f, g: abs(a + HOLE) < e and abs(d - HOLE) < e and g - c > 1),
        "lug_end": surfaces_where(lug_tag, lambda a, b, c, d, f, g: abs(d + SHANK) < e),
        "symmetry_lug": surfaces_where(lug_tag, lambda a, b, c, d, f, g: abs(f) < e),
        "mid_lug": surfaces_where(lug_tag, lambda a, b, c, d, f, g: abs(g) < e),
    }
    for name, test in {
        "pin_contact": lambda a, b, c, d, f, g: f - b > 1 and c < e and g > HALF_THICKNESS,
        "pin_end": lambda a, b, c, d, f, g: c > HALF_THICKNESS + OVERHANG - e,
        "symmetry_pin": lambda a, b, c, d, f, g: abs(f) < e,
        "mid_pin": lambda a, b, c, d, f, g: abs(g) < e,
    }.items():
        names[name] = [tag for body in pins for tag in surfaces_where(body, test)]
    gmsh.model.addPhysicalGroup(3, [lug_tag], name="lug")
    gmsh.model.addPhysicalGroup(3, pins, name="pin")
    for name, tags in names.items():
        assert tags, f"no surface found for {name}"
        gmsh.model.addPhysicalGroup(2, tags, name=name)
    # Fine where the pin presses: around the hole at x > 0.
    field = gmsh.model.mesh.field
    near = field.add("Distance")
    field.setNumbers(near, "SurfacesList", names["hole"] + names["pin_contact"])
    size = field.add("MathEval")
    field.setString(size, "F", f"{FINE} + 0.22 * F{near} + 0.12 * Max(0, 4 - x)")
    limit = field.add("MathEval")
    field.setString(limit, "F", f"{COARSE}")
    both = field.add("Min")
    field.setNumbers(both, "FieldsList", [size, limit])
    field.setAsBackgroundMesh(both)
    for option in ("MeshSizeFromPoints", "MeshSizeFromCurvature", "MeshSizeExtendFromBoundary"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)
    gmsh.option.setNumber("Mesh.ElementOrder", 2)
    gmsh.option.setNumber("Mesh.HighOrderOptimize", 1)
    gmsh.option.setNumber("Mesh.Binary", 1)
    gmsh.model.mesh.generate(3)
    target = Path(__file__).with_name("pin-lug.msh")
    gmsh.write(str(target))
    nodes = len(gmsh.model.mesh.getNodes()[0])
    print(f"{nodes} nodes, {3 * nodes} displacements, {target.stat().st_size / 1e6:.1f} MB")
    gmsh.finalize()


if __name__ == "__main__":
    main()
