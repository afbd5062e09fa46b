"""Portfolio of searches for the upper end: the stages that apply take turns, each longer than the last.

``stages/schedule.py`` lists the stages. The smallest bound of all counts, with its own proof.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.staging import LEFT_OUT
from ratt_opt.budget import Stop
from ratt_opt.solvers.maxmin.stages import schedule
from ratt_opt.solvers.maxmin.time_slices import Turn

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt.solvers.maxmin.bound_stage import BoundSearch, BoundStage, TurnShare
    from ratt_opt.solvers.maxmin.known import Known
    from ratt_opt.solvers.maxmin.proof import UpperProof
    from ratt_opt.solvers.maxmin.time_slices import Progress, TimeSlices

__all__ = ["UpperBoundPortfolio"]


@dataclass(slots=True)
class _Part:
    """A stage's name, its search, its share, and the factor of a turn's nodes that it has now."""

    name: str
    search: BoundSearch
    share: TurnShare
    factor: float

    def run(self, turn: Turn) -> Stop:
        """Give the search a turn, and change the factor by whether it lowered the upper end."""
        stop = self.search.run(turn)
        if not isinstance(stop, Stop):
            raise TypeError(f"a turn of the stage {self.name!r} must return a Stop, such as Stop.NODES; got {stop!r}")
        self.factor = self.share.most if self.search.upper < turn.upper else self.factor * self.share.in_vain
        return stop


class UpperBoundPortfolio:
    """The smallest of all bounds, with its proof; may be interrupted at any point, as all of them may."""

    def __init__(self, known: Known, stages: Sequence[BoundStage] | None = None) -> None:
        self._known, self._params = known, known.task.params.depth
        self._parts: list[_Part] = []
        kinds: set[str] = set()
        for stage in schedule.BOUND_STAGES if stages is None else stages:
            kind = stage.kind or stage.name
            if stage.name not in LEFT_OUT and kind not in kinds and stage.applies(known):
                share = stage.share(known)
                self._parts.append(_Part(stage.name, stage.begin(known), share, share.first))
                kinds.add(kind)
        self._slice, self._begun = float(self._params.slice), False

    @property
    def upper(self) -> float:
        """Proved upper bound on the optimum; infinite before the first one."""
        spacing = self._known.rule.spacing
        return self._before_spacing if spacing is None else spacing.below(self._before_spacing)

    @property
    def _before_spacing(self) -> float:
        return min((part.search.upper for part in self._parts), default=np.inf)

    @property
    def lowest(self) -> str:
        """Name of the stage whose bound is :attr:`upper`."""
        return self._lowest.name

    @property
    def _lowest(self) -> _Part:
        return min(self._parts, key=lambda part: part.search.upper)

    def proof(self) -> UpperProof:
        """The proof of :attr:`upper`, together with the spacing of values."""
        return replace(self._lowest.search.proof(), spacing=self._known.rule.spacing)

    def run(self, slices: TimeSlices, progress: Progress) -> Stop:
        """Search until the gap closes, the budget is spent or it is time for a proof; return why it stopped."""
        told = progress and (lambda nodes, lower, upper: progress(nodes, lower, min(upper, self.upper)))
        if len(self._parts) == 1:
            stop = self._parts[0].run(Turn(slices=slices, progress=told, upper=np.inf, nodes=np.inf))
            return Stop.HEURISTIC if stop is Stop.NODES and slices.budget.stop() is None else stop
        while True:
            before = slices.budget.nodes
            for part in self._parts:
                upper = self._before_spacing
                nodes = max(int(part.factor * self._slice), 1)
                if not self._begun and part.share.at_first is not None:
                    nodes = part.share.at_first
                stop = part.run(Turn(slices=slices, progress=told, upper=upper, nodes=nodes))
                if stop is not Stop.NODES or slices.budget.stop() is not None:
                    return stop
            if slices.budget.nodes == before:  # all that is left is what margins for rounding leave
                return Stop.GAP
            self._slice, self._begun = self._slice * self._params.growth, True
