"""Worth of messages: ``python -m analysis.decentralised.worth --trials 24 --out DIR``.

Each plan's exact worst case as a share of the certified optimum, against the time in which the robots decide. The
command writes ``decentralised.md`` and ``decentralised.png`` into the folder of the results.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import networkx as nx
import numpy as np

from analysis.decentralised.clique_selection import clique_selection
from analysis.decentralised.costs import table
from analysis.decentralised.neighbour_greedy import neighbour_greedy
from analysis.decentralised.radio import RADIO, element_bytes, neighbours, sending
from ratt_opt._files import write_atomically
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.decentralised.faults import Faults
from ratt_opt.decentralised.plan import decentralised_ratt
from ratt_opt.planners.resource_aware_greedy import resource_aware_greedy
from ratt_opt.problem import Problem
from ratt_opt.scenario.limited_view import limited_view_scenario
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.solvers.maxmin.solve import solve_maxmin
from ratt_opt.solvers.ratt import myopic
from ratt_opt.solvers.refined import refined
from ratt_opt.studies.cases import Case
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.plots import new_figure
from ratt_opt.studies.statistics import Estimate, column, estimate, select
from ratt_opt.studies.store import read_table
from ratt_opt.studies.study import Study

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from matplotlib.figure import Figure

    from ratt_opt._validation import IntArray
    from ratt_opt.studies.cases import Cell, Seeds

    Rows = Sequence[Mapping[str, str]]

__all__ = ["STUDY", "figure_of", "problem_of", "write_page"]

CAMERAS, ALL_ROUND, COVERAGE = "cameras of 60°", "cameras all round", "coverage"
SIDE, SHORT, LONG = 60.0, 30, 45
"""Side of the square [m], and ranges of a link [m]: mean degrees about 3.4 and 5.4 of eight robots."""
KINDS = ((CAMERAS, SHORT), (CAMERAS, LONG), (ALL_ROUND, LONG), (COVERAGE, LONG))
"""Sensors or coverage, and the range of links [m]: a panel each."""
SEEN_BY, ITEMS, SHARP = 0.25, 16, 1e6
"""Coverage: share of items that a choice covers, number of items, and information of one that is covered."""
SEARCH = 20.0
"""Seconds for one certified optimum; a gap left open counts against every plan."""


def problem_of(case: Case, seeds: Seeds) -> Problem:
    """The team of one trial, in a disk network; no link can be cut yet."""
    options = dict(case.options)
    kind, reach = options["kind"], float(options["links"])
    if kind == COVERAGE:
        return _coverage(case, reach, np.random.default_rng(seeds.scenario))
    view = 60.0 if kind == CAMERAS else 360.0
    return limited_view_scenario(
        case.n_robots,
        case.n_targets,
        alpha_s=case.alpha_s,
        alpha_c=0,
        seed=seeds.scenario,
        view=view,
        communication_range=reach,
    ).problem()


def _coverage(case: Case, reach: float, rng: np.random.Generator) -> Problem:
    """Coverage as the trace of nearly perfect sensors: each item is a number of variance 1."""
    choices = 4
    seen = rng.random((choices * case.n_robots, ITEMS)) < SEEN_BY
    at = rng.random((case.n_robots, 2)) * SIDE
    graph = nx.empty_graph(case.n_robots)
    apart = np.linalg.norm(at[:, None] - at, axis=-1)
    graph.add_edges_from((i, j) for i in range(case.n_robots) for j in range(i) if apart[i, j] <= reach)
    f = TraceObjective(np.ones((ITEMS, 1, 1)), SHARP * seen[:, :, None, None])
    return Problem(f, np.repeat(np.arange(case.n_robots), choices), graph, case.alpha_s, 0)


def with_cuts(problem: Problem, alpha_c: int) -> Problem:
    """The problem for an adversary who may cut links as well, as far as there are any."""
    alpha_c = min(alpha_c, len(problem.communication.links))
    return Problem(problem.objective, problem.robot, problem.graph, problem.alpha_s, alpha_c)


def _by_rag(problem: Problem) -> tuple[IntArray, float]:
    """Resource-aware greedy, and an upper bound on its time: the busiest radio in every round."""
    plan = resource_aware_greedy(problem)
    busiest = max(map(len, neighbours(problem)))
    gain_and_choice = sending(element_bytes(problem, 0) + 8) + sending(element_bytes(problem))
    return plan.elements, plan.rounds * (busiest * gain_and_choice + 2 * RADIO.delay[1]) if busiest else 0.0


def _by_messages(problem: Problem, faults: Faults | None = None) -> tuple[IntArray, float]:
    plan = decentralised_ratt(problem, faults=faults)
    return plan.elements, plan.decision_time


def _half_lost(problem: Problem) -> tuple[IntArray, float]:
    """RATT by messages, every second link lost as the robots begin to plan; the attack finds the whole network."""
    links = sorted(problem.communication.links)[::2]
    return _by_messages(problem, Faults(cuts=tuple((0, i, j) for i, j in links)))


WAYS: dict[str, Callable[[Problem], tuple[IntArray, float]]] = {
    "myopic": lambda problem: (myopic(problem).elements, 0.0),
    "neighbours' greedy": neighbour_greedy,
    "RAG": _by_rag,
    "cliques": clique_selection,
    "RATT by messages": _by_messages,
    "half of the links lost": _half_lost,
    "refined, with a centre": lambda problem: (refined(problem, time_limit=None, max_kicks=100).elements, np.nan),
}
"""Plan and decision time [s] of each way to plan; the last one shows what a centre would reach."""


def measured(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:  # noqa: ARG001  (the interface of studies)
    """Share of the certified optimum [1] and decision time [s] of each way; ``open`` : gap of the optimum [1]."""
    problem = with_cuts(problem_of(case, seeds), case.alpha_c)
    optimum = solve_maxmin(problem, time_limit=SEARCH)
    row: dict[str, Cell] = {"open": 1 - optimum.lower / optimum.upper if optimum.upper > 0 else 0.0}
    for name, way in WAYS.items():
        elements, seconds = way(problem)
        kept = worst_case_attack(problem, elements).lower
        row[f"{name}/worst/share"] = min(kept / optimum.upper, 1.0) if optimum.upper > 0 else 1.0
        row[f"{name}/worst/seconds"] = float(seconds)
    return row


STUDY = Study(
    name="messages",
    cases=tuple(
        Case(n_robots=8, n_targets=6, alpha_s=2, alpha_c=2, options=(("kind", kind), ("links", links)))
        for kind, links in KINDS
    ),
    metrics=("share", "seconds"),
    measure=measured,
)


def _means(rows: Rows, kind: str, links: int) -> dict[str, tuple[float, Estimate]]:
    """Mean decision time [s] and share [%] of each way in one kind of teams."""
    own = select(rows, kind=kind, links=links)
    return {
        name: (float(column(own, f"{name}/worst/seconds").mean()), estimate(100 * column(own, f"{name}/worst/share")))
        for name in WAYS
    }


def figure_of(rows: Rows) -> Figure:
    """A panel for each kind of teams: the share kept over the decision time, with 95 % intervals."""
    figure = new_figure(12, 4.2)
    every = figure.subplots(1, len(KINDS), sharey=True)
    for axes, (kind, links) in zip(every, KINDS, strict=True):
        for k, (name, (seconds, share)) in enumerate(_means(rows, kind, links).items()):
            if np.isnan(seconds):
                axes.axhline(share.mean, color="#222222", linestyle="--", linewidth=1.2, label=name)
                continue
            spread = [[share.mean - share.low], [share.high - share.mean]]
            axes.errorbar([seconds], [share.mean], spread, fmt="osD^vP"[k], ms=6.5, capsize=3, label=name)
        axes.set_xscale("symlog", linthresh=0.01)
        axes.set_xlim(-0.002, 2)
        axes.set_title(f"{kind}, {links} m")
        axes.set_xlabel("decision time at 0.25 Mbit/s [s]")
    every[0].set_ylabel("worst case kept [% of the certified optimum]")
    handles, labels = every[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=4, frameon=False)
    return figure


PAGE = """# What messages are worth

