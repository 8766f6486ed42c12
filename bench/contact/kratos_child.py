"""Runs what kratos.py wrote, in the current folder and under a Python that has Kratos; knows nothing of abut.

Prints one line of JSON: seconds from reading the files to the solution, iterations, force on the lower body's foot.
"""

from __future__ import annotations

import json
import time

import KratosMultiphysics
import KratosMultiphysics.ConstitutiveLawsApplication
import KratosMultiphysics.ContactStructuralMechanicsApplication
from KratosMultiphysics.StructuralMechanicsApplication.structural_mechanics_analysis import StructuralMechanicsAnalysis


def main() -> None:
    with open("parameters.json", encoding="ascii") as file:
        parameters = KratosMultiphysics.Parameters(file.read())
    KratosMultiphysics.Logger.GetDefaultOutput().SetSeverity(KratosMultiphysics.Logger.Severity.WARNING)
    model = KratosMultiphysics.Model()
    start = time.perf_counter()
    analysis = StructuralMechanicsAnalysis(model, parameters)
    analysis.Initialize()
    read, part = time.perf_counter(), model["Structure"]
    solver, converged, iterations = analysis._GetSolver(), True, 0
    while analysis.KeepAdvancingSolutionLoop():
        analysis.time = analysis._AdvanceTime()
        analysis.InitializeSolutionStep()
        solver.Predict()
        converged = solver.SolveSolutionStep() and converged
        analysis.FinalizeSolutionStep()
        iterations += part.ProcessInfo[KratosMultiphysics.NL_ITERATION_NUMBER]
    seconds = time.perf_counter() - start
    foot = model["Structure.support_0"].Nodes
    result = {
        "status": "ok" if converged else "not converged",
        "seconds": seconds,
        "stages": {"read and set-up": read - start, "solve": start + seconds - read},
        "iterations": iterations,
        "force": abs(sum(node.GetSolutionStepValue(KratosMultiphysics.REACTION_Z) for node in foot)),
    }
    print(json.dumps(result))


if __name__ == "__main__":
    main()
