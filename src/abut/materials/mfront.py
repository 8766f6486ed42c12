"""Behaviours that MFront has compiled, through MGIS (the Python module ``mgis.behaviour``).

Tensors of MGIS are 11 22 33 12 13 23 with shear times the square root of 2, stress and strain alike; deformation gradients
are 11 22 33 12 21 13 31 23 32.
"""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np

from abut import checks
from abut.axes import Axes
from abut.errors import InputError, Unsound, nearest
from abut.materials.directions import Directions, frames, turned, uniform
from abut.materials.elastic import LinearElastic
from abut.materials.evaluated import Array, Evaluated
from abut.materials.material import Material, OwnMaterial
from abut.materials.places import Places
from abut.materials.plastic import EQUIVALENT, WORK

ORDER = np.array([0, 1, 2, 3, 5, 4])  # of xx yy zz xy yz zx among 11 22 33 12 13 23, and back
ROOT = np.array([1.0, 1.0, 1.0, *[np.sqrt(2.0)] * 3])
TENSOR = ((0, 3, 5), (4, 1, 7), (6, 8, 2))  # places of the rows of a gradient, in MGIS's order
SMALL, FINITE = "StandardStrainBasedBehaviour", "StandardFiniteStrainBehaviour"
FIRST = "Temperature"  # of the external state variables, which abut itself gives
ALIKE = 1e-9  # difference from an isotropic tangent over its largest entry that is rounding
STRAIN, STRESS, FLOWED, HEAD = slice(1, 7), slice(7, 13), 13, 14  # of the history, after the temperature
NAMES = MappingProxyType({"EquivalentPlasticStrain": EQUIVALENT})  # of what abut knows
WORDS = {"properties": "material property", "parameters": "parameter", "variables": "external state variable"}
NOT_THERE = (
    "the Python module mgis.behaviour, which runs behaviours of MFront, is not there ({}); it is not on PyPI: take the "
    "package mgis of conda-forge (conda install -c conda-forge mgis), mgis +python of Spack, or build "
    "MFrontGenericInterfaceSupport with -Denable-python-bindings=ON for this Python, and put it on PYTHONPATH"
)


