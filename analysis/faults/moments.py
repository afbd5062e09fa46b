"""Interrupts at random moments inside each long search: each comes back soon, with a bracket.

Run as ``python -m analysis.faults.moments [--moments 100] [--seed 1] [--seconds 60] [--searches NAME ...]``. A
thread interrupts the main one (Ctrl-C) once the search has used a random number of seconds of the processor, up to what
it takes undisturbed or ``--most``. For each search it prints how it came back, and the longest time from the interrupt
to its return, in seconds of the processor.
The exit code is 1 if one raised, came back as if nothing had been, without a bracket, or later than ``--within``.
"""

import argparse
import signal
import threading
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from time import process_time, sleep
from typing import Any

import networkx as nx
import numpy as np

import ratt_opt as ro
from ratt_opt.running.interrupts import interrupt_main_thread

__all__ = ["Moment", "interrupted_after", "is_answered", "searches"]

LOOK = 0.0005
"""Seconds between two looks at the processor's clock."""


class Square(ro.SetFunction):
    """A function of a user's own: known by its values alone, neither submodular nor supermodular to the searches."""

    def __init__(self, weights: Any) -> None:
        self.weights = weights

    @property
    def n(self) -> int:
        """Number of elements."""
        return len(self.weights)

    def evaluate(self, membership: Any) -> Any:
        """Squares of the sums of weights."""
        return (membership @ self.weights) ** 2


@dataclass(frozen=True, slots=True, kw_only=True)
class Moment:
    """Outcome of an interrupted search: its result or error, and seconds of the processor since the interrupt.

    ``seconds`` is ``None`` if it was back before the interrupt.
    """

    found: Any
    raised: str | None
    seconds: float | None


def interrupted_after(search: Callable[[], Any], delay: float) -> Moment:
    """Run a search and interrupt it once it has begun and used ``delay`` seconds of the processor."""
    began, sent, is_back = process_time(), [0.0], threading.Event()
    before = signal.getsignal(signal.SIGINT)

    def interrupt() -> None:
        while not is_back.is_set() and (process_time() - began < delay or signal.getsignal(signal.SIGINT) is before):
            sleep(LOOK)
        if not is_back.is_set():
            sent[0] = process_time()
            interrupt_main_thread()

    thread, found, raised = threading.Thread(target=interrupt, daemon=True), None, None
    thread.start()
    try:
        found = search()
    except BaseException as error:  # noqa: BLE001  (an interrupt that left the search is what is looked for)
        raised = type(error).__name__
    back = process_time()
    is_back.set()
    thread.join()
    return Moment(found=found, raised=raised, seconds=back - sent[0] if sent[0] else None)


def is_answered(moment: Moment) -> bool:
    """Tell whether the search returned a bracket as interrupted, or ended before the interrupt."""
    if moment.seconds is None:
        return moment.raised is None
    return moment.raised is None and all(map(_is_bracket, _results(moment.found)))


def _results(found: Any) -> list[Any]:
    return list(found.values()) if isinstance(found, dict) else [found]


def _is_bracket(found: Any) -> bool:
    if isinstance(found, tuple) and not hasattr(found, "stop"):  # a ranking: brackets of gains, and no reason
        return all(row.gain_lower <= row.gain_upper for row in found)
    is_in_order = not hasattr(found, "lower") or found.lower <= found.upper
    return bool(getattr(found, "stop", ro.Stop.INTERRUPTED) is ro.Stop.INTERRUPTED and is_in_order)


def _network(n_robots: int, alpha_s: int, alpha_c: int, objective: str = "trace") -> ro.Problem:
    scenario = ro.limited_view_scenario(
        n_robots, 8, alpha_s=alpha_s, alpha_c=alpha_c, seed=3, view=120, communication_range=60
    )
    return scenario.problem(objective)


def _own(n_robots: int, controls: int, alpha_s: int = 2, alpha_c: int = 4) -> ro.Problem:
    rng = np.random.default_rng(4)
    graph = nx.random_geometric_graph(n_robots, 0.5, seed=4)
    robot = np.repeat(np.arange(n_robots), controls)
    return ro.Problem(Square(rng.random(len(robot))), robot, graph, alpha_s, min(alpha_c, graph.number_of_edges()))


