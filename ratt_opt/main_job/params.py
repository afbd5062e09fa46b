"""Parameters of the main job: shares of the time of its parts."""

from __future__ import annotations

from dataclasses import dataclass

from ratt_opt.budget import Budget

__all__ = ["QUICK", "SHARES", "QuickGuarantees", "ReportParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class ReportParams:
    """Shares of the time left that the parts of a report may take; a part whose share is spent returns its bracket.

    If all take theirs, the attacks on RATT and four baselines and the non-robust optimum leave 0.92**5 * 0.9 = 59 % to
    the best plan, which may spend 44 % of the whole; the curvature and the guarantee from it share the rest.

    ``attack`` : for each attack. ``nonrobust`` : for the best plan without attacks, a baseline if it is proved
    ``optimum`` : for the best plan. ``curvature`` : for curvatures, and then for the guarantees from them
    ``certificate`` : of the whole time, kept for writing and verifying a certificate; time that is left comes on top
    ``cuts_certificate`` : of a certificate's time, for that of the smallest largest group
    ``curvature_gap`` : a curvature is bracketed until ``(1 - lower) / (1 - upper)`` is at most one plus this: every
        guarantee is a power or a ratio of ``1 - curvature``, so that is what an open bracket costs it per factor
    ``spared`` : robots or links of the worst attack that are spared in turn to find the next worst one, which a map
        shows; each costs an attack
    ``saved`` : seconds for a certificate that is written when a report is saved
    ``lines_apart`` : fewest seconds between two lines of progress of a search: about as fast as a person reads
    ``seed`` : of the random baseline, so that a report is reproducible
    """

    attack: float = 0.08
    nonrobust: float = 0.1
    optimum: float = 0.75
    curvature: float = 0.5
    certificate: float = 0.25
    cuts_certificate: float = 0.2
    curvature_gap: float = 0.1
    spared: int = 12
    saved: float = 60.0
    lines_apart: float = 1.0
    seed: int = 0


SHARES = ReportParams()


@dataclass(frozen=True, slots=True, kw_only=True)
class QuickGuarantees:
    """Time of quick guarantees: more of it narrows curvatures and lets a user wait.

    Of six bearing-only drones the curvature took half a minute, the plan a second.

    ``seconds`` : of the processor [s], so that a busy machine reports what an idle one does; ``slowest`` : seconds of
    the clock for each of them at most, for functions that wait for something else.
    """

    seconds: float = 2.0
    slowest: float = 8.0

    def within(self, budget: Budget, busy: float) -> Budget:
        """Return these seconds at the pace of the work so far, of which ``busy`` seconds were the processor's."""
        pace = min(max(1.0, budget.elapsed / busy), self.slowest) if busy > 0 else 1.0
        return Budget.inside(budget, self.seconds * pace)


QUICK = QuickGuarantees()
