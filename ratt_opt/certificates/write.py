"""Certificates: the problem as exact binary floats, the plan, the claim and its two proofs in one JSON file."""

from __future__ import annotations

import json
from time import monotonic
from typing import TYPE_CHECKING, Any

from flint import ctx

from ratt_opt._files import write_atomically
from ratt_opt.budget import Budget
from ratt_opt.certificates.certification import NOT_ASKED_FOR, Certificate, Certification
from ratt_opt.certificates.lower import ENUMERATED, lower_proof, weaker_lower_proof
from ratt_opt.certificates.params import DEFAULT
from ratt_opt.certificates.stated_inequalities import round_up
from ratt_opt.certificates.stated_problem import is_certified, prior_range_of, problem_document
from ratt_opt.certificates.upper import upper_record
from ratt_opt.certificates.verifier.limits import SECONDS, within
from ratt_opt.certificates.verifier.reading import FORMAT, VERSION
from ratt_opt.certificates.verifier.statement import Statement
from ratt_opt.certificates.verifier.upper import upper_bounds
from ratt_opt.certificates.verifier.verify import verify_certificate
from ratt_opt.certificates.verifier.work import limited, seconds_left, tick, watched
from ratt_opt.errors import InputError, ProofError, UndecidedError
from ratt_opt.running.progress import Step
from ratt_opt.scenario.problem_record import ProblemRecord

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from ratt_opt._validation import IntArray
    from ratt_opt.certificates.params import CertificateParams
    from ratt_opt.certificates.verifier.verified import Verified
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.result import MaxMinResult

__all__ = [
    "certify",
    "certify_if_possible",
    "write_certificate",
]


def certify_if_possible(
    problem: Problem,
    result: MaxMinResult,
    path: str | Path | None,
    budget: Budget | None = None,
    *,
    source: object = None,
    params: CertificateParams = DEFAULT,
) -> Certification:
    """:func:`certify`, or why it would refuse this result; ``path`` is ``None`` if no certificate is wanted.

    A file that cannot be written is such a reason too: what the search found does not hang on it.

    Raises
    ------
    ProofError : the result's proof has a fault. One that is not decided within the verifier's limits is a reason.
    """
    if path is None:
        return NOT_ASKED_FOR
    if not is_certified(problem):
        return Certification(why_not="only the trace, log-det and max-eigenvalue criteria have certificates")
    if result.proof is None:
        return Certification(why_not="the best plan was enumerated, which leaves no proof")
    try:
        return Certification(certificate=certify(problem, result, path, budget=budget, source=source, params=params))
    except (InputError, UndecidedError, MemoryError) as error:
        reason = "not enough memory" if isinstance(error, MemoryError) else str(error)
        return Certification(why_not=f"could not be made: {reason}", final=False)


def certify(
    problem: Problem,
    result: MaxMinResult,
    path: str | Path,
    *,
    time_limit: float | None = None,
    budget: Budget | None = None,
    source: object = None,
    params: CertificateParams = DEFAULT,
) -> Certificate:
    """Write the proof of a ``solve_maxmin`` result as a file that stands without the solver.

    The file is verified under a temporary name first; only then is it renamed to ``path``.

    The bracket in the file is the result's, moved outwards by what exact arithmetic cannot prove
    (``lower_shaved``, ``upper_raised``). If no cover of all attacks is found within the limits of ``lower.py`` and
    two fifths of the time, a value some hundredths lower is tried in two fifths of the rest (``lower_shaved`` says
    by how much). If that is not proved either, or not verified in time, the lower end is stated as enumerated in
    floating point and ``verified.lower_proved`` is False. An interrupt propagates; no file is left.

    Parameters
    ----------
    time_limit : seconds, verification included; unlimited by default
    budget : an outer search's budget: its seconds count too
    source : the scenario or information that the problem was made from, if it is known: its SHA-256 is stated
    params : how proofs are found and shortened, and the limits within which the file is verified

    Raises
    ------
    InputError : the objective cannot be certified, the result carries no proof, or the file cannot be written.
    ProofError : the result's proof has a fault.
    UndecidedError : the upper end was not proved and verified in time; no file is left.
    """
    if result.proof is None:
        raise InputError("result", "must carry a proof (from solve_maxmin)", result.stop)
    own = Budget.inside(budget, time_limit)
    with within(params.verifier), limited(own.seconds_left):
        tick()
        record = upper_record(problem, result.proof, result.upper, params)
        return write_certificate(
            problem,
            result.elements,
            lower=result.lower,
            upper=result.upper,
            upper_part=record,
            path=path,
            source=source,
            params=params,
        )


