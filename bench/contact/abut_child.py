"""One solve by abut in a process of its own: python bench/contact/abut_child.py CASE DOFS [--tied] [--dual] [--linear NAME]

Prints one line of JSON: seconds from a model in memory to results in memory, in all, of the processor and by stage,
iterations, force.
"""

from __future__ import annotations

import argparse
import json
import time

import cases

from abut.analysis import solve


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("case")
    parser.add_argument("dofs", type=int)
    parser.add_argument("--tied", action="store_true", help="tie the bodies: the linear problem on the same mesh")
    parser.add_argument(
        "--dual", action="store_true", help="dual multipliers, as Kratos and CalculiX (mortar) have them"
    )
    parser.add_argument("--linear", default="auto")
    arguments = parser.parse_args()
    case = cases.model(arguments.case, arguments.dofs)
    model = cases.with_options(case, linear=arguments.linear, tied=arguments.tied, dual=arguments.dual)
    start, processor = time.perf_counter(), time.process_time()
    solution = solve(model)
    seconds, processor = time.perf_counter() - start, time.process_time() - processor
    contact = solution.contacts[0]
    result = {
        "status": "ok" if solution.converged else "not converged",
        "dofs": cases.dofs(model),
        "seconds": seconds,
        "processor": processor,
        "stages": dict(solution.timings),
        "iterations": sum(len(step.iterations) for step in solution.steps),
        "force": abs(float(contact.force[2])),
        "active": contact.active,
        "multipliers": contact.multipliers,
        "solver": solution.solver,
    }
    print(json.dumps(result))


if __name__ == "__main__":
    main()
