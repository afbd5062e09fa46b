"""The max-min problem of one step: an element for every combination of a node's actions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from stonesoup.base import Base, Property

from ratt_opt._validation import check_integer
from ratt_opt.errors import InputError
from ratt_opt.interop.stonesoup.forecast import Forecast
from ratt_opt.interop.stonesoup.information import mapped_by, node_information, notes_of
from ratt_opt.interop.stonesoup.network import Network
from ratt_opt.interop.stonesoup.nodes import title
from ratt_opt.problem import Problem
from ratt_opt.scenario.information_input import InformationInput
from ratt_opt.setfunctions.criteria.registry import WITH_OUTPUT, get_criterion
from ratt_opt.solvers.undominated import UndominatedProblem, undominated

if TYPE_CHECKING:
    from collections.abc import Sequence
    from datetime import datetime

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.interop.stonesoup.information import Choices
    from ratt_opt.interop.stonesoup.nodes import Node
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["PlanningStep", "TeamProblem"]


@dataclass(frozen=True, slots=True, eq=False)
class PlanningStep:
    """One step's ``problem``, and which of a node's combinations each element is (``combination``, (E,)).

    ``coordinates`` : of each track, those of its state that count; ``notes`` : how sensors are linearised
    that have no Jacobian of their own
    """

    problem: UndominatedProblem
    nodes: tuple[Node, ...]
    relays: tuple[Any, ...]
    choices: tuple[Choices, ...]
    combination: IntArray
    forecast: Forecast
    coordinates: tuple[IntArray, ...]
    notes: tuple[str, ...]

    @property
    def names(self) -> tuple[Any, ...]:
        """The platform or sensor of each robot of the problem; then the relays."""
        return (*(node.name for node in self.nodes), *self.relays)

    def to_information(self) -> InformationInput:
        """The step as model-free input, for reports (:func:`ratt_opt.bound`) and files.

        The ``payload`` of each element is its ``{actionable: actions}``.

        Raises
        ------
        InputError : only some of its coordinates count.
        """
        problem, objective = self.problem, self.problem.information_objective
        if getattr(objective, "output", None) is not None:
            raise InputError("coordinates", "must be None: model-free input counts all that are measured", "a part")
        owners = problem.robot.tolist()
        fields: dict[str, Any] = {
            "prior": objective.prior,
            "information": objective.information,
            "robot": owners,
            "links": None if problem.graph is None else sorted(problem.communication.links),
            "robot_names": [title(name) for name in self.names],
            "payload": [self._of_node(i, e) if i < len(self.nodes) else {} for e, i in enumerate(owners)],
        }
        return InformationInput(alpha_s=problem.alpha_s, alpha_c=problem.alpha_c, **fields)

    def configuration(self, elements: Any) -> dict[Any, tuple[Any, ...]]:
        """``{actionable: actions}`` of a plan, node by node."""
        chosen: dict[Any, tuple[Any, ...]] = {}
        for i, e in enumerate(list(elements)[: len(self.nodes)]):
            chosen |= self._of_node(i, e)
        return chosen

    def _of_node(self, i: int, e: int) -> dict[Any, tuple[Any, ...]]:
        choices = self.choices[i]
        places = np.unravel_index(self.combination[e], tuple(map(len, choices)))
        return {a: own[k] or () for a, own, k in zip(self.nodes[i].actionables, choices, places, strict=True)}


class TeamProblem(Base):
    """Setting in which plans are judged: predictions of tracks, what counts, links, the adversary's budgets."""

    predictor: Any = Property(default=None, doc="Predicts tracks to the time of the actions; None: states as they are.")
    updater: Any = Property(
        default=None, doc="Unscented and cubature updaters linearise by points, others by Jacobian."
    )
    criterion: str = Property(default="trace", doc="'trace', 'logdet' or 'maxeig' of the coordinates that count.")
    coordinates: Any = Property(default=None, doc="Those of the states that count, as (0, 2); None: all measured ones.")
    graph: Any = Property(default=None, doc="networkx graph, or edges of Stone Soup's networks; None: all are linked.")
    alpha_s: int = Property(default=0, doc="Number of platforms, or sensors that stand alone, blinded at once.")
    alpha_c: int = Property(default=0, doc="Number of links cut at once.")

    def step(
        self, nodes: tuple[Node, ...], choices: tuple[Choices, ...], tracks: Any, timestamp: datetime
    ) -> PlanningStep:
        """The problem of these choices in the coordinates that are measured, without elements that no plan needs.

        Raises
        ------
        InputError : a budget is larger than the team, a track's covariance is not positive definite, or a sensor does
            not fit the tracks.
        """
        network, forecast = Network.of(self.graph, nodes), Forecast.of(tracks, self.predictor, timestamp)
        _check_budgets(self.alpha_s, self.alpha_c, len(nodes), network)
        told = [
            node_information(node, own, timestamp, forecast, self.updater)
            for node, own in zip(nodes, choices, strict=True)
        ]
        relay = np.zeros((1, *forecast.covariances.shape))
        told += [relay] * len(network.relays)
        firsts = [_distinct(part) for part in told]
        information = np.concatenate([part[first] for part, first in zip(told, firsts, strict=True)])
        rows = _measured(information, forecast, mapped_by(nodes), self.coordinates)
        prior, information = _in(rows, forecast, information)
        objective = _objective(self.criterion, prior, information, rows, self.coordinates)
        robot = np.repeat(np.arange(len(told)), list(map(len, firsts)))
        kept = undominated(Problem(objective, robot, network.graph, self.alpha_s, self.alpha_c))
        combination, notes = np.concatenate(firsts)[kept.kept], notes_of(nodes, self.updater)
        return PlanningStep(kept, nodes, network.relays, choices, combination, forecast, rows, notes)


