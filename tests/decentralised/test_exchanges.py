"""Exchanges by messages never lower a component's worst case, and come near those with a centre."""

from itertools import pairwise

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import ExchangeParams, Problem, Stop, decentralised_ratt, decentralised_refined
from ratt_opt.budget import Budget
from ratt_opt.decentralised import simulator
from ratt_opt.decentralised.component_plan import State
from ratt_opt.decentralised.plan import make_agents
from ratt_opt.decentralised.processes import plan_in_processes
from tests.decentralised.teams import connected_graph, parts, radio_faults, team

QUICK = ExchangeParams(kicks=1)


def cameras(rng, seed, n=6):
    """Cameras in few pairs of links, so that RATT's plan is often not the best one; some cannot be blinded."""
    scenario = ro.limited_view_scenario(n, n, alpha_s=0, alpha_c=0, seed=seed, headings=6)
    found = ro.undominated(scenario.problem(["trace", "logdet", "maxeig"][seed % 3]))
    sheltered = [i for i in range(n) if rng.random() < 0.1]
    graph = connected_graph(rng, n, 0.4)
    links = sorted(tuple(sorted(link)) for link in graph.edges)
    kept = [link for link in links if rng.random() < 0.1]
    return Problem(found.objective, found.robot, graph, 1, min(2, len(links)), sheltered, kept)


def check_no_worse(seed):
    rng = np.random.default_rng([3, seed])
    problem = cameras(rng, seed)
    links, at = sorted(problem.communication.links), lambda: int(rng.integers(40))
    cuts = tuple((at(), *links[k]) for k in rng.permutation(len(links))[: seed % 4])
    crashed = ((at(), int(rng.integers(problem.n_robots))),) if seed % 5 == 0 else ()
    faults = radio_faults(rng, cuts=cuts, crashed=crashed, blinded=((at(), 0),) if seed % 7 == 0 else ())
    plan = decentralised_refined(problem, params=QUICK, faults=faults, seed=seed, c=0.5)
    is_claimed = not sum(plan.exchanges) or len(plan.components) == 1
    assert plan.guarantee == (0.25 if is_claimed else 0.0)
    assert plan.stop is Stop.EXHAUSTED
    assert not plan.disagreements
    taken = dict(zip(plan.components, plan.exchanges, strict=True))
    for group, own, alone in parts(problem, plan):
        ratts = ro.ratt(alone).elements
        elements = np.searchsorted(own, [plan.elements[i] for i in group])
        if taken[group] == 0:
            assert list(elements) == list(ratts)
        else:
            before, after = (ro.worst_case_attack(alone, chosen) for chosen in (ratts, elements))
            assert after.lower > before.upper
    return sum(plan.exchanges), len(plan.components) > 1


def test_no_component_is_worse_whatever_goes_wrong():
    found = np.array([check_no_worse(seed) for seed in (9, 10)])
    assert found.all(axis=1).any()


@pytest.mark.slow
def test_no_component_is_worse_in_many_teams():
    for seed in range(100, 108):
        check_no_worse(seed)


def test_every_exchange_raises_the_worst_case_and_none_leaves_ratts_plan():
    problem, values = cameras(np.random.default_rng(1), 3), []
    for most in range(3):
        plan = decentralised_refined(problem, params=ExchangeParams(most=most, kicks=0))
        values.append(ro.worst_case_attack(problem, plan.elements).lower)
        assert sum(plan.exchanges) <= most
    assert values[0] == ro.worst_case_attack(problem, ro.ratt(problem).elements).lower
    assert values[0] < values[1] <= values[2]


class Watcher(Budget):
    """A budget that never ends and looks at the agents at every event."""

    def __init__(self, look):
        super().__init__()
        self.look = look

    def stop(self):
        self.look()


def test_at_any_time_the_last_exchange_that_all_have_heard_of_is_no_worse():
    problem = cameras(np.random.default_rng(1), 3)
    agents, seen = make_agents(problem, exchanges=ExchangeParams(kicks=0)), []

    def look():
        if all(agent.state in {State.PROPOSING, State.PROPOSED, State.ENDED} for agent in agents.values()):
            taken = min(agent.exchanges for agent in agents.values())
            elements = tuple(agents[i].element_after(taken) for i in range(6))
            if not seen or seen[-1] != elements:
                seen.append(elements)

    simulator.Simulation(agents, ro.Faults(), 0).run(Watcher(look), 1)
    assert seen[0] == tuple(ro.ratt(problem).elements)
    worst = [ro.worst_case_attack(problem, list(elements)) for elements in seen]
    assert len(worst) > 1
    assert all(after.lower > before.upper for before, after in pairwise(worst))


@pytest.mark.slow
@pytest.mark.parametrize("reach", [30, 45])
def test_ten_cameras_come_within_two_percent_of_a_centre(reach):
    teams = (
        ro.limited_view_scenario(10, 8, alpha_s=2, alpha_c=3, seed=seed, communication_range=reach).problem()
        for seed in range(100)
    )
    problem = next(one for one in teams if len(one.communication.groups()) == 1)
    central = ro.refined(problem, time_limit=None, max_kicks=200).upper
    plans = decentralised_ratt(problem), decentralised_refined(problem)
    ratt, exchanged = (ro.worst_case_attack(problem, plan.elements).lower / central for plan in plans)
    assert exchanged >= max(ratt, 0.98)


@pytest.mark.slow
def test_processes_take_the_same_exchanges():
    problem = team(np.random.default_rng(5), 4, objective="trace")
    problem = Problem(problem.objective, problem.robot, problem.graph, 1, 1)
    params = ExchangeParams(kicks=1)
    plan, simulated = plan_in_processes(problem, exchanges=params), decentralised_refined(problem, params=params)
    assert list(plan.elements) == list(simulated)


def test_robots_that_plan_otherwise_are_refused():
    problem = team(np.random.default_rng(6), 4, objective="trace")
    assert not decentralised_ratt(problem).disagreements
    with pytest.raises(ro.InputError, match="hops"):
        decentralised_ratt(problem, hops=0)
    with pytest.raises(ro.InputError, match="kicks"):
        ExchangeParams(kicks=-1)
