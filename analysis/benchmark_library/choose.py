"""Choose a library from solved candidates: spread over families, classes, sizes and hardness.

Go round the families. Take from each the candidate that lies farthest from those already taken of it: its distance is
the sum of differences in hardness, in the logarithm of its size, and of class. Stop at the number or the bytes asked
for. Of each family the smallest closed candidate is curated. MIPLIB 2017 is the model; its choice is a program, too.
"""

import math
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from analysis.benchmark_library.solve import read_journal
from ratt_opt.benchmark.instances.instance import read_document, read_instance
from ratt_opt.benchmark.instances.library import INDEX, BenchmarkLibrary, hash_of
from ratt_opt.benchmark.proofs.records import submit_record

__all__ = ["ChoiceParams", "build", "hardness_of"]

LEVELS = ("easy", "medium", "hard", "open")


@dataclass(frozen=True, slots=True, kw_only=True)
class ChoiceParams:
    """Size of a library: ``most`` instances and ``most_bytes`` in all, ``largest`` of one instance with its record."""

    most: int = 240
    most_bytes: int = 19 * 10**6
    largest: int = 600_000
    curated: int = 10


def hardness_of(line: dict[str, Any]) -> str:
    """Hardness by several solvers.

    Open: the ends do not meet. Hard: only the longest run met them. Easy: a heuristic has the best value, and the proof
    took a second of the processor. Medium: the others.
    """
    value, bound = line["value"], line["bound"]
    if bound is None or abs(bound - value) > 1e-6 * max(abs(value), abs(bound)):
        return "open"
    if "maxmin long" in line["values"] or "fewest_cuts" in line["values"]:
        return "hard"
    exact = ("maxmin", "worst", "fewest_cuts short", "exhaustive")
    heuristics = [v for who, v in line["values"].items() if who not in exact]
    reached = any(abs(v - value) <= 1e-6 * max(abs(value), 1e-12) for v in heuristics) or not heuristics
    quick = max(line["seconds"].get(who, 0.0) for who in exact) <= 1.0
    return "easy" if reached and quick else "medium"


def build(pool: Path, folder: Path, params: ChoiceParams) -> BenchmarkLibrary:
    """Choose from a pool and write the library, every record verified once more as it enters.

    What the folder holds already stays, if it is chosen and the same, so that a build that was stopped goes on.
    """
    lines = {line["name"]: {**line, "hardness": hardness_of(line)} for line in read_journal(pool)}
    chosen = _chosen([line for line in lines.values() if line["bytes"] <= params.largest], params)
    curated = _curated(chosen, params.curated)
    folder.mkdir(parents=True, exist_ok=True)
    library = _kept(folder, {line["name"] for line in chosen})
    for line in chosen:
        name = line["name"]
        instance, entry = read_instance(pool / f"{name}.instance.json.xz"), library.entries.get(name)
        flags = {"hardness": line["hardness"], "curated": int(name in curated)}
        if entry is None or entry != replace(entry, sha256=hash_of(instance.document), **flags):
            library = library.add(instance, hardness=line["hardness"], curated=name in curated)
        record = read_document(pool / f"{name}.record.json.xz")
        if name not in library.best or library.best[name].certificate != hash_of(record):
            library, _ = submit_record(library, record, who=f"ratt_opt {line['who']}")
    return library


def _kept(folder: Path, chosen: set[str]) -> BenchmarkLibrary:
    """The library of a folder without what is not chosen any more; an empty one if there is none."""
    if not (folder / INDEX).exists():
        return BenchmarkLibrary(folder, {}, {})
    known = BenchmarkLibrary.load(folder)
    for name in set(known.entries) - chosen:
        known.path(name).unlink(missing_ok=True)
        known.record_path(name).unlink(missing_ok=True)
    entries = {name: entry for name, entry in known.entries.items() if name in chosen}
    return BenchmarkLibrary(folder, entries, {name: row for name, row in known.best.items() if name in chosen})


def _chosen(lines: list[dict[str, Any]], params: ChoiceParams) -> list[dict[str, Any]]:
    families: dict[str, list[dict[str, Any]]] = {}
    for line in lines:
        families.setdefault(line["family"], []).append(line)
    taken: dict[str, list[dict[str, Any]]] = {family: [] for family in families}
    count = spent = 0
    while any(families.values()) and count < params.most:
        for family in list(families):
            left = families[family]
            if not left or count >= params.most:
                continue
            farthest = max(left, key=lambda line: _distance(line, taken[family]))
            left.remove(farthest)
            if spent + farthest["bytes"] <= params.most_bytes:
                taken[family].append(farthest)
                spent, count = spent + farthest["bytes"], count + 1
    return [line for family in taken.values() for line in family]


def _distance(line: dict[str, Any], others: list[dict[str, Any]]) -> float:
    if not others:
        return -math.log(line["sizes"][1])  # the smallest first
    return min(_apart(line, other) for other in others)


def _apart(one: dict[str, Any], other: dict[str, Any]) -> float:
    hard = abs(LEVELS.index(one["hardness"]) - LEVELS.index(other["hardness"]))
    size = abs(math.log(one["sizes"][1] / other["sizes"][1]))
    return float(hard + size + sum(a != b for a, b in zip(one["code"], other["code"], strict=True)))


def _curated(lines: list[dict[str, Any]], most: int) -> set[str]:
    """The smallest closed instance of each family, then further ones of other classes."""
    closed = sorted((line for line in lines if line["hardness"] != "open"), key=lambda line: line["sizes"][1])
    picked: list[dict[str, Any]] = []
    for key in ("family", "code"):
        for line in closed:
            if len(picked) < most and all(line[key] != other[key] for other in picked) and line not in picked:
                picked.append(line)
    return {line["name"] for line in picked}
