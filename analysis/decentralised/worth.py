"""Worth of messages: ``python -m analysis.decentralised.worth --trials 16 --out DIR``.

Each plan's exact worst case as a share of the certified optimum, against the time in which the robots decide. The
command writes ``decentralised.md`` and ``decentralised.png`` into the folder of the results.
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

import networkx as nx
import numpy as np

from analysis.decentralised.clique_selection import clique_selection
from analysis.decentralised.costs import table
from analysis.decentralised.neighbour_greedy import neighbour_greedy
from analysis.decentralised.radio import LONG, RADIO, element_bytes, neighbours, sending, with_cuts
from ratt_opt._files import write_atomically
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.budget import uninterrupted
from ratt_opt.decentralised.faults import Faults
from ratt_opt.decentralised.knowledge import ExchangeParams
from ratt_opt.decentralised.links import link_losses
from ratt_opt.decentralised.plan import decentralised_ratt, decentralised_refined
from ratt_opt.missions.run import run_mission
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
    from ratt_opt.decentralised.plan import DecentralisedPlan
    from ratt_opt.problem import Plan
    from ratt_opt.scenario.model import Scenario
    from ratt_opt.studies.cases import Cell, Seeds

    Rows = Sequence[Mapping[str, str]]

__all__ = ["STUDY", "figure_of", "problem_of", "write_page"]

CAMERAS, MISSION, ALL_ROUND, COVERAGE = "cameras of 60°", "cameras on a mission", "cameras all round", "coverage"
SIDE, SHORT = 60.0, 30
"""Side of the square [m], and ranges of a link [m]: mean degrees about 3.4 and 5.4 of eight robots."""
KINDS = ((CAMERAS, SHORT), (CAMERAS, LONG), (MISSION, LONG), (ALL_ROUND, LONG), (COVERAGE, LONG))
"""Sensors or coverage, and the range of links [m]: a panel each."""
STEPS = 8
"""Steps of a mission under attack; the team of the last one plans."""
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
    scenario = limited_view_scenario(
        case.n_robots,
        case.n_targets,
        alpha_s=case.alpha_s,
        alpha_c=0,
        seed=seeds.scenario,
        view=360.0 if kind == ALL_ROUND else 60.0,
        communication_range=reach,
    )
    return _flown(scenario, seeds.scenario) if kind == MISSION else scenario.problem()


def _flown(scenario: Scenario, seed: int) -> Problem:
    """The problem in which a team finds itself after some steps of a mission planned by messages, under attack."""
    met: list[Problem] = []

    def planner(problem: Problem) -> Plan:
        met.append(problem)
        return decentralised_ratt(problem)

    run_mission(scenario, steps=STEPS, planner=planner, sharing="all surviving", seed=seed)
    return met[-1]


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


@dataclass(frozen=True, slots=True)
class Lost:
    """Losses while a team plans: ``faults`` of robots that plan by messages, and the network ``left`` in the end.

    Baselines plan on what is left from the start, which is in their favour.
    """

    faults: Faults
    left: Problem


def lost(problem: Problem, condition: str, rng: np.random.Generator) -> Lost:
    """Draw losses, or find the worst ones: links up to the budget, one after the other by what its loss costs."""
    links, faults = sorted(problem.communication.links), Faults()

    def at() -> int:
        return int(rng.integers(0, LATEST))

    if condition == PUBLISHERS:
        silent = sorted(rng.choice(problem.n_robots, SILENT, replace=False).tolist())
        faults = Faults(crashed=tuple((at(), i) for i in silent))
        links = [link for link in links if not set(link) & set(silent)]
    elif condition == CHANNELS:
        cut = [link for link in links if rng.random() < CUT_SHARE]
        faults = Faults(cuts=tuple((at(), *link) for link in cut))
        links = [link for link in links if link not in cut]
    elif condition == WORST:
        for _ in range(min(problem.alpha_c, len(links))):
            left = [loss for loss in link_losses(problem, faults=faults).losses if loss.link in links]
            faults = Faults(cuts=(*faults.cuts, (0, *left[0].link)))
            links.remove(left[0].link)
    graph = nx.empty_graph(problem.n_robots)
    graph.add_edges_from(links)
    alpha_c = min(problem.alpha_c, len(links))
    return Lost(faults, Problem(problem.objective, problem.robot, graph, problem.alpha_s, alpha_c))


NOTHING, PUBLISHERS, CHANNELS, WORST = "nothing", "two robots", "40 % of links", "worst two links"
CONDITIONS = (NOTHING, PUBLISHERS, CHANNELS, WORST)
"""Losses while the team plans; all is there again when the plan is attacked."""
LATEST, SILENT, CUT_SHARE = 20, 2, 0.4
"""Rounds within which robots fall silent or links are lost, number of robots, share of links."""


def _by_rag(problem: Problem) -> tuple[IntArray, float]:
    """Resource-aware greedy, and an upper bound on its time: the busiest radio in every round."""
    plan = resource_aware_greedy(problem)
    busiest = max(map(len, neighbours(problem)))
    gain_and_choice = sending(element_bytes(problem, 0) + 8) + sending(element_bytes(problem))
    return plan.elements, plan.rounds * (busiest * gain_and_choice + 2 * RADIO.delay[1]) if busiest else 0.0


def _timed(plan: DecentralisedPlan) -> tuple[IntArray, float]:
    return uninterrupted(plan).elements, plan.decision_time


RATT, ONE_EXCHANGE, EXCHANGES, CENTRE = "RATT by messages", "one exchange", "all exchanges", "refined, with a centre"
WAYS: dict[str, Callable[[Problem, Lost], tuple[IntArray, float]]] = {
    "myopic": lambda problem, _: (myopic(problem).elements, 0.0),
    "neighbours' greedy": lambda _, lost: neighbour_greedy(lost.left),
    "RAG": lambda _, lost: _by_rag(lost.left),
    "cliques": lambda _, lost: clique_selection(lost.left),
    "choices told one hop": lambda problem, lost: _timed(decentralised_ratt(problem, faults=lost.faults, hops=1)),
    RATT: lambda problem, lost: _timed(decentralised_ratt(problem, faults=lost.faults)),
    ONE_EXCHANGE: lambda problem, lost: _timed(
        decentralised_refined(problem, faults=lost.faults, params=ExchangeParams(most=1))
    ),
    EXCHANGES: lambda problem, lost: _timed(decentralised_refined(problem, faults=lost.faults)),
    CENTRE: lambda problem, _: (refined(problem, time_limit=None, max_kicks=100).elements, np.nan),
}
"""Plan and decision time [s] of each way to plan; the last one shows what a centre would reach."""
BROKEN = ("neighbours' greedy", "RAG", "cliques", RATT, EXCHANGES)
"""Ways that are tried with losses as well; without messages nothing can be lost."""


def measured(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:  # noqa: ARG001  (the interface of studies)
    """Share of the certified optimum [1] and decision time [s] of each way; ``open`` : gap of the optimum [1]."""
    problem, rng = with_cuts(problem_of(case, seeds), case.alpha_c), np.random.default_rng(seeds.scenario)
    optimum = uninterrupted(solve_maxmin(problem, time_limit=SEARCH))
    row: dict[str, Cell] = {"open": 1 - optimum.lower / optimum.upper if optimum.upper > 0 else 0.0}
    known: dict[bytes, float] = {}
    for condition in CONDITIONS:
        met = lost(problem, condition, rng)
        for name in WAYS if condition == NOTHING else BROKEN:
            elements, seconds = WAYS[name](problem, met)
            key = elements.tobytes()
            if key not in known:
                known[key] = uninterrupted(worst_case_attack(problem, elements)).lower
            share = min(known[key] / optimum.upper, 1.0) if optimum.upper > 0 else 1.0
            row[f"{labelled(name, condition)}/worst/share"] = share
            row[f"{labelled(name, condition)}/worst/seconds"] = float(seconds)
    return row


def labelled(name: str, condition: str) -> str:
    """Name of a way with what was lost."""
    return name if condition == NOTHING else f"{name}, {condition} lost"


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
    """Mean decision time [s] and share [%] of each way, with each loss, in one kind of teams."""
    own = select(rows, kind=kind, links=links)
    return {
        name: (float(column(own, f"{name}/worst/seconds").mean()), estimate(100 * column(own, f"{name}/worst/share")))
        for name in (
            labelled(way, condition) for condition in CONDITIONS for way in (WAYS if condition == NOTHING else BROKEN)
        )
    }


MARKERS = dict(zip(WAYS, "osD^vP*X_", strict=True))


def figure_of(rows: Rows) -> Figure:
    """A column for each kind of teams: the share kept over the decision time, and below it with what was lost."""
    figure = new_figure(15, 7.4)
    upper, lower = figure.subplots(2, len(KINDS), sharey="row")
    for axes, below, (kind, links) in zip(upper, lower, KINDS, strict=True):
        means = _means(rows, kind, links)
        for name, marker in MARKERS.items():
            seconds, share = means[name]
            if np.isnan(seconds):
                axes.axhline(share.mean, color="#222222", linestyle="--", linewidth=1.2, label=name)
                continue
            spread = [[share.mean - share.low], [share.high - share.mean]]
            axes.errorbar([seconds], [share.mean], spread, fmt=marker, ms=6.5, capsize=3, label=name)
        axes.set_xscale("symlog", linthresh=0.01)
        axes.set_xlim(-0.002, 5)
        axes.set_title(f"{kind}, {links} m")
        axes.set_xlabel("decision time at 0.25 Mbit/s [s]")
        for k, name in enumerate(MARKERS):
            if name in {"myopic", *BROKEN}:
                met = [condition if name in BROKEN else NOTHING for condition in CONDITIONS]
                shares = [means[labelled(name, condition)][1].mean for condition in met]
                below.plot(range(len(CONDITIONS)), shares, marker=MARKERS[name], color=f"C{k}", linewidth=1.2)
        below.set_xticks(range(len(CONDITIONS)), ["nothing", "two\nrobots", "40 %\nof links", "worst\ntwo links"])
        below.set_xlabel("lost while planning")
    for first in (upper[0], lower[0]):
        first.set_ylabel("worst case kept [% of the certified optimum]")
    handles, labels = upper[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=5, frameon=False)
    return figure


PAGE = """# What messages are worth

