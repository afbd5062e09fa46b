"""``ratt-opt demo`` and ``ratt-opt bound``: the main job on a scenario of the library's or of the user's."""

from dataclasses import replace
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from ratt_opt.certificates.certification import CERTIFICATE, CUTS, INTERRUPTED, PENDING, Certification
from ratt_opt.cli.options import (
    GAP,
    TIME_LIMIT,
    CertificateFlag,
    InputFile,
    JsonFlag,
    LatexFlag,
    ObjectiveOption,
    OutFolder,
    check_output,
)
from ratt_opt.cli.terminal import WorkInterrupted, print_json, print_tables, written
from ratt_opt.errors import ProofError
from ratt_opt.running.progress import Step

if TYPE_CHECKING:
    from ratt_opt.certificates.params import CertificateParams
    from ratt_opt.main_job.job_params import JobParams
    from ratt_opt.main_job.result import BoundReport
    from ratt_opt.scenario.information_input import InformationInput
    from ratt_opt.scenario.model import Scenario

__all__ = ["bound", "demo"]

EARLIER = "certificate.earlier.json"
"""The certificate of an earlier report in the folder when a later one has none."""
NOT_DRAWN = "without plan.png, plan.svg and maps, which the same command draws once it ends"
"""Message after an interrupt: drawing takes a second or two, mostly to load the drawing library."""


def demo(
    out: OutFolder = Path("demo"),
    paper: Annotated[
        bool, typer.Option("--paper", help="The paper's small scenario instead: 4 robots that see all 4 targets.")
    ] = False,
    certificate: CertificateFlag = True,
    as_json: JsonFlag = False,
    as_latex: LatexFlag = False,
) -> None:
    """Plan, attack and bound a team of six turning cameras and six targets, end to end.

    Its seed is the first from 0 on whose network is connected and whose targets can all be seen.
    """
    from ratt_opt._files import output_directory
    from ratt_opt.report.write import FILES
    from ratt_opt.scenario.files import save_scenario
    from ratt_opt.scenario.generator import random_scenario
    from ratt_opt.scenario.limited_view import demo_scenario

    # With this seed the planners differ; with many others RATT and greedy find the same plan.
    scenario = random_scenario(4, 4, alpha_s=1, alpha_c=3, seed=14) if paper else demo_scenario()
    save_scenario(scenario, output_directory(out, CERTIFICATE, EARLIER, CUTS, *FILES) / "scenario.json")
    _bound(scenario, out, certificate=certificate, as_json=as_json, as_latex=as_latex)


def bound(
    file: InputFile,
    out: OutFolder,
    objective: ObjectiveOption = "trace",
    time_limit: Annotated[
        float,
        typer.Option("--time-limit", help="Seconds for all searches and the certificate, which has a quarter of them."),
    ] = TIME_LIMIT,
    gap: Annotated[float, typer.Option("--gap", help="Relative gap at which that search stops.")] = GAP,
    guarantees: Annotated[
        Literal["none", "quick", "full"],
        typer.Option("--guarantees", help="What was sure before planning: left out, in two seconds, or in full."),
    ] = "quick",
    motion: Annotated[
        str | None,
        typer.Option("--motion", help="Of targets: plan the first step of a mission with it.", show_default=False),
    ] = None,
    params: Annotated[
        Path | None,
        typer.Option("--params", help="TOML: parameters that are not as by default, such as [search.rows]."),
    ] = None,
    certificate: CertificateFlag = True,
    as_json: JsonFlag = False,
    as_latex: LatexFlag = False,
) -> None:
    """Plan, find the worst attack, bracket the best plan; write the report, plan and certificate.

    An interrupt (Ctrl-C) leaves a report of what is proved so far, marked so, and exits with 130.
    """
    from ratt_opt._params import read_params
    from ratt_opt.main_job.job_params import JobParams
    from ratt_opt.scenario.files import load_input

    chosen = read_params(params, JobParams())
    source = load_input(file)
    shown = {"as_json": as_json, "as_latex": as_latex, "certificate": certificate}
    _bound(source, out, objective, time_limit, gap, guarantees, motion=motion, params=chosen, **shown)


