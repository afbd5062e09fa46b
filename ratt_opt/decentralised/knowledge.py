"""Data of one robot: its knowledge before the first message, awarded information, and neighbours that it refused."""

from __future__ import annotations

from bisect import bisect
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_integer, check_number
from ratt_opt.decentralised.messages import VERSION, Choice
from ratt_opt.decentralised.view import digest
from ratt_opt.errors import InputError
from ratt_opt.problem import Problem
from ratt_opt.setfunctions.information import from_triangles, triangles
from ratt_opt.solvers.undominated import undominated

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["AwardedSum", "Disagreement", "ExchangeParams", "Knowledge", "OwnChoice"]


@dataclass(frozen=True, slots=True)
class ExchangeParams:
    """Exchanges after RATT's plan: what more finds better ones, and takes longer.

    ``most`` : exchanges that a component takes; ``None`` until nobody has one. ``reach`` : links over which a robot
    tells its elements: robots within them are exchanged together; 1 sends least. ``kicks`` : perturbations in each
    robot's search for one, see :func:`ratt_opt.refined`. ``seconds`` : of computing for one such search; without a
    limit the plan is the same on every run.

    Raises
    ------
    InputError : a number is negative.
    """

    most: int | None = None
    reach: int = 2
    kicks: int = 3
    seconds: float | None = None

    def __post_init__(self) -> None:
        for name in ("most", "kicks"):
            if getattr(self, name) is not None:
                check_integer(name, getattr(self, name), low=0)
        check_integer("reach", self.reach, low=1)
        if self.seconds is not None:
            check_number("seconds", self.seconds, low=0.0)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Knowledge:
    """All that a robot knows before the first message.

    ``elements`` : (K,) its own element numbers, ascending; ``objective`` : the criterion of these elements.
    ``protected`` : neighbours whose link to it cannot be cut; ``is_protected`` : it cannot be blinded.
    ``links_worth`` : number of sensing attacks that the link attacks of a threat are worth.
    ``hops`` : links over which choices are told, ``None`` for all; ``exchanges`` : ``None`` for RATT's plan.
    ``budget`` : of the computer that searches for exchanges, if there is a limit.

    Raises
    ------
    InputError : exchanges with limited hops.
    """

    robot: int
    elements: IntArray
    objective: InformationObjective
    neighbours: tuple[int, ...]
    protected: frozenset[int]
    is_protected: bool
    alpha_s: int
    alpha_c: int
    links_worth: Callable[[Threat], int]
    hops: int | None = None
    exchanges: ExchangeParams | None = None
    version: int = VERSION
    budget: Budget | None = None

    def __post_init__(self) -> None:
        if None not in {self.hops, self.exchanges}:
            raise InputError("hops", "must be None if robots exchange: all choices must be known", self.hops)

    @property
    def common(self) -> bytes:
        """Digest of the data that all robots must share: criterion, prior, weights, output, budgets, way to plan."""
        f = self.objective
        data = [f.prior.tobytes(), f.weights.tobytes(), b"" if f.output is None else f.output.tobytes()]
        way = (self.hops, None if self.exchanges is None else (self.exchanges.most, self.exchanges.reach))
        return digest(type(f).__name__, self.alpha_s, self.alpha_c, f.prior.shape, *way, *(part.hex() for part in data))


@dataclass(slots=True, eq=False)
class OwnChoice:
    """A robot's choice so far: before its first award, and as bait, its individually best element.

    ``heard`` : robots whose choices it knew when it chose, in the order of these, with their elements.
    ``value_alone`` : of its best element; ``evaluations`` : values that it computed.
    """

    knowledge: Knowledge
    objective: InformationObjective = field(init=False)
    element: int = field(default=0, init=False)
    heard: dict[int, int] = field(default_factory=dict, init=False)
    value_alone: float = field(default=0.0, init=False)
    evaluations: int = field(default=0, init=False)

    def __post_init__(self) -> None:
        self.objective = self.knowledge.objective
        self.choose_alone()

    def blind(self) -> None:
        """Choose among elements that tell nothing from now on."""
        self.objective = self.objective.with_information(np.zeros_like(self.objective.information))
        self.choose_alone()

    def choose_alone(self) -> None:
        """Take the individually best element."""
        self.value_alone, choice = self.best_beside(self.objective.prior_information)
        self.take(choice)

    def take(self, choice: Choice, heard: Iterable[Choice] = ()) -> None:
        """Take an element that is best beside the choices heard."""
        self.element, self.heard = choice.element, {other.robot: other.element for other in heard}

    def best_beside(self, posterior: FloatArray) -> tuple[float, Choice]:
        """Most valuable own element beside others, whose posterior information (M, d, d) is given."""
        self.evaluations += self.objective.n
        values = self.objective.value(posterior + self.objective.information)
        k = int(np.argmax(values))
        return float(values[k]), self._told(k)

    def menu(self) -> tuple[Choice, ...]:
        """Own elements that no other one dominates, as messages tell them."""
        alone = Problem(self.objective, np.zeros(self.objective.n, dtype=np.int64), None, 0, 0)
        return tuple(self._told(int(k)) for k in undominated(alone).kept)

    def _told(self, k: int) -> Choice:
        flat = triangles(self.objective.information[k]).ravel()
        return Choice(self.knowledge.robot, int(self.knowledge.elements[k]), flat)


@dataclass(frozen=True, slots=True)
class Disagreement:
    """A neighbour that a robot refused: ``own`` and ``other`` are what differs, digests in hexadecimal."""

    robot: int
    neighbour: int
    about: str
    own: str
    other: str


class AwardedSum:
    """Awarded information matrices, kept in ascending order of elements."""

    __slots__ = ("_elements", "_rows")

    def __init__(self, objective: InformationObjective) -> None:
        self._elements: list[int] = []
        self._rows = objective.prior_information[None].copy()

    def add(self, choice: Choice) -> None:
        """Add an element's matrices."""
        place, k = bisect(self._elements, choice.element) + 1, len(self._elements) + 1
        if k == len(self._rows):
            self._rows = np.concatenate([self._rows, np.empty_like(self._rows)])
        self._rows[place + 1 : k + 1] = self._rows[place:k].copy()
        self._rows[place] = from_triangles(choice.information.reshape(self._rows.shape[1], -1))
        self._elements.insert(place - 1, choice.element)

    def posterior(self) -> FloatArray:
        """(M, d, d) posterior information, added as ``InformationObjective.posterior_information`` does."""
        return np.asarray(np.add.reduce(self._rows[: len(self._elements) + 1], axis=0))
