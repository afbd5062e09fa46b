"""What the library is given is copied: arrays, lists, sets and graphs that their owner changes later change nothing."""

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro

PRIOR, INFORMATION, OWNERS = (
    np.eye(2)[None],
    np.stack([k * np.eye(2)[None] for k in (1.0, 2.0, 3.0, 4.0)]),
    [0, 0, 1, 1],
)
CRITERIA = (ro.TraceObjective, ro.LogDetObjective, ro.MaxEigenvalueObjective)


def of_criterion(kind):
    def made(prior, information, weights, output):
        part = {} if kind is ro.LogDetObjective else {"output": output}
        return kind(prior, information, weights, **part)

    return made, (PRIOR, INFORMATION, np.ones(1), np.eye(2)[:1])


def problem(owners):
    return ro.Problem(ro.TraceObjective(PRIOR, INFORMATION), owners, None, 1, 0)


def information_input(prior, information, weights):
    return ro.InformationInput(
        prior=prior, information=information, weights=weights, robot=OWNERS, alpha_s=1, alpha_c=0
    ).problem()


def moment(poses, covariances):
    belief = ro.Belief(np.ones((1, 2)), np.eye(2)[None])
    return ro.Moment(time=0.0, poses=poses, pose_covariances=covariances, belief=belief, refused=(0,))


DOORS = {
    **{kind.__name__: of_criterion(kind) for kind in CRITERIA},
    "Problem": (problem, (np.array(OWNERS),)),
    "InformationInput": (information_input, (PRIOR, INFORMATION, np.ones(1))),
    "TableFunction": (ro.TableFunction, (np.array([0.0, 1.0, 1.0, 2.0]),)),
    "Modular": (ro.Modular, (np.ones(3),)),
    "Coverage": (ro.Coverage, (np.eye(3), np.ones(3))),
    "FacilityLocation": (ro.FacilityLocation, (np.ones((3, 2)),)),
    "ConcaveOfModular": (ro.ConcaveOfModular, (np.ones(3),)),
    "Cut": (ro.Cut, (1.0 - np.eye(3),)),
    "PartitionMatroidRank": (ro.PartitionMatroidRank, (np.ones(3), np.array([0, 0, 1]), np.ones(2, dtype=int))),
    "Belief": (ro.Belief, (np.ones((1, 2)), np.eye(2)[None])),
    "Belief.of": (ro.Belief.of, (np.ones((1, 2)), np.eye(2)[None])),
    "ConstantVelocity": (ro.ConstantVelocity, (np.ones(2),)),
    "CoordinatedTurn": (ro.CoordinatedTurn, (np.ones(2),)),
    "Moment": (moment, (np.ones((1, 3)), np.zeros((1, 3, 3)))),
}


def contents(made):
    """Every array and number that it holds, as plain data."""
    if isinstance(made, ro.Problem):
        return contents(made.objective), made.robot.tolist()
    names = {name for kind in type(made).__mro__ for name in getattr(kind, "__slots__", ())} | set(
        vars(made) if hasattr(made, "__dict__") else ()
    )
    values = {name: getattr(made, name) for name in names if hasattr(made, name)}
    held = {name: value.tolist() for name, value in values.items() if isinstance(value, np.ndarray)}
    return held, [made([0]), made(range(made.n))] if isinstance(made, ro.SetFunction) else None


@pytest.mark.parametrize("door", DOORS)
def test_arrays(door):
    make, originals = DOORS[door]
    given = [np.array(original) for original in originals]
    made = make(*given)
    before = contents(made)
    assert str(before) != str(({}, None))
    for array in given:
        array[...] = 7  # still the caller's own to write to
    assert contents(made) == before


def test_lists_sets_and_graphs():
    robots, links, graph = {1}, {(0, 1)}, nx.path_graph(2)
    made = ro.Problem(ro.TraceObjective(PRIOR, INFORMATION), OWNERS, graph, 1, 1, robots, links)
    robots.add(0)
    links.clear()
    graph.remove_edge(0, 1)
    assert (made.protected_robots, made.protected_links) == ({1}, {(0, 1)})
    assert made.communication.links == {(0, 1)}
    prior = [np.eye(2).tolist()]
    given = ro.InformationInput(prior=prior, information=INFORMATION.tolist(), robot=OWNERS, alpha_s=1, alpha_c=0)
    prior[0][0][0] = 9.0
    assert given.problem().objective.prior[0, 0, 0] == 1.0
