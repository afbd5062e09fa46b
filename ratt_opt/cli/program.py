"""All commands, and what becomes of their errors.

Exit codes: 0 done; 1 a certificate does not prove its claim; 2 bad input, one line on
standard error; 130 interrupted. Results go to standard output, progress to standard error.
"""

import re
import sys
from typing import Annotated, Any

import typer

from ratt_opt import __version__
from ratt_opt.cli.attacking import attack
from ratt_opt.cli.planning import bound, demo
from ratt_opt.cli.proofs import audit, verify
from ratt_opt.cli.scenarios import new, schema
from ratt_opt.cli.terminal import fail
from ratt_opt.errors import InputError, ProofError

__all__ = ["app", "main", "run"]

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
        print(__version__)
        raise typer.Exit


def main() -> None:
    """Run the command line and exit."""
    sys.exit(run(sys.argv[1:]))


def run(arguments: list[str]) -> int:
    """Run one command line and return its exit code; every error is one line on standard error."""
    try:
        code = app(arguments, standalone_mode=False)
        sys.stdout.flush()
    except (InputError, _UsageError) as error:
        return fail(str(error) if isinstance(error, InputError) else _usage_text(error, arguments), 2)
    except ProofError as error:
        return fail(str(error), 1)
    except (KeyboardInterrupt, typer.Abort):
        return fail("interrupted", 130)
    except BrokenPipeError:
        sys.stdout = None  # the reader has left; the interpreter must not flush again
        return 0
    return code if isinstance(code, int) else 0


def _usage_text(error: Any, arguments: list[str]) -> str:
    """Typer's message, with the value it refused where it does not show it."""
    text = str(error.format_message()).rstrip(".")
    option = re.search(r"Invalid value for '(--[\w-]+)'", text)
    if option and option[1] in arguments[:-1]:
        value = arguments[arguments.index(option[1]) + 1]
        return text if value in text else f"{text}; got {value}"
    return text
