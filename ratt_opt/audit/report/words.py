"""What both reports say about the ledger: titles, counts per chain, evidence in words."""

from __future__ import annotations

from typing import Any

__all__ = ["evidence", "per_chain", "proof_lines", "shown_claim", "title"]

SHOWN_SETS = 60
"""Most values of a counterexample that a report prints."""


def title(record: dict[str, Any]) -> str:
    """Label, kind and reading of an entry."""
    reading = f" ({record['reading']})" if record["reading"] else ""
    return f"{record['label']}, {record['kind']}{reading}"


def per_chain(document: dict[str, Any]) -> dict[str, dict[str, int]]:
    """Verdict counts of each chain, in order of appearance, then of all."""
    table: dict[str, dict[str, int]] = {}
    for record in document["entries"]:
        row = table.setdefault(record["chain"], dict.fromkeys(document["counts"], 0))
        row[record["verdict"]] += 1
    table["all"] = dict(document["counts"])
    return table


def shown_claim(record: dict[str, Any]) -> dict[str, Any] | None:
    """The claim whose evidence a report prints: the first refuted one, else the first with a proof that has steps."""
    claims: list[dict[str, Any]] = record["claims"]
    refuted = [claim for claim in claims if claim["witness"] is not None]
    stepped = [claim for claim in claims if claim["proofs"] and claim["proofs"][0]["steps"]]
    return next(iter(refuted or stepped or claims), None)


def evidence(record: dict[str, Any]) -> list[str]:
    """Counterexample or enumeration, what is left of the step, and whether the conclusion survives."""
    lines = list(record.get("counterexamples", []))
    if "detail" in record:
        lines.insert(0, f"{record['sizes']}: {record['detail']}")
    claim = shown_claim(record)
    if claim is not None and claim["witness"] is not None:
        lines += _witness_lines(claim)
    for weaker in record.get("best_factors", []):
        if weaker["factor"] == "0":
            where = "" if weaker["curvature"] is None else f" at curvature {weaker['curvature']}"
            lines.append(f"no positive factor on the right saves the step{where}")
            continue
        best = "and no larger factor (within 1/1000)" if weaker["cannot_exceed_by_1/1000"] else "a valid factor"
        where = "" if weaker["curvature"] is None else f" at curvature {weaker['curvature']}"
        lines.append(f"with the factor {weaker['factor']} on the right the step holds{where}, {best}")
    if record.get("realistic"):
        lines += _realistic_lines(record["realistic"])
    elif claim is not None and claim["witness"] is not None and "realistic" in record:
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


def _witness_lines(claim: dict[str, Any]) -> list[str]:
    witness = claim["witness"]
    lines = [f"smallest counterexample found: {claim['size']}; {claim['scope']}; the claim {claim['claim']}"]
    lines.append(f"fails by {witness['violation']} for the function with values {_values(witness)}")
    if witness["ratt_chooses_the_roles"] is not None:
        said = "does" if witness["ratt_chooses_the_roles"] else "does not"
        lines.append(f"run on this function, RATT {said} choose the elements the claim calls its own")
    if witness["auxiliary"]:
        lines.append("other numbers: " + ", ".join(f"{k} = {v}" for k, v in witness["auxiliary"].items()))
    return lines


def _realistic_lines(found: dict[str, Any]) -> list[str]:
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


def _values(witness: dict[str, Any]) -> str:
    """The values that the claim and its premises speak of."""
    shown = [f"{name} = {value}" for name, value in witness["values_in_play"].items()]
    if len(shown) > SHOWN_SETS:
        shown[SHOWN_SETS:] = [f"... ({len(shown) - SHOWN_SETS} more sets)"]
    return f"{', '.join(shown)} (all {len(witness['values'])} values are in audit.json)"


def proof_lines(claim: dict[str, Any]) -> list[str]:
    """The printed proof of a claim: multiplier times inequality, one per line; their sum is the claim."""
    lines = []
    for proof in claim["proofs"]:
        where = "all curvatures" if proof["curvature"] is None else f"curvature {proof['curvature']}"
        lines.append(f"{where}, from {proof['curvature_domain']}; the sum of:")
        lines += [f"[{multiplier}] x ({inequality})   {reason}" for multiplier, reason, inequality in proof["steps"]]
        if not proof["steps"]:
            lines.append("nothing: both sides are the same expression")
    return lines
