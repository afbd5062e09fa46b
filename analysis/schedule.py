"""The schedules of attacks as Markdown: ``python -m analysis.schedule criterion|function|sizes``."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Any

from ratt_opt.attack.size_vectors.size_vector_search import STAGES as SIZE_VECTORS
from ratt_opt.attackers.schedule import CRITERION, USER_FUNCTION

if TYPE_CHECKING:
    from collections.abc import Sequence

TABLES: dict[str, Sequence[Any]] = {
    "criterion": CRITERION,
    "function": USER_FUNCTION,
    "sizes": SIZE_VECTORS,
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
