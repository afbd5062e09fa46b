"""A certificate's proof in words, leaf by leaf with its numbers: for readers, after the verifier has accepted it.

``lower_explanation.py`` and ``upper_explanation.py`` tell the two ends; cases, costs and bounds are the verifier's own.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from flint import fmpq

from ratt_opt.certificates.lower_explanation import LowerStory, Wording
from ratt_opt.certificates.params import ExplanationParams
from ratt_opt.certificates.upper_explanation import upper_story
from ratt_opt.certificates.verifier.reading import exact
from ratt_opt.certificates.verifier.statement import Statement

if TYPE_CHECKING:
    from collections.abc import Mapping

__all__ = ["explained"]

EXPLANATION = ExplanationParams()
"""Length of proofs in words for which no other is given."""


def explained(document: Mapping[str, Any], params: ExplanationParams = EXPLANATION) -> list[str]:
    """Say what both proofs of a verified certificate show, and how; long trees are cut short."""
    about = Statement(document["problem"], document["plan"], document["prior_eigenvalue"])
    lower = exact("claim lower", document["claim"]["lower"])
    assert isinstance(lower, fmpq)
    wording = Wording(params)
    low, high = document["claim"]["lower"], document["claim"]["upper"]
    return [
        "",
        f"Why this plan is worth at least {low!r} (the claim) under every attack:",
        *LowerStory(about, lower, wording).lines(document["lower"]),
        "",
        f"Why no plan is worth more than {high!r} under every attack:",
        *upper_story(about, document["upper"], wording),
    ]