def _searches() -> dict[str, Callable[[], Any]]:
    """Searches that take seconds and more, by name."""
    dense, large = (ro.random_scenario(n, 8, alpha_s=n // 5, alpha_c=3 * n, seed=2).problem("maxeig") for n in (30, 60))
    network, small, own, larger = _network(30, 6, 20), _network(8, 2, 6), _own(14, 2), _own(24, 2, 5, 8)
    spatial = _spatial()
    plans = {id(p): ro.myopic(p).elements for p in (dense, large, network, small, own, larger, spatial)}

    def attacked(problem: ro.Problem) -> Callable[[], Any]:
        return lambda: ro.worst_case_attack(problem, plans[id(problem)])

    graph = nx.random_geometric_graph(60, 0.3, seed=1)
    searches = {
        "worst_case_attack, network": attacked(network),
        "worst_case_attack, complete": attacked(dense),
        "worst_case_attack, complete 60": attacked(large),
        "worst_case_attack, three dimensions": attacked(spatial),
        "worst_case_attack, own function": attacked(larger),
        "solve_maxmin": lambda: ro.solve_maxmin(network),
        "solve_maxmin, complete": lambda: ro.solve_maxmin(dense),
        "solve_maxmin, own function": lambda: ro.solve_maxmin(larger),
        "refined": lambda: ro.refined(network, time_limit=60),
        "exhaustive_optimum": lambda: ro.exhaustive_optimum(_own_small()),
        "nonrobust_optimum": lambda: ro.nonrobust_optimum(dense),
        "links_to_protect": lambda: ro.links_to_protect(network, plans[id(network)], 3),
        "links_to_add": lambda: ro.links_to_add(network, plans[id(network)], 3),
        "criticality_ranking": lambda: ro.criticality_ranking(network, plans[id(network)]),
        "breaking_budgets": lambda: ro.breaking_budgets(network, plans[id(network)], 1.0),
        "attack_survey": lambda: ro.attack_survey(network, plans[id(network)]),
        "total_curvature": lambda: ro.total_curvature(network.objective, network.robot, gap=1e-9, time_limit=None),
        "total_curvature, own function": lambda: ro.total_curvature(_own(10, 2).objective, time_limit=None),
        "curvature": lambda: ro.curvature(network.objective, network.robot, gap=1e-9, time_limit=None),
        "submodularity_ratio": lambda: ro.submodularity_ratio(own.objective, own.robot, time_limit=None),
        "generalised_curvature": lambda: ro.generalised_curvature(own.objective, own.robot, time_limit=None),
        "smallest_largest_group": lambda: ro.smallest_largest_group(graph, 60),
        "worst_case_ratio": lambda: ro.worst_case_ratio(
            6, 2, 3, curvature=0.5, family="nondecreasing", use_theorem=False
        ),
    }
    for name in searches:
        getattr(ro, name.partition(",")[0])  # its module is loaded: before that there is no search to interrupt
    return searches


def _spatial() -> ro.Problem:
    rng = np.random.default_rng(5)
    h = rng.normal(size=(40, 4, 1, 4))
    objective = ro.MaxEigenvalueObjective(np.stack([np.eye(4)] * 4), np.swapaxes(h, -1, -2) @ h)
    return ro.Problem(objective, np.arange(40), None, 6, 120)


def _own_small() -> ro.Problem:
    return _own(10, 4)


@cache
def searches() -> Mapping[str, Callable[[], Any]]:
    """Searches that take seconds and more, by name; making them takes seconds too."""
    return _searches()


def main() -> int:
    """Run the campaign, print what came back and how soon, and return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--moments", type=int, default=100, help="of each search (default %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the moments (default %(default)s)")
    parser.add_argument("--within", type=float, default=0.3, help="seconds of the processor (default %(default)s)")
    parser.add_argument("--most", type=float, default=2.0, help="the latest moment, in seconds (default %(default)s)")
    parser.add_argument("--seconds", type=float, default=np.inf, help="of the processor for each search: fewer moments")
    parser.add_argument("--searches", nargs="+", choices=list(searches()), default=list(searches()))
    options = parser.parse_args()
    rng, is_fine = np.random.default_rng(options.seed), True
    for name in options.searches:
        interrupted_after(searches()[name], options.most)  # loads what is imported when it is first needed
        began = process_time()
        interrupted_after(searches()[name], options.most)
        until, moments, latest = process_time() + options.seconds, [], min(process_time() - began, options.most)
        for delay in rng.uniform(0, latest, options.moments):
            moments.append(interrupted_after(searches()[name], delay))
            if process_time() > until:
                break
        late = max((m.seconds for m in moments if m.seconds is not None), default=0.0)
        wrong = Counter(m.raised or "no bracket" for m in moments if not is_answered(m))
        before = sum(m.seconds is None for m in moments)
        is_fine &= not wrong and late <= options.within
        answers = dict(wrong) or "all answered"
        print(f"{name}: {len(moments)} moments, {before} back before, latest {late:.3f} s, {answers}", flush=True)
    return 0 if is_fine else 1


if __name__ == "__main__":
    raise SystemExit(main())
