"""What abut uses of the Python module ``mgis.behaviour``, with three behaviours in Python: Metal, Maxwell and Kirchhoff.

Names, shapes and orders are those that MGIS documents: tensors 11 22 33 12 13 23 with shear times the square root of 2,
deformation gradients 11 22 33 12 21 13 31 23 32. ``tests/materials/behaviours.cpp`` has the same for MGIS itself."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np

from models.j2 import J2

PLACES = np.array([0, 1, 2, 3, 5, 4])  # xx yy zz xy yz zx among 11 22 33 12 13 23, and back
ROOT = np.array([1.0, 1.0, 1.0, *[np.sqrt(2.0)] * 3])
GRADIENT = np.array([[0, 3, 5], [4, 1, 7], [6, 8, 2]])
LIBRARY = "stand-in"
OF = {
    "Metal": ("YoungModulus", "PoissonRatio", "YieldStress", "Hardening"),
    "Maxwell": ("YoungModulus", "PoissonRatio", "RelaxationTime"),
    "Kirchhoff": ("YoungModulus", "PoissonRatio"),
    "Heated": ("YoungModulus", "PoissonRatio"),
}


class Variable(SimpleNamespace):
    def getType(self) -> str:
        return self.kind


class Behaviour:
    def __init__(self, name: str, options: Any) -> None:
        self.name, self.options, self.hypothesis, self.given = name, options, "Tridimensional", {"Shift": 0.0}
        self.mps = [Variable(name=each, kind="Scalar") for each in OF[name]]
        outside = ("Temperature", "Humidity") if name == "Heated" else ("Temperature",)
        self.esvs = [Variable(name=each, kind="Scalar") for each in outside]
        inside = {"ElasticStrain": "Stensor", "EquivalentPlasticStrain": "Scalar"} if name == "Metal" else {}
        self.isvs = [Variable(name=each, kind=kind) for each, kind in inside.items()]
        self.params = ["Shift"] if name == "Heated" else []

    def getBehaviourType(self) -> str:
        return "StandardFiniteStrainBehaviour" if self.name == "Kirchhoff" else "StandardStrainBasedBehaviour"

    def setParameter(self, name: str, value: float) -> None:
        self.given[name] = value


class State:
    def __init__(self, behaviour: Behaviour, n: int) -> None:
        self.gradients = np.zeros((n, 9 if behaviour.name == "Kirchhoff" else 6))
        self.thermodynamic_forces = np.zeros((n, 6))
        self.internal_state_variables = np.zeros((n, sum(6 if v.kind == "Stensor" else 1 for v in behaviour.isvs)))
        self.values: dict[str, Any] = {}


class MaterialDataManager:
    def __init__(self, behaviour: Behaviour, n: int) -> None:
        self.behaviour, self.n, self.K = behaviour, n, np.zeros((n, 6, 6))
        self.s0, self.s1 = State(behaviour, n), State(behaviour, n)


def isStandardFiniteStrainBehaviour(library: str, name: str) -> bool:
    if library != LIBRARY:
        raise RuntimeError(f"library '{library}' could not be loaded")
    if name not in OF:
        raise RuntimeError(f"could not load symbol '{name}_BehaviourType'")
    return name == "Kirchhoff"


def load(*given: Any) -> Behaviour:
    *options, library, name, hypothesis = given
    assert hypothesis == "Tridimensional"
    if isStandardFiniteStrainBehaviour(library, name) != bool(options):
        raise RuntimeError("load: options go with finite strains alone")
    return Behaviour(name, *(options or [None]))


def setMaterialProperty(state: State, name: str, value: float) -> None:
    state.values[name] = value


def setExternalStateVariable(state: State, name: str, value: Any, storage: Any = None) -> None:
    assert (storage == "LOCAL") == (np.ndim(value) > 0)
    state.values[name] = value


def getVariableSize(variable: Variable, hypothesis: str) -> int:
    return 6 if variable.kind == "Stensor" else 1


def hooke(values: dict[str, Any]) -> np.ndarray:
    young, poisson = values["YoungModulus"], values["PoissonRatio"]
    shear = young / (2.0 * (1.0 + poisson))
    result = 2.0 * shear * np.eye(6)
    result[:3, :3] += young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    return result


def integrate(data: MaterialDataManager, kind: str, step: float, first: int, last: int) -> int:
    assert (kind, first, last) == ("CONSISTENT", 0, data.n)
    old, new, values = data.s0, data.s1, data.s1.values
    if data.behaviour.name == "Metal":
        return metal(data)
    stiff = hooke(values)
    if data.behaviour.name == "Kirchhoff":
        options = data.behaviour.options
        assert (options.stress_measure, options.tangent_operator) == ("PK2", "DS_DEGL")
        gradient = new.gradients[:, GRADIENT]
        strain = 0.5 * (np.swapaxes(gradient, 1, 2) @ gradient - np.eye(3))
        strain = strain[:, [0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]] * ROOT
        data.K[...], new.thermodynamic_forces[...] = stiff, strain @ stiff
    elif data.behaviour.name == "Maxwell":
        fade = 1.0 / (1.0 + step / values["RelaxationTime"])
        data.K[...] = fade * stiff
        new.thermodynamic_forces[...] = fade * (old.thermodynamic_forces + (new.gradients - old.gradients) @ stiff)
    else:  # Heated: softer by a percent a degree, a humidity and a parameter
        assert np.shape(old.values["Temperature"]) == (data.n,)
        soft = 1.0 - 0.01 * (values["Temperature"] - 293.15) - values["Humidity"] - data.behaviour.given["Shift"]
        data.K[...] = soft[:, None, None] * stiff
        new.thermodynamic_forces[...] = soft[:, None] * (new.gradients @ stiff)
    return 1 if np.isfinite(new.thermodynamic_forces).all() else -1


def metal(data: MaterialDataManager) -> int:
    old, new, values = data.s0, data.s1, data.s1.values
    young, poisson = values["YoungModulus"], values["PoissonRatio"]
    moduli = young / (3.0 * (1.0 - 2.0 * poisson)), young / (2.0 * (1.0 + poisson))
    law = J2(*moduli, values["YieldStress"], values["Hardening"], 0.0)
    before, now = (strain[:, PLACES] * ROOT for strain in (old.gradients, new.gradients))
    history = law.initial(data.n)
    history[:, :6] = before - old.internal_state_variables[:, :6][:, PLACES] * ROOT
    history[:, 6] = old.internal_state_variables[:, 6]
    stress, tangent, after = law.evaluate(now, history)
    new.thermodynamic_forces[...] = stress[:, PLACES] * ROOT
    data.K[...] = tangent[:, PLACES[:, None], PLACES] * np.outer(ROOT, ROOT)
    new.internal_state_variables[:, :6] = (now - after[:, :6])[:, PLACES] / ROOT
    new.internal_state_variables[:, 6] = after[:, 6]
    return 1


Hypothesis = SimpleNamespace(Tridimensional="Tridimensional")
FiniteStrainBehaviourOptions = SimpleNamespace
FiniteStrainBehaviourOptionsStressMeasure = SimpleNamespace(PK2="PK2")
FiniteStrainBehaviourOptionsTangentOperator = SimpleNamespace(DS_DEGL="DS_DEGL")
IntegrationType = SimpleNamespace(INTEGRATION_CONSISTENT_TANGENT_OPERATOR="CONSISTENT")
MaterialStateManagerStorageMode = SimpleNamespace(LOCAL_STORAGE="LOCAL")