![Worst case kept, as a share of the certified optimum, over the decision time](decentralised.png)

{sentences}

These are differences in points of the optimum, exchanges by messages less the other way, paired, with 95 % intervals.

Eight robots in a square of 60 m, linked within 30 or 45 m; the adversary blinds two robots and cuts two links.
*Cameras of 60°* must choose among six targets what to look at; those *on a mission* have flown {steps} steps under
attack, planned by messages, and plan again. *Cameras all round* see every target, and *coverage* is 16 items of which a
choice covers a quarter (`TraceObjective` with nearly perfect sensors). Each plan is attacked exactly. Its worst case is
divided by the proved upper end of the optimum: on average {open:.1f} % of it are open, and count against every plan.
{trials} teams a column, 95 % intervals.

The decision time is that of radios of 0.25 Mbit/s that send one packet at a time. What is planned by messages is
simulated with acknowledgements and what finding the component takes; computing is not counted. The baselines are
counted in their favour: no packet is acknowledged, cliques and neighbours are given; the time of RAG is an upper bound.
The dashed line is `refined`, with a centre. *One exchange* stops after the first one: the plan may be used at any time.

The lower row loses robots' radios (two of them, at a random round among the first {latest}), links (each with
probability 0.4, likewise), or, as the robots begin, the two links whose loss costs RATT's plan most, one by one.
Robots that plan by messages meet the loss while they plan; baselines know what is left from the start. All is there
again when the adversary attacks.