@dataclass(frozen=True)
class MFront(OwnMaterial):
    """A behaviour that MFront has compiled (mfront --obuild --interface=generic), through MGIS (mgis.behaviour).

    Of small strains, which under finite kinematics sees those of Green and Lagrange (large turns, small strains), or of
    finite ones (as with ``@StrainMeasure Hencky``). It is asked for as Tridimensional in plane and axisymmetric models, too,
    whose strains out of the plane are known. Its state variables are the history, its time step that of the run.

    Parameters
    ----------
    library : str
        The shared library, a path.
    behaviour : str
        Its name.
    properties : mapping of str to float, optional
        Its material properties, all of them.
    parameters : mapping of str to float, optional
        Parameters of the behaviour that are not what its source says.
    variables : mapping of str to float, optional
        External state variables beside Temperature, constant.
    initial_temperature : float
        The variable Temperature at the beginning, to which changes add up.
    axes : Axes or callable, optional
        Local directions of an orthotropic behaviour, as of ``Orthotropic``; by default the global ones.
    volume_preserving : bool
        It flows or deforms nearly without change of volume: integration "auto" then takes what does not lock.
    density : float
        Mass per volume, used by gravity.
    expansion : float
        Thermal expansion [1/temperature], used by temperature changes; 0 for a behaviour that has it in itself.

    Raises
    ------
    InputError
        Where mgis is missing, for a library, behaviour, property, parameter or variable that is not there, and one missing.

    References
    ----------
    T. Helfer, J. Bleyer, T. Frondelius, I. Yashchuk, T. Nagel, D. Naumov, The MFrontGenericInterfaceSupport project, J. Open
    Source Softw. 5 (2020) 2003.
    """

    library: str
    behaviour: str
    properties: Mapping[str, float] | None = field(default=None, hash=False)
    parameters: Mapping[str, float] | None = field(default=None, hash=False)
    variables: Mapping[str, float] | None = field(default=None, hash=False)
    initial_temperature: float = 293.15
    axes: Directions | None = None
    volume_preserving: bool = False
    density: float = 0.0
    expansion: float = 0.0

    def __post_init__(self) -> None:
        checks.text(self.library, "library")
        checks.text(self.behaviour, "behaviour")
        for name in ("properties", "parameters", "variables"):
            given = getattr(self, name)
            if given is not None:
                if not isinstance(given, Mapping):
                    raise InputError(f"{name}: expected numbers by name, got {given!r}")
                given = {str(key): checks.finite(value, f"{name}.{key}") for key, value in given.items()}
                object.__setattr__(self, name, given)
        for name in ("initial_temperature", "density", "expansion"):
            checks.finite(getattr(self, name), name)
        if self.density < 0.0:
            raise InputError(f"density: expected a number >= 0, got {self.density!r}")
        if self.axes is not None and not isinstance(self.axes, Axes) and not callable(self.axes):
            raise InputError(f"axes: expected Axes or a function of points, got {self.axes!r}")
        _ = self._signature

    @property
    def small(self) -> bool:  # type: ignore[override]
        """As in ``OwnMaterial``: whether it is of small strains."""
        return not self._signature.finite

    @property
    def fields(self) -> Mapping[str, slice]:  # type: ignore[override]
        """As in ``OwnMaterial``: its state variables by name."""
        return self._signature.fields

    @cached_property
    def linear(self) -> LinearElastic | None:  # type: ignore[override]
        """What it is at rest, where that is isotropic."""
        tangent = self._at_rest
        shear, first = tangent[3, 3], tangent[0, 1]
        alike = np.diag([2.0 * shear] * 3 + [shear] * 3)
        alike[:3, :3] += first
        if shear <= 0.0 or np.abs(tangent - alike).max() > ALIKE * np.abs(tangent).max():
            return None
        poisson = 0.5 * first / (first + shear)
        return LinearElastic(float(2.0 * shear * (1.0 + poisson)), float(poisson), self.density, self.expansion)

    @property
    def modulus(self) -> float:
        """At rest, the geometric mean along the axes."""
        return float(np.prod(np.diag(self.compliance)[:3]) ** (-1.0 / 3.0))

    def initial(self, n: int) -> Array:
        """Temperature, strain (6) and stress (6) at the end of the last step, along the local axes, work of plastic
        flow, and state variables, of symmetric tensors without doubled shear."""
        history = np.zeros((n, self._signature.columns))
        history[:, 0] = self.initial_temperature
        return history

    def at(self, places: Places) -> Material:
        """As in ``LocalMaterial``."""
        frame = None
        if self.axes is not None:
            frame = frames(self.axes, places.points[:1] if uniform(self.axes) else places.points)
        return _Here(self, self._signature, frame, places.change, places.elapsed)

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        """As in ``Material``, where axes are global and no time passes."""
        return _Here(self, self._signature, None, np.zeros(1), 0.0).evaluate(strain, history)

    def evaluate_finite(self, strain: Array, history: Array) -> Evaluated:
        """As in ``FiniteMaterial``, likewise."""
        return self.evaluate(strain, history)

    def check(self, dim: int, plane: str | None, where: str) -> None:
        """As in ``OwnMaterial``."""
        if isinstance(self.axes, Axes):
            self.axes.check(dim, where)

    @cached_property
    def _signature(self) -> Signature:
        mgis, behaviour = loaded(self)
        given = {"properties": self.properties, "parameters": self.parameters, "variables": self.variables}
        asked = {
            "properties": [variable.name for variable in behaviour.mps],
            "variables": [variable.name for variable in behaviour.esvs if variable.name != FIRST],
        }
        for what, names in {**asked, "parameters": list(behaviour.params)}.items():
            for name in given[what] or {}:
                if name not in names:
                    raise InputError(
                        f"{what}.{name}: behaviour '{self.behaviour}' has no such {WORDS[what]}{nearest(name, names)}"
                    )
        for what, names in asked.items():
            missing = [name for name in names if name not in (given[what] or {})]
            if missing:
                raise InputError(f"{what}: missing of behaviour '{self.behaviour}': {', '.join(missing)}")
        return signature(mgis, behaviour)

    @cached_property
    def compliance(self) -> Array:
        """(6, 6) of strains by stresses at rest, along the local axes."""
        return np.asarray(np.linalg.pinv(self._at_rest))

    @cached_property
    def _at_rest(self) -> Array:
        here = _Here(self, replace(self._signature, fields={}), None, np.zeros(1), 0.0)
        return np.asarray(here.evaluate(np.zeros((1, 6)), self.initial(1))[1][0])


