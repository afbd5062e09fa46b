"""Verify exactly that a certificate proves its claim.

Imports no solver, no attacker, no numerical library. Trace and max-eigenvalue are decided in rational
arithmetic, logarithms in balls (python-flint).
"""

from __future__ import annotations

import math
from numbers import Real
from typing import TYPE_CHECKING, Any

from flint import arb

from ratt_opt.certificates.verifier import reading
from ratt_opt.certificates.verifier.limits import SECONDS, VerifierLimits, within
from ratt_opt.certificates.verifier.lower import check_lower
from ratt_opt.certificates.verifier.reading import exact, fields, need
from ratt_opt.certificates.verifier.statement import Statement
from ratt_opt.certificates.verifier.upper import check_upper
from ratt_opt.certificates.verifier.verified import Verified
from ratt_opt.certificates.verifier.work import limited
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["verify_certificate", "verify_document"]


def verify_certificate(
    path: str | Path,
    *,
    expected_problem: object = None,
    time_limit: float | None = SECONDS,
    limits: VerifierLimits | None = None,
) -> Verified:
    """Decide whether the certificate at ``path`` proves its claim.

    Parameters
    ----------
    time_limit : seconds; no limit when ``None``
    expected_problem : the problem record it must be about (``problem_document(problem)``), or a function of the
        record that says how it differs from the one expected, and nothing if it does not (``differences``); any
        when ``None``
    limits : of memory and work, by kind; those of the library when ``None``

    Raises
    ------
    FileFormatError : the file is not a certificate of this version.
    ProofError : the proof has a fault; the text names the first one found.
    UndecidedError : neither, within the time and memory that the verifier gives to one file.
    """
    seconds = _checked(time_limit)
    with within(limits):
        return verify_document(reading.load(path), expected_problem=expected_problem, time_limit=seconds)


def verify_document(
    document: dict[str, Any], *, expected_problem: object = None, time_limit: float | None = SECONDS
) -> Verified:
    """Decide the same of a document that is loaded already; it stays as it is."""
    reading.check_format(document)
    with limited(_checked(time_limit)):
        return _decide(dict(document), expected_problem)


def _checked(time_limit: float | None) -> float:
    if time_limit is None:
        return math.inf
    if isinstance(time_limit, bool) or not isinstance(time_limit, Real) or not time_limit > 0:
        raise InputError("time_limit", "must be a positive number of seconds", time_limit)
    return float(time_limit)


def _decide(document: dict[str, Any], expected_problem: object) -> Verified:
    made_from = reading.stated_hash("made_from", document.pop("made_from")) if "made_from" in document else None
    names = "format version problem plan claim prior_eigenvalue upper lower"
    _, _, problem, plan, claim, prior_range, upper_part, lower_part = fields("", document, names)
    _need_same(problem, expected_problem, made_from)
    low, high = fields("claim", claim, "lower upper")
    lower, upper = exact("claim lower", low), exact("claim upper", high)
    need(lower <= upper, "claim: lower is above upper")
    about = Statement(problem, plan, prior_range)
    upper_leaves = check_upper(about, upper_part, upper)
    lower_leaves = check_lower(about, lower_part, lower)
    return Verified(
        lower=float(low),
        upper=float(high),
        lower_proved=lower_leaves > 0,
        lower_method=str(lower_part["conclusion"]),
        elements=about.plan,
        objective=about.objective,
        arithmetic="ball arithmetic" if about.objective == "logdet" else "exact rational arithmetic",
        problem_hash=reading.document_hash(problem),
        made_from=made_from,
        n_robots=about.n,
        n_targets=len(about.prior),
        n_elements=len(about.owner),
        alpha_s=about.alpha_s,
        alpha_c=about.alpha_c,
        at_most=about.at_most,
        largest_defect=float(arb(max(map(max, about.defect))).upper()),
        upper_leaves=upper_leaves,
        lower_leaves=lower_leaves,
    )


def _need_same(problem: object, expected: object, made_from: str | None) -> None:
    """Raise where the record is not the one expected, with what the file says about where it came from."""
    difference = (
        expected(problem) if callable(expected) else "" if expected in (None, problem) else "its record differs"
    )
    source = f" (it says that it was made from the input with SHA-256 {made_from})" if made_from else ""
    need(not difference, f"the certificate is about a different problem than the one given: {difference}{source}")
