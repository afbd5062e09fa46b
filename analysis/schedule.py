"""The schedules of stages as Markdown: ``python -m analysis.schedule criterion|function|sizes|bounds|plans``."""

import sys
from collections.abc import Sequence
from typing import Any

from ratt_opt.attack.params import AttackParams
from ratt_opt.attack.size_vectors.size_vector_search import SIZE_STAGES
from ratt_opt.attack.stages.schedule import CRITERION_STAGES, VALUE_STAGES
from ratt_opt.solvers.maxmin.stages.schedule import BOUND_STAGES, PLAN_STAGES

TABLES: dict[str, Sequence[Any]] = {
    "criterion": CRITERION_STAGES,
    "function": VALUE_STAGES,
    "sizes": SIZE_STAGES,
}


def _sentence(function: Any) -> str:
    text = " ".join((function.__doc__ or "").split("\n\n")[0].split())
    return text.rstrip(".")


def bounds() -> None:
    """Print the table of the stages that lower the upper end of the best plan."""
    print("| stage | what it does | applies when | kind |")
    print("| --- | --- | --- | --- |")
    for stage in BOUND_STAGES:
        done = _sentence(type(stage)).removeprefix("Stage that ").capitalize()
        when = _sentence(stage.applies)
        if hasattr(stage, "fits"):
            when += "; " + _sentence(stage.fits).removeprefix("Tell whether ")
        print("| " + " | ".join([stage.name, done, when, stage.kind or stage.name]) + " |")


def plans() -> None:
    """Print the table of the stages that find the best plan and prove its value."""
    print("| stage | what it does | applies when | phase |")
    print("| --- | --- | --- | --- |")
    for stage in PLAN_STAGES:
        row = [stage.name, _sentence(stage.run), _sentence(stage.applies), stage.phase.value]
        print("| " + " | ".join(row) + " |")


def main() -> None:
    """Print one table."""
    own = {"bounds": bounds, "plans": plans}
    if sys.argv[1:] not in ([name] for name in (*TABLES, *own)):
        sys.exit(__doc__)
    if sys.argv[1] in own:
        own[sys.argv[1]]()
        return
    print("| stage | what it does | applies when | share of what is left | nodes at most |")
    print("| --- | --- | --- | --- | --- |")
    for stage in TABLES[sys.argv[1]]:
        part = stage.share(AttackParams())
        share = "" if part.part is None else f"{part.part:g}"
        nodes = "" if part.max_nodes is None else f"{part.max_nodes:,}"
        print("| " + " | ".join([stage.name, _sentence(stage.run), _sentence(stage.applies), share, nodes]) + " |")


if __name__ == "__main__":
    main()
