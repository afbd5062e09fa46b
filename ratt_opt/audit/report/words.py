"""What both reports say about the ledger: titles, counts per chain, evidence in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ratt_opt.audit.report.document import (
        ClaimRecord,
        EntryHead,
        EntryRecord,
        FactorRecord,
        LedgerDocument,
        RealRecord,
        WitnessRecord,
    )

__all__ = ["evidence", "per_chain", "proof_lines", "shown_claim", "title"]

SHOWN_SETS = 60
"""Most values of a counterexample that a report prints."""


def title(record: EntryHead) -> str:
    """Label, kind and reading of an entry."""
    reading = f" ({record['reading']})" if record["reading"] else ""
    return f"{record['label']}, {record['kind']}{reading}"


def per_chain(document: LedgerDocument) -> dict[str, dict[str, int]]:
    """Verdict counts of each chain, in order of appearance, then of all."""
    table: dict[str, dict[str, int]] = {}
    for record in document["entries"]:
        row = table.setdefault(record["chain"], dict.fromkeys(document["counts"], 0))
        row[record["verdict"]] += 1
    table["all"] = dict(document["counts"])
    return table


def shown_claim(record: EntryRecord) -> ClaimRecord | None:
    """The claim whose evidence a report prints: the first refuted one, else the first with a proof that has steps."""
    claims = record["claims"]
    refuted = [claim for claim in claims if claim["witness"] is not None]
    stepped = [claim for claim in claims if claim["proofs"] and claim["proofs"][0]["steps"]]
    return next(iter(refuted or stepped or claims), None)


def evidence(record: EntryRecord) -> list[str]:
    """Counterexample or enumeration, what is left of the step, and whether the conclusion survives."""
    claim = shown_claim(record)
    is_refuted = claim is not None and claim["witness"] is not None
    lines = [f"{record['sizes']}: {record['detail']}"] if "detail" in record else []
    lines += record.get("counterexamples", [])
    if claim is not None and claim["witness"] is not None:
        lines += _witness_lines(claim, claim["witness"])
    lines += [_factor_line(best) for best in record.get("best_factors", [])]
    found = record.get("realistic")
    if found:
        lines += _realistic_lines(found)
    elif is_refuted and "realistic" in record:
        lines.append("not tried on EKF objectives: no roles, numbers that are no values, or many robots")
    if record.get("follows_from"):
        lines.append(f"a direct step that serves the proof: the line follows from {record['follows_from']} (proved)")
    serves = record.get("weaker_step_that_serves")
    if serves:
        lines.append(f"a weaker step that serves the proof: {serves['entry']} ({serves['verdict']})")
    survival = record.get("conclusion_without_it")
    if survival:
        verdict = survival["verdict"] or "different verdicts for different readings"
        lines.append(f"the conclusion without this step ({survival['entry']}): {verdict}")
    return lines


def _factor_line(best: FactorRecord) -> str:
    where = "" if best["curvature"] is None else f" at curvature {best['curvature']}"
    if best["factor"] == "0":
        return f"no positive factor on the right saves the step{where}"
    how = "and no larger factor (within 1/1000)" if best["cannot_exceed_by_1/1000"] else "a valid factor"
    return f"with the factor {best['factor']} on the right the step holds{where}, {how}"


def _witness_lines(claim: ClaimRecord, witness: WitnessRecord) -> list[str]:
    lines = [f"smallest counterexample found: {claim['size']}; {claim['scope']}; the claim {claim['claim']}"]
    lines.append(f"fails by {witness['violation']} for the function with values {_values(witness)}")
    if witness["ratt_chooses_the_roles"] is not None:
        said = "does" if witness["ratt_chooses_the_roles"] else "does not"
        lines.append(f"run on this function, RATT {said} choose the elements the claim calls its own")
    if witness["auxiliary"]:
        lines.append("other numbers: " + ", ".join(f"{k} = {v}" for k, v in witness["auxiliary"].items()))
    return lines


def _realistic_lines(found: RealRecord) -> list[str]:
    """The search on EKF objectives in words."""
    seen, broken = found["section_vi_instances"], found["section_vi_violations"]
    lines = [f"on Section VI scenarios ({found['objective']}): violated in {broken} of {seen} cases it applies to"]
    worst = found["worst"]
    if worst is None:
        return lines
    size = f"{worst['relative_violation']:.3g} of the largest value in it"
    if worst["violated_exactly"]:
        lines.append(f"worst geometry found: violated by {size}, replayed without rounding; {worst['origin']}")
    elif worst["relative_violation"] > 0:
        lines.append(f"worst geometry found: violated by {size} in rounding, not confirmed exactly; {worst['origin']}")
    else:
        lines.append(
            f"worst geometry found: not violated (margin {-worst['relative_violation']:.3g}); {worst['origin']}"
        )
    return lines


def _values(witness: WitnessRecord) -> str:
    """The values that the claim and its premises speak of."""
    shown = [f"{name} = {value}" for name, value in witness["values_in_play"].items()]
    if len(shown) > SHOWN_SETS:
        shown[SHOWN_SETS:] = [f"... ({len(shown) - SHOWN_SETS} more sets)"]
    return f"{', '.join(shown)} (all {len(witness['values'])} values are in audit.json)"


def proof_lines(claim: ClaimRecord) -> list[str]:
    """The printed proof of a claim: multiplier times inequality, one per line; their sum is the claim."""
    lines = []
    for proof in claim["proofs"]:
        where = "all curvatures" if proof["curvature"] is None else f"curvature {proof['curvature']}"
        lines.append(f"{where}, from {proof['curvature_domain']}; the sum of:")
        lines += [f"[{multiplier}] x ({inequality})   {reason}" for multiplier, reason, inequality in proof["steps"]]
        if not proof["steps"]:
            lines.append("nothing: both sides are the same expression")
    return lines