![Worst case kept, as a share of the certified optimum, over the decision time](decentralised.png)

{sentences}

These are differences in points of the optimum, paired, with 95 % intervals; more is better for RATT by messages.

Eight robots in a square of 60 m, linked within 30 or 45 m; the adversary blinds two robots and cuts two links.
*Cameras of 60°* must choose among six targets what to look at, *cameras all round* see every target, and *coverage* is
16 items of which a choice covers a quarter (`TraceObjective` with nearly perfect sensors). Each plan is attacked
exactly. Its worst case is divided by the proved upper end of the optimum: on average {open:.1f} % of it are open, and
count against every plan. {trials} teams a panel, 95 % intervals.

The decision time is that of radios of 0.25 Mbit/s that send one packet at a time. *RATT by messages* is simulated with
acknowledgements and what finding the component takes. The baselines are counted in their favour: no packet is
acknowledged, cliques and neighbours are given; the time of RAG is an upper bound. "Half of the links lost" means that
every second link of the list is gone as the robots begin to plan, while the adversary finds the whole network. The
dashed line is `refined`, which no message reached.

| | {kinds} |
| --- | {dashes} |
{table}

## What is guaranteed, and what others prove

Whatever the robots have heard of, a plan in which each took the best element beside that keeps `(1-c)^2` of the optimum
after the worst attack, `c` the total curvature; a submodular function keeps `(1-k) (1-k + k/Q)` if `Q` cliques of
the graph of who heard whom hold all robots that heard somebody. Components that plan alone, with RATT's own number of
baits, keep `1/g` and `t/(g-1+t)` (`group_size_bound` has the proof). All are proved in Coq, in
`formal/theories/SplitTeams.v`. If all robots are bait, they keep `1-k` without a message: these bounds alone do not
justify one.

