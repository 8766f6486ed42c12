"""The command line: abut run, sweep, mesh, check, convert, verify, infsup, fit, schema."""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import sys
import time
import traceback
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from abut.cli.check import add_check
from abut.cli.convert import add_convert
from abut.cli.fit import add_fit
from abut.cli.mesh import add_mesh
from abut.cli.run import add_run, passes_on
from abut.cli.sweep import add_sweep
from abut.cli.terminal import shortened, show
from abut.cli.verify import add_infsup, add_verify
from abut.errors import AbutError, InputError
from abut.parallel.launch import processes, rank

DONE, BUG, INTERRUPTED, NO_READER = 0, 1, 130, 141
EXAMPLES = """examples:
  abut check punch.toml              mistakes, before the solve
  abut run punch.toml                then open results/report.html in a browser, results/*.pvd in ParaView
  abut run deck.inp                  an Abaqus or CalculiX deck
  abut convert deck.inp punch.toml   the same as a job file with its mesh, to edit

`abut COMMAND --help` says more of a command.
"""
PAUSE = 10.0  # seconds; mpiexec ends all processes when one fails, and process 0 must get to its message first


def main(argv: Sequence[str] | None = None, loaded: Callable[[], None] | None = None) -> int:
    """Run the command line and return its exit status: 0 done, 2 bad input, 3 not converged, 4 no unique solution,
    124 out of time, 130 stopped by Ctrl-C (143 by SIGTERM), 1 internal error. Of several processes all but
    the first keep silent about it. loaded: called when what commands import is there."""
    if processes() > 1:
        os.environ.setdefault("OMP_NUM_THREADS", "1")  # read when NumPy and the core are imported
    arguments = _parse(argv)
    if rank() and not arguments.together:
        return DONE  # process 0 does it alone
    try:
        if loaded is not None:
            _load()
            loaded()
        return int(arguments.command(arguments))
    except AbutError as error:
        if rank():
            time.sleep(PAUSE)
        else:
            show(f"abut: error: {shortened(str(error))}", file=sys.stderr, flush=True)
        return error.exit_status
    except MemoryError:
        show(
            "abut: error: not enough memory for this model; choose a coarser mesh, or a larger machine (a mesh file that "
            "is small may be damaged)",
            file=sys.stderr,
        )
        return InputError.exit_status
    except BrokenPipeError:  # whoever read the output has gone, as in `abut run JOB | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return NO_READER
    except KeyboardInterrupt:
        show("abut: stopped", file=sys.stderr)
        return INTERRUPTED
    except Exception as error:
        if getattr(arguments, "debug", False):
            show(traceback.format_exc(), file=sys.stderr, end="")
        show(f"abut: internal error: this is a bug in abut: {type(error).__name__}: {error}", file=sys.stderr)
        show(
            "abut: please report it with the job file and the output of the same command with --debug", file=sys.stderr
        )
        return BUG


def _load() -> None:
    """Import what commands need, which they would otherwise do on the way."""
    import abut.analysis
    import abut.cli.interrupt
    import abut.cli.progress
    import abut.job
    import abut.output.stream  # noqa: F401


def _parse(argv: Sequence[str] | None) -> argparse.Namespace:
    """Arguments; what abut does not know of them, and PETSc may, as ``petsc``."""
    parser = _parser()
    if not (sys.argv[1:] if argv is None else argv):
        if not rank():
            parser.print_help()
        raise SystemExit(InputError.exit_status)
    with contextlib.ExitStack() as silence:
        if rank():
            nowhere = silence.enter_context(open(os.devnull, "w"))
            silence.enter_context(contextlib.redirect_stdout(nowhere))
            silence.enter_context(contextlib.redirect_stderr(nowhere))
        try:
            arguments, rest = parser.parse_known_args(argv)
            if rest and not (arguments.together and passes_on(arguments.job, rest)):
                parser.error(f"unrecognized arguments: {' '.join(rest)}")
        except SystemExit as end:
            raise SystemExit(DONE if rank() else end.code) from None  # process 0 says the same, and ends them all
    arguments.petsc = rest
    return arguments


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="abut",
        description="Finite element contact mechanics that one can trust.",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and exit")
    parser.set_defaults(together=False)  # whether all processes take part
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    add_run(commands)
    add_sweep(commands)
    add_mesh(commands)
    add_check(commands)
    add_convert(commands)
    add_verify(commands)
    add_infsup(commands)
    add_fit(commands)
    schema = commands.add_parser(
        "schema",
        help="print the JSON Schema of job files, for editors",
        description="Print the JSON Schema of job files: every key with its type and meaning. Editors with a TOML language "
        "server complete and check jobs by it.",
    )
    schema.add_argument("--output", type=Path, metavar="FILE", help="write it to a file")
    schema.set_defaults(command=_schema)
    return parser


class _Parser(argparse.ArgumentParser):
    def _print_message(self, message: str, file: Any = None) -> None:
        """Whatever stands on the command line."""
        if message:
            show(message, end="", file=file or sys.stderr)


class _Version(argparse.Action):
    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> None:
        from importlib.metadata import version

        show(f"abut {version('abut')}")
        parser.exit(DONE)


def _schema(arguments: argparse.Namespace) -> int:
    from abut.io.atomic import write_text
    from abut.job import json_schema

    text = json.dumps(json_schema(), indent=2) + "\n"
    if arguments.output is None:
        show(text, end="")
    else:
        write_text(arguments.output, text)
    return DONE
