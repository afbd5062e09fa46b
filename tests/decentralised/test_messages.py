"""Messages come back as they were sent, have the sizes that they say, and robots that disagree say so by name."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import Faults
from ratt_opt.decentralised.agent import Agent
from ratt_opt.decentralised.component_plan import State
from ratt_opt.decentralised.messages import HEADER, RECORD, VERSION, Bid, LinkRecord, Packet, decode, encode
from ratt_opt.decentralised.plan import make_agents
from ratt_opt.decentralised.simulator import Simulation
from tests.decentralised.teams import team


def deliver_all(agents, seen=None):
    """Pass packets in turn until nobody has any."""
    moved = True
    while moved:
        moved = False
        for agent in agents.values():
            for other in agent.addressees:
                packet = agent.send(other)
                if packet is not None:
                    moved = True
                    if seen is not None:
                        seen.append(packet)
                    agents[other].receive(decode(encode(packet)))


def test_packets_come_back_and_their_bytes_plan_as_well():
    problem = team(np.random.default_rng(11), 6, objective="trace")
    agents, seen = make_agents(problem), []
    deliver_all(agents, seen)
    assert [agents[i].element for i in range(6)] == list(ro.ratt(problem))
    assert all(agent.state is State.ENDED for agent in agents.values())
    for packet in seen:
        again = decode(encode(packet))
        assert len(encode(packet)) == packet.size == again.size
        for one, other in zip(packet.items, again.items, strict=True):
            assert type(one) is type(other)
            if isinstance(one, Bid):
                assert all(map(np.array_equal, *([c.information for c in bid.choices] for bid in (one, other))))
                assert (one.value, one.round) == (other.value, other.round)
            else:
                assert one == other


def test_damaged_packets_are_refused():
    problem = team(np.random.default_rng(11), 5, objective="trace")
    agents, seen = make_agents(problem), []
    deliver_all(agents, seen)
    for packet in seen[:40]:
        data = encode(packet)
        for k in range(len(data)):
            with pytest.raises(ro.InputError, match="packet"):
                decode(data[:k])
        with pytest.raises(ro.InputError, match="packet"):
            decode(data + b"\0")
        with pytest.raises(ro.InputError, match="version"):
            decode(bytes([VERSION + 1]) + data[1:])


def test_link_records_are_sent_the_shorter_way():
    for ends, kept, size in (((1, 300), {300}, 4), (tuple(range(40)), {3, 39}, 10), ((), set(), 0)):
        record = LinkRecord(7, 3, ends, frozenset(kept), blinded=True, is_protected=bool(ends))
        packet = Packet(VERSION, b"12345678", 7, 0, 0, (record,))
        assert decode(encode(packet)) == packet
        assert len(encode(packet)) == packet.size == HEADER.size + RECORD.size + size


def run_with(problem, robot, agent):
    agents = make_agents(problem) | {robot: agent}
    simulation = Simulation(agents, Faults(), 0)
    simulation.run()
    return agents


def test_a_robot_of_another_version_is_left_out_by_name():
    problem = team(np.random.default_rng(12), 5, objective="trace")
    other = Agent(replace(make_agents(problem)[2].knowledge, version=VERSION + 1))
    agents = run_with(problem, 2, other)
    near = {i for link in problem.communication.links if 2 in link for i in link} - {2}
    told = {one.robot: one for agent in agents.values() for one in agent.disagreements if one.robot != 2}
    assert told
    assert set(told) <= near
    assert {one.about for one in told.values()} == {"version of the messages"}
    assert all(one.neighbour == 2 and one.other == str(VERSION + 1) for one in told.values())
    assert all(agent.has_ended for agent in agents.values())
    assert all(2 not in agent.component for i, agent in agents.items() if i != 2)


@pytest.mark.parametrize("field", ["alpha_s", "prior", "hops", "exchanges"])
def test_robots_with_other_data_are_left_out_by_their_digest(field):
    problem = team(np.random.default_rng(13), 5, objective="trace")
    known = make_agents(problem)[1].knowledge
    changed = {"alpha_s": problem.alpha_s + 1, "hops": 2, "exchanges": ro.ExchangeParams()}
    if field in changed:
        other = replace(known, **{field: changed[field]})
    else:
        f = known.objective
        other = replace(known, objective=type(f)(2 * f.prior, f.information))
    agents = run_with(problem, 1, Agent(other))
    told = [one for i, agent in agents.items() if i != 1 for one in agent.disagreements]
    assert told
    assert all(
        one.about == "criterion, prior, budgets or way to plan" and one.other == other.common.hex() for one in told
    )
    assert all(agent.has_ended for agent in agents.values())


def test_robots_that_find_another_alpha_name_the_component():
    problem = team(np.random.default_rng(14), 5, objective="trace")
    known = replace(make_agents(problem)[1].knowledge, links_worth=lambda _: 0)
    agents = run_with(problem, 1, Agent(known))
    whole = make_agents(problem)
    deliver_all(whole)
    if whole[0].knowledge.links_worth(
        ro.Problem(
            problem.objective,
            problem.robot,
            problem.graph,
            problem.alpha_s,
            problem.alpha_c,
            (),
            problem.protected_links,
        ).threat
    ):
        assert any(one.about == "component" for agent in agents.values() for one in agent.disagreements)
    assert all(agent.has_ended for agent in agents.values())


def test_every_state_has_a_sentence():
    assert all(state.value.endswith(".") and state.value.startswith("It ") for state in State)
    guide = (Path(__file__).parents[2] / "docs/guides/decentralised.md").read_text(encoding="utf-8")
    assert all(f"| {state.name.lower()} | It " in guide for state in State)
