"""The problem as a certificate states it: exact binary floats, from which the verifier derives all else."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.verifier.statement import Statement
from ratt_opt.errors import InputError, ProofError
from ratt_opt.problem import check_problem
from ratt_opt.setfunctions.criteria.registry import CERTIFIED, CRITERIA
from ratt_opt.setfunctions.information import packed

if TYPE_CHECKING:
    from ratt_opt.problem import Problem

__all__ = ["is_certified", "prior_range_of", "problem_document", "statement_of"]


def problem_document(problem: Problem) -> dict[str, Any]:
    """Return the problem record of a certificate; JSON numbers are shortest decimals that round-trip.

    Raises
    ------
    InputError : the objective is none of the criteria that the verifier knows.
    """
    objective = check_problem(problem, knows_at_most=True).information_objective
    if not is_certified(problem):
        *names, last = CRITERIA
        raise InputError("objective", f"must be {', '.join(names)} or {last} to be certified", type(objective).__name__)
    return {
        "objective": objective.name,
        "dimension": objective.dimension,
        **objective.stated,
        "prior": packed(objective.prior),
        "information": packed(objective.information),
        "weights": objective.weights.tolist(),
        "owners": problem.robot.tolist(),
        "links": [list(link) for link in sorted(problem.communication.links)],
        "alpha_s": problem.alpha_s,
        "alpha_c": problem.alpha_c,
        "protected_robots": sorted(problem.protected_robots),
        "protected_links": [list(link) for link in sorted(problem.protected_links)],
        **({} if problem.at_most is None else {"at_most": problem.at_most}),
    }


def is_certified(problem: Problem) -> bool:
    """Tell whether the objective is a registered criterion itself: a subclass may have another formula."""
    return type(problem.objective) in CERTIFIED


def prior_range_of(problem: Problem, record: dict[str, Any], plan: list[int]) -> list[float]:
    """Floats around the largest weighted eigenvalue of the priors, as narrow as the verifier can check."""
    middle = problem.information_objective.prior_eigenvalue
    if middle is None:
        return []
    for shave in (1e-15, 1e-14, 1e-13, 1e-12):
        found = [middle * (1 - shave), middle * (1 + shave)]
        try:
            Statement(record, plan, found)
        except ProofError:
            continue
        return found
    return [middle * (1 - 1e-9), middle * (1 + 1e-9)]


def statement_of(problem: Problem) -> Statement:
    """The statement of a problem as the verifier reads it, with some plan, of idle robots if there are such."""
    informed = abs(problem.information_objective.information).sum(axis=(1, 2, 3))
    record, plan = problem_document(problem), [int(own[informed[own].argmin()]) for own in problem.choices]
    return Statement(record, plan, prior_range_of(problem, record, plan))
