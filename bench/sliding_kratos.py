"""Runs what sliding.py wrote, under a Python that has Kratos; knows nothing of abut. Prints one line of JSON."""

from __future__ import annotations

import json
import os
import sys
import time
from pathlib import Path
from typing import Any

import KratosMultiphysics
import KratosMultiphysics.ConstitutiveLawsApplication
import KratosMultiphysics.ContactStructuralMechanicsApplication
import KratosMultiphysics.LinearSolversApplication
from KratosMultiphysics.StructuralMechanicsApplication import structural_mechanics_analysis


def run(folder: Path) -> dict[str, Any]:
    """Processor time, iterations and the force on the slab of the run described in a folder."""
    KratosMultiphysics.Logger.GetDefaultOutput().SetSeverity(KratosMultiphysics.Logger.Severity.WARNING)
    model_ = KratosMultiphysics.Model()
    os.chdir(folder)
    text = KratosMultiphysics.Parameters(Path("parameters.json").read_text(encoding="ascii"))
    analysis = structural_mechanics_analysis.StructuralMechanicsAnalysis(model_, text)
    start = time.process_time()
    analysis.Initialize()
    solver, rows, force, stopped = analysis._GetSolver(), [], [], ""
    reached, end = 0.0, start
    axes = (KratosMultiphysics.REACTION_X, KratosMultiphysics.REACTION_Z)
    while analysis.KeepAdvancingSolutionLoop():
        analysis.time = analysis._AdvanceTime()
        analysis.InitializeSolutionStep()
        solver.Predict()
        try:
            good = bool(solver.SolveSolutionStep())
        except RuntimeError as error:  # of its linear solver
            stopped = f"at t = {analysis.time:.3f}: {str(error).strip().splitlines()[0]}"
            break
        analysis.FinalizeSolutionStep()
        rows.append((model_["Structure"].ProcessInfo[KratosMultiphysics.NL_ITERATION_NUMBER], good))
        nodes = model_["Structure.support_0"].Nodes
        reached, end = analysis.time, time.process_time()
        force = [sum(node.GetSolutionStepValue(one) for node in nodes) for one in axes]
    return {
        "cpu": end - start, "reached": min(reached, 1.0), "iterations": sum(row[0] for row in rows), "steps": len(rows),
        "unconverged": sum(not row[1] for row in rows), "force": force, "stopped": stopped,
    }  # fmt: skip


if __name__ == "__main__":
    print(json.dumps(run(Path(sys.argv[1]))))
