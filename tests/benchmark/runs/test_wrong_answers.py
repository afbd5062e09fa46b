"""Wrong attackers and cutters, and a sweep of broken output on each track: named, and worth only what holds."""

import json
import random
import shlex

import pytest

from ratt_opt.benchmark.runs.trial import BenchTrial
from ratt_opt.studies import Case
from tests.benchmark.small_library import attack_instance, coverage_instance, cuts_instance, small_library


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    return small_library(tmp_path_factory.mktemp("library"), [coverage_instance(), attack_instance(), cuts_instance()])


def row_of(library, name, *lines):
    """The row of a solver that prints these lines."""
    track, printed = library.instance(name).track, library.folder / "printed"
    texts = (line if isinstance(line, str) else json.dumps(line) for line in lines)
    printed.write_text("".join(f"{text}\n" for text in texts), encoding="utf-8")
    case = Case(n_robots=5, n_targets=5, alpha_s=1, alpha_c=0, options=(("instance", name), ("track", track)))
    command = f"sh -c {shlex.quote(f'cat {printed}')} solver {{instance}} {{out}}"
    return BenchTrial(command, str(library.folder), 5.0, 0.3)(None, case, None)


@pytest.mark.parametrize(
    ("name", "answer", "fault"),
    [
        ("attack", {"sensing": [0, 1]}, "line 1: attack must blind at most alpha_s = 1 robots; got 2"),
        ("attack", {"sensing": [9]}, "attack robot must be an integer in [0, 4]; got 9"),
        ("attack", {"links": [[0, 1], [0, 2], [0, 3], [0, 4]]}, "attack must cut at most alpha_c = 3 links; got 4"),
        ("attack", {"links": [[2, 2]]}, "line 1: attack link"),
        ("attack", {"sensing": "0"}, "sensing must be a list; got str"),
        ("attack", {"elements": [0, 1, 2, 3, 4]}, "printed no answer"),
        ("cuts", {"cut": [[0, 1]]}, "cut must leave groups of at most 4; got 10"),
        ("cuts", {"cut": [[0, 2]]}, "cut must hold links of the network"),
        ("cuts", {"cut": [[0]]}, "line 1: link must be a pair of robots"),
        ("cuts", {"cut": None}, "printed no answer"),
    ],
)
def test_wrong_attacks_and_cuts_are_named(made, name, answer, fault):
    row = row_of(made, name, answer)
    assert fault in row["faults"]
    assert row["value"] == ""
    assert row["gap"] == 1.0


@pytest.mark.parametrize("name", ["attack", "cuts"])
def test_a_claim_of_more_than_an_answer_shows_is_a_lie(made, name):
    """A lower end above the best known answer is refuted by that answer."""
    best = made.best[name].value
    whole = (
        {"sensing": [], "links": []}
        if name == "attack"
        else {"cut": [list(x) for x in made.instance(name).network.links]}
    )
    row = row_of(made, name, {**whole, "lower": best + 1.0})
    assert f"claims that nobody passes {best + 1:.9g}, but {best:.9g} is attained" in row["faults"]
    assert row["proved"] == ""
    assert row["value"] >= best


def test_broken_output_costs_only_its_own_lines(made):
    """Pieces of right and wrong lines in any order: right ones count, the others are named, nothing is raised."""
    rng = random.Random(0)
    right = {"elements": made.instance("cover").team.choices[0].tolist()[:1]}
    plan = [int(choice[0]) for choice in made.instance("cover").team.choices]
    pieces = [
        json.dumps({"elements": plan}),
        json.dumps({"elements": plan[:-1]}),
        json.dumps({"elements": plan, "upper": -1}),
        json.dumps({"elements": [None] * 4}),
        json.dumps({"elements": {"0": 1}}),
        json.dumps({"elements": [[0]] * 4}),
        json.dumps({"elements": [1e9] * 4}),
        json.dumps({"elements": [True] * 4}),
        json.dumps({"lower": "NaN", "elements": plan}),
        '{"lower": NaN}',
        '{"upper": 1e999}',
        json.dumps(right)[:-1],
        "[" * 3000,
        "null",
        "{}",
        "\x00",
        "é" * 40,
        json.dumps({"certificate": "x" * 500}),
        json.dumps({"certificate": 3}),
        json.dumps({"elements": plan, "elements ": 1}),
    ]
    for _ in range(12):
        lines = [rng.choice(pieces) for _ in range(rng.randint(1, 6))]
        row = row_of(made, "cover", *lines)
        good = any(line in {pieces[0], pieces[2], pieces[-1]} for line in lines)
        assert (row["value"] != "") == good
        if any(line not in {pieces[0], "{}"} for line in lines):
            assert row["faults"] or all(line in {pieces[0], "{}", pieces[-1]} for line in lines)
