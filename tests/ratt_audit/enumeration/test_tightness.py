"""Which bounds are attained: verdicts that follow from instances and proofs."""

from ratt_audit.engine.decide import Verdict
from ratt_audit.enumeration.tightness import tightness_entries


def test_verdicts() -> None:
    verdicts = {entry.label: entry.enumerate_cases().verdict for entry in tightness_entries()}
    assert verdicts == {
        "theorem1_nd_tight": Verdict.REFUTED,
        "theorem1_sub_tight": Verdict.REFUTED,
        "pattern_free_sub_tight": Verdict.PROVED,
        "pattern_free_sub_tight_no_ties": Verdict.PROVED,
        "pattern_free_sub_tight_links": Verdict.PROVED,
        "pattern_free_sub_tight_n4": Verdict.PROVED,
        "pattern_free_nd_tight": Verdict.PROVED,
        "sensing_nd_exact": Verdict.PROVED,
        "survivors_sub_tight": Verdict.PROVED,
    }