def _objective(
    criterion: str, prior: FloatArray, information: FloatArray, rows: tuple[IntArray, ...], counted: Any
) -> InformationObjective:
    """The criterion of the coordinates that count, ``None`` for all of ``rows``."""
    kind = get_criterion(criterion)
    if counted is None or all(len(own) == len(counted) for own in rows):
        return kind(prior, information)
    if criterion not in WITH_OUTPUT:
        rule = f"must be None with the criterion {criterion}, which counts all coordinates that are measured"
        raise InputError("coordinates", rule, list(counted))
    output = np.zeros((len(rows), len(counted), prior.shape[-1]))
    for j, own in enumerate(rows):
        output[j, np.arange(len(counted)), np.searchsorted(own, counted)] = 1
    return WITH_OUTPUT[criterion](prior, information, output=output)


def _measured(
    information: FloatArray, forecast: Forecast, mapped: set[int], counted: Sequence[int] | None
) -> tuple[IntArray, ...]:
    """Coordinates of each track that sensors are made for, some element tells about, or that are ``counted``.

    They ascend; those of equally large states are alike. Measurements of position tell nothing about velocity but
    through the position, so the position's covariance after them follows from its covariance before, and the log-det of
    both together changes as much as the position's alone. If nothing is known of them, the first one stands for all.
    """
    told = np.einsum("emii->emi", information).any(axis=0)
    sizes = np.array(forecast.sizes)
    for axis in counted or ():
        check_integer("coordinates (of the tracks' states)", axis, low=0, high=int(sizes.min()) - 1)
    named = sorted(axis for axis in mapped | set(counted or ()) if axis < told.shape[1])
    told[:, named] = True
    rows = {n: np.flatnonzero(told[sizes == n, :n].any(axis=0)) for n in set(forecast.sizes)}
    return tuple(rows[n] if len(rows[n]) else np.arange(1) for n in forecast.sizes)


def _in(
    coordinates: tuple[IntArray, ...], forecast: Forecast, information: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Priors and information in those coordinates.

    Tracks with fewer of them get further ones that nobody measures, of the smallest variance: they change no value.
    """
    dimension = max(map(len, coordinates))
    prior = np.zeros((len(coordinates), dimension, dimension))
    told = np.zeros((len(information), len(coordinates), dimension, dimension))
    for j, rows in enumerate(coordinates):
        block = forecast.covariances[j][np.ix_(rows, rows)]
        block = (block + block.T) / 2
        lowest = np.linalg.eigvalsh(block)[0]
        if lowest <= 0:
            raise InputError("tracks", "must have positive definite covariances where sensors measure", lowest)
        prior[j] = np.eye(dimension) * lowest
        prior[j, : len(rows), : len(rows)] = block
        told[:, j, : len(rows), : len(rows)] = information[:, j][:, rows[:, None], rows]
    return prior, told


def _distinct(information: FloatArray) -> IntArray:
    """The first of every set of combinations that are equal to 1e-12 of the largest entry, ascending."""
    rows = information.reshape(len(information), -1)
    scale = np.abs(rows).max(axis=0, initial=0.0)
    # 0 is added since the bytes of -0 differ from those of 0.
    digits = np.round(rows / np.where(scale > 0, scale * 1e-12, 1.0)) + 0.0
    firsts = {row.tobytes(): k for k, row in reversed(list(enumerate(digits)))}
    return np.sort(list(firsts.values()))


def _check_budgets(alpha_s: int, alpha_c: int, n_nodes: int, network: Network) -> None:
    who = f"alpha_s (platforms and sensors that may be blinded, of {n_nodes})"
    check_integer(who, alpha_s, low=0, high=n_nodes)
    total = n_nodes + len(network.relays)
    links = total * (total - 1) // 2 if network.graph is None else network.graph.number_of_edges()
    check_integer(f"alpha_c (links that may be cut, of {links})", alpha_c, low=0, high=links)