| | {kinds} |
| --- | {dashes} |
{table}

## Exchanges by messages and with a centre

Connected teams of ten cameras, eight targets, two robots blinded, three links cut; shares of what `refined` with 200
kicks keeps, of {teams} teams a row; costs are those of the first four. Printed by
`python -m analysis.decentralised.exchanges --teams {teams}`.

{exchanges}

## What is guaranteed, and what others prove

Whatever the robots have heard of, a plan in which each took the best element beside that keeps `(1-c)^2` of the optimum
after the worst attack, `c` the total curvature; a submodular function keeps `(1-k) (1-k + k/Q)` if `Q` cliques of
the graph of who heard whom hold all robots that heard somebody. If choices are told `r` links far, robots within
`r / 2` links of one robot hear each other, so `Q` is at most the number of such balls that hold the team. Components
that plan alone, with RATT's own number of baits, keep `1/g` and `t/(g-1+t)` (`group_size_bound` has the proof). All are
proved in Coq, in `formal/theories/SplitTeams.v`. If all robots are bait, they keep `1-k` without a message: these
bounds alone do not justify one. Exchanges never lower the worst case of a connected team, so RATT's guarantees stay.

Published bounds are about other questions. That sequential greedy with few heard choices depends on cliques of the
information graph is known, without curvature or attacks (Gharesifard and Smith, arXiv 1706.04082). The bound of RAG
(arXiv 2407.10382) is on the value without an attack, and subtracts an amount that depends on the instance. The
bandit version (arXiv 2602.19366) has a bound that is positive on disconnected networks, too, by such an amount. The
resilient selection of arXiv 2105.07305 ends with the central plan of a connected team, and DRM (Zhou and others)
divides the team into cliques; both are about lost robots alone. We found none about cut links.