Published bounds are about other questions. That sequential greedy with few heard choices depends on cliques of the
information graph is known, without curvature or attacks (Gharesifard and Smith, arXiv 1706.04082). The bound of RAG
(arXiv 2407.10382) is on the value without an attack, and subtracts an amount that depends on the instance. The
bandit version (arXiv 2602.19366) has a bound that is positive on disconnected networks, too, by such an amount. The
resilient selection of arXiv 2105.07305 ends with the central plan of a connected team, and DRM (Zhou and others)
divides the team into cliques; both are about lost robots alone. We found none about cut links.

## Costs

Powers of the number of robots, fitted over 12, 25, 50 and 100 of them, with 95 % intervals. Four targets, three
controls; two robots may be blinded and no link cut, so all but two robots win an auction. An auction takes one item a
link of a tree and direction, and finding the component one item a link list and link: without losses, on a tree, fewer
than `4 N^2` items. On complete networks link lists are most of the bytes.

{costs}

The table is printed by `python -m analysis.decentralised.costs --seeds 1`; this page is written by

<!-- slow -->
```bash
python -m analysis.decentralised.worth --trials {trials} --out results
```
"""


def _sentences(rows: Rows) -> list[str]:
    """Per kind of teams: how RATT by messages compares, paired, with no message and with the best baseline."""
    found = []
    for kind, links in KINDS:
        own = select(rows, kind=kind, links=links)
        ratts = column(own, "RATT by messages/worst/share")
        parts = []
        for name in ("myopic", "RAG", "cliques", "half of the links lost", "refined, with a centre"):
            change = estimate(100 * (ratts - column(own, f"{name}/worst/share")))
            parts.append(f"{change.mean:+.1f} [{change.low:+.1f}, {change.high:+.1f}] against {name}")
        where = f"*{kind}, links within {links} m*"
        found.append(f"- {where}: RATT by messages keeps {', '.join(parts[:3])}. It keeps {', '.join(parts[3:])}.")
    return found


def write_page(folder: Path) -> None:
    """Write the page and its figure beside the results."""
    rows = read_table(folder / STUDY.name)
    means = [_means(rows, kind, links) for kind, links in KINDS]
    lines = []
    for name in WAYS:
        cells = [
            f"{one[name][1].text()} %" + ("" if np.isnan(one[name][0]) else f", {one[name][0]:.2g} s") for one in means
        ]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    text = PAGE.format(
        sentences="\n".join(_sentences(rows)),
        open=100 * float(column(rows, "open").mean()),
        trials=len({row["trial"] for row in rows}),
        kinds=" | ".join(f"{kind}, {links} m" for kind, links in KINDS),
        dashes=" | ".join("---" for _ in KINDS),
        table="\n".join(lines),
        costs="\n".join(table(1)),
    )
    figure = figure_of(rows)
    write_atomically(folder / "decentralised.png", lambda file: figure.savefig(file, dpi=120))
    write_atomically(folder / "decentralised.md", lambda file: file.write_text(text, encoding="utf-8"))


if __name__ == "__main__":
    sys.exit(main("What messages are worth", [Entry(STUDY)], trials=24, after=write_page))
