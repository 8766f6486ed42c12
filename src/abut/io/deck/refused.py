"""What abut must refuse in a deck: cards, procedures and parameters, each with why and what to do instead."""

from __future__ import annotations

_HEAT = "take the temperatures from a heat solver and give them by *TEMPERATURE in a *STATIC step"
_MODES = (
    "write one *FREQUENCY step, then this one, without further parameters, or [harmonic] or [transient] of a job file "
    "(abut convert)"
)
_DESIGN = "use *STATIC, and change the design from run to run (abut sweep)"
PROCEDURES = {  # other than *STATIC: what each is, and what to do; ignoring one leaves the whole step out
    "BUCKLE": ("buckling but as the only step", "make a deck whose only step it is"),
    "CFD": ("flow", "solve the flow elsewhere and give its pressures by *DLOAD, its temperatures by *TEMPERATURE"),
    "COMPLEX FREQUENCY": (
        "complex eigenfrequencies but with CORIOLIS or of friction (no parameter), without limits, after *FREQUENCY in a "
        "*STEP, PERTURBATION; FLUTTER takes forces of a flow",
        "write the steps so",
    ),
    "COUPLED TEMPERATURE-DISPLACEMENT": ("heat transfer coupled with displacement", _HEAT),
    "CRACK PROPAGATION": ("crack propagation", "use *STATIC for the body with the crack as it is"),
    "DYNAMIC": ("dynamics", "use *STATIC for what moves slowly or has come to rest"),
    "ELECTROMAGNETICS": ("electromagnetics", "give its forces by *CLOAD, its temperatures by *TEMPERATURE"),
    "FEASIBLE DIRECTION": ("optimisation", _DESIGN),
    "FREQUENCY": (
        "eigenfrequencies with loads in their step, an upper limit, STORAGE=YES (but before vibrations), contacts that "
        "static steps after it lack, too, or *STEP, PERTURBATION before any static step",
        "write the step without, or in a deck of its own",
    ),
    "GREEN": ("Green functions", "use *STATIC with each unit force"),
    "HEAT TRANSFER": ("heat transfer", _HEAT),
    "MODAL DYNAMIC": ("modal dynamics", _MODES),
    "SENSITIVITY": ("sensitivities", _DESIGN),
    "STEADY STATE DYNAMICS": ("steady-state dynamics", _MODES),
    "SUBSTRUCTURE GENERATE": ("substructures", "use *STATIC with the whole model"),
    "UNCOUPLED TEMPERATURE-DISPLACEMENT": ("heat transfer coupled with displacement", _HEAT),
    "VISCO": ("creep and viscosity", "use *STATIC with *ELASTIC or *PLASTIC for what happens before time counts"),
}

