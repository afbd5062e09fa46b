"""The command line ``ratt-opt``: parse, call, print.

Open ``program.py`` first: the list of commands, exit codes, errors in one line. A command stands with its kin:
``planning.py`` (demo, bound), ``scenarios.py`` (new, schema), ``attacking.py`` (attack), ``tracking.py`` (track),
``replaying.py`` (replay),
``proofs.py`` (verify, audit). ``options.py`` has the options that several commands share, ``terminal.py`` the
streams, ``exit_codes.py`` how a command ends; ``interrupts.py`` and ``faults.py`` are the last line of defence.
"""

# Nothing else is imported here: an interrupt before `main` guards is Python's to show, with a traceback.
import os
import sys

__all__ = ["main", "run"]


def main() -> None:
    """Run the command line and exit."""
    try:
        code = _run_and_ignore()
    except KeyboardInterrupt:  # outside of the command's own guards: nothing has begun, or all is done
        try:
            code = _end_interrupted()
        except KeyboardInterrupt:  # a second one, before interrupts were ignored
            code = _end_interrupted()
    from ratt_opt.cli.exit_codes import ExitCode

    if code == ExitCode.INTERRUPTED:
        # A half-done import may complain on the way out.
        from ratt_opt.cli.terminal import abandon_output

        abandon_output()
        os._exit(code)
    sys.exit(code)


def _run_and_ignore() -> int:
    """The exit code of the program's own arguments; interrupts that come later are ignored."""
    from ratt_opt.cli.interrupts import ignore_interrupts

    _hold_streams()
    code = run(sys.argv[1:])
    ignore_interrupts()
    return code


def _end_interrupted() -> int:
    """Say that the program was interrupted; further interrupts are ignored first."""
    from ratt_opt.cli.interrupts import ignore_interrupts

    ignore_interrupts()
    from ratt_opt.cli.exit_codes import ExitCode
    from ratt_opt.cli.terminal import fail

    return fail("interrupted", ExitCode.INTERRUPTED)


def _hold_streams() -> None:
    """Fill the places of closed standard streams: a result's file opened there would get what libraries print."""
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)


def _draw_into_files() -> None:
    """Draw into files, not windows, without warnings about fonts that lack a letter or cannot be cached."""
    import logging
    import warnings

    os.environ["MPLBACKEND"] = "agg"
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    warnings.filterwarnings("ignore", message=r"Glyph \d+ .* missing from")


def run(arguments: list[str]) -> int:
    """Run one command line and return its exit code; every error is one line on standard error."""
    from ratt_opt.cli.exit_codes import ExitCode
    from ratt_opt.cli.interrupts import Interrupts

    fault: Exception | None = None
    with Interrupts() as interrupts:
        try:
            from ratt_opt.cli.program import run_program

            _draw_into_files()
            return run_program(arguments)
        except KeyboardInterrupt:
            pass
        except Exception as error:  # noqa: BLE001  (the last line of defence)
            # Imports turn an interrupt into errors of their own.
            fault = None if interrupts.happened else error
        from ratt_opt.cli.faults import keep_traceback
        from ratt_opt.cli.terminal import fail

        return (
            fail("interrupted", ExitCode.INTERRUPTED)
            if fault is None
            else fail(keep_traceback(fault, arguments), ExitCode.FAULT)
        )