## Costs

Powers of the number of robots N, the diameter and the number of baits alpha, fitted over teams of 25, 50, 100 and 200
with budgets of 4, 20 and 60 % of them (complete networks of 200: 4 and 20 %); four targets, three controls, {seeds}
teams each (one of 200), 95 % intervals. An auction takes one item a link of a tree and direction, and finding the
component one item a link list and link: without losses, on a tree, fewer than `4 N^2` items, and as many
acknowledgements at most. Messages are packets: in small teams one holds several items. More baits mean fewer
auctions. On sparse networks (all but the complete ones) the diameter tells families apart.

{costs}

The tables are printed by `python -m analysis.decentralised.costs --seeds {seeds}`; this page is written by

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
        best = column(own, f"{EXCHANGES}/worst/share")
        parts = []
        for name in ("myopic", "RAG", "cliques", RATT, CENTRE):
            change = estimate(100 * (best - column(own, f"{name}/worst/share")))
            parts.append(f"{change.mean:+.1f} [{change.low:+.1f}, {change.high:+.1f}] against {name}")
        where = f"*{kind}, links within {links} m*"
        found.append(f"- {where}: {', '.join(parts)}.")
    return found


TEAMS, SEEDS = 16, 2
"""Teams of the table of exchanges a row, and of the tables of costs."""


def _kept(folder: Path, name: str, make: Callable[[], list[str]]) -> str:
    """Lines of a table, from an earlier run if it has left them in the folder."""
    file = folder / f"{name}.md"
    if not file.exists():
        text = "\n".join(make())
        write_atomically(file, lambda path: path.write_text(text, encoding="utf-8"))
    return file.read_text(encoding="utf-8").rstrip("\n")


def write_page(folder: Path) -> None:
    """Write the page and its figure beside the results."""
    from analysis.decentralised.exchanges import table as exchange_table

    rows = read_table(folder / STUDY.name)
    means = [_means(rows, kind, links) for kind, links in KINDS]
    lines = []
    for name in means[0]:
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
        steps=STEPS,
        latest=LATEST,
        teams=TEAMS,
        exchanges=_kept(folder, "exchanges", lambda: exchange_table(TEAMS)),
        seeds=SEEDS,
        costs=_kept(folder, "costs", lambda: table(SEEDS)),
    )
    figure = figure_of(rows)
    write_atomically(folder / "decentralised.png", lambda file: figure.savefig(file, dpi=120))
    write_atomically(folder / "decentralised.md", lambda file: file.write_text(text, encoding="utf-8"))


if __name__ == "__main__":
    sys.exit(main("What messages are worth", [Entry(STUDY)], trials=16, after=write_page))
