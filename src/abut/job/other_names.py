"""What engineers and other programs call keys and kinds of a job file: named where they are written in place of abut's."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

KEYS: Mapping[str, str] = {
    "mu": "friction", "friction_coefficient": "friction", "coefficient": "friction", "fric": "friction",
    "e": "young", "youngs_modulus": "young", "elastic_modulus": "young", "modulus": "young",
    "nu": "poisson", "poissons_ratio": "poisson", "alpha": "expansion",
    "slave": "contactor", "secondary": "contactor", "master": "target", "main": "target",
    "clearance": "offset", "interference": "offset", "increments": "steps",
}  # fmt: skip
YIELDS = "metal that yields is not supported: stresses beyond the yield stress are those of an elastic body"
RUBBER = "of the laws for rubber there is neo-Hooke"
KINDS: Mapping[str, str] = {
    "plastic": YIELDS, "elastic-plastic": YIELDS, "elastoplastic": YIELDS, "j2": YIELDS, "von-mises": YIELDS,
    "hyperelastic": RUBBER, "mooney-rivlin": RUBBER, "ogden": RUBBER, "yeoh": RUBBER, "arruda-boyce": RUBBER,
    "viscoelastic": "there are no materials that creep or relax",
    "orthotropic": "materials are the same in all directions", "anisotropic": "materials are the same in all directions",
    "elastic": "linear-elastic is what it is called", "isotropic": "linear-elastic is what it is called",
}  # fmt: skip


def key_called(name: str, known: Iterable[str]) -> str:
    """The key of a table with the keys ``known`` that elsewhere goes by a name, "" where there is none."""
    key = KEYS.get(_plain(name).replace("-", "_"), "")
    return key if key in known else ""


def kind_said(name: str) -> str:
    """What to say of a kind of material that other programs have, "" where it is not known."""
    return KINDS.get(_plain(name).replace("_", "-"), "")


def _plain(name: str) -> str:
    return name.lower().replace("'", "").replace(" ", "-")