_MATERIAL = "; give *ELASTIC, *PLASTIC or, with NLGEOM, *HYPERELASTIC"
RUBBER = "this kind of rubber elasticity is not supported; fit MOONEY-RIVLIN, YEOH, OGDEN or ARRUDA-BOYCE"
_WRITE = "; have the preprocessor write out every node and element"
_THERMAL = "; give the temperatures by *TEMPERATURE"
_FLOW = "belongs to the flow in networks or of fluids, which abut does not solve; give its pressures by *DLOAD"
_STATE = "; make a deck for each state"
_OPTIMISED = "belongs to optimisation; take it out with its step"
REFUSED: dict[str, str] = {
    "BOUNDARYF": _FLOW,
    "CFLUX": f"heat flux belongs to heat transfer, which abut does not solve{_THERMAL}",
    "CHANGE CONTACT TYPE": f"contact that changes between steps is not supported{_STATE}",
    "CHANGE MATERIAL": f"materials that change between steps are not supported{_STATE}",
    "COHESIVE BEHAVIOR": "cohesive contact is not supported; tie the surfaces (*TIE), or let them touch",
    "CONSTRAINT": f"a constraint of the design {_OPTIMISED}",
    "CONTACT EXCLUSIONS": "exclusions are not read; name the surfaces that touch in *CONTACT PAIR",
    "CREEP": f"creep is not supported{_MATERIAL}",
    "DAMPING MODEL": "damping belongs to dynamics; take it out",
    "DEFORMATION PLASTICITY": "deformation theory is not supported; give *PLASTIC",
    "DEPVAR": f"variables of user materials are not read{_MATERIAL}",
    "DESIGN VARIABLES": f"what the design may change {_OPTIMISED}",
    "DFLUX": f"heat flux belongs to heat transfer, which abut does not solve{_THERMAL}",
    "ELECTRICAL CONDUCTIVITY": "it belongs to electromagnetics, which abut does not solve; take it out",
    "ELGEN": f"generated elements are not read{_WRITE}",
    "ELCOPY": f"generated elements are not read{_WRITE}",
    "EQUATIONF": _FLOW,
    "FILM": f"heat films belong to heat transfer, which abut does not solve{_THERMAL}",
    "FLUID CONSTANTS": _FLOW,
    "FLUID SECTION": _FLOW,
    "HYPERFOAM": f"foam elasticity is not supported{_MATERIAL}",
    "MAGNETIC PERMEABILITY": "it belongs to electromagnetics, which abut does not solve; take it out",
    "MASS FLOW": _FLOW,
    "MODAL DAMPING": "damping belongs to *STEADY STATE DYNAMICS and *MODAL DYNAMIC; take it out",
    "MULTI-STAGE CYCLIC SYMMETRY": "multistage cyclic symmetry is not supported; model one sector",
    "NCOPY": f"generated nodes are not read{_WRITE}",
    "NFILL": f"generated nodes are not read{_WRITE}",
    "NGEN": f"generated nodes are not read{_WRITE}",
    "RADIATE": f"radiation belongs to heat transfer, which abut does not solve{_THERMAL}",
    "RATE DEPENDENT": f"rates are not supported{_MATERIAL}",
    "REFINE MESH": "refinement is not supported; refine the mesh in the preprocessor",
    "SPECIFIC GAS CONSTANT": _FLOW,
    "SYSTEM": f"nodes in a system of their own are not read{_WRITE}",
    "TRANSFORMF": _FLOW,
    "USER MATERIAL": f"user materials are not supported{_MATERIAL}",
    "VISCOELASTIC": f"viscosity is not supported{_MATERIAL}",
} | {name: f"abut solves *STATIC steps only, not {what}; {cure}" for name, (what, cure) in PROCEDURES.items()}

PARAMETERS = {  # of cards that are read
    ("STEP", "PERTURBATION"): "perturbation steps are not supported; give all loads of the state in one step",
    ("STATIC", "RIKS"): "arc-length steps are not supported; prescribe a displacement in place of the force",
    ("BOUNDARY", "MASSFLOW"): _FLOW,
    ("BOUNDARY", "PRESSURE"): _FLOW,
    ("BOUNDARY", "TEMPERATURE"): f"it belongs to heat transfer, which abut does not solve{_THERMAL}",
    ("BOUNDARY", "DATASET"): "modes of another run are not read; give STEP, a static one",
    ("TEMPERATURE", "SUBMODEL"): "temperatures of another run are not read; give them as numbers",
    ("SUBMODEL", "GLOBALELSET"): "parts of the global model are not told apart; write a result file of the part alone",
    ("INITIAL CONDITIONS", "USER"): "user subroutines are not read; give numbers",
    ("AMPLITUDE", "USER"): "user subroutines are not read; give a table of times and factors",
    ("SPRING", "ORIENTATION"): "axes of its own are not read; give springs along the global axes, or SPRINGA",
    ("TIE", "MULTISTAGE"): "multistage ties are not supported; model one stage",
    ("TIE", "FLUIDCYCLIC"): _FLOW,
    ("TIE", "FLUIDPERIODIC"): _FLOW,
    ("FRICTION", "TAUMAX"): "a largest shear stress is not read; give the coefficient over pressure, line by line",
    ("FRICTION", "EXPONENTIALDECAY"): "a coefficient over the slip rate is not supported; give one",
    ("FRICTION", "ANISOTROPIC"): "friction that depends on the direction is not supported; give one coefficient",
    ("FRICTION", "DEPENDENCIES"): "a coefficient over field variables is not supported; give one",
    ("FRICTION", "USER"): "user subroutines are not read; give the coefficient as a number",
    ("CHANGE FRICTION", "AMPLITUDE"): "a coefficient over time within a step is not read; it changes as a step begins",
}
