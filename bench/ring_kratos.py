"""Runs what ring_peers.py wrote, under a Python that has Kratos: python ring_kratos.py FOLDER NODE. Prints time, rise of the
node (mm), and whether it converged, for each step."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import KratosMultiphysics
import KratosMultiphysics.ConstitutiveLawsApplication
import KratosMultiphysics.ContactStructuralMechanicsApplication
import KratosMultiphysics.LinearSolversApplication
from KratosMultiphysics.StructuralMechanicsApplication import structural_mechanics_analysis


def run(folder: Path, number: int) -> None:
    """Ends with the last step that its linear solver can take."""
    KratosMultiphysics.Logger.GetDefaultOutput().SetSeverity(KratosMultiphysics.Logger.Severity.WARNING)
    os.chdir(folder)
    model_ = KratosMultiphysics.Model()
    parameters = KratosMultiphysics.Parameters(Path("parameters.json").read_text(encoding="ascii"))
    analysis = structural_mechanics_analysis.StructuralMechanicsAnalysis(model_, parameters)
    analysis.Initialize()
    solver = analysis._GetSolver()
    while analysis.KeepAdvancingSolutionLoop():
        analysis.time = analysis._AdvanceTime()
        analysis.InitializeSolutionStep()
        solver.Predict()
        try:
            good = bool(solver.SolveSolutionStep())
        except RuntimeError:  # a singular matrix
            return
        analysis.FinalizeSolutionStep()
        moved = model_["Structure"].GetNode(number).GetSolutionStepValue(KratosMultiphysics.DISPLACEMENT_Y)
        print(f"ROW {analysis.time!r} {1e3 * moved!r} {int(good)}", flush=True)


if __name__ == "__main__":
    run(Path(sys.argv[1]), int(sys.argv[2]))
