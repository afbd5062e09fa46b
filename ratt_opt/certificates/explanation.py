"""The proof of a certificate's lower end in words, node by node: for readers, after the verifier has accepted it."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["explained"]

MOST_LINES = 200
"""Lines printed of one tree at most."""
QUESTIONS = {
    "sense": ("does robot {} sense in the group?", "yes", "no"),
    "inside": ("is robot {} in the group?", "yes", "no"),
    "sensing": ("do at least {} robots of the group sense?", "yes", "no"),
    "blinded": ("are fewer than {} robots of the group blinded?", "yes", "no"),
    "limit": ("limit {} says how many robots sense at most, and how many are blinded at least", "so"),
}
LEAVES = {
    "worth": "the robots that sense for sure are worth the claim",
    "copies": "any robots that must sense besides are enough, by the average over copies of each",
    "budget": "no attack within the budgets leaves such a group",
    "listed": "this is one group; it is listed",
    "flow": "such groups cost too much, by bound {}",
    "form": "such a group costs more than the largest one may, by bound {}",
}
CONCLUSIONS = {
    "forced": "All robots are linked. By the sizes of groups alone, every attack leaves a group of which {size} robots "
    "sense.",
    "duals": "No group below the claim costs less than nothing (below). An attack that leaves only such groups would "
    "leave groups that cost {slack} together, at most. So there is none.",
    "cover": "The groups that an attack leaves cost {slack} together, at most. A group below the claim costs at least "
    "nothing, and more than that unless it is listed (below). No listed groups partition the team within the budgets: "
    "the search for such groups chose robots {partition} in turn.",
    "sizes": "The group of which most robots sense would cost more than the other groups leave for it: one tree for "
    "each number of sensing and of blinded robots that it can have, by {forms} bounds of what groups of a size cost.",
    "enumerated": "There is no proof: attacks were enumerated in floating point.",
}


def explained(document: dict[str, Any]) -> list[str]:
    """Say what the lower proof of a verified certificate shows, and how; long trees are cut short."""
    lower, problem = document["lower"], document["problem"]
    conclusion = lower["conclusion"]
    told = {"size": lower.get("sets", {}).get("size"), "forms": len(lower.get("forms", []))}
    if conclusion in ("duals", "cover"):
        told |= {"slack": _slack(problem, lower["duals"]), "partition": _robots(lower.get("partition", []))}
    lines = ["", f"Why this plan is worth at least {document['claim']['lower']!r} (the claim) under every attack:"]
    if conclusion in ("duals", "cover"):
        lines.append(_duals(problem, lower["duals"]))
    lines.append(CONCLUSIONS[conclusion].format(**told))
    if "sets" in lower:
        size = lower["sets"]["size"]
        lines += ["", f"Any {size} robots that sense in one group are worth the claim. Take any {size}:"]
        lines += _tree(lower["sets"]["tree"])
    for k, limit in enumerate(lower.get("limits", [])):
        size, robots = limit["size"], _robots(limit["robots"])
        lines += ["", f"Limit {k}: any {size} of robots {robots} are worth the claim, too. Take any {size} of them:"]
        lines += _tree(limit["tree"])
    for tree in [lower["tree"]] if "tree" in lower else lower.get("trees", []):
        lines += ["", "Take any group of such an attack:", *_tree(tree)]
    return lines


def _slack(problem: dict[str, Any], duals: dict[str, Any]) -> str:
    n_robots = max(problem["owners"]) + 1
    blinded = min(problem["alpha_s"], n_robots - len(problem["protected_robots"]))
    link, robots = duals["link"], sum(duals["robots"])
    slack = 2 * link * problem["alpha_c"] + duals["blinded"] * blinded - robots
    return f"2 * {link} * {problem['alpha_c']} + {duals['blinded']} * {blinded} - {robots} = {slack}"


def _duals(problem: dict[str, Any], duals: dict[str, Any]) -> str:
    n_robots = max(problem["owners"]) + 1
    return (
        f"Let a group cost {duals['link']} for each link that leaves it and {duals['blinded']} for each of its blinded "
        f"robots, less {_robots(duals['robots'])} for the robots 0 to {n_robots - 1} that it has."
    )


def _robots(numbers: list[int]) -> str:
    shown = [str(number) for number in numbers[:MOST_LINES]]
    return ", ".join([*shown, "..."] if len(numbers) > MOST_LINES else shown)


def _tree(nodes: list[Any]) -> list[str]:
    lines = list(_lines(nodes[:MOST_LINES]))
    if len(nodes) > MOST_LINES:
        lines.append(f"  ... and {len(nodes) - MOST_LINES:,} nodes more")
    return lines


def _lines(nodes: list[Any]) -> Iterator[str]:
    waiting = [(1, "")]
    for node in nodes:
        depth, answer = waiting.pop()
        name, number = (node, None) if isinstance(node, str) else next(iter(node.items()))
        margin = "  " * depth + answer
        if name in QUESTIONS:
            question, *answers = QUESTIONS[name]
            yield margin + question.format(number)
            waiting += [(depth + 1, f"{answer}: ") for answer in reversed(answers)]
        else:
            yield margin + LEAVES[name].format(number)
