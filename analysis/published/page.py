"""The page of published tables: each with one sentence that says where we are ahead and where behind."""

from __future__ import annotations

from typing import TYPE_CHECKING

from analysis.tables import read_csv

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

__all__ = ["page_text"]

Row = dict[str, str]
HEAD = """# Published tables, beside ours

Instances and values that others published. Rows are made by one command, each search and rival with
{seconds:g} s of the processor. `data` is a folder of your own with the published files, which are not part of this
repository. A table has the rows made so far; the same command goes on.

`python -m analysis.published --data data --rows rows --page docs/researchers/published.md`
"""
ABSENT = "No row is made yet.\n"


def page_text(folder: Path, seconds: float) -> str:
    """Return the page of the rows in a folder."""
    parts = [HEAD.format(seconds=seconds)]
    for name, (title, text, columns) in SECTIONS.items():
        path = folder / f"{name}.csv"
        rows = read_csv(path) if path.exists() else []
        parts += [f"\n## {title}\n", text(rows) if rows else ABSENT]
        if rows:
            parts.append(_table(rows, columns))
    return "\n".join(parts)


def _table(rows: Sequence[Row], columns: Sequence[str]) -> str:
    lines = ["| " + " | ".join(columns) + " |", "| " + " | ".join("---" for _ in columns) + " |"]
    lines += ["| " + " | ".join(_cell(row[name]) for name in columns) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def _cell(text: str) -> str:
    try:
        return text if text.isdecimal() else f"{float(text):.7g}"
    except ValueError:
        return text


def _cuts(rows: Sequence[Row]) -> str:
    agree, slowest = sum(row["agrees"] == "True" for row in rows), max(float(row["s"]) for row in rows)
    slower = sum(float(row["s"]) > float(row["gurobi_s"].split()[0]) for row in rows)
    return (
        f"Papazaharias and Walteros, Mathematical Programming Computation 2022. Of {len(rows)} rows {agree} are exact "
        f"and agree with a published value. The slowest takes {slowest:.2f} s. Gurobi's quickest formulation takes "
        f"less on {slower} of them, on a machine of its own. [Fewest cuts](fewest_cuts.md) says more.\n"
    )


def _facilities(rows: Sequence[Row]) -> str:
    plain = [row for row in rows if row["published"]]
    best = sum(float(row["ours to"]) <= float(row["published"]) for row in plain)
    closed = sum(_gap(row, "ours") <= 1e-3 for row in rows)
    behind = [row["row"] for row in rows if _gap(row, "ours") > _gap(row, "HiGHS") + 1e-3]
    return (
        "OR-Library (Beasley 1990): choose p sites, after which an adversary takes 0, 1 or 2 of them; costs. "
        f"Without losses our plan has the published optimum on {best} of {len(plain)}. {closed} of {len(rows)} "
        f"brackets close to a thousandth. {_behind(behind)}\n"
    )


def _teams(rows: Sequence[Row]) -> str:
    behind = [row["row"] for row in rows if _gap(row, "ours") > _gap(row, "HiGHS") + 1e-3]
    closed = sum(float(row["ours to"]) - float(row["ours from"]) < 1 for row in rows)
    return (
        "Resilient coverage (Shi, Zhou, Tokekar and others, ICRA 2021): robots, paths, targets, lost robots; "
        f"targets covered in the worst case. Ours are of the trace criterion, up to a ten-thousandth "
        f"lower. {closed} of {len(rows)} brackets hold one whole number. "
        f"{_behind(behind)}\n"
    )


def _entropy(rows: Sequence[Row]) -> str:
    bounds = ("linx", "factorization", "complementary")
    better = sum(float(row["ours"]) > float(row["heuristic"]) + 1e-6 for row in rows)
    worse = sum(float(row["ours"]) < float(row["heuristic"]) - 1e-6 for row in rows)
    theirs = [min(float(row[name]) for name in bounds) for row in rows]
    ahead = sum(float(row["our bound"]) < other for row, other in zip(rows, theirs, strict=True))
    wider = [float(row["our bound"]) - other for row, other in zip(rows, theirs, strict=True)]
    return (
        "Maximum-entropy sampling (Chen, Fampa, Lee): choose s of n places of the largest log-determinant [nats]. "
        "The first number of a row is n, the second s; every tenth published row, of n = "
        f"{', '.join(dict.fromkeys(row['row'].split()[0] for row in rows))}. Greedy with exchanges is better than "
        f"the published heuristic on {better} of {len(rows)} rows, worse on {worse}. Our bound is the concave "
        "relaxation of the log-det criterion; it is below the best of three published relaxations on "
        f"{ahead} rows. Elsewhere it is behind, by up to {max(wider):.2f} nats.\n"
    )


def _designs(rows: Sequence[Row]) -> str:
    widest = max(float(row["our bound"]) - float(row["ours"]) for row in rows)
    return (
        "D-optimal designs of 0/1 type: place s phasor units in the IEEE networks of 118 and 300 buses beside the "
        "sensors that are there (Li, Fampa, Lee and others, arXiv 2208.03589; gain in log-determinant [nats]). Their "
        "values are not at hand. Greedy with exchanges and the concave relaxation leave up to "
        f"{widest:.3g} nats open: a mixture of all units is worth far more than any few.\n"
    )


def _gap(row: Row, who: str) -> float:
    low, high = float(row[f"{who} from"]), float(row[f"{who} to"])
    return (high - low) / max(abs(high), 1e-9)


def _behind(rows: Sequence[str]) -> str:
    whom = "HiGHS's scenario program, whose bound is its claim"
    if not rows:
        return f"No bracket is wider than that of {whom}, by more than a thousandth."
    return f"We are behind on {len(rows)} rows ({'; '.join(rows)}): there the bracket of {whom}, is narrower."


SECTIONS: dict[str, tuple[str, Callable[[Sequence[Row]], str], tuple[str, ...]]] = {
    "cuts": ("Fewest cuts", _cuts, ("table", "graph", "size", "published", "ours", "s", "gurobi_s")),
    "facilities": (
        "p-median with losses",
        _facilities,
        ("row", "published", "ours from", "ours to", "HiGHS from", "HiGHS to", "s", "HiGHS s"),
    ),
    "teams": ("Resilient coverage", _teams, ("row", "ours from", "ours to", "HiGHS from", "HiGHS to", "s", "HiGHS s")),
    "entropy": (
        "Entropy sampling",
        _entropy,
        ("row", "ours", "heuristic", "our bound", "linx", "factorization", "complementary", "s"),
    ),
    "designs": ("D-optimal designs", _designs, ("row", "ours", "our bound", "s")),
}
