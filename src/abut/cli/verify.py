"""abut verify and abut infsup: the method on problems with known answers, and on a user's own model."""

from __future__ import annotations

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from abut.cli.run import add_set
from abut.cli.terminal import show
from abut.errors import InputError, closest

if TYPE_CHECKING:
    from abut.benchmarks import Outcome
    from abut.types import Json

DONE, FAILED = 0, 1


def add_verify(commands: Any) -> None:
    """Add ``abut verify`` to the parser's ``commands``."""
    verify = commands.add_parser(
        "verify",
        help="run problems with known answers, or tests of a job",
        description="Run the benchmark library: value, reference, error, tolerance and source of every quantity. With "
        "a job or deck, run the contact patch test on its meshes instead; with --swap, solve it as it is and with the "
        "sides of its contacts swapped, and compare.",
        epilog="exit status: 0 all pass; 1 something fails, or the two solutions of --swap differ (by more than 10 %% of "
        "the largest pressure inside the contact, or 2 %% of the force); 2 bad input; 3 not converged",
    )
    verify.add_argument(
        "names", nargs="*", metavar="NAME", help="benchmarks to run (all of them if left out), or one job or deck"
    )
    verify.add_argument("--swap", action="store_true", help="of a job: a second opinion, with the sides swapped")
    verify.add_argument("--output", type=Path, metavar="DIR", help="with --swap: write report.html here")
    verify.add_argument("--list", action="store_true", help="list the benchmarks")
    verify.add_argument("--levels", type=int, metavar="N", help="refine N times, fit the rate of convergence, plot it")
    verify.add_argument("--plot", type=Path, metavar="FILE", help="with --levels: save the plot (png, svg; matplotlib)")
    verify.add_argument("--job", type=Path, help="patch test of every contact of this job (or deck), on its own meshes")
    add_set(verify)
    verify.add_argument("--json", action="store_true", help="print the results as JSON")
    verify.add_argument("--debug", action="store_true", help="print the traceback of an internal error")
    verify.set_defaults(command=_verify)


def add_infsup(commands: Any) -> None:
    """Add ``abut infsup`` to the parser's ``commands``."""
    infsup = commands.add_parser(
        "infsup",
        help="inf-sup constant of a job's contact",
        description="The numerical inf-sup test of a contact: is its pressure stable? Supports are those of the job.",
        epilog="exit status: 0 stable; 1 not stable; 2 bad input",
    )
    infsup.add_argument("job", type=Path, help="the job file or deck")
    add_set(infsup)
    infsup.add_argument("--contact", metavar="NAME", help="which contact (all of them if left out)")
    infsup.add_argument(
        "--levels",
        type=int,
        default=1,
        metavar="N",
        help="also on generated meshes with cells halved, up to N - 1 times",
    )
    infsup.add_argument("--json", action="store_true", help="print the results as JSON")
    infsup.add_argument("--debug", action="store_true", help="print the traceback of an internal error")
    infsup.set_defaults(command=_infsup)


def _verify(arguments: argparse.Namespace) -> int:
    if arguments.job is None and len(arguments.names) == 1 and _is_job(arguments.names[0]):
        arguments.job = Path(arguments.names.pop())
    if arguments.job is not None:
        if arguments.names or arguments.levels is not None:
            raise InputError("verify: a job goes without benchmark names and --levels")
        return _verify_job(arguments)
    if arguments.swap or arguments.output is not None or arguments.set:
        raise InputError("verify: --swap, --output and --set are for a job: abut verify job.toml --swap")
    from abut.benchmarks import BENCHMARKS, run

    for name in arguments.names:
        if name not in BENCHMARKS:
            cure = closest(name, BENCHMARKS) or "; abut verify --list names them"
            raise InputError(f"verify: no benchmark named {name!r}{cure}")
    chosen = [BENCHMARKS[name] for name in arguments.names or BENCHMARKS]
    if arguments.list:
        longest = max(len(name) for name in BENCHMARKS)
        for benchmark in chosen:
            show(f"{benchmark.name:{longest}s}  {benchmark.title}")
        return DONE
    if arguments.levels is not None and arguments.levels < 1:
        raise InputError(f"verify: --levels: expected a whole number >= 1, got {arguments.levels}")
    if arguments.plot is not None:
        _matplotlib()
    outcomes: list[Outcome] = []
    width = max(len(benchmark.name) for benchmark in chosen)
    if not arguments.json:
        titles = f"{'value':>12s} {'reference':>12s} {'error':>9s} {'limit':>9s}  rate"
        show(f"      {'benchmark':{width}s} {'quantity':16s} {titles}")
    for benchmark in chosen:
        results = run(benchmark, arguments.levels)
        outcomes += results
        if arguments.json:
            continue
        for outcome in results:
            _print_outcome(outcome, width)
        for source in dict.fromkeys(outcome.reference.source for outcome in results):
            show(f"      {'':{width}s} source: {source}", flush=True)
    if arguments.json:
        show(json.dumps([_plain(outcome) for outcome in outcomes], indent=2))
    elif arguments.levels is not None and arguments.levels > 1:
        for outcome in outcomes:
            _text_plot(outcome)
    if arguments.plot is not None:
        _plot(outcomes, arguments.plot)
    failed = [outcome for outcome in outcomes if not outcome.passed]
    if not arguments.json:
        seconds = sum({outcome.benchmark: outcome.seconds for outcome in outcomes}.values())
        show(f"{len(outcomes) - len(failed)} of {len(outcomes)} quantities pass, {seconds:.0f} s")
    return FAILED if failed else DONE


