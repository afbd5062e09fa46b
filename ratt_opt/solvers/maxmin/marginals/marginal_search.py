"""The search by marginal gains at one level after the other."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.solvers.maxmin.levels.by_levels import SearchByLevels
from ratt_opt.solvers.maxmin.marginals.diving import ROUNDINGS, ChoosingTeam, MarginalLevelSearch, MarginalProof
from ratt_opt.solvers.maxmin.marginals.tables import MOST_ROBOTS

if TYPE_CHECKING:
    from ratt_opt.solvers.maxmin.levels.elements import Elements
    from ratt_opt.solvers.maxmin.levels.level_search import LevelSearch
    from ratt_opt.solvers.maxmin.proof import UpperProof
    from ratt_opt.solvers.maxmin.search import Known

__all__ = ["MarginalSearch"]

MOST_PLANS = 1e12
"""Plans of undominated elements: of more, too few are dead ends early."""


class MarginalSearch(SearchByLevels):
    """Bounds the optimum by searches whose dead ends are attacks that leave too little to gain."""

    def __init__(self, known: Known, elements: Elements) -> None:
        super().__init__(known, elements)
        self._error = known.task.problem.evaluation_error
        self._margin = (2 * elements.problem.n_robots + 1 + ROUNDINGS) * self._error
        self._team: ChoosingTeam | None = None
        self._proof: MarginalProof | None = None

    @classmethod
    def of(cls, known: Known, elements: Elements) -> MarginalSearch | None:
        """The search if gains diminish, as those of log-determinants do, and there are not too many plans."""
        diminish = known.task.objective.compiled_code == LogDetObjective.compiled_code
        choices = elements.problem.choices
        fits = len(choices) <= MOST_ROBOTS and np.prod([float(len(choice)) for choice in choices]) <= MOST_PLANS
        return cls(known, elements) if diminish and fits else None

    def proof(self) -> UpperProof:
        """The proof of ``upper``."""
        assert self._proof is not None
        return self._proof.written()

    def _begun(self) -> LevelSearch:
        self._team = self._team or ChoosingTeam(self._elements, self._known.incumbent.pool)
        return MarginalLevelSearch(self._elements, self._team, self._known.incumbent, self._level, self._error)

    def _level(self) -> float:
        """Lower by the margin that values and their sums have for rounding, but not below the best plan."""
        return max(super()._level() - self._margin, self._known.incumbent.candidates.level)

    def _keep(self, search: LevelSearch) -> None:
        assert isinstance(search, MarginalLevelSearch)
        assert self._team is not None
        if (bound := search.level + self._margin) < self.upper:
            self.upper = bound
            self._proof = MarginalProof(self._elements, self._team, self._known.incumbent.pool, search.record)