@dataclass(frozen=True)
class Signature:
    """Of a behaviour. finite: it takes a deformation gradient; tensors: which columns of its state variables are
    symmetric tensors; fields: columns of the history by name; columns: how many these are."""

    finite: bool
    tensors: tuple[slice, ...]
    fields: Mapping[str, slice]
    columns: int


def loaded(material: MFront) -> tuple[Any, Any]:
    """mgis.behaviour and the behaviour, Tridimensional; of finite strains with second stresses of Piola and Kirchhoff.

    Raises InputError where they are not there."""
    try:
        mgis = importlib.import_module("mgis.behaviour")
    except ImportError as error:
        raise InputError(f"kind: {NOT_THERE.format(error)}") from None
    space = mgis.Hypothesis.Tridimensional
    name = f"behaviour '{material.behaviour}' of library '{material.library}'"
    try:
        if mgis.isStandardFiniteStrainBehaviour(material.library, material.behaviour):
            options = mgis.FiniteStrainBehaviourOptions()
            options.stress_measure = mgis.FiniteStrainBehaviourOptionsStressMeasure.PK2
            options.tangent_operator = mgis.FiniteStrainBehaviourOptionsTangentOperator.DS_DEGL
            found = mgis.load(options, material.library, material.behaviour, space)
        else:
            found = mgis.load(material.library, material.behaviour, space)
    except RuntimeError as error:
        raise InputError(f"library: {name} can't be loaded for the hypothesis Tridimensional: {error}") from None
    if found.getBehaviourType() not in (SMALL, FINITE):
        raise InputError(f"behaviour: {name} takes neither strains nor deformation gradients; abut runs such alone")
    for parameter, value in (material.parameters or {}).items():
        if parameter in list(found.params):
            found.setParameter(parameter, value)  # of the library: set before each use
    return mgis, found


def signature(mgis: Any, behaviour: Any) -> Signature:
    """Of a loaded behaviour."""
    tensors, fields, first = [], {}, 0
    for variable in behaviour.isvs:
        size = mgis.getVariableSize(variable, behaviour.hypothesis)
        if variable.getType() == "Stensor":
            tensors.append(slice(first, first + size))
        fields[NAMES.get(variable.name, variable.name)] = slice(HEAD + first, HEAD + first + size)
        first += size
    if EQUIVALENT in fields:
        fields[WORK] = slice(FLOWED, FLOWED + 1)
    finite = behaviour.getBehaviourType() == FINITE
    return Signature(finite, tuple(tensors), fields, HEAD + first)