def _is_job(name: str) -> bool:
    """Whether a name is that of a job or deck, rather than a benchmark's."""
    return Path(name).suffix.lower() in (".toml", ".inp")


def _print_outcome(outcome: Outcome, width: int) -> None:
    rate = "" if len(outcome.values) < 2 else "-" if outcome.rate is None else f"{outcome.rate:.2f}"
    if outcome.rate is not None and outcome.reference.rate is not None:
        rate += f" (theory {outcome.reference.rate:g})"
    show(
        f"{'pass' if outcome.passed else 'FAIL'}  {outcome.benchmark:{width}s} {outcome.quantity:16s} "
        f"{outcome.values[-1]:12.6g} {outcome.reference.value:12.6g} {outcome.error:9.2e} "
        f"{outcome.reference.tolerance:9.1e}  {rate}",
        flush=True,
    )


def _plain(outcome: Outcome) -> Json:
    return {
        "benchmark": outcome.benchmark,
        "quantity": outcome.quantity,
        "values": list(outcome.values),
        "reference": outcome.reference.value,
        "error": outcome.error,
        "tolerance": outcome.reference.tolerance,
        "reason": outcome.reference.reason,
        "source": outcome.reference.source,
        "rate": outcome.rate,
        "expected_rate": outcome.reference.rate,
        "passed": outcome.passed,
    }


def _text_plot(outcome: Outcome, columns: int = 60) -> None:
    """Errors by level as bars on a logarithmic scale."""
    import math

    errors = outcome.errors
    exponents = [math.log10(max(error, 1e-17)) for error in errors]
    low, high = math.floor(min(exponents)), math.ceil(max(exponents))
    show(f"{outcome.benchmark} {outcome.quantity}: error by level, 1e{low} .. 1e{high}")
    for level, (error, exponent) in enumerate(zip(errors, exponents)):
        bar = round(columns * (exponent - low) / max(high - low, 1))
        show(f"  {level}  {error:9.2e} {'#' * bar}")


def _matplotlib() -> Any:
    try:
        import matplotlib

        matplotlib.use("Agg")
        import matplotlib.pyplot as plt
    except ImportError:
        raise InputError("--plot needs matplotlib, which is not installed: pip install 'abut[picture]'") from None
    return plt


def _plot(outcomes: Sequence[Outcome], path: Path) -> None:
    from abut.benchmarks import BENCHMARKS

    plt = _matplotlib()
    figure, axes = plt.subplots(figsize=(6, 4.5), constrained_layout=True)
    for outcome in outcomes:
        sizes = [BENCHMARKS[outcome.benchmark].size(level) for level in range(len(outcome.values))]
        rate = "" if outcome.rate is None else f", rate {outcome.rate:.2f}"
        axes.loglog(sizes, outcome.errors, "o-", label=f"{outcome.benchmark} {outcome.quantity}{rate}")
    axes.set_xlabel("mesh size")
    axes.set_ylabel("error")
    axes.grid(True, which="both", alpha=0.3)
    axes.legend(fontsize="small")
    try:
        figure.savefig(path, dpi=150)
    except (OSError, ValueError) as error:
        raise InputError(f"--plot: cannot write {path} ({error})") from None


def _verify_job(arguments: argparse.Namespace) -> int:
    from abut.job import load_job
    from abut.job.parameters import read_settings
    from abut.verify import interface_patch
    from abut.verify.interface_patch import describe

    job = load_job(arguments.job, settings=read_settings(arguments.set))
    if arguments.swap:
        from abut.cli.swap import verify_swap

        return verify_swap(arguments, job)
    results = interface_patch(job.model)
    if arguments.json:
        show(json.dumps([{**vars(result), "passed": result.passed} for result in results], indent=2))
    else:
        for result in results:
            show(*describe(result), sep="\n")
    return DONE if all(result.passed for result in results) else FAILED


def _infsup(arguments: argparse.Namespace) -> int:
    from abut.job import load_job
    from abut.job.parameters import read_settings
    from abut.verify import inf_sup

    if arguments.levels < 1:
        raise InputError(f"infsup: --levels: expected a whole number >= 1, got {arguments.levels}")
    settings = read_settings(arguments.set)
    models = [load_job(arguments.job, refine=level, settings=settings).model for level in range(arguments.levels)]
    names = [arguments.contact] if arguments.contact else [c.name for c in models[0].contacts if c.kind != "tied"]
    results = [inf_sup(models, name) for name in names or [None]]
    if arguments.json:
        plain = [{**vars(r), "levels": [vars(level) for level in r.levels]} for r in results]
        show(json.dumps(plain, indent=2))
        return DONE if all(r.stable for r in results) else FAILED
    for result in results:
        first = result.levels[0]
        show(f"contact '{first.contact}', pressure {first.space}")
        cells = any(level.cells is not None for level in result.levels)
        beside = "   beta with cells" if cells else ""
        show(f"  multipliers   facet size   beta (H^-1/2)   beta (h M)   spurious modes{beside}")
        for level in result.levels:
            show(
                f"  {level.multipliers:11d}   {level.size:10.4g}   {level.trace:13.4f}   {level.mesh:10.4f}   "
                f"{level.spurious:14d}{'' if level.cells is None else f'   {level.cells:15.4f}'}"
            )
        show(f"  {result.verdict}")
    return DONE if all(r.stable for r in results) else FAILED
