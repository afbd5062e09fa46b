"""The proof of a certificate's upper end in words: its attacks and covers, then the tree, with each leaf's numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.verifier.exact_matrices import total
from ratt_opt.certificates.verifier.upper import UpperCheck

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from ratt_opt.certificates.lower_explanation import Wording
    from ratt_opt.certificates.verifier.statement import Statement
    from ratt_opt.certificates.verifier.upper import Left, Winners

__all__ = ["upper_story"]

COVERS = (
    "A plan worth more than a cover's number has left-out elements at {count} robots or more, else the adversary "
    "blinds these robots and makes the cover's attack on links."
)
TANGENTS = (
    "A tangent of a group's value under an attack is a constant and a score of each element; no plan's is larger."
)

ROWS = (
    "A row adds up one inequality of each target: a tangent of what the target alone is worth, or a lemma, which a "
    "tree of such tangents shows for every set of elements."
)
SPACING = (
    "What sees n targets is worth n times {least} at least and n times {most} at most. So a plan that is worth less "
    "than {next} is worth at most {value}."
)


def upper_story(about: Statement, part: Mapping[str, Any], wording: Wording) -> list[str]:
    """Say why every plan of each leaf is worth at most the claim under some attack; long trees are cut short."""
    story, most = _Story(about, part, wording), wording.params.lines
    lines = ["Each leaf bounds its plans by attacks:"]
    lines += [f"Attack {k}: {text}" for k, text in enumerate(map(story.attack, part["attacks"], story.groups))]
    lines += [story.cover_line(k, given) for k, given in enumerate(part.get("covers", []))]
    lines += [story.lemma_line(k, given) for k, given in enumerate(part.get("lemmas", []))]
    cut = [f"  ... and {len(part['tree']) - most:,} nodes more"] if len(part["tree"]) > most else []
    said = [TANGENTS] if part["cuts"] else []
    said += [ROWS] if part.get("rows") else []
    said += [story.spacing_line(part["spacing"]["count"])] if story.spacing is not None else []
    said += [COVERS.format(count=story.needed)] if story.covers else []
    return [*lines[: most + 1], *said, "", "Take any plan:", *story.lines, *cut]


class _Story(UpperCheck):
    """Reader of the proof, as the verifier reads it, that notes a line at each node."""

    def __init__(self, about: Statement, part: Mapping[str, Any], wording: Wording) -> None:
        self.say = wording
        self.lines: list[str] = []
        self._waiting, self._reason, self.first_row = [(1, "")], "", len(part["cuts"])
        super().__init__(about, part)

    @property
    def needed(self) -> int:
        """Robots with left-out elements that an attack cannot blind all."""
        return min(self.about.alpha_s, self.about.n - len(self.about.safe_robots)) + 1

    def attack(self, given: Mapping[str, Any], groups: Sequence[frozenset[int]]) -> str:
        """Tell what an attack does and which robots still see, by group."""
        cut = ", ".join(f"{i}-{j}" for i, j in given["links"]) or "none"
        left = " and ".join(f"({self.say.listing(sorted(group))})" for group in groups)
        blinded = f"robots {self.say.listing(given['robots'])}" if given["robots"] else "nobody"
        return f"blinds {blinded}, cuts links {cut}; robots that see: {left}"

    def cover_line(self, number: int, given: Mapping[str, Any]) -> str:
        """Tell what a cover says of plans without the elements that it leaves out."""
        bound = self.say.up(self.covers[number].bound)
        without = f"without elements {self.say.spans(given['left_out'])}"
        return f"Cover {number}: under attack {given['attack']} no group {without} is worth more than {bound}"

    def lemma_line(self, number: int, given: Mapping[str, Any]) -> str:
        """Tell what a lemma says of sets of elements, and what shows it."""
        lemma = self.inequalities.lemmas[number]
        scores = "".join(f" + {self.say.up(score)} (element {e})" for e, score in lemma.scores.items())
        leaves = sum("parts" not in node for node in given["tree"] if isinstance(node, dict)) + sum(
            isinstance(node, int) for node in given["tree"]
        )
        one = "one tangent" if isinstance(given["tree"][0], int) else "gains beside one base"
        cases = one if leaves == 1 else f"{leaves} cases"
        most = f"{self.say.up(lemma.constant)}{scores}"
        return f"Lemma {number}: no set is worth more for target {lemma.target} than {most}, by {cases}"

    def spacing_line(self, count: int) -> str:
        """Tell which values plans can have."""
        assert self.spacing is not None
        value, beyond = self.spacing.value, self.spacing.next_value
        most = self.say.up(value / count) if count else "0"
        return SPACING.format(
            least=self.say.down(beyond / (count + 1)), most=most, next=self.say.down(beyond), value=self.say.up(value)
        )

    def expand(self, node: object, case: tuple[Left, Winners]) -> Iterator[tuple[Left, Winners]]:
        """Note the node, and go on as the verifier does."""
        depth, answer = self._waiting.pop()
        below = list(super().expand(node, case))
        if not below and self.spacing is not None and self.bounds[-1] is self.spacing.value:
            self._reason += f"; so at most {self.say.up(self.spacing.value)}, as values are spaced"
        if len(self.lines) < self.say.params.lines:
            self.lines.append("  " * depth + answer + (self._question(node, case) if below else self._reason))
        self._waiting += [(depth + 1, f"{self._answer(node, after)}: ") for after in reversed(below)]
        yield from below

    def _question(self, node: object, case: tuple[Left, Winners]) -> str:
        assert isinstance(node, dict)
        if "part" in node:
            return f"which robots are the best group after attack {node['part']}?"
        robot = node["element"]
        return f"which of its {len(case[0][robot])} elements does robot {robot} have?"

    def fenchel_leaf(self, node: object, left: Left, winners: Winners) -> Any:
        """Note the constant and the best score of each robot, which sum to the bound."""
        bound = super().fenchel_leaf(node, left, winners)
        pairs = self.weighed(node, "fenchel", self.cuts)
        mass = total(w for w, _ in pairs)
        parts = [("", total(w * cut.bound.constant for w, cut in pairs) / mass)]
        for i, elements in enumerate(left):
            scores = [(w, cut.bound.scores) for w, cut in pairs if i in cut.group]
            if scores:
                parts.append((f" (robot {i})", max(total(w * s[e] for w, s in scores) / mass for e in elements)))
        attacks = self.say.listing(dict.fromkeys(cut.attack for _, cut in pairs))
        assert isinstance(node, dict)
        rows = sum(k >= self.first_row for k in node["fenchel"])
        kind = "tangent" if not rows else "row" if rows == len(pairs) else "bound"
        mean = (
            f"the {kind}" if len(pairs) == 1 else f"the mean of {len(pairs)} {kind}s, weights {self._weights(pairs)},"
        )
        summed = " + ".join(f"{self.say.up(value)}{of}" for of, value in parts)
        self._reason = f"at most {self.say.up(bound)}, by {mean} of attack {attacks}: {summed}"
        return bound

    def cover_leaf(self, node: object, left: Left, winners: Winners) -> Any:
        """Note which covers no plan of the leaf can meet together."""
        bound = super().cover_leaf(node, left, winners)
        pairs = self.weighed(node, "covers", self.covers)
        counts = []
        for i, elements in enumerate(left):
            best = max(total(w for w, cover in pairs if e in cover.left_out) for e in elements)
            counts.append((self.needed if i in self.about.safe_robots else 1) * best)
        assert isinstance(node, dict)
        wanted = self.needed * total(w for w, _ in pairs)
        named = f"cover {node['covers'][0]}" if len(pairs) == 1 else f"one of covers {self.say.listing(node['covers'])}"
        weights = "" if len(pairs) == 1 else f" (weights {self._weights(pairs)})"
        shown = " + ".join(self.say.up(count) for count in counts)
        self._reason = (
            f"at most {self.say.up(bound)}: to be worth more, a plan must count {self.say.up(wanted)} left-out elements"
            f"{weights}; robot by robot it counts {shown} at most, so it fails {named}"
        )
        return bound

    def marginal_leaf(self, node: object, left: Left, winners: Winners) -> Any:
        """Note the attack and the bound."""
        bound = super().marginal_leaf(node, left, winners)
        assert isinstance(node, dict)
        self._reason = (
            f"at most {self.say.up(bound)}, by the largest gain of each free robot under attack {node['marginals']}"
        )
        return bound

    def _answer(self, node: object, after: tuple[Left, Winners]) -> str:
        assert isinstance(node, dict)
        if "part" in node:
            return f"robots {self.say.listing(sorted(after[1][node['part']]))}"
        return self.say.spans(after[0][node["element"]])

    def _weights(self, pairs: Sequence[tuple[Any, Any]]) -> str:
        return ", ".join(self.say.up(w) for w, _ in pairs)
