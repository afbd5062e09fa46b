"""The command line ``ratt-opt``: parse, call, print.

Open ``program.py`` first: the list of commands, exit codes, errors in one line. A command stands with its kin:
``planning.py`` (demo, bound), ``scenarios.py`` (new, schema), ``attacking.py`` (attack), ``tracking.py`` (track),
``proofs.py`` (verify, audit). ``options.py`` has the options that several commands share, ``terminal.py`` where text
goes.
"""

import os
import sys

__all__ = ["main", "run"]


def main() -> None:
    """Run the command line and exit."""
    try:
        code = run(sys.argv[1:])
    except KeyboardInterrupt:  # while modules were imported: nothing has begun
        code = 130
    if code == 130:
        # What an import left half done may complain on the way out.
        for stream in (sys.stdout, sys.stderr):
            if stream is not None:
                stream.flush()
        os._exit(code)
    sys.exit(code)


def run(arguments: list[str]) -> int:
    """Run one command line and return its exit code; every error is one line on standard error."""
    from ratt_opt.cli.program import run as run_program

    return run_program(arguments)
