"""code_aster's contact cases as models of abut: what commands say, and what is compared (TEST_RESU of displacements)."""

from __future__ import annotations

import ast
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from aster_commands import NAMES, Command, Unknown, commands, entries, several, value
from aster_groups import add_groups, cells, nodes
from aster_mesh import read_mail, read_med
from foreign_mesh import ForeignMesh, NotReadable, build, layer
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components

import abut
from abut.cells import CELLS

PLANES = {"D_PLAN": "strain", "C_PLAN": "stress", "AXIS": "axisymmetric", "3D": None}
REDUCED = {"D_PLAN_SI": "strain", "AXIS_SI": "axisymmetric", "3D_SI": None}
COMPONENTS = ("DX", "DY", "DZ")
STRAINS = {None: "small-strain", "PETIT": "small-strain", "GREEN_LAGRANGE": "finite", "GROT_GDEP": "finite"}
PRESSURE = 3  # as a component: LAGS_C, minus the pressure


@dataclass(frozen=True)
class Test:
    """A displacement component of a point, or its pressure, at a time (of 0 to 1): what code_aster has, and a reference
    from elsewhere, NaN where the file has none."""

    point: int
    component: int
    time: float
    own: float
    reference: float
    where: str


@dataclass
class Case:
    """A model and what it is compared with."""

    model: abut.Model
    tests: list[Test]
    notes: list[str] = field(default_factory=list)


def read_case(path: Path) -> list[Case]:
    """One for each STAT_NON_LINE with contact of a command file (.comm), whose mesh (.mmed, .med, .mail) lies beside it.

    Raises NotReadable for what is not read, or not solved by abut."""
    found = commands(path.read_text(encoding="latin-1"))
    mesh = _mesh(path)
    for command in found:
        if command.name == "DEFI_GROUP":
            add_groups(mesh, command)
        elif command.name in ("CREA_MAILLAGE", "AFFE_CARA_ELEM", "DEFI_FISS_XFEM", "MACR_ADAP_MAIL"):
            raise NotReadable(f"line {command.line}: {command.name}")
        elif command.name in ("DYNA_NON_LINE", "THER_LINEAIRE", "MECA_STATIQUE"):
            raise NotReadable(f"line {command.line}: {command.name}: another procedure")
        elif command.name == "MODI_MAILLAGE" and {"DEFORME", "TRANSLATION", "ROTATION", "ECHELLE"} & set(
            command.keywords
        ):
            raise NotReadable(f"line {command.line}: MODI_MAILLAGE that moves the mesh")
    runs = [c for c in found if c.name == "STAT_NON_LINE" and isinstance(c.get("CONTACT"), Command)]
    if not runs:
        raise NotReadable("no STAT_NON_LINE with contact")
    return [_Reader(mesh, found, run).case() for run in runs]


def _mesh(path: Path) -> ForeignMesh:
    names = [path.with_suffix(ending) for ending in (".mmed", ".med", ".mail")]
    export = path.with_suffix(".export")
    for line in export.read_text(encoding="latin-1").splitlines() if export.exists() else ():
        words = line.split()
        if len(words) > 2 and words[0] == "F" and words[1] in ("mmed", "mail"):
            names.insert(0, path.parent / words[2])
    for name in names:
        if name.exists():
            return read_mail(name.read_text(encoding="latin-1")) if name.suffix == ".mail" else read_med(name)
    raise NotReadable("no mesh in MED or code_aster's text format beside it")


