"""FEBio's contact cases (.feb, specification 3.0 and 4.0) as models of abut.

Read: solid modules that are static; hex8, hex20, hex27, tet4, tet10, penta6, penta15; neo-Hookean (energy with (ln J)^2)
and isotropic elastic materials, rigid bodies; sliding and tied contact of all kinds, which differ in how FEBio solves them;
fixed and prescribed displacements, rigid ones; pressures, nodal forces; load curves, linear. All else says what it is.
"""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from foreign_mesh import ForeignMesh, NotReadable, Part, build

import abut
from abut.cells import CELLS

CELL_KINDS = {
    "hex8": "hex8", "hex20": "hex20", "hex27": "hex27", "tet4": "tet4", "tet10": "tet10", "penta6": "wedge6",
    "penta15": "wedge15",
}  # fmt: skip
FACET_KINDS = ("tri3", "tri6", "quad4", "quad8", "quad9")
SLIDING = (
    "sliding-elastic", "sliding-facet-on-facet", "sliding-node-on-facet", "sliding_with_gaps", "facet-to-facet sliding",
    "sliding-tension-compression", "contact potential",
)  # fmt: skip
TIED = ("tied-elastic", "tied-node-on-facet", "tied-facet-on-facet", "tied")
# A degree of freedom of a rigid body in FEBio, and the key of ``abut.Rigid``
RIGID = {"Rx": "x", "Ry": "y", "Rz": "z", "Ru": "rx", "Rv": "ry", "Rw": "rz"}
RIGID |= {"x": "x", "y": "y", "z": "z", "u": "rx", "v": "ry", "w": "rz"}


def read_model(path: Path) -> abut.Model:
    """Raises NotReadable for what is not read, or not solved by abut."""
    try:
        root = ElementTree.parse(path).getroot()
    except ElementTree.ParseError as error:
        raise NotReadable(f"no XML: {error}") from None
    if root.tag != "febio_spec" or not root.get("version", "").startswith(("3.", "4.")):
        raise NotReadable(f"febio_spec version {root.get('version')}")
    return _Reader(root).model()


