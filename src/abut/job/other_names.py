"""What engineers and other programs call keys and kinds of a job file: named where they are written in place of abut's."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

KEYS: Mapping[str, str] = {
    "mu": "friction", "friction_coefficient": "friction", "coefficient": "friction", "fric": "friction",
    "e": "young", "youngs_modulus": "young", "elastic_modulus": "young", "modulus": "young",
    "nu": "poisson", "poissons_ratio": "poisson", "alpha": "expansion",
    "slave": "contactor", "secondary": "contactor", "master": "target", "main": "target",
    "yield": "yield_stress", "sigma_y": "yield_stress", "sigy": "yield_stress", "sy": "yield_stress", "sig0": "yield_stress",
    "initial_yield_stress": "yield_stress", "yield_strength": "yield_stress", "re": "yield_stress", "rp02": "yield_stress",
    "h": "hardening", "tangent_modulus": "hardening", "hardening_modulus": "hardening", "h_iso": "hardening",
    "isotropic_hardening": "hardening", "q": "saturation", "q_inf": "saturation", "b": "rate", "c": "backstresses",
    "prager": "backstresses", "kinematic": "backstresses", "kinematic_hardening": "backstresses",
    "chaboche": "backstresses", "back_stress": "backstresses", "gamma": "backstresses",
    "clearance": "offset", "interference": "offset", "increments": "steps",
}  # fmt: skip
YIELDS = "plastic is what it is called"
RUBBER = "of the laws for rubber there are neo-hooke, mooney-rivlin, yeoh, ogden and arruda-boyce"
ORTHOTROPIC = "orthotropic is what it is called"
KINDS: Mapping[str, str] = {
    "elastic-plastic": YIELDS, "elastoplastic": YIELDS, "j2": YIELDS, "von-mises": YIELDS, "vmis": YIELDS, "mises": YIELDS,
    "vmis-isot-line": YIELDS, "vmis-isot-trac": YIELDS, "vmis-cine-line": YIELDS, "chaboche": YIELDS,
    "logarithmic": "hencky is what it is called", "elas-hyper-log": "hencky is what it is called",
    "hyperelastic": RUBBER, "mooney": RUBBER, "polynomial": RUBBER, "rubber": RUBBER, "signorini": RUBBER, "gent": RUBBER,
    "prony": "viscoelastic is what it is called", "maxwell": "viscoelastic is what it is called",
    "creep": "there is no creep of metals; of polymers that relax viscoelastic", "norton": "there is no creep of metals",
    "umat": "behaviours of MFront go by kind mfront, laws in Python by a class of one's own",
    "ortho": ORTHOTROPIC, "engineering-constants": ORTHOTROPIC, "lamina": ORTHOTROPIC, "transversely-isotropic": ORTHOTROPIC,
    "elas-orth": ORTHOTROPIC, "elas-istr": ORTHOTROPIC, "aniso": "anisotropic is what it is called",
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
