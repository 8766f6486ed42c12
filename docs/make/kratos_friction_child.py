"""Runs the files of the current folder step by step, under a Python that has Kratos; prints a line of JSON for each step."""

from __future__ import annotations

import json
import time

import KratosMultiphysics
import KratosMultiphysics.ContactStructuralMechanicsApplication
from KratosMultiphysics.StructuralMechanicsApplication.structural_mechanics_analysis import StructuralMechanicsAnalysis

PRESSURE = KratosMultiphysics.ContactStructuralMechanicsApplication.AUGMENTED_NORMAL_CONTACT_PRESSURE


def main() -> None:
    with open("parameters.json", encoding="ascii") as file:
        parameters = KratosMultiphysics.Parameters(file.read())
    KratosMultiphysics.Logger.GetDefaultOutput().SetSeverity(KratosMultiphysics.Logger.Severity.WARNING)
    model = KratosMultiphysics.Model()
    analysis = StructuralMechanicsAnalysis(model, parameters)
    analysis.Initialize()
    solver, part, grip = analysis._GetSolver(), model["Structure"], model["Structure.support_1"]
    slave = list(model["Structure.slave"].Nodes)
    while analysis.KeepAdvancingSolutionLoop():
        start = time.perf_counter()
        analysis.time = analysis._AdvanceTime()
        analysis.InitializeSolutionStep()
        solver.Predict()
        converged = bool(solver.SolveSolutionStep())
        analysis.FinalizeSolutionStep()
        torque = 0.0
        for node in grip.Nodes:
            x, y = (
                node.GetSolutionStepValue(v) for v in (KratosMultiphysics.REACTION_X, KratosMultiphysics.REACTION_Y)
            )
            torque += node.X0 * y - node.Y0 * x
        row = {
            "time": analysis.time,
            "converged": converged,
            "iterations": part.ProcessInfo[KratosMultiphysics.NL_ITERATION_NUMBER],
            "torque": torque,
            "slipping": sum(1 for node in slave if node.Is(KratosMultiphysics.SLIP)),
            "pressure": -sum(node.GetValue(PRESSURE) for node in slave) / len(slave),
            "seconds": time.perf_counter() - start,
        }
        print(json.dumps(row), flush=True)


if __name__ == "__main__":
    main()
