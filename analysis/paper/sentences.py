"""The sentences of Section VI beside our figures: ``python -m analysis.paper.sentences``.

The page of the evaluation has the tables of claims, which their commands print. This program makes the table of
sentences from them and from ``docs/measured.toml``, so that no figure is typed twice.
"""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from pathlib import Path

from analysis.measurements import values

__all__ = ["PAGE", "SENTENCES", "Sentence", "refreshed"]

PAGE = Path(__file__).parents[2] / "docs" / "researchers" / "evaluation.md"
HEAD = "| the paper | our figure | verdict |\n| --- | --- | --- |\n"
QUALITATIVE = "ql_1sen_atk, ql_1comm_atk, ql_1sen2comm_atk"
SLOT = re.compile(r"\{(?P<how>\w+):(?P<what>[^}]*)\}")
INTERVAL = re.compile(r"(?P<mean>[+-][\d.]+) (?P<ends>\[[^]]*\]) (?P<unit>m²|%)")


@dataclass(frozen=True, slots=True)
class Sentence:
    """A sentence of the paper, and what we found: ``{how:what}`` is filled from the page.

    ``how`` : ``mean`` or ``interval`` of the result of a claim, its ``result`` or ``verdict``, or a ``measured`` value;
    ``what`` : ``figure; claim``, of which the beginning suffices, or the value's name.
    """

    paper: str
    ours: str
    verdict: str


WITHOUT = f"{QUALITATIVE}; without attack, NR-OPT has the lower "
UNDER = f"{QUALITATIVE}; under the worst attack, RATT has the lower "
SMALL, LARGE = "small_comp; RATT's ", "large_comp; RATT's "
SENTENCES = (
    Sentence(
        '"without the sensing attack, NR-OPT attains a better tracking quality than RATT"',
        f"trace {{interval:{WITHOUT}trace}}, MSE {{interval:{WITHOUT}MSE}}",
        f"trace {{verdict:{WITHOUT}trace}}, MSE {{verdict:{WITHOUT}MSE}}",
    ),
    Sentence(
        '"when there exists a sensing attack, NR-OPT loses its good tracking quality"; "drops sharply"',
        f"at least 10 % above RATT's trace {{result:{QUALITATIVE}; (ours) how often}}",
        "true of few teams",
    ),
    Sentence(
        '"RATT shows its superiority against the sensing attack"; figures of link attacks "exhibit similar results"',
        f"trace {{interval:{UNDER}trace}}, MSE {{interval:{UNDER}MSE}}, over the three figures",
        f"trace {{verdict:{UNDER}trace}}, MSE {{verdict:{UNDER}MSE}}",
    ),
    Sentence(
        '"RATT has on average a superior tracking quality to NR-OPT, Greedy, and Random"',
        "four robots: trace "
        + ", ".join(f"{{mean:{SMALL}trace of covariance is below that of {name}}}" for name in ("NR-OPT", "Greedy"))
        + f", {{mean:{SMALL}trace of covariance is below that of Random}} m²; MSE "
        + ", ".join(f"{{mean:{SMALL}MSE is below that of {name}}}" for name in ("NR-OPT", "Greedy", "Random"))
        + " m²",
        f"trace {{verdict:{SMALL}trace}}, MSE {{verdict:{SMALL}MSE}}",
    ),
    Sentence(
        '"RATT performs close to OPT"',
        "trace {interval:small_comp; RATT is close to OPT}",
        "{verdict:small_comp; RATT is close to OPT}",
    ),
    Sentence(
        '"OPT becomes intractable with a large number of robots"',
        "best plans of 30 robots within 1e-6 in {measured:plan_30} s at most",
        "exact plans can be had",
    ),
    Sentence(
        'the worst attack "is NP-hard", so large teams meet the bounded-rational attack',
        "the exact attack on 30 robots takes {measured:attack_30} s; under the bounded-rational one the trace "
        "differs by {interval:exact_attack; the bounded-rational attacker causes less}",
        "exact attacks can be had",
    ),
    Sentence(
        '"RATT is again superior to both Greedy and Rand with regard to averaged trace of covariance and MSE"',
        f"10 to 30 robots: trace {{mean:{LARGE}trace of covariance is below that of Greedy}}, "
        f"{{mean:{LARGE}trace of covariance is below that of Random}} m²; "
        f"MSE {{mean:{LARGE}MSE is below that of Greedy}}, {{mean:{LARGE}MSE is below that of Random}} m²",
        f"trace {{verdict:{LARGE}trace}}, MSE {{verdict:{LARGE}MSE is below that of Greedy}}; "
        f"MSE against Random {{verdict:{LARGE}MSE is below that of Random}}",
    ),
    Sentence(
        '"close-to-optimal performance against worst-case attacks"',
        "exact attacks, 10 to 30 robots: trace {interval:exact_attack; RATT's trace is less than 10% above} "
        "above what is proved of every plan",
        "{verdict:exact_attack; RATT's trace is less than 10% above}",
    ),
)


def refreshed(page: str) -> str:
    """Return the page with the table of sentences made again from its other tables.

    Raises
    ------
    ValueError : a claim is not on the page, or twice.
    """
    rows = [line.strip("| ").split(" | ") for line in page.splitlines() if line.count(" | ") == 4]
    lines = [f"| {one.paper} | {_filled(one.ours, rows)} | {_filled(one.verdict, rows)} |\n" for one in SENTENCES]
    before, _, rest = page.partition(HEAD)
    return before + HEAD + "".join(lines) + rest[rest.index("\n\n") + 1 :]


def _filled(template: str, rows: list[list[str]]) -> str:
    return SLOT.sub(lambda slot: _figure(slot["how"], slot["what"], rows), template)


def _figure(how: str, what: str, rows: list[list[str]]) -> str:
    if how == "measured":
        return values()[what].text
    figure, _, claim = what.partition("; ")
    found = [row for row in rows if row[0] == figure and row[2].startswith(claim)]
    verdicts = {row[4] for row in found}
    if not found or (how != "verdict" and len(found) > 1) or len(verdicts) > 1:
        raise ValueError(f"{len(found)} claims like {what!r}, of {len(verdicts)} verdicts")
    if how == "verdict":
        return found[0][4]
    if how == "result":
        return found[0][3]
    number = INTERVAL.search(found[0][3])
    assert number is not None
    return number["mean"] if how == "mean" else number[0]


if __name__ == "__main__":
    PAGE.write_text(refreshed(PAGE.read_text(encoding="utf-8")), encoding="utf-8")
    sys.exit()
