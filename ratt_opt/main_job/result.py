"""Result of the main job: every plan with its worst case, the bracket, the guarantees, the proof."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from ratt_opt._files import output_directory
from ratt_opt._rounding import down, up
from ratt_opt.budget import Budget
from ratt_opt.certificates.certification import CERTIFICATE, CUTS, NOT_ASKED_FOR, Certification
from ratt_opt.certificates.edge_cuts import certify_size_if_possible
from ratt_opt.certificates.params import DEFAULT
from ratt_opt.certificates.write import certify_if_possible
from ratt_opt.errors import ProofError
from ratt_opt.findings import AssessedPlan, Findings
from ratt_opt.main_job.params import SHARES
from ratt_opt.report.document import plan_document, report_document
from ratt_opt.report.figure import plan_figure
from ratt_opt.report.latex import latex_of
from ratt_opt.report.notebook import plan_view, report_view
from ratt_opt.report.picture import picture_of
from ratt_opt.report.tables import report_tables
from ratt_opt.report.write import write_report

if TYPE_CHECKING:
    from collections.abc import Mapping
    from pathlib import Path

    from matplotlib.figure import Figure

    from ratt_opt.certificates.params import CertificateParams
    from ratt_opt.report.map_style import MapStyle

__all__ = ["BoundReport", "PlanAssessment"]


class PlanAssessment(AssessedPlan):
    """One planner's plan and its worst case. Two are equal if all their fields are.

    ``planner`` : its name; ``elements`` : (N,) flat element indices; ``controls`` : their positions among each robot's
    own elements; ``bait`` : RATT's bait robots, empty for other planners.
    ``groups`` : the connected groups that the worst attack leaves; ``best_group`` : the robots that still see in the
    one whose value is the team's; ``posterior`` : (M, d, d) covariances they leave, ``None`` for set
    functions that are no criterion of information matrices.
    """

    __slots__ = ()

    @property
    def name(self) -> str:
        """The planner's name, as it was called before ``planner``; it warns."""
        warnings.warn("PlanAssessment.name is called planner now", FutureWarning, stacklevel=2)
        return self.planner

    def to_dict(self) -> dict[str, Any]:
        """The plan as plain data, as ``report.json`` has it."""
        return plan_document(self)

    def _repr_html_(self) -> str:
        return plan_view(self)

    def __repr__(self) -> str:
        return (
            f"PlanAssessment({self.planner}, keeps {down(self.worst_case.lower, 8)} to {up(self.worst_case.upper, 8)})"
        )

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, PlanAssessment):
            return NotImplemented
        return (self.planner, self.to_dict()) == (other.planner, other.to_dict())

    def __hash__(self) -> int:
        return hash((self.planner, self.controls))


class BoundReport(Findings):
    """Recommended plan, its worst case, and its distance from the best possible.

    Claims, all in floating point unless a certificate says more: each plan's worst case lies in
    its bracket; ``optimum.lower <= Phi* <= optimum.upper``; RATT's plan has a worst-case value of at least
    ``certified_ratio`` of ``Phi*``. ``best`` is the plan the search for the optimum found.
    ``curvature`` is given for submodular criteria (log-det), ``total_curvature`` for the others.
    ``inapplicable`` : the guarantees that do not apply here, and why; ``omitted`` : what was left out, and why.
    ``certificate`` : the verified proof file of ``optimum``, or why there is none.
    ``largest_group`` : the smallest largest group that link attacks leave, with the cut and the reason;
    ``cuts_certificate`` : the verified proof file of its lower end, or why there is none.
    ``seconds`` : wall time of each step; ``created`` : when the call began (UTC, ISO 8601).
    ``source`` : the scenario or model-free input that was given, ``None`` for a problem.
    ``views`` : the recommended plan under other attacks too, for maps: its ``worst`` case; the worst found that spares
    one of the robots or links which that attacks (``next worst``, if the worst attacks anything); and ``none``.
    ``seeds`` : of everything drawn at random.
    ``interrupted`` : the user ended the searches; the brackets hold all the same.

    Two reports are equal when they say the same, whenever that was and whatever time it took.
    """

    __slots__ = ()

    if TYPE_CHECKING:  # its plans show themselves, too
        ratt: PlanAssessment
        best: PlanAssessment
        baselines: tuple[PlanAssessment, ...]
        views: Mapping[str, PlanAssessment]

        @property
        def plans(self) -> tuple[PlanAssessment, ...]:
            """RATT's, the best one found, and the baselines'."""

        @property
        def recommended(self) -> PlanAssessment:
            """The plan with the best proved worst case."""

    def to_dict(self) -> dict[str, Any]:
        """The report as plain data, which is what ``report.json`` holds: unknown numbers are ``None``."""
        return report_document(self)

    def save(
        self,
        directory: str | Path,
        *,
        certificate: bool = True,
        time_limit: float | None = SHARES.saved,
        params: CertificateParams = DEFAULT,
    ) -> list[Path]:
        """Write what ``ratt-opt bound`` writes into a folder, which is made if needed, and return the files.

        ``report.json`` (all of it), ``report.html`` (to read), ``plan.csv`` (to execute), ``plan.png``, ``plan.svg``,
        and ``certificate.json``: a copy of the report's, or, if the report has none, one that is written now. Then
        ``cuts.json`` comes with it, which proves how large a group link attacks must leave.

        Parameters
        ----------
        certificate : whether to write one now; the files say why there is none
        time_limit : seconds for that
        params : how its proofs are found, and the limits within which it is verified

        Raises
        ------
        InputError : the folder cannot be written.
        ProofError : the proof has a fault; the other files are written.
        """
        if not certificate or self.certificate != NOT_ASKED_FOR:
            return write_report(self, directory)
        folder, budget = output_directory(directory), Budget(time_limit)
        try:
            proof = certify_if_possible(
                self.problem, self.optimum, folder / CERTIFICATE, budget, source=self.source, params=params
            )
        except ProofError as fault:
            write_report(replace(self, certificate=Certification.faulty(fault)), directory)
            raise
        cuts = certify_size_if_possible(self.problem.threat, self.largest_group, folder / CUTS, budget, params)
        files = write_report(replace(self.with_certificate(proof), cuts_certificate=cuts), directory)
        return files if cuts.path is None else [*files, cuts.path]

    def to_latex(self) -> str:
        r"""Return the tables that ``ratt-opt bound`` prints as LaTeX, which needs ``\usepackage{booktabs}``."""
        return "\n".join(map(latex_of, report_tables(self)))

    def plot(self, style: MapStyle | None = None) -> Figure:
        """Return a figure: the recommended plan and its worst attack on a map, beside the worst case of each plan.

        ``style`` : sizes and limits of the map; those of :class:`ratt_opt.MapStyle` by default
        """
        return plan_figure(self, picture_of(self.source, self, style=style))

    def _repr_html_(self) -> str:
        return report_view(self)

    def __repr__(self) -> str:
        best = f"the best plan has a worst-case value of {down(self.optimum.lower, 8)} to {up(self.upper, 8)}"
        return f"BoundReport({self.objective}, {self.problem.n_robots} robots, {best}, {self.recommended!r})"

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, BoundReport):
            return NotImplemented
        apart = {"seconds": None, "created": None}
        return self.to_dict() | apart == other.to_dict() | apart

    __hash__ = None  # type: ignore[assignment]  # equal reports may hold different, unhashable mappings