class _Reader:
    """One STAT_NON_LINE."""

    def __init__(self, mesh: ForeignMesh, found: Sequence[Command], run: Command) -> None:
        self.mesh, self.found, self.run = mesh, found, run
        if run.get("ETAT_INIT") is not None or run.get("reuse") is not None:
            raise NotReadable(f"line {run.line}: a calculation that goes on from another")
        self.sets: dict[str, np.ndarray] = {}
        self.surfaces: dict[str, list[str]] = {}
        self.span = self._times()
        self.supports: list[abut.Support] = []
        self.loads: list[Any] = []
        self.equations: list[abut.Equation] = []

    def case(self) -> Case:
        plane, reduced, members = self._modelling()
        dim = 2 if plane else 3
        bodies, solids = self._bodies(members, dim, reduced)
        for entry in entries(self.run, "EXCIT"):
            self._loads(entry, dim)
        kinematics, contacts = self._contacts()
        self._give_bodies(contacts, bodies, solids, dim)
        made, self.new = build(self.mesh, bodies, self.surfaces, self.sets, dim)
        if any(not len(rows) for rows in made.surfaces.values()):
            raise NotReadable("a surface that no solid has: a rigid one without cells")
        gone = [name for name in self.sets if name not in made.node_sets]
        self.supports = [s for s in self.supports if s.on not in gone]
        tests = self._tests()
        if not tests:
            raise NotReadable("no TEST_RESU of a displacement at a point")
        times = sorted({t.time for t in tests} | {1.0} | self._own_times(kinematics))
        model = abut.Model(
            made, solids, self.supports, self.loads, contacts, plane=plane, kinematics=kinematics, equations=self.equations,
            solve=abut.SolveOptions(times=tuple(t for t in times if t > 0.0)),
        )  # fmt: skip
        return Case(model, tests)

    def _own_times(self, kinematics: str) -> set[float]:
        return (
            {(t - self.span[0]) / (self.span[-1] - self.span[0]) for t in self.span[1:]}
            if kinematics == "small"
            else set()
        )

    def _times(self) -> list[float]:
        increment = next(entries(self.run, "INCREMENT"))
        listed = increment.get("LIST_INST")
        if isinstance(listed, Command) and listed.name == "DEFI_LIST_INST":
            listed = next(entries(listed, "DEFI_LIST")).get("LIST_INST")
        if not isinstance(listed, Command) or listed.name != "DEFI_LIST_REEL":
            raise NotReadable("list of instants")
        if listed.get("VALE") is not None:
            times = [float(t) for t in several(listed["VALE"])]
        else:
            times = [float(listed.get("DEBUT", 0.0))]
            for part in entries(listed, "INTERVALLE"):
                count = part.get("NOMBRE") or max(1, round((float(part["JUSQU_A"]) - times[-1]) / float(part["PAS"])))
                times += np.linspace(times[-1], float(part["JUSQU_A"]), int(count) + 1)[1:].tolist()
        first = increment.get("NUME_INST_INIT")
        times = times[int(first) :] if first else times
        last = increment.get("INST_FIN")
        end = increment.get("NUME_INST_FIN")
        times = [t for t in times if last is None or t <= float(last) * (1 + 1e-9)]
        return times if end is None else times[: int(end) + 1]

    def _modelling(self) -> tuple[str | None, bool, list[str]]:
        kinds, members = set(), []
        for entry in entries(self.run["MODELE"], "AFFE"):
            kinds.add(str(several(entry.get("MODELISATION"))[0]))
            members += cells(self.mesh, entry)
        if len(kinds) != 1 or not kinds <= PLANES.keys() | REDUCED.keys():
            raise NotReadable(f"MODELISATION {', '.join(sorted(kinds))}")
        kind = kinds.pop()
        return {**PLANES, **REDUCED}[kind], kind in REDUCED, members

    def _bodies(self, members: list[str], dim: int, reduced: bool) -> tuple[dict[str, list[str]], list[abut.Solid]]:
        """Connected cells of one material."""
        material: dict[str, Command] = {}
        chosen = self.run["CHAM_MATER"]
        if chosen.get("AFFE_VARC") is not None:
            raise NotReadable("AFFE_VARC: temperatures")
        for entry in entries(chosen, "AFFE"):
            for name in cells(self.mesh, entry):
                material[name] = several(entry["MATER"])[0]
        mine = [n for n in dict.fromkeys(members) if self._dim(n) == dim]
        if any(n not in material for n in mine):
            raise NotReadable("cells without a material")
        kinds = list(dict.fromkeys(material[n] for n in mine))
        bodies: dict[str, list[str]] = {}
        solids = []
        for number, kind in enumerate(kinds):
            elastic = _elastic(kind)
            own = [n for n in mine if material[n] is kind]
            for k, part in enumerate(self._connected(own)):
                body = f"body-{number + 1}-{k + 1}"
                bodies[body] = part
                solids.append(abut.Solid(body, elastic, integration="reduced" if reduced else "full"))
        return bodies, solids

    def _dim(self, name: str) -> int:
        kind = self.mesh.parts[self.mesh.place[name][0]].kind
        return CELLS[kind].dim if kind else 0

    def _connected(self, names: list[str]) -> list[list[str]]:
        rows = [self.mesh.parts[p].nodes[i] for p, i in (self.mesh.place[n] for n in names)]
        cell = np.repeat(np.arange(len(rows)), [len(r) for r in rows])
        point = np.concatenate(rows)
        joined = csr_matrix((np.ones(len(cell)), (cell, point)), shape=(len(rows), len(self.mesh.points)))
        count, label = connected_components(joined @ joined.T, directed=False)
        return [[n for n, own in zip(names, label) if own == k] for k in range(count)]

    def _loads(self, entry: Mapping[str, Any], dim: int) -> None:
        load = entry["CHARGE"]
        if not isinstance(load, Command) or load.name not in ("AFFE_CHAR_MECA", "AFFE_CHAR_CINE", "AFFE_CHAR_MECA_F"):
            raise NotReadable(f"load {getattr(load, 'name', load)}")
        over = self._history(entry.get("FONC_MULT"))
        follows = entry.get("TYPE_CHARGE") in ("SUIV", "SUIVEUR")
        for key in load.keywords.keys() - {"MODELE", "INFO", "VERI_NORM", "VERI_DDL"}:
            for part in entries(load, key):
                if key in ("DDL_IMPO", "MECA_IMPO", "FACE_IMPO", "ARETE_IMPO"):
                    self._support(part, over, dim)
                elif key == "PRES_REP":
                    value, history = self._value(part["PRES"], over)
                    self.loads.append(abut.Pressure(self._surface(part), value, history, follows=follows))
                elif key in ("FORCE_CONTOUR", "FORCE_FACE"):
                    self._force(part, over, dim, abut.Traction, self._surface(part))
                elif key == "FORCE_NODALE":
                    self._force(part, over, dim, abut.NodalForce, self._set(part))
                elif key == "LIAISON_DDL":
                    self._equation(part, over)
                else:
                    raise NotReadable(f"line {load.line}: {load.name}, {key}")

    def _support(self, part: Mapping[str, Any], over: abut.Amplitude | None, dim: int) -> None:
        given = {key: part[key] for key in COMPONENTS[:dim] if part.get(key) is not None}
        if part.get("BLOCAGE") or part.get("LIAISON"):
            given = dict.fromkeys(COMPONENTS[:dim], 0.0)
        other = part.keys() - {
            *COMPONENTS,
            "GROUP_NO",
            "GROUP_MA",
            "NOEUD",
            "TOUT",
            "SANS_GROUP_NO",
            "LIAISON",
            "BLOCAGE",
        }
        if other - {"LAGS_C", "LAGS_F1", "DRX", "DRY", "DRZ"} or not given:
            raise NotReadable(f"support with {', '.join(sorted(other)) or 'nothing'}")
        on = self._set(part)
        for key, given_value in given.items():
            value, history = self._value(given_value, over)
            self.supports.append(abut.Support(on, **{"xyz"[COMPONENTS.index(key)]: value}, amplitude=history))

    def _force(self, part: Mapping[str, Any], over: abut.Amplitude | None, dim: int, kind: Any, on: str) -> None:
        given = {axis: part[key] for axis, key in enumerate(("FX", "FY", "FZ")[:dim]) if part.get(key) is not None}
        for axis, number in given.items():
            value, history = self._value(number, over)
            self.loads.append(kind(on, tuple(value if a == axis else 0.0 for a in range(dim)), history))

    def _equation(self, part: Mapping[str, Any], over: abut.Amplitude | None) -> None:
        points = [n for g in several(part.get("GROUP_NO")) for n in self.mesh.node_groups.get(g, ())]
        points += [str(n) for n in several(part.get("NOEUD"))]
        keys, factors = several(part["DDL"]), several(part["COEF_MULT"])
        value, history = self._value(part["COEF_IMPO"], over)
        if not len(points) == len(keys) == len(factors):
            raise NotReadable("LIAISON_DDL of several points each")
        terms = [
            abut.Term(self._set({"NOEUD": n}), "xyz"[COMPONENTS.index(k)], float(c))
            for n, k, c in zip(points, keys, factors)
        ]
        self.equations.append(abut.Equation(tuple(terms), value, history))

    def _set(self, part: Mapping[str, Any]) -> str:
        name = f"nodes-{len(self.sets) + 1}"
        self.sets[name] = nodes(self.mesh, part)
        return name

    def _surface(self, part: Mapping[str, Any]) -> str:
        name = f"surface-{len(self.surfaces) + 1}"
        self.surfaces[name] = cells(self.mesh, part)
        return name

    def _value(self, given: Any, over: abut.Amplitude | None) -> tuple[float, abut.Amplitude | None]:
        """A number with its history, or a function of time with size one."""
        if isinstance(given, int | float):
            return float(given), over
        history = self._history(given)
        if over is not None and any(f != 1.0 for _, f in over.points):
            raise NotReadable("a function of time times another one")
        return 1.0, history

    def _history(self, function: Any) -> abut.Amplitude | None:
        if function is None:
            return abut.Amplitude(((0.0, 1.0), (1.0, 1.0)))
        if isinstance(function, Command) and function.name == "DEFI_CONSTANTE":
            return abut.Amplitude(((0.0, float(function["VALE"])), (1.0, float(function["VALE"]))))
        if (
            isinstance(function, Command)
            and function.name == "FORMULE"
            and several(function.get("NOM_PARA")) == ["INST"]
        ):
            return self._formula(str(function.get("VALE")))
        if not isinstance(function, Command) or function.name != "DEFI_FONCTION" or function.get("NOM_PARA") != "INST":
            raise NotReadable(f"function {getattr(function, 'name', function)}")
        numbers = [float(x) for x in several(function.get("VALE"))]
        if isinstance(function.get("VALE"), Unknown) or not numbers or len(numbers) % 2:
            raise NotReadable("values of DEFI_FONCTION")
        t, f = np.array(numbers[::2]), np.array(numbers[1::2])
        first, last = self.span[0], self.span[-1]
        at = np.unique(np.concatenate([[first], t[(t > first) & (t < last)], [last]]))
        values = np.interp(at, t, f)
        for end, side, place in ((t[0], "PROL_GAUCHE", at < t[0]), (t[-1], "PROL_DROITE", at > t[-1])):
            if place.any() and function.get(side) == "LINEAIRE":
                i, j = (0, 1) if side == "PROL_GAUCHE" else (-1, -2)
                values[place] = f[i] + (at[place] - end) * (f[i] - f[j]) / (t[i] - t[j])
        return abut.Amplitude(tuple(zip(((at - first) / (last - first)).tolist(), values.tolist())))

    def _formula(self, text: str) -> abut.Amplitude:
        """A formula of time, at the instants of the calculation, linear between."""
        tree = ast.parse(text.strip(), mode="eval").body
        values = [value(tree, {**NAMES, "INST": t}) for t in self.span]
        if not all(isinstance(v, int | float) for v in values):
            raise NotReadable(f"formula {text}")
        first, last = self.span[0], self.span[-1]
        return abut.Amplitude(tuple(((t - first) / (last - first), float(v)) for t, v in zip(self.span, values)))

    def _contacts(self) -> tuple[str, list[abut.Contact]]:
        contact = self.run["CONTACT"]
        if contact.get("FORMULATION", "DISCRETE") not in ("DISCRETE", "CONTINUE"):
            raise NotReadable(f"contact FORMULATION {contact.get('FORMULATION')}")
        strains = {entry.get("DEFORMATION") for entry in entries(self.run, "COMPORTEMENT")}
        laws = {entry.get("RELATION") for entry in entries(self.run, "COMPORTEMENT")}
        if not laws <= {"ELAS"} or not strains <= STRAINS.keys():
            raise NotReadable(f"COMPORTEMENT {', '.join(sorted(map(str, (laws | strains) - {None})))}")
        kinematics = STRAINS[next(iter(strains), None)]
        if kinematics == "small-strain" and contact.get("REAC_GEOM", contact.get("ALGO_RESO_GEOM")) == "SANS":
            kinematics = "small"
        made = []
        for number, zone in enumerate(entries(contact, "ZONE")):
            if zone.get("RESOLUTION") == "NON":
                continue
            if any(zone.get(key) is not None for key in ("DIST_MAIT", "DIST_ESCL", "DIST_POUTRE", "DIST_COQUE")):
                raise NotReadable("contact with a distance of its own")
            if "GROUP_MA_ESCL" not in zone:
                raise NotReadable("contact of one group of cells")
            rubs = contact.get("FROTTEMENT") == "COULOMB"
            sides = [self._surface({"GROUP_MA": zone[key]}) for key in ("GROUP_MA_ESCL", "GROUP_MA_MAIT")]
            made.append(
                abut.Contact(
                    contactor=sides[0], target=sides[1], name=f"zone-{number + 1}",
                    kind="bilateral" if zone.get("GLISSIERE") == "OUI" else "contact",
                    friction=float(zone.get("COULOMB", 0.0)) if rubs else 0.0,
                )
            )  # fmt: skip
        return kinematics, made

    def _give_bodies(
        self, contacts: Sequence[abut.Contact], bodies: dict[str, list[str]], solids: list[abut.Solid], dim: int
    ) -> None:
        """Cells behind rigid targets, which code_aster takes as facets alone, of held points: a layer of them, held."""
        inside = {n for names in bodies.values() for n in names}
        solid = {int(i) for n in inside for i in self.mesh.nodes_of_cells([n])}
        for number, contact in enumerate(contacts):
            facets = self.surfaces[str(contact.target)]
            own = self.mesh.nodes_of_cells(facets)
            if solid & set(own.tolist()):
                continue
            held = [np.zeros(0, np.int64)] * dim
            for support in self.supports:
                for axis in range(dim):
                    if getattr(support, "xyz"[axis]) is not None:
                        held[axis] = np.union1d(held[axis], self.sets[support.on])
            if not all(np.isin(own, h).all() for h in held):
                raise NotReadable("a target without cells that is not held")
            slave = self.mesh.nodes_of_cells(self.surfaces[str(contact.contactor)])
            near = [points for points in map(self.mesh.nodes_of_cells, bodies.values()) if np.isin(slave, points).any()]
            side = self.mesh.points[np.concatenate(near)].mean(axis=0)
            body = f"rigid-{number + 1}"
            bodies[body], behind = layer(self.mesh, facets, side, body)
            solids.append(abut.Solid(body, solids[0].material))
            name = f"behind-{number + 1}"
            self.sets[name] = behind
            self.supports.append(abut.Support(name, **dict.fromkeys("xyz"[:dim], 0.0)))

    def _tests(self) -> list[Test]:
        """Displacements of points that the file tests, at times of this calculation."""
        result = []
        for command in self.found:
            if command.name != "TEST_RESU" or not isinstance(command.get("RESU"), dict | list):
                continue
            for entry in entries(command, "RESU"):
                if (
                    entry.get("RESULTAT") is not self.run
                    and getattr(entry.get("RESULTAT"), "into", "") != self.run.into
                ):
                    continue
                if entry.get("NOM_CHAM") == "DEPL" and entry.get("NOM_CMP") in (*COMPONENTS, "LAGS_C"):
                    result += self._test(entry)
        return result

    def _test(self, entry: Mapping[str, Any]) -> list[Test]:
        rows = nodes(self.mesh, {k: entry[k] for k in ("GROUP_NO", "NOEUD") if k in entry})
        own, reference = (
            float(entry[key]) if isinstance(entry.get(key), int | float) else float("nan")
            for key in ("VALE_CALC", "VALE_REFE")
        )
        if len(rows) != 1 or np.isnan([own, reference]).all():
            return []
        if "INST" in entry:
            when = float(entry["INST"])
        elif "NUME_ORDRE" in entry and int(entry["NUME_ORDRE"]) < len(self.span):
            when = self.span[int(entry["NUME_ORDRE"])]
        else:
            return []
        point, name = int(self.new[rows[0]]), str(entry["NOM_CMP"])
        time = (when - self.span[0]) / (self.span[-1] - self.span[0])
        if point < 0 or not 0.0 < time <= 1.0 + 1e-9:
            return []
        component = COMPONENTS.index(name) if name in COMPONENTS else PRESSURE
        where = f"{entry.get('GROUP_NO', entry.get('NOEUD'))} {name}"
        return [Test(point, component, min(time, 1.0), own, reference, where)]


def _elastic(material: Command) -> abut.LinearElastic:
    for entry in entries(material, "ELAS"):
        if all(isinstance(entry.get(key), int | float) for key in ("E", "NU")):
            return abut.LinearElastic(float(entry["E"]), float(entry["NU"]), density=float(entry.get("RHO", 0.0)))
    raise NotReadable(f"line {material.line}: {material.name}: no isotropic elasticity in numbers")
