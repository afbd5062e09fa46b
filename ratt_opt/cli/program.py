"""All commands, and what becomes of their errors.

Exit codes: 0 done; 1 a certificate does not prove its claim; 2 bad input; 3 ``verify``: only the upper end is proved;
4 ``verify``: not decided within its limits; 70 a fault of the program, whose traceback is in a file; 74 standard
output is closed or full; 130 interrupted. Each but 0 and 3 comes with one line on standard error. Results go to
standard output, progress to standard error.
"""

import re
from typing import Annotated, Any

import typer
from typer.core import TyperCommand, TyperGroup

from ratt_opt._version import __version__
from ratt_opt.cli import benching
from ratt_opt.cli.attacking import attack
from ratt_opt.cli.cutting import cuts
from ratt_opt.cli.decentralising import decentralise
from ratt_opt.cli.exit_codes import ExitCode
from ratt_opt.cli.planning import bound, demo
from ratt_opt.cli.proofs import audit, verify
from ratt_opt.cli.replaying import replay
from ratt_opt.cli.scenarios import new, schema
from ratt_opt.cli.terminal import OutputError, WorkInterrupted, encode_anything, fail, flush, note, print_lines
from ratt_opt.cli.tracking import track
from ratt_opt.errors import InputError, ProofError, UndecidedError

__all__ = ["app", "run_program"]

ERRORS = {
    InputError: ExitCode.BAD_INPUT,
    UndecidedError: ExitCode.UNDECIDED,
    ProofError: ExitCode.REFUTED,
    OutputError: ExitCode.NO_OUTPUT,
    WorkInterrupted: ExitCode.INTERRUPTED,
}
"""Exit codes of the errors that users can act on; the first kind that fits counts."""


class _Command(TyperCommand):
    def get_help_option(self, ctx: Any) -> Any:
        return _delivered(super().get_help_option(ctx))


class _CommandGroup(TyperGroup):
    def get_help_option(self, ctx: Any) -> Any:
        return _delivered(super().get_help_option(ctx))


def _delivered(option: Any) -> Any:
    """The option ``--help``, which prints like a command prints its results: if it cannot arrive, that is said."""

    def show_help(ctx: typer.Context, _: object, wanted: bool) -> None:
        if wanted and not ctx.resilient_parsing:
            print_lines([ctx.get_help()])
            ctx.exit()

    option.callback = show_help
    return option


app = typer.Typer(
    name="ratt-opt",
    cls=_CommandGroup,
    help="Plan robot teams that keep tracking targets under attack, and prove how good each plan is.",
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
for command in (demo, new, bound, attack, cuts, decentralise, track, replay, verify, audit, schema):
    app.command(cls=_Command)(command)

bench = typer.Typer(
    name="bench",
    cls=_CommandGroup,
    help="The open benchmark: list instances, run solvers, verify and enter records, write the page.",
    add_completion=False,
    rich_markup_mode=None,
)
bench.command("list", cls=_Command)(benching.list_instances)
for about_records in (benching.run, benching.verify, benching.submit, benching.page):
    bench.command(cls=_Command)(about_records)
app.add_typer(bench)

# Typer's own usage errors (unknown option, missing value, ...) share this base; typer does not export it.
_UsageError: Any = typer.BadParameter.__mro__[1]


@app.callback(invoke_without_command=True)
def _alone(
    ctx: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Print the version and exit.")] = False,
) -> None:
    if version:
        print_lines([__version__])
        raise typer.Exit
    if ctx.invoked_subcommand is None:
        print_lines([ctx.get_help()])
        raise InputError("command", "must be given", "none")


def run_program(arguments: list[str]) -> int:
    """Run one command line and return its exit code; errors that users can act on are one line on standard error.

    Everything else is raised.
    """
    encode_anything()
    if word := next((word for word in arguments if "\0" in word), None):  # no path can; the system's words never do
        return fail(f"a word must not hold a null character; got {word}", ExitCode.BAD_INPUT)
    try:
        code = app(_with_current_names(arguments), prog_name="ratt-opt", standalone_mode=False)
        flush()
    except typer.Abort:
        raise KeyboardInterrupt from None
    except (*ERRORS, _UsageError) as error:
        if isinstance(error, _UsageError):
            return fail(_usage_text(error, arguments), ExitCode.BAD_INPUT)
        return fail(str(error), next(code for kind, code in ERRORS.items() if isinstance(error, kind)))
    if code == ExitCode.INTERRUPTED:  # what Typer makes of an interrupt; no command returns it
        raise KeyboardInterrupt
    return code if isinstance(code, int) else 0


def _with_current_names(arguments: list[str]) -> list[str]:
    """The words with today's names of planners and attackers; a note says of each that was given by a former one."""
    from ratt_opt.vocabulary import FORMER

    words = list(arguments)
    for k, word in enumerate(words[1:], start=1):
        before = words[k - 1]
        for role, former in FORMER.items():
            if before == f"--{role}" and word in former:
                words[k] = former[word]
                note(f"the {role} {word!r} is called {former[word]!r} now")
    return words


def _usage_text(error: Any, arguments: list[str]) -> str:
    """Typer's message, with the value it refused if it does not show it."""
    text = str(error.format_message()).rstrip(".").replace("': Value error, '", "': '")
    option = re.search(r"Invalid value for '(--[\w-]+)'", text)
    if option and option[1] in arguments[:-1]:
        value = arguments[arguments.index(option[1]) + 1]
        return text if value in text else f"{text}; got {value}"
    return text
