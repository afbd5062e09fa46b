"""Proved statement of a certificate, as a record and in words; decides nothing."""

from __future__ import annotations

from dataclasses import dataclass

from ratt_opt._rounding import gap_text, relative_gap, up

__all__ = ["Verified"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Verified:
    """Proved statement about one problem and one plan [unit of the objective].

    No plan has a worst-case value above ``upper`` (proved). The plan ``elements`` has
    at least ``lower`` under every attack: proved if ``lower_proved``, otherwise only claimed.
    ``largest_defect`` bounds how far below zero an eigenvalue of the stored information is (rounding);
    the proofs account for it. ``problem_hash`` is the SHA-256 of the problem record; ``made_from`` that of the scenario
    or information from which the record is said to be made, ``None`` if that is not said.
    """

    lower: float
    upper: float
    lower_proved: bool
    lower_method: str
    elements: tuple[int, ...]
    objective: str
    arithmetic: str
    problem_hash: str
    made_from: str | None = None
    n_robots: int
    n_targets: int
    n_elements: int
    alpha_s: int
    alpha_c: int
    at_most: int | None = None
    largest_defect: float
    upper_leaves: int
    lower_leaves: int

    @property
    def gap(self) -> float:
        """``(upper - lower) / upper``, rounded up; 0 when ``upper`` is 0."""
        return relative_gap(self.lower, self.upper)

    def lines(self) -> list[str]:
        """Say in plain text what was proved, for which data, with which arithmetic, and what was not."""
        proved = f"proved in {self.arithmetic}"
        lower = f"this plan has a worst-case value of at least {self.lower!r}"
        limit = "" if self.at_most is None else f", at most {self.at_most} robots not idle"
        gap = f"the plan is within {gap_text(self.lower, self.upper, 3)} (relative) of the best possible worst case"
        return [
            f"problem: {self.objective}, {self.n_robots} robots, {self.n_elements} elements, {self.n_targets} targets, "
            f"alpha_s = {self.alpha_s}, alpha_c = {self.alpha_c}{limit}; SHA-256 of its data {self.problem_hash}",
            *([f"made, as the file says, from the input with SHA-256 {self.made_from}"] if self.made_from else []),
            f"plan: {', '.join(map(str, self.elements))}",
            f"{proved}: no plan has a worst-case value above {self.upper!r} ({self.upper_leaves} leaves)",
            f"{proved}: {lower} ({self.lower_method}, {self.lower_leaves} leaves)"
            if self.lower_proved
            else f"NOT proved: {lower} (outcomes enumerated in floating point)",
            f"{'proved' if self.lower_proved else 'NOT proved'}: {gap}",
            f"information: positive semidefinite up to {up(self.largest_defect, 3)}, which the proofs account for",
            "not covered: whether the data describe the real robots, targets and sensors",
        ]
