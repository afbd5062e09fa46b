"""``ratt-opt demo`` and ``ratt-opt bound``: the main job on a scenario of the library's or of the user's."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ratt_opt.cli.options import GAP, TIME_LIMIT, CertificateFlag, InputFile, JsonFlag, ObjectiveOption, OutFolder
from ratt_opt.cli.terminal import print_json, print_tables, progress

if TYPE_CHECKING:
    from ratt_opt.scenario.information_input import InformationInput
    from ratt_opt.scenario.model import Scenario

__all__ = ["bound", "demo"]

DEMO_SEED = 14
"""A scenario on which the planners differ; on many others RATT and greedy find the same plan."""


def demo(out: OutFolder = Path("demo"), certificate: CertificateFlag = True, as_json: JsonFlag = False) -> None:
    """Plan, attack and bound the paper's small scenario (4 robots, 4 targets), end to end."""
    from ratt_opt._files import output_directory
    from ratt_opt.scenario.files import save_scenario
    from ratt_opt.scenario.generator import random_scenario

    scenario = random_scenario(4, 4, alpha_s=1, alpha_c=3, seed=DEMO_SEED)
    save_scenario(scenario, output_directory(out) / "scenario.json")
    _bound(scenario, out, certificate=certificate, as_json=as_json)


def bound(
    file: InputFile,
    out: OutFolder,
    objective: ObjectiveOption = "trace",
    time_limit: Annotated[
        float, typer.Option("--time-limit", help="Seconds for all searches; the certificate comes on top.")
    ] = TIME_LIMIT,
    gap: Annotated[float, typer.Option("--gap", help="Relative gap at which that search stops.")] = GAP,
    certificate: CertificateFlag = True,
    as_json: JsonFlag = False,
) -> None:
    """Plan, find the worst attack, bracket the best plan; write report.json, plan.png, plan.svg, certificate.json."""
    from ratt_opt.scenario.files import load_input

    source = load_input(file)
    _bound(source, out, objective, time_limit, gap, certificate=certificate, as_json=as_json)


def _bound(
    source: "Scenario | InformationInput",
    out: Path,
    objective: str = "trace",
    time_limit: float = TIME_LIMIT,
    gap: float = GAP,
    *,
    certificate: bool,
    as_json: bool,
) -> None:
    from ratt_opt._files import output_directory
    from ratt_opt.main_job.bound import bound as main_job
    from ratt_opt.report.tables import report_tables
    from ratt_opt.report.write import write_report

    proof = output_directory(out) / "certificate.json"
    path = proof if certificate else None
    with progress() as tell:
        report = main_job(source, objective=objective, time_limit=time_limit, gap=gap, certificate=path, progress=tell)
        tell("report and figure")
        files = write_report(report, out, source)
    if report.certificate.certificate is None:
        proof.unlink(missing_ok=True)  # an earlier run's: it is not about this report
    else:
        files.append(report.certificate.certificate.path)
    if as_json:
        print_json(report.to_dict())
        return
    print_tables(report_tables(report, source.element_labels))
    print("written: " + ", ".join(str(file) for file in files))
