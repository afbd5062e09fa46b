"""Options that several commands share."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from ratt_opt.errors import InputError
from ratt_opt.missions.players import names
from ratt_opt.setfunctions.criteria.names import CLASSES

__all__ = [
    "GAP",
    "TIME_LIMIT",
    "Attacker",
    "CertificateFlag",
    "InputFile",
    "JsonFlag",
    "LatexFlag",
    "Objective",
    "ObjectiveOption",
    "OutFolder",
    "Planner",
    "check_output",
]

if TYPE_CHECKING:
    Objective = str
    Planner = str
    Attacker = str
else:  # the choices that help and refusals list
    Objective, Planner, Attacker = Literal[tuple(CLASSES)], Literal[names.PLANNERS], Literal[names.ATTACKERS]

TIME_LIMIT = 60.0
"""Seconds for all searches of a command, unless the user says otherwise: as in ``ratt_opt.bound``."""
GAP = 1e-9
"""Relative gap at which the search for the optimum stops, unless the user says otherwise: as in ``ratt_opt.bound``."""

InputFile = Annotated[Path, typer.Argument(help="Scenario or information file.", show_default=False)]
OutFolder = Annotated[Path, typer.Option("--out", help="Folder for the results; created if absent.")]
JsonFlag = Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")]
LatexFlag = Annotated[bool, typer.Option("--latex", help="Print LaTeX tables (package booktabs) instead.")]
CertificateFlag = Annotated[
    bool, typer.Option(help="Write certificate.json, and verify it before anything is printed.")
]
ObjectiveOption = Annotated[Objective, typer.Option("--objective", help="Criterion of the tracking quality.")]


def check_output(*, as_json: bool, as_latex: bool) -> None:
    """InputError : more than one kind of output is wanted."""
    if as_json and as_latex:
        raise InputError("--latex", "must come without --json", "both")
