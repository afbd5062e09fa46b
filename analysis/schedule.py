"""The schedules of attacks as Markdown: ``python -m analysis.schedule criterion|function|sizes``."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from ratt_opt.attack.params import AttackParams
from ratt_opt.attack.size_vectors.size_vector_search import stages_of
from ratt_opt.attack.stages.schedule import criterion_stages, stages_by_values

if TYPE_CHECKING:
    from collections.abc import Sequence

PARAMS = AttackParams()
TABLES: dict[str, Sequence[Any]] = {
    "criterion": criterion_stages(PARAMS.stages),
    "function": stages_by_values(PARAMS.stages),
    "sizes": stages_of(PARAMS.size_vectors),
}


def _sentence(function: Any) -> str:
    text = " ".join((function.__doc__ or "").split("\n\n")[0].split())
    return text.rstrip(".")


def main() -> None:
    """Print one table."""
    print("| stage | what it does | applies when | share of what is left | nodes at most |")
    print("| --- | --- | --- | --- | --- |")
    for stage in TABLES[sys.argv[1]]:
        share = "" if stage.share is None else f"{stage.share:g}"
        nodes = "" if stage.max_nodes is None else f"{stage.max_nodes:,}"
        print("| " + " | ".join([stage.name, _sentence(stage.run), _sentence(stage.applies), share, nodes]) + " |")


if __name__ == "__main__":
    main()