def _bound(
    source: "Scenario | InformationInput",
    out: Path,
    objective: str = "trace",
    time_limit: float = TIME_LIMIT,
    gap: float = GAP,
    guarantees: str = "quick",
    *,
    motion: str | None = None,
    params: "JobParams | None" = None,
    certificate: bool,
    as_json: bool,
    as_latex: bool,
) -> None:
    from ratt_opt._files import output_directory
    from ratt_opt.main_job.bound import bound as main_job
    from ratt_opt.main_job.job_params import DEFAULT
    from ratt_opt.main_job.params import SHARES
    from ratt_opt.missions.world import MissionModel
    from ratt_opt.report.tables import report_tables
    from ratt_opt.report.write import FILES, write_numbers
    from ratt_opt.solvers.maxmin.solve import check_limits

    check_output(as_json=as_json, as_latex=as_latex)
    folder = output_directory(out, CERTIFICATE, EARLIER, CUTS, *FILES)
    check_limits(gap, time_limit)
    began = monotonic()
    searching = (1 - SHARES.certificate) * time_limit if certificate else time_limit
    chosen = DEFAULT if params is None else params
    model = None if motion is None else MissionModel(motion=motion, objective=objective)
    asked: dict[str, Any] = {
        "model": model,
        "time_limit": searching,
        "gap": gap,
        "guarantees": guarantees,
        "params": chosen,
    }
    report = main_job(source, objective=objective, **asked)
    left = max(0.0, time_limit - (monotonic() - began))
    wanted = certificate and not report.interrupted
    with Step("interrupted: writing what is proved", 0.0) if report.interrupted else Step("report"):
        files = write_numbers(replace(report, certificate=PENDING) if wanted else report, folder)
    fault: ProofError | None = None
    if wanted:
        with Step("certificate"):
            report, fault = _certified(report, folder, left, chosen.certificate)
    if not report.interrupted:
        report, figures = _drawn(report, folder)
        files += figures
    if fault is not None:
        raise fault
    files += [proof.path] if (proof := report.certificate.certificate) else []
    files += [cuts] if (cuts := report.cuts_certificate.path) else []
    if report.certificate.certificate is None and report.certificate.final and (folder / CERTIFICATE).exists():
        (folder / CERTIFICATE).replace(folder / EARLIER)  # it is not about this report
    if as_json:
        print_json(report.to_dict())
    else:
        print_tables(report_tables(report), [written(files)], latex=as_latex)
    if report.interrupted:
        raise WorkInterrupted(f"interrupted; {folder} holds what was proved until then, {NOT_DRAWN}")


def _drawn(report: "BoundReport", folder: Path) -> "tuple[BoundReport, list[Path]]":
    """Draw the figures, once all else is written; a report whose figures cannot be drawn says so.

    Raises WorkInterrupted.
    """
    from ratt_opt.report.write import write_figures

    try:
        with Step("figure"):
            files, remarks = write_figures(report, folder)
    except KeyboardInterrupt:
        raise WorkInterrupted(f"interrupted; {folder} holds the report, {NOT_DRAWN}") from None
    return replace(report, remarks=(*report.remarks, *remarks)), files


def _certified(
    report: "BoundReport", folder: Path, time_limit: float, params: "CertificateParams"
) -> "tuple[BoundReport, ProofError | None]":
    """The report with its certificate, or why there is none, written over the one in the folder; a fault in our proof.

    Raises WorkInterrupted; the report in the folder then says so.
    """
    from ratt_opt.budget import Budget
    from ratt_opt.certificates.edge_cuts import certify_size_if_possible
    from ratt_opt.certificates.write import certify_if_possible
    from ratt_opt.main_job.params import SHARES
    from ratt_opt.report.write import write_verdict

    began = monotonic()
    budget = Budget(time_limit)
    fault: ProofError | None = None
    interrupted, cuts = False, report.cuts_certificate
    (folder / CUTS).unlink(missing_ok=True)  # of an earlier report
    try:
        cuts = certify_size_if_possible(
            report.problem.threat,
            report.largest_group,
            folder / CUTS,
            budget.part(SHARES.cuts_certificate),
            params,
        )
        asked: dict[str, Any] = {"source": report.source, "params": params}
        proof = certify_if_possible(report.problem, report.optimum, folder / CERTIFICATE, budget, **asked)
    except ProofError as error:
        proof, fault = Certification.faulty(error), error
    except KeyboardInterrupt:
        proof, interrupted = INTERRUPTED, True
    seconds = {**report.seconds, "certificate": monotonic() - began}
    report = replace(report.with_certificate(proof), cuts_certificate=cuts, seconds=seconds)
    write_verdict(report, folder)
    if interrupted:
        raise WorkInterrupted(f"interrupted; {folder} holds the report, not yet its certificate, {NOT_DRAWN}")
    return report, fault
