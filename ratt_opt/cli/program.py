"""All commands, and what becomes of their errors.

Exit codes: 0 done; 1 a certificate does not prove its claim; 2 bad input; 3 ``verify``: only the upper end is proved;
4 ``verify``: not decided within its limits; 70 a fault of the program, whose traceback is in a file; 74 standard
output is closed or full; 130 interrupted. Each but 0 and 3 comes with one line on standard error. Results go to
standard output, progress to standard error.
"""

import re
from typing import Annotated, Any

import typer

from ratt_opt import __version__
from ratt_opt.cli.attacking import attack
from ratt_opt.cli.faults import Interrupts, keep_traceback
from ratt_opt.cli.planning import bound, demo
from ratt_opt.cli.proofs import audit, verify
from ratt_opt.cli.scenarios import new, schema
from ratt_opt.cli.terminal import OutputError, WorkInterrupted, encode_anything, fail, flush, print_lines
from ratt_opt.errors import InputError, ProofError, UndecidedError

__all__ = ["app", "run"]

REFUTED, BAD_INPUT, UNDECIDED, FAULT, NO_OUTPUT, INTERRUPTED = 1, 2, 4, 70, 74, 130

app = typer.Typer(
    name="ratt-opt",
    help="Plan robot teams that keep tracking targets under attack, and prove how good each plan is.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
for command in (demo, new, bound, attack, verify, audit, schema):
    app.command()(command)

# Typer's own usage errors (unknown option, missing value, ...) share this base; typer does not export it.
_UsageError: Any = typer.BadParameter.__mro__[1]


@app.callback(invoke_without_command=True)
def _version(version: Annotated[bool, typer.Option("--version", help="Print the version and exit.")] = False) -> None:
    if version:
        print_lines([__version__])
        raise typer.Exit


def run(arguments: list[str]) -> int:
    """Run one command line and return its exit code; every error is one line on standard error."""
    encode_anything()
    with Interrupts() as interrupts:
        try:
            code = app(arguments, prog_name="ratt-opt", standalone_mode=False)
            flush()
            if code == INTERRUPTED:  # what Typer makes of an interrupt; no command returns it
                raise KeyboardInterrupt
        except (KeyboardInterrupt, typer.Abort):
            return fail("interrupted", INTERRUPTED)
        except Exception as error:  # noqa: BLE001  (the last line of defence)
            return _failed(error, arguments, interrupted=interrupts.happened)
    return code if isinstance(code, int) else 0


def _failed(error: Exception, arguments: list[str], *, interrupted: bool) -> int:
    """Say in one line what went wrong, and return the exit code."""
    if isinstance(error, _UsageError):
        return fail(_usage_text(error, arguments), BAD_INPUT)
    codes = (
        (InputError, BAD_INPUT),
        (UndecidedError, UNDECIDED),
        (ProofError, REFUTED),
        (OutputError, NO_OUTPUT),
        (WorkInterrupted, INTERRUPTED),
    )
    code = next((code for kind, code in codes if isinstance(error, kind)), None)
    if code is not None:
        return fail(str(error), code)
    # Compiled code and imports turn an interrupt into errors of their own.
    return fail("interrupted", INTERRUPTED) if interrupted else fail(keep_traceback(error, arguments), FAULT)


def _usage_text(error: Any, arguments: list[str]) -> str:
    """Typer's message, with the value it refused where it does not show it."""
    text = str(error.format_message()).rstrip(".")
    option = re.search(r"Invalid value for '(--[\w-]+)'", text)
    if option and option[1] in arguments[:-1]:
        value = arguments[arguments.index(option[1]) + 1]
        return text if value in text else f"{text}; got {value}"
    return text
