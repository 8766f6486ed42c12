"""Descriptions of the keys of a job file: materials."""

from __future__ import annotations

OF_MATERIALS: dict[str, dict[str, str]] = {
    "LinearElasticTable": {
        "kind": "the material law",
        "young": "Young's modulus, > 0 [force/length^2]",
        "poisson": "Poisson's ratio, between -1 and 0.5; 0.5 with integration mixed, b-bar or reduced",
        "density": "mass per volume, used by gravity [mass/length^3]",
        "expansion": "thermal expansion, used by temperature changes [1/temperature]",
    },
    "OrthotropicTable": {
        "kind": "the material law: linear elastic, with three planes of symmetry",
        "young": "Young's moduli E1, E2, E3, > 0 [force/length^2]",
        "poisson": "nu12, nu13, nu23; nu12 is the strain along 2 over the one along 1 under a stress along 1, sign turned; "
        "nu21 = nu12 E2 / E1",
        "shear": "shear moduli G12, G13, G23, > 0 [force/length^2]",
        "axes": "the local directions 1, 2, 3; in 2D the third is out of the plane, in axisymmetric models around the axis; "
        "left out: the global ones",
        "density": "mass per volume, used by gravity [mass/length^3]",
        "expansion": "thermal expansion, a number or one along each local direction [1/temperature]",
    },
    "AnisotropicTable": {
        "kind": "the material law: linear elastic, without symmetry",
        "constants": "stiffness, the upper triangle column after column, of 11 22 33 12 13 23, shear strains doubled: "
        "D1111, D1122, D2222, D1133, D2233, D3333, D1112, D2212, D3312, D1212, D1113, D2213, D3313, D1213, D1313, D1123, "
        "D2223, D3323, D1223, D1323, D2323 [force/length^2]",
        "axes": "the local directions 1, 2, 3; in 2D the third is out of the plane, in axisymmetric models around the axis; "
        "left out: the global ones",
        "density": "mass per volume, used by gravity [mass/length^3]",
        "expansion": "thermal expansion, a number or one along each local direction [1/temperature]",
    },
    "OverTemperatureTable": {
        "kind": "elasticity, or metal that yields, between other materials at some temperatures",
        "temperatures": "at which these are, growing [temperature]",
        "materials": "names of materials, all linear-elastic, or all plastic with as many backstresses, or orthotropic "
        "and anisotropic ones with the same axes; constants are linear between, and constant beyond",
        "initial_temperature": "temperature at the beginning, from which changes count [temperature]",
        "zero": "temperature from which expansions count, secants alpha(T) of alpha(T) (T - zero); left out: "
        "initial_temperature [temperature]",
    },
    "ViscoelasticTable": {
        "kind": "another material, elastic or rubber, whose stresses fade in part: linear viscoelasticity (Prony series)",
        "material": "name of the material that it is at once; linear-elastic, hencky, or rubber but for neo-hooke",
        "terms": "triples g, k, tau: shares of shear and of bulk that fade, each with a sum < 1, and their time of the run "
        "[1; 1; time]",
    },
    "MFrontTable": {
        "kind": "a behaviour compiled by MFront, through the Python module mgis.behaviour (conda-forge, Spack)",
        "library": "the shared library, from the job's folder on or as the system finds it",
        "behaviour": "its name in the library",
        "properties": "material properties by name, all that the behaviour has",
        "parameters": "parameters by name that are not what the behaviour's source says",
        "variables": "external state variables by name, constant; without Temperature",
        "initial_temperature": "the variable Temperature at the beginning, from which changes count [temperature]",
        "axes": "directions of an orthotropic behaviour, as of supports; left out: the global ones",
        "volume_preserving": "it flows or deforms nearly without change of volume, so that integration auto takes what "
        "does not lock",
        "density": "mass per volume, used by gravity [mass/length^3]",
        "expansion": "thermal expansion, 0 where the behaviour has it in itself [1/temperature]",
    },
    "NeoHookeTable": {
        "kind": "the material law, for finite kinematics",
        "young": "Young's modulus at small strains, > 0; with poisson [force/length^2]",
        "poisson": "Poisson's ratio at small strains, between -1 and 0.5; with young",
        "shear": "shear modulus mu, > 0; with bulk or lame, in place of young and poisson [force/length^2]",
        "bulk": "bulk modulus K = lambda + 2 mu / 3, > 0; with shear [force/length^2]",
        "lame": "Lame's first constant lambda; with shear [force/length^2]",
        "volumetric": "energy of volume changes J = det F: square-log is lambda/2 ((J^2 - 1)/2 - ln J), log-squared "
        "lambda/2 (ln J)^2; isochoric is K/2 (J - 1)^2 beside shear at constant volume",
        "density": "mass per undeformed volume, used by gravity [mass/length^3]",
        "expansion": "thermal expansion, used by temperature changes [1/temperature]",
    },
    "HenckyTable": {
        "kind": "the material law, for finite kinematics: stress linear in the logarithmic strain",
        "young": "Young's modulus, > 0 [force/length^2]",
        "poisson": "Poisson's ratio, between -1 and 0.5; 0.5 with integration mixed, b-bar or reduced",
        "density": "mass per undeformed volume, used by gravity [mass/length^3]",
        "expansion": "thermal expansion, used by temperature changes [1/temperature]",
    },
    "MooneyRivlinTable": {
        "kind": "the material law, for finite kinematics: C10 (I1 - 3) + C01 (I2 - 3) of volume-preserving invariants",
        "c10": "factor of I1 - 3 [force/length^2]",
        "c01": "factor of I2 - 3 [force/length^2]",
        "bulk": "bulk modulus K of the energy K/2 (J - 1)^2, or a list of factors of (J - 1)^2, (J - 1)^4, ... "
        "[force/length^2]",
        "density": "mass per undeformed volume, used by gravity [mass/length^3]",
        "expansion": "thermal expansion, used by temperature changes [1/temperature]",
    },
    "YeohTable": {
        "kind": "the material law, for finite kinematics: C10 (I1 - 3) + C20 (I1 - 3)^2 + C30 (I1 - 3)^3",
        "c10": "factor of I1 - 3 [force/length^2]",
        "c20": "factor of (I1 - 3)^2 [force/length^2]",
        "c30": "factor of (I1 - 3)^3 [force/length^2]",
        "bulk": "bulk modulus K of the energy K/2 (J - 1)^2, or a list of factors of (J - 1)^2, (J - 1)^4, ... "
        "[force/length^2]",
        "density": "mass per undeformed volume, used by gravity [mass/length^3]",
        "expansion": "thermal expansion, used by temperature changes [1/temperature]",
    },
    "OgdenTable": {
        "kind": "the material law, for finite kinematics: the sum of mu / alpha (l1^alpha + l2^alpha + l3^alpha - 3)",
        "terms": "[mu, alpha] of each term, Ogden's own form; mu of Abaqus and CalculiX is half of mu alpha here "
        "[force/length^2, 1]",
        "bulk": "bulk modulus K of the energy K/2 (J - 1)^2, or a list of factors of (J - 1)^2, (J - 1)^4, ... "
        "[force/length^2]",
        "density": "mass per undeformed volume, used by gravity [mass/length^3]",
        "expansion": "thermal expansion, used by temperature changes [1/temperature]",
    },
    "ArrudaBoyceTable": {
        "kind": "the material law, for finite kinematics: chains that lock at a stretch",
        "shear": "mu of the series, about the shear modulus at rest [force/length^2]",
        "locking": "stretch at which chains lock",
        "bulk": "bulk modulus K of the energy K/2 (J - 1)^2, or a list of factors of (J - 1)^2, (J - 1)^4, ... "
        "[force/length^2]",
        "density": "mass per undeformed volume, used by gravity [mass/length^3]",
        "expansion": "thermal expansion, used by temperature changes [1/temperature]",
    },
    "PlasticTable": {
        "kind": "the material law: metal that yields (von Mises)",
        "young": "Young's modulus, > 0 [force/length^2]",
        "poisson": "Poisson's ratio, between -1 and 0.5; 0.5 with integration mixed, b-bar or reduced",
        "yield_stress": "in uniaxial tension, or a table of [equivalent plastic strain, yield stress] from strain 0 on, "
        "linear between and constant beyond; true stresses [force/length^2]",
        "hardening": "isotropic hardening: yield stress over equivalent plastic strain, added to yield_stress "
        "[force/length^2]",
        "saturation": "Voce's isotropic hardening: adds saturation (1 - exp(-rate x)) at an equivalent plastic strain x "
        "[force/length^2]",
        "rate": "of Voce's hardening, with saturation",
        "backstresses": "kinematic hardening: [modulus, recall] of each back stress; recall 0 is linear (Prager), else "
        "Armstrong and Frederick's [force/length^2, 1]",
        "density": "mass per volume, used by gravity [mass/length^3]",
        "expansion": "thermal expansion, used by temperature changes [1/temperature]",
    },
}
