"""What the main job found: every plan with its worst case, the bracket, the guarantees, the proof."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from ratt_opt._files import output_directory
from ratt_opt._rounding import down, up
from ratt_opt.budget import Budget
from ratt_opt.certificates.certification import CERTIFICATE, NOT_ASKED_FOR, Certification
from ratt_opt.certificates.write import certify_if_possible
from ratt_opt.errors import ProofError
from ratt_opt.main_job.document import plan_document, report_document
from ratt_opt.report.figure import plan_figure
from ratt_opt.report.notebook import plan_view, report_view
from ratt_opt.report.picture import picture_of
from ratt_opt.report.write import write_report

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from matplotlib.figure import Figure

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attackers.task import AttackResult
    from ratt_opt.bounds.guarantees import Guarantee
    from ratt_opt.curvatures.curvature import Curvature
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.result import MaxMinResult

__all__ = ["BoundReport", "PlanAssessment"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class PlanAssessment:
    """One planner's plan and its worst case; equal to another that says the same.

    ``elements`` : (N,) flat element indices; ``controls`` : their positions among each robot's
    own elements; ``bait`` : RATT's bait robots, empty for other planners.
    ``groups`` : the connected groups that the worst attack leaves; ``best_group`` : the robots that still see in the
    one whose value is the team's; ``posterior`` : (M, d, d) covariances they leave, ``None`` for set
    functions that are no criterion of information matrices.
    """

    name: str
    elements: IntArray
    controls: tuple[int, ...]
    bait: tuple[int, ...]
    worst_case: AttackResult
    evaluations: int
    groups: tuple[frozenset[int], ...]
    best_group: frozenset[int]
    posterior: FloatArray | None

    def to_dict(self) -> dict[str, Any]:
        """The plan as plain data, as ``report.json`` has it."""
        return plan_document(self)

    def _repr_html_(self) -> str:
        return plan_view(self)

    def __repr__(self) -> str:
        return f"PlanAssessment({self.name}, keeps {down(self.worst_case.lower, 8)} to {up(self.worst_case.upper, 8)})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, PlanAssessment):
            return NotImplemented
        return (self.name, self.to_dict()) == (other.name, other.to_dict())

    def __hash__(self) -> int:
        return hash((self.name, self.controls))


SECONDS = 60.0


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class BoundReport:
    """What to do now, the worst that can follow, and how far that is from the best possible.

    Claims, all in floating point unless a certificate says more: each plan's worst case lies in
    its bracket; ``optimum.lower <= Phi* <= optimum.upper``; RATT's plan keeps at least
    ``certified_ratio`` of ``Phi*``. ``best`` is the plan the search for the optimum found.
    ``curvature`` is given for submodular criteria (log-det), ``total_curvature`` for the others.
    ``inapplicable`` : the guarantees that do not apply here, and why; ``omitted`` : what was left out, and why.
    ``certificate`` : the verified proof file of ``optimum``, or why there is none.
    ``seconds`` : wall time of each step; ``created`` : when the call began (UTC, ISO 8601).
    ``source`` : the scenario or model-free input that was given, ``None`` for a problem.
    ``views`` : the recommended plan under other attacks too, for maps: its ``worst`` case; the worst found that spares
    one of the robots or links which that attacks (``next worst``, where the worst attacks anything); and ``none``.
    ``seeds`` : of everything drawn at random.
    ``interrupted`` : the user ended the searches; the brackets hold all the same.

    Two reports are equal when they say the same, whenever that was and whatever time it took.
    """

    problem: Problem
    alpha_cs: int
    ratt: PlanAssessment
    baselines: tuple[PlanAssessment, ...]
    optimum: MaxMinResult
    best: PlanAssessment
    curvature: Curvature | None
    total_curvature: Curvature | None
    guarantees: Mapping[str, Guarantee]
    inapplicable: Mapping[str, str]
    omitted: Mapping[str, str] = field(default_factory=dict)
    certificate: Certification
    seconds: Mapping[str, float]
    created: str = ""
    source: object = None
    views: Mapping[str, PlanAssessment] = field(default_factory=dict)
    seeds: Mapping[str, int] = field(default_factory=dict)
    interrupted: bool = False

    @property
    def objective(self) -> str:
        """Name of the criterion, or the class of a set function that has none."""
        f = self.problem.objective
        return getattr(f, "name", "") or type(f).__name__

    @property
    def unit(self) -> str:
        """Unit of the objective; empty where none is stated."""
        return getattr(self.problem.objective, "unit", "")

    @property
    def n_targets(self) -> int | None:
        """Number of targets M; ``None`` for set functions that are no criterion of information matrices."""
        return getattr(self.problem.objective, "n_targets", None)

    @property
    def n_max(self) -> int:
        """Size of the largest group that link attacks are taken to leave, ``N - alpha_cs``: on networks a bound."""
        return self.problem.n_robots - self.alpha_cs

    @property
    def plans(self) -> tuple[PlanAssessment, ...]:
        """RATT's, the best one found, and the baselines'."""
        return (self.ratt, self.best, *self.baselines)

    @property
    def recommended(self) -> PlanAssessment:
        """The plan with the best proved worst case; RATT's among equals. ``views`` are of this one."""
        if "worst" in self.views:
            return next(plan for plan in self.plans if plan.name == self.views["worst"].name)
        return max(self.plans, key=lambda plan: plan.worst_case.lower)

    @property
    def upper(self) -> float:
        """Proved upper bound on what any plan can keep."""
        return float(max(self.optimum.upper, *(plan.worst_case.lower for plan in self.plans)))

    def share(self, plan: PlanAssessment) -> float:
        """What a plan keeps at least, as a share of the best possible; 1 when both are 0."""
        return float(plan.worst_case.lower) / self.upper if self.upper > 0 else 1.0

    @property
    def certified_ratio(self) -> float:
        """RATT's proved worst-case value over the optimum's upper bound; 1 when both are 0."""
        return self.share(self.ratt)

    @property
    def guaranteed_share(self) -> float:
        """The largest share of the optimum that was guaranteed before planning; 0 where nothing was."""
        return max((float(guarantee) for guarantee in self.guarantees.values()), default=0.0)

    def with_certificate(self, certification: Certification) -> BoundReport:
        """The report with its certificate: none of its ends goes beyond what that states."""
        if certification.certificate is None:
            return replace(self, certificate=certification)
        stated = certification.certificate.verified

        def supported(plan: PlanAssessment) -> PlanAssessment:
            """The plan's lower end, no higher than that of the best plan."""
            worst = plan.worst_case
            return replace(plan, worst_case=replace(worst, lower=min(worst.lower, stated.lower)))

        return replace(
            self,
            certificate=certification,
            optimum=self.optimum.within(self.problem, stated.lower, stated.upper),
            ratt=supported(self.ratt),
            best=supported(self.best),
            baselines=tuple(map(supported, self.baselines)),
            views={name: supported(view) for name, view in self.views.items()},
        )

    def to_dict(self) -> dict[str, Any]:
        """The report as plain data, which is what ``report.json`` holds: unknown numbers are ``None``."""
        return report_document(self)

    def save(
        self, directory: str | Path, *, certificate: bool = True, time_limit: float | None = SECONDS
    ) -> list[Path]:
        """Write what ``ratt-opt bound`` writes into a folder, which is made if needed, and return the files.

        ``report.json`` (all of it), ``report.html`` (to read), ``plan.csv`` (to execute), ``plan.png``, ``plan.svg``,
        and ``certificate.json``: a copy of the report's, or if none was asked for before, one that is written now.

        Parameters
        ----------
        certificate : whether to write one now; the files say why there is none
        time_limit : seconds for that

        Raises
        ------
        InputError : the folder cannot be written.
        ProofError : the proof has a fault; the other files are written.
        """
        if not certificate or self.certificate != NOT_ASKED_FOR:
            return write_report(self, directory)
        path = output_directory(directory) / CERTIFICATE
        try:
            proof = certify_if_possible(self.problem, self.optimum, path, Budget(time_limit), source=self.source)
        except ProofError as fault:
            write_report(replace(self, certificate=Certification.faulty(fault)), directory)
            raise
        return write_report(self.with_certificate(proof), directory)

    def plot(self) -> Figure:
        """Return a figure: the map of the recommended plan and its worst attack, beside what each planner keeps."""
        return plan_figure(self, picture_of(self.source, self))

    def _repr_html_(self) -> str:
        return report_view(self)

    def __repr__(self) -> str:
        best = f"the best plan keeps {down(self.optimum.lower, 8)} to {up(self.upper, 8)}"
        return f"BoundReport({self.objective}, {self.problem.n_robots} robots, {best}, {self.recommended!r})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, BoundReport):
            return NotImplemented
        apart = {"seconds": None, "created": None}
        return self.to_dict() | apart == other.to_dict() | apart

    __hash__ = None  # type: ignore[assignment]  # equal reports may hold different, unhashable mappings