@dataclass(frozen=True)
class _Here(OwnMaterial):
    """At n points, over a time. frame: local directions (n or 1, 3, 3), None: the global ones; change: (n or 1,) degrees."""

    law: MFront
    of: Signature
    frame: Array | None
    change: Array
    elapsed: float

    @property
    def modulus(self) -> float:
        return self.law.modulus

    def initial(self, n: int) -> Array:
        return self.law.initial(n)

    def evaluate(self, strain: Array, history: Array) -> Evaluated:
        """Of either kind of strain: what heat does comes first, alike in all directions, theory (A3)."""
        swelling = self.law.expansion * self.change
        elastic = np.array(strain, dtype=float)
        elastic[:, :3] -= swelling[:, None]
        return self._local(elastic, history)

    def evaluate_finite(self, strain: Array, history: Array) -> Evaluated:
        stretch = 1.0 + self.law.expansion * self.change
        elastic = np.array(strain, dtype=float)
        elastic[:, :3] -= 0.5 * (stretch**2 - 1.0)[:, None]
        elastic /= (stretch**2)[:, None]
        stress, tangent, after = self._local(elastic, history)
        return stretch[:, None] * stress, tangent / stretch[:, None, None], after

    def _local(self, strain: Array, history: Array) -> Evaluated:
        if self.frame is None:
            return self._told(strain, history)
        turn = turned(self.frame)
        stress, tangent, after = self._told((turn @ strain[..., None])[..., 0], history)
        back = np.swapaxes(turn, 1, 2)
        return (back @ stress[..., None])[..., 0], back @ tangent @ turn, after

    def _told(self, strain: Array, history: Array) -> Evaluated:
        n, law = len(strain), self.law
        mgis, behaviour = loaded(law)
        data = mgis.MaterialDataManager(behaviour, n)
        now = np.ascontiguousarray(np.broadcast_to(law.initial_temperature + self.change, n))
        for state, degrees in ((data.s0, history[:, 0]), (data.s1, now)):
            _set(mgis, behaviour, state, law, np.ascontiguousarray(degrees))
            state.thermodynamic_forces[:, :6] = _turned_over(history[:, STRESS], ROOT)
            if self.of.columns > HEAD:
                state.internal_state_variables[...] = self._scaled(history[:, HEAD:], ROOT)
        data.s0.gradients[...] = self._gradient(history[:, STRAIN])
        data.s1.gradients[...] = self._gradient(strain)
        wanted = mgis.IntegrationType.INTEGRATION_CONSISTENT_TANGENT_OPERATOR
        status = mgis.integrate(data, wanted, self.elapsed, 0, n)
        stress = _turned_over(np.array(data.s1.thermodynamic_forces)[:, :6], 1.0 / ROOT)
        tangent = np.array(data.K).reshape(n, 6, 6)[:, ORDER[:, None], ORDER] / (ROOT[:, None] * ROOT)
        if status < 0 or not (np.isfinite(stress).all() and np.isfinite(tangent).all()):
            raise Unsound(
                f"behaviour '{law.behaviour}' of MFront was not integrated at some point; try more load steps"
            )
        after = np.empty_like(history)
        after[:, 0], after[:, STRAIN], after[:, STRESS] = now, strain, stress
        after[:, FLOWED] = history[:, FLOWED] + self._flowed(history, after)
        if self.of.columns > HEAD:
            after[:, HEAD:] = self._scaled(np.array(data.s1.internal_state_variables), 1.0 / ROOT)
        return stress, tangent, after

    def _flowed(self, before: Array, after: Array) -> Array:
        """Work of the stresses over the step less what is elastic at the stiffness at rest, (n,)."""
        if EQUIVALENT not in self.of.fields:
            return np.zeros(len(before))
        mean = 0.5 * (before[:, STRESS] + after[:, STRESS])
        strain, stress = (after[:, part] - before[:, part] for part in (STRAIN, STRESS))
        return np.asarray((mean * (strain - stress @ self.law.compliance)).sum(axis=1))

    def _gradient(self, strain: Array) -> Array:
        """Strain as MGIS has it, or of that of Green and Lagrange the stretch U as a deformation gradient."""
        if not self.of.finite:
            return _turned_over(strain, 1.0 / ROOT)
        place = np.array([[0, 3, 5], [3, 1, 4], [5, 4, 2]])
        right = (strain * [2.0, 2.0, 2.0, 1.0, 1.0, 1.0])[:, place] + np.eye(3)
        squares, along = np.linalg.eigh(right)
        stretch = (along * np.sqrt(squares)[:, None]) @ np.swapaxes(along, 1, 2)
        result = np.empty((len(strain), 9))
        for row, places in enumerate(TENSOR):
            result[:, list(places)] = stretch[:, row]
        return result

    def _scaled(self, values: Array, factor: Array) -> Array:
        """State variables, (n, k), whose symmetric tensors take the other order of components and a factor, (6,)."""
        result = np.array(values, dtype=float)
        for columns in self.of.tensors:
            result[:, columns] = _turned_over(values[:, columns], factor)
        return result


def _turned_over(values: Array, factor: Array) -> Array:
    """From abut's order of components to that of MGIS, or back: (n, 6)."""
    return np.asarray(values[:, ORDER] * factor)


def _set(mgis: Any, behaviour: Any, state: Any, law: MFront, degrees: Array) -> None:
    """Properties and external state variables of a state."""
    for name, value in (law.properties or {}).items():
        mgis.setMaterialProperty(state, name, value)
    for name, value in (law.variables or {}).items():
        mgis.setExternalStateVariable(state, name, value)
    if FIRST in [variable.name for variable in behaviour.esvs]:
        kept = mgis.MaterialStateManagerStorageMode.LOCAL_STORAGE
        mgis.setExternalStateVariable(state, FIRST, degrees, kept)