def write_certificate(
    problem: Problem,
    elements: IntArray,
    *,
    lower: float,
    upper: float,
    upper_part: dict[str, Any],
    path: str | Path,
    source: object = None,
    params: CertificateParams = DEFAULT,
) -> Certificate:
    """Write a certificate of the bracket, verify the file, and say how far its claim had to move.

    Parameters
    ----------
    elements : (N,) the plan
    lower, upper : the bracket as computed in floating point [unit of the objective]
    upper_part : the record of the upper proof
    source, params : as for :func:`certify`

    Raises
    ------
    InputError : the objective cannot be certified, or the file cannot be written.
    ProofError : the upper proof has a fault.
    """
    with Step("certificate, written and checked") as step, watched(step.say):
        record, plan = problem_document(problem), problem.check_plan(elements).tolist()
        prior_range = prior_range_of(problem, record, plan)
        began = monotonic()
        high = max(
            float(upper), _proved_upper(Statement(record, plan, prior_range), upper_part, params.points.precision), 0.0
        )
        own = params.writing
        reserve = own.reserved * (monotonic() - began) + own.least_reserved
        origin = {"made_from": source.digest} if isinstance(source, ProblemRecord) else {}
        undecided: object = None
        for low, lower_part in _lower_claims(problem, elements, float(min(lower, high)), params):
            if lower_part is undecided:
                continue
            document = {
                "format": FORMAT,
                "version": VERSION,
                **origin,
                "problem": record,
                "plan": plan,
                "claim": {"lower": low, "upper": high},
                "prior_eigenvalue": prior_range,
                "upper": upper_part,
                "lower": lower_part,
            }
            is_last = lower_part is ENUMERATED
            try:
                with limited(seconds_left() if is_last else own.checked_share * (seconds_left() - reserve)):
                    return _write_verified(document, path, lower - low, high - upper)
            except ProofError as error:
                if is_last:
                    raise
                undecided = lower_part if isinstance(error, UndecidedError) else None
        raise AssertionError  # the last claim is an enumeration


def _write_verified(document: dict[str, Any], path: str | Path, shaved: float, raised: float) -> Certificate:
    text = "{" + ",\n".join(f"{json.dumps(name)}:{_compact(value)}" for name, value in document.items()) + "}\n"
    found: list[Verified] = []

    def write(file: Path) -> None:
        """A file that does not stand before the verifier never gets the certificate's name."""
        file.write_text(text, encoding="utf-8")
        tick()
        seconds = min(SECONDS, seconds_left())
        found.append(verify_certificate(file, expected_problem=document["problem"], time_limit=seconds or None))

    target = write_atomically(path, write)
    return Certificate(path=target, verified=found[0], lower_shaved=shaved, upper_raised=raised, size=len(text))


def _compact(value: object) -> str:
    return json.dumps(value, separators=(",", ":"), allow_nan=False)


def _proved_upper(about: Statement, upper_part: dict[str, Any], precision: int) -> float:
    """Smallest float that the verifier can prove as an upper bound from this proof."""
    with ctx.workprec(precision):
        return max((round_up(bound) for bound in upper_bounds(about, upper_part)), default=0.0)


def _lower_claims(
    problem: Problem, elements: IntArray, lower: float, params: CertificateParams
) -> Iterator[tuple[float, dict[str, Any]]]:
    """Floats at or a little below ``lower`` with a proof; then some hundredths below; last ``lower`` with a word."""
    # Values far below the prior's criterion are differences of larger numbers: no share of them covers their rounding.
    own, largest = params.writing, max(params.writing.shaves)
    rounding = own.roundings * problem.information_objective.rounding / (largest or 1.0)
    scale = max(abs(lower), abs(problem.objective(elements)), rounding)
    below = largest * scale / 10
    for prove in (_whole_proof, weaker_lower_proof):
        with limited(own.lower_share * seconds_left()):
            threshold, part = prove(problem, elements, lower - below, params)
        if part is not ENUMERATED:
            yield from ((min(lower, threshold + below) - shave * scale, part) for shave in own.shaves)
    yield lower, ENUMERATED


def _whole_proof(
    problem: Problem, elements: IntArray, threshold: float, params: CertificateParams
) -> tuple[float, Any]:
    return threshold, lower_proof(problem, elements, threshold, params)
