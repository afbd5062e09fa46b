"""The proof of a certificate's lower end in words, node by node, with the reason and the numbers of each leaf."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from flint import ctx, fmpq

from ratt_opt._rounding import down, up
from ratt_opt.certificates.verifier.cases import Cases, is_short, mask_of, read_node, robots_of
from ratt_opt.certificates.verifier.duals import Duals
from ratt_opt.certificates.verifier.sizes import possible_groups
from ratt_opt.certificates.verifier.worth import Worth

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from ratt_opt.certificates.params import ExplanationParams
    from ratt_opt.certificates.verifier.cases import GroupCase
    from ratt_opt.certificates.verifier.statement import Statement
    from ratt_opt.certificates.verifier.worth import Known

__all__ = ["LowerStory", "Wording"]

QUESTIONS = {
    "sense": ("does robot {} sense in the group?", "yes", "no"),
    "inside": ("is robot {} in the group?", "yes", "no"),
    "sensing": ("do at least {} robots of the group sense?", "yes", "no"),
    "blinded": ("are fewer than {} robots of the group blinded?", "yes", "no"),
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


class Wording:
    """Lists and values as both stories word them, cut short after ``params.lines``."""

    def __init__(self, params: ExplanationParams) -> None:
        self.params = params

    def listing(self, numbers: Iterable[int]) -> str:
        """Numbers with commas."""
        every, most = list(numbers), self.params.lines
        shown = [str(number) for number in every[:most]]
        return ", ".join([*shown, "..."] if len(every) > most else shown)

    def spans(self, numbers: Iterable[int]) -> str:
        """Ascending numbers with commas, runs of three or more as ``first to last``."""
        runs: list[list[int]] = []
        for number in numbers:
            if runs and number == runs[-1][-1] + 1:
                runs[-1].append(number)
            else:
                runs.append([number])
        most = self.params.lines
        texts = (f"{run[0]} to {run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs[:most])
        return ", ".join([*texts, "..."] if len(runs) > most else texts)

    def up(self, value: Any) -> str:
        """A rational or the upper end of a ball, rounded up."""
        exact = Fraction(int(value.p), int(value.q)) if isinstance(value, fmpq) else Fraction(float(value.upper()))
        return up(exact, self.params.digits) if exact else "0"

    def down(self, value: Any) -> str:
        """A rational or the lower end of a ball, rounded down."""
        exact = Fraction(int(value.p), int(value.q)) if isinstance(value, fmpq) else Fraction(float(value.lower()))
        return down(exact, self.params.digits) if exact else "0"


class LowerStory:
    """Explanation of one lower proof; cases, worths and costs are computed by the verifier's classes."""

    def __init__(self, about: Statement, lower: fmpq, wording: Wording) -> None:
        self._params, self._listing = wording.params, wording.listing
        self.about, self.worth = about, Worth(about, lower)
        self.cases = Cases(about, self.worth)
        self._duals: Duals | None = None

    def lines(self, lower: Mapping[str, Any]) -> list[str]:
        """Tell the conclusion, the lemmas on sets of robots, and the trees over groups."""
        conclusion = lower["conclusion"]
        if conclusion in ("duals", "cover"):
            self._duals = Duals(self.cases, lower["duals"])
            self._duals.read_bounds(lower["bounds"])
        told = {"size": lower.get("sets", {}).get("size"), "forms": len(lower.get("forms", []))}
        told |= {"slack": self._slack(), "partition": self._listing(lower.get("partition", []))}
        lines = [*self._prices(), CONCLUSIONS[conclusion].format(**told)]
        if conclusion == "enumerated":
            return lines
        size, everyone = lower["sets"]["size"], range(self.about.n)
        lines += ["", *self._lemma("", size, everyone, lower["sets"]["tree"])]
        for k, limit in enumerate(lower.get("limits", [])):
            lines += ["", *self._lemma(f"Limit {k}: ", limit["size"], limit["robots"], limit["tree"])]
            self.cases.limits.append((mask_of(limit["robots"]), limit["size"] - 1))
        if "tree" in lower:
            root = self.cases.groups(min(size - 1, self.about.n))
            lines += ["", "Take any group of such an attack:", *self._tree(lower["tree"], root)]
        if "trees" in lower:
            lines += self._largest_groups(lower, size)
        return lines

    def _lemma(self, head: str, size: int, robots: Sequence[int], tree: list[Any]) -> list[str]:
        """Tell why any ``size`` of some robots are worth the claim, or that the robots are fewer."""
        if size > len(robots):
            has = f"the team has {len(robots)} robots" if len(robots) == self.about.n else f"there are {len(robots)}"
            return [f"{head}Nothing is said of sets of all robots: {has}, so no set of {size} exists."]
        some = "" if len(robots) == self.about.n else f" of {self._listing(robots)}"
        everyone = self.cases.everyone
        root = replace(self.cases.groups(size), may_sense=mask_of(robots), may_blind=0, least=size, low=0, high=0)
        root = replace(root, may_leave=everyone)
        first = f"{head}Any {size} robots{some} that sense in one group are worth the claim. Take any {size} of them:"
        return [first, *self._tree(tree, root, of_sets=True)]

    def _largest_groups(self, lower: Mapping[str, Any], size: int) -> list[str]:
        """Tell of each size that the largest group may have why it does not."""
        _, groups = possible_groups(self.cases, size, lower["duals"], lower["forms"])
        lines = []
        for group, tree in zip(groups, lower["trees"], strict=True):
            root = self.cases.groups(group.sensing, group.sensing, group.blinded)
            lines += [
                "",
                f"Take a largest group of which {group.sensing} robots sense and {group.blinded} are blinded:",
            ]
            lines += self._tree(tree, root)
        return lines

    def _prices(self) -> list[str]:
        if self._duals is None:
            return []
        duals = self._duals
        return [
            f"Let a group cost {duals.link} for each link that leaves it and {duals.blinded} for each of its blinded "
            f"robots, less {self._listing(duals.robot)} for the robots 0 to {self.about.n - 1} that it has."
        ]

    def _slack(self) -> str:
        if self._duals is None:
            return ""
        duals = self._duals
        most = f"2 * {duals.link} * {self.about.alpha_c} + {duals.blinded} * {self.cases.blinded}"
        return f"{most} - {sum(duals.robot)} = {duals.slack}"

    def _tree(self, nodes: list[Any], root: GroupCase, *, of_sets: bool = False) -> list[str]:
        lines: list[str] = []
        waiting = [(1, "", root)]
        for node in nodes[: self._params.lines]:
            depth, answer, case = waiting.pop()
            name, number = read_node(node)
            margin = "  " * depth + answer
            if name in QUESTIONS:
                question, *answers = QUESTIONS[name]
                lines.append(margin + question.format(number))
                below = zip(answers, self.cases.halves(name, number, case), strict=True)
                waiting += reversed([(depth + 1, f"{given}: ", half) for given, half in below])
            elif name == "limit":
                (narrowed,) = self.cases.halves(name, number, case)
                lines.append(margin + self._limit(number, case, narrowed))
                waiting.append((depth + 1, "so: ", narrowed))
            else:
                lines.append(margin + self._leaf(name, number, case, of_sets=of_sets))
        if len(nodes) > self._params.lines:
            lines.append(f"  ... and {len(nodes) - self._params.lines:,} nodes more")
        return lines

    def _limit(self, number: object, case: GroupCase, narrowed: GroupCase) -> str:
        assert isinstance(number, int)
        robots, most = self.cases.limits[number]
        blinded = f", so at least {narrowed.low} are blinded" if narrowed.low > max(case.low, 0) else ""
        return f"by limit {number} at most {most} of robots {self._listing(robots_of(robots))} sense in it{blinded}"

    def _leaf(self, name: str, number: object, case: GroupCase, *, of_sets: bool) -> str:
        if name == "worth":
            worth = self._number(case.known)
            return f"robots {self._listing(robots_of(case.sensing))} are worth {worth or 'at least the claim'}"
        if name == "copies":
            return self._copies(case)
        if name == "budget":
            return self._no_set(case) if of_sets else self._no_group(case)
        if name == "flow":
            assert self._duals is not None
            assert isinstance(number, int)
            least = self._duals.least(case, self._duals.bounds[number])
            return f"such a group costs at least {least}, by bound {number}"
        if name == "listed":
            return f"this is the group of robots {self._listing(robots_of(case.inside))}; it is listed"
        return f"such a group costs more than the largest one may, by bound {number}"

    def _copies(self, case: GroupCase) -> str:
        """The average over copies, with the worth of each robot's copies."""
        among, count = case.may_sense, case.least - case.sensing.bit_count()
        if count <= 0:
            among, count = among & case.inside, (case.inside & ~case.sensing).bit_count() - case.high
        sure = f"with robots {self._listing(robots_of(case.sensing))}, " if case.sensing else ""
        values = [(self._copied(case.known, robot, count), robot) for robot in robots_of(among)]
        head = f"{count}{' more' if case.sensing else ''} of robots {self._listing(robots_of(among))} sense"
        if any(value is None for value, _ in values):
            return f"{head}; {sure}{count} copies of any of them are worth at least the claim"
        known = sorted((value, robot) for value, robot in values if value is not None)
        average = down(sum(value for value, _ in known[:count]) / count, self._params.digits)
        shown = ", ".join(
            f"{down(value, self._params.digits)} (robot {robot})" for value, robot in sorted(known, key=lambda p: p[1])
        )
        if count == 1:
            return f"{head}; {sure}it is worth {shown}"
        return f"{head}; {sure}{count} copies of one are worth {shown}; the {count} least have the mean {average}"

    def _copied(self, known: Known, robot: int, times: int) -> float | None:
        for _ in range(times):
            known = self.worth.plus(known, robot)
        return self._value(known)

    def _number(self, known: Known) -> str | None:
        value = self._value(known)
        return None if value is None else down(value, self._params.digits)

    def _value(self, known: Known) -> float | None:
        """The worth of a set of robots, rounded down; ``None`` if the verifier decides without it."""
        if self.about.objective == "maxeig" and not (self.about.d == 2 and self.about.is_whole):
            return None
        with ctx.workprec(self._params.bits):
            found = self.worth.value(known, self._params.bits)
        return int(found.p) / int(found.q) if isinstance(found, fmpq) else float(found)

    def _no_set(self, case: GroupCase) -> str:
        """Say why a set of the case need not be looked at."""
        can = case.sensing | case.may_sense
        if is_short(case):
            left = self._listing(robots_of(can)) or "none"
            return f"there is no such set: {case.least} must sense, and only robots {left} can"
        return f"{case.least} that sense are more than a group below the claim has ({case.most} at most)"

    def _no_group(self, case: GroupCase) -> str:
        """Say why no attack within the budgets leaves a group of the case."""
        inside, outside = case.inside, case.outside
        possible = case.everyone & ~outside
        lost = sum((self.cases.near[i] & outside).bit_count() for i in robots_of(inside))
        sure, can = case.sensing.bit_count(), (case.sensing | case.may_sense).bit_count()
        least, room = max(sure, case.least), possible.bit_count()
        is_tied = any(self.cases.tied[i] & outside for i in robots_of(inside))
        reasons = (
            (is_short(case), f"only {can} robots can sense, and {case.least} must"),
            (least > case.most, f"at least {least} robots sense, and a group below the claim has {case.most} at most"),
            (case.need > case.high, f"at least {case.need} of its robots must be blinded, and {case.high} can be"),
            (room < case.least + case.low, f"it has {room} robots at most, and needs {case.least + case.low}"),
            (is_tied, "a protected link leaves it"),
            (lost > self.about.alpha_c, f"{lost} links leave it, and {self.about.alpha_c} can be cut"),
            (True, f"robots {self._listing(robots_of(inside))} are not connected in it"),
        )
        return next(text for holds, text in reasons if holds)