class _Reader:
    def __init__(self, root: ElementTree.Element) -> None:
        self.root = root
        module = root.find("Module")
        if module is None or module.get("type") != "solid":
            raise NotReadable(f"module {module.get('type') if module is not None else None}")
        if root.find("Step") is not None:
            raise NotReadable("several steps")
        control = root.find("Control")
        if control is None or self._text(control, "analysis", "STATIC").upper() != "STATIC":
            raise NotReadable("analysis that is not static")
        self.duration = float(self._text(control, "time_steps", "1")) * float(self._text(control, "step_size", "1"))
        self.mesh = self._mesh()
        self.curves = {c.get("id"): self._curve(c) for c in root.iterfind("LoadData/load_controller")}

    def model(self) -> abut.Model:
        solids, rigid = self._bodies()
        supports = list(self._supports())
        loads = [load for part in self.root.iterfind("Loads/*") for load in self._load(part)]
        contacts = [self._contact(part) for part in self.root.iterfind("Contact/*")]
        for name in ("Discrete", "Constraints", "Initial"):
            if len(self.root.findall(f"{name}/*")):
                raise NotReadable(f"section {name}")
        used = {s for c in contacts for s in (c.first, c.second)} | {getattr(load, "on", None) for load in loads}
        surfaces = {name: own for name, own in self.surfaces.items() if name in used}
        mesh, _ = build(self.mesh, self.bodies, surfaces, {k: self.mesh.rows(v) for k, v in self.sets.items()}, 3)
        if any(not len(rows) for rows in mesh.surfaces.values()):
            raise NotReadable("a surface that no solid has")
        own = {name: np.setdiff1d(rows, self._rigid_nodes(mesh, rigid)) for name, rows in mesh.node_sets.items()}
        mesh = abut.Mesh(mesh.points, mesh.blocks, mesh.bodies, mesh.surfaces, {k: v for k, v in own.items() if len(v)})
        return abut.Model(
            mesh,
            solids,
            [s for s in supports if s.on in mesh.node_sets],
            loads,
            contacts,
            kinematics="finite",
            rigid=rigid,
        )

    def _rigid_nodes(self, mesh: abut.Mesh, rigid: list[abut.Rigid]) -> np.ndarray:
        return np.unique(np.concatenate([np.zeros(0, np.int64), *(mesh.nodes_of(body.body) for body in rigid)]))

    @staticmethod
    def _text(of: ElementTree.Element, name: str, default: str) -> str:
        return (of.findtext(name) or default).strip()

    def _mesh(self) -> ForeignMesh:
        names, points = [], []
        for node in self.root.iterfind("Mesh/Nodes/node"):
            names.append(str(node.get("id")))
            points.append([float(x) for x in (node.text or "").split(",")])
        row = {name: i for i, name in enumerate(names)}
        parts, groups = [], {}
        for block in self.root.iterfind("Mesh/Elements"):
            kind = str(block.get("type"))
            ids = [str(e.get("id")) for e in block.iterfind("elem")]
            groups[str(block.get("name"))] = ids
            nodes = np.array([[row[n.strip()] for n in (e.text or "").split(",")] for e in block.iterfind("elem")])
            parts.append(Part(CELL_KINDS.get(kind, ""), ids, nodes))
            if kind not in CELL_KINDS:
                raise NotReadable(f"elements {kind}")
        self.surfaces: dict[str, list[str]] = {}
        for surface in self.root.iterfind("Mesh/Surface"):
            name, by_kind = str(surface.get("name")), dict[str, list[list[int]]]()
            for facet in surface:
                by_kind.setdefault(facet.tag, []).append([row[n.strip()] for n in (facet.text or "").split(",")])
            self.surfaces[name] = []
            for kind, facets in by_kind.items():
                if kind not in FACET_KINDS:
                    raise NotReadable(f"facets {kind}")
                ids = [f"{name}/{kind}/{i}" for i in range(len(facets))]
                self.surfaces[name] += ids
                parts.append(Part(kind, ids, np.array(facets)))
        self.sets = {str(s.get("name")): self._members(s) for s in self.root.iterfind("Mesh/NodeSet")}
        mesh = ForeignMesh(np.array(points), names, parts, groups)
        for name, facets in self.surfaces.items():
            self.sets[f"@surface:{name}"] = [names[int(i)] for i in mesh.nodes_of_cells(facets)]
        return mesh

    def _members(self, node_set: ElementTree.Element) -> list[str]:
        if len(node_set):
            return [str(node.get("id")) for node in node_set]
        return [n.strip() for n in (node_set.text or "").replace("\n", " ").split(",") if n.strip()]

    def _bodies(self) -> tuple[list[abut.Solid], list[abut.Rigid]]:
        materials = {m.get("name"): m for m in self.root.iterfind("Material/material")}
        materials |= {m.get("id"): m for m in self.root.iterfind("Material/material")}
        self.bodies: dict[str, list[str]] = {}
        solids = []
        rigid: dict[str, list[str]] = {}
        for domain in self.root.iterfind("MeshDomains/*"):
            name, material = str(domain.get("name")), materials[domain.get("mat")]
            if domain.tag != "SolidDomain":
                raise NotReadable(domain.tag)
            if material.get("type") == "rigid body":
                rigid.setdefault(str(material.get("name")), []).extend(self.mesh.cell_groups[name])
                continue
            self.bodies[name] = self.mesh.cell_groups[name]
            solids.append(abut.Solid(name, _material(material)))
        self.bodies |= {f"rigid {name}": cells for name, cells in rigid.items()}
        return solids, [self._rigid(name, materials) for name in rigid]

    def _rigid(self, name: str, materials: dict[Any, ElementTree.Element]) -> abut.Rigid:
        given: dict[str, float] = {}
        amplitudes = {}
        for part in self.root.iterfind("Rigid/*"):
            body = materials.get(self._text(part, "rb", ""))
            if body is None or body.get("name") != name:
                continue
            if part.get("type") == "rigid_fixed":
                given |= {
                    RIGID[d.tag[:2]]: 0.0 for d in part if d.tag.endswith("_dof") and (d.text or "").strip() == "1"
                }
            elif part.get("type") in ("rigid_displacement", "rigid_rotation"):
                key = RIGID[self._text(part, "dof", "")]
                given[key], amplitudes[key] = self._value(part.find("value"))
            else:
                raise NotReadable(f"rigid: {part.get('type')}")
        centre = materials[name].findtext("center_of_mass")
        reference = tuple(float(x) for x in centre.split(",")) if centre else None
        return abut.Rigid(
            f"rigid {name}", reference, **given, amplitudes={k: v for k, v in amplitudes.items() if v is not None}
        )

    def _supports(self) -> Iterator[abut.Support]:
        for part in self.root.iterfind("Boundary/*"):
            on, kind = str(part.get("node_set")), str(part.get("type"))
            if on not in self.sets:
                raise NotReadable(f"node set {on}")
            if kind in ("zero displacement", "fix"):
                listed = [d.tag[0] for d in part if d.tag.endswith("_dof") and (d.text or "").strip() == "1"]
                listed += [d.strip() for d in self._text(part, "dofs", "").split(",") if d.strip()]
                given = {d: 0.0 for d in listed if d in "xyz"}
                if given:
                    yield abut.Support(on, **given)  # type: ignore[arg-type]
            elif kind in ("prescribed displacement", "prescribe"):
                value, history = self._value(
                    part.find("value") if part.find("value") is not None else part.find("scale")
                )
                if self._text(part, "relative", "0") != "0":
                    raise NotReadable("relative displacements")
                yield abut.Support(on, **{self._text(part, "dof", ""): value}, amplitude=history)  # type: ignore[arg-type]
            else:
                raise NotReadable(f"boundary condition {kind}")

    def _load(self, part: ElementTree.Element) -> Iterator[Any]:
        kind = f"{part.tag} {part.get('type')}"
        if kind == "surface_load pressure":
            value, history = self._value(part.find("pressure"))
            dead = self._text(part, "linear", "0") == "1"
            yield abut.Pressure(str(part.get("surface")), value, history, follows=not dead)
        elif part.tag == "nodal_load" and part.find("dof") is not None and self._text(part, "dof", "") in "xyz":
            value, history = self._value(part.find("scale") if part.find("scale") is not None else part.find("value"))
            axis = "xyz".index(self._text(part, "dof", ""))
            yield abut.NodalForce(
                str(part.get("node_set")), tuple(value if a == axis else 0.0 for a in range(3)), history
            )
        else:
            raise NotReadable(kind)

    def _contact(self, part: ElementTree.Element) -> abut.Contact:
        kind = str(part.get("type"))
        if kind not in (*SLIDING, *TIED):
            raise NotReadable(f"contact {kind}")
        pair = next(p for p in self.root.iterfind("Mesh/SurfacePair") if p.get("name") == part.get("surface_pair"))
        sides = [self._text(pair, side, "").removeprefix("@surface:") for side in ("primary", "secondary")]
        if self._text(part, "tension", "0") == "1":
            raise NotReadable("contact that holds under tension")
        friction = float(self._text(part, "fric_coeff", "0")) if kind in SLIDING else 0.0
        return abut.Contact(
            *sides, name=str(part.get("name")), kind="tied" if kind in TIED else "contact", friction=friction
        )

    def _value(self, element: ElementTree.Element | None) -> tuple[float, abut.Amplitude | None]:
        if element is None:
            raise NotReadable("a condition without value")
        curve = element.get("lc")
        history = abut.Amplitude(((0.0, 1.0), (1.0, 1.0))) if curve is None else self.curves[curve]
        if history is None:
            raise NotReadable(f"load controller {curve}: not a linear curve")
        return float(element.text or 0.0), history

    def _curve(self, controller: ElementTree.Element) -> abut.Amplitude | None:
        """Over 0 to 1 of the run; None for other kinds."""
        interpolation = self._text(controller, "interpolate", "LINEAR").upper()
        points = [p.text or "" for p in controller.iterfind("points/*")]
        if controller.get("type") != "loadcurve" or interpolation not in ("LINEAR", "STEP") or not points:
            return None
        t, f = np.array([[float(x) for x in p.split(",")] for p in points]).T
        if interpolation == "STEP" and len(set(f.tolist())) > 1:
            return None
        at = np.unique(np.concatenate([[0.0], t[(t > 0.0) & (t < self.duration)], [self.duration]]))
        if t[0] > 0.0 or (
            t[-1] < self.duration * (1 - 1e-9) and self._text(controller, "extend", "CONSTANT") != "CONSTANT"
        ):
            return None
        return abut.Amplitude(tuple(zip((at / self.duration).tolist(), np.interp(at, t, f).tolist())))


def _material(material: ElementTree.Element) -> Any:
    kind = material.get("type")
    if kind not in ("neo-Hookean", "isotropic elastic"):
        raise NotReadable(f"material {kind}")
    try:
        young, poisson = (float(material.findtext(key) or "nan") for key in ("E", "v"))
    except ValueError:
        raise NotReadable(f"material {kind}: constants that are no numbers") from None
    density = float(material.findtext("density") or 0.0)
    if kind == "isotropic elastic":
        return abut.LinearElastic(young, poisson, density=density)
    return abut.NeoHooke(young, poisson, volumetric="log-squared", density=density)


assert set(CELL_KINDS.values()) <= CELLS.keys()
