"""The fair baseline: greedy managers of Stone Soup score each sensor alone, this one what it adds to those before."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

from ratt_opt.errors import InputError
from ratt_opt.interop.stonesoup.nodes import options
from ratt_opt.interop.stonesoup.team import TeamManager

if TYPE_CHECKING:
    from collections.abc import Iterable
    from datetime import datetime

__all__ = ["SequentialGreedySensorManager"]


class SequentialGreedySensorManager(TeamManager):
    """Node by node, choose the actions with the largest ``reward_function`` of all chosen so far; not robust.

    A node is a platform with its sensors, or a sensor that stands alone. Among equal rewards the first action is taken.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        if self.reward_function is None:
            raise InputError("reward_function", "must be given, as CriterionReward(predictor)", None)

    def choose_actions(
        self, tracks: Iterable[Any], timestamp: datetime, nchoose: int = 1, **_: Any
    ) -> list[dict[Any, tuple[Any, ...]]]:
        """Return ``[{actionable: actions}]``.

        Raises
        ------
        InputError : ``nchoose`` is not 1, or there is no sensor.
        """
        if nchoose != 1:
            raise InputError("nchoose", "must be 1: the greedy choice is one", nchoose)
        chosen: dict[Any, tuple[Any, ...]] = {}
        for node in self.nodes:
            every = product(*(options(actionable, timestamp) for actionable in node.actionables))
            tried = [chosen | dict(zip(node.actionables, choice, strict=True)) for choice in every]
            rewards = [self.reward_function(config, tracks, timestamp) for config in tried]
            chosen = tried[max(range(len(tried)), key=rewards.__getitem__)]
        return [chosen]
