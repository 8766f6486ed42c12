"""Materials that outlive the interpreter, as those of test modules and notebooks may, hold no compiled objects."""

from __future__ import annotations

import subprocess
import sys

import pytest

SCRIPT = """
import ctypes, abut
from abut.mesh.make import join, rectangle
plastic = [abut.Plastic(200e3, 0.3, 250.0), abut.Plastic(150e3, 0.3, 150.0)]
material = {material}
mesh = join({{"bar": rectangle((0.0, 2.0), (0.0, 1.0), (2, 1), "quad4")}})
supports = [abut.Support("bar.left", x=0.0, y=0.0), abut.Support("bar.right", x=0.01)]
model = abut.Model(mesh, [abut.Solid("bar", material)], supports, plane="strain", kinematics="{kinematics}")
assert abut.solve(model).converged
del model
ctypes.pythonapi.Py_IncRef(ctypes.py_object(material))
"""


@pytest.mark.parametrize("kinematics", ["small", "finite"])
@pytest.mark.parametrize("material", ["abut.OverTemperature((0.0, 100.0), plastic)", "plastic[0]"])
def test_no_instance_leaks(material: str, kinematics: str) -> None:
    """nanobind tells of instances that are alive when the interpreter ends."""
    script = SCRIPT.format(material=material, kinematics=kinematics)
    run = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert run.stderr == ""
