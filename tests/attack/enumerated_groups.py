"""A second exact attacker for 20 to 30 robots, planar targets; it shares nothing with the library but the model.

An attack leaves connected groups whose links to other groups are all cut, so no group has more of them than the budget:
all such groups are listed. For a threshold, ``need(G)`` is the fewest robots of ``G`` to blind so that the others are
worth less. An attack below the threshold exists iff some of the groups, each robot in exactly one, fit both budgets:

    sum of y_G over the groups of each robot = 1,   sum of links(G) y_G <= 2 alpha_c,   sum of need(G) y_G <= alpha_s.

Needs are found by trying who is blinded, the strongest robots first, and inherited where that saves trying:
``need(X) >= need(G) - |G \\ X|``, as what is blinded in ``X`` and all of ``G \\ X`` would do for ``G``. Relies on
non-decreasing criteria. Their formulas stand here once more.
"""

import numpy as np
from scipy.optimize import Bounds, LinearConstraint, milp
from scipy.sparse import csr_array, vstack

INFEASIBLE = 2
"""Status of ``scipy.optimize.milp``."""


class TooManyGroupsError(Exception):
    """More groups than are worth listing."""


def list_groups(problem, most_nodes=3_000_000):
    """Groups that ``alpha_c`` links separate from the others, as bit masks, and the links of each.

    They grow from their lowest robot: a neighbour joins, or it stays out and then its links to the group are cut.
    """
    n_robots, near, fixed = problem.n_robots, [0] * problem.n_robots, [0] * problem.n_robots
    for i, j in problem.communication.links:
        table = fixed if (i, j) in problem.protected_links else near
        table[i] |= 1 << j
        table[j] |= 1 << i
    found, nodes = {}, 0
    for lowest in range(n_robots):
        stack = [(1 << lowest, (1 << lowest) - 1)]
        while stack:
            inside, outside = stack.pop()
            members = bits(inside)
            cut = sum((near[i] & outside).bit_count() for i in members)
            nodes += 1
            if nodes > most_nodes:
                raise TooManyGroupsError
            if cut > problem.alpha_c or any(fixed[i] & outside for i in members):
                continue
            reached = 0
            for i in members:
                reached |= near[i] | fixed[i]
            open_neighbours = bits(reached & ~inside & ~outside)
            if not open_neighbours:
                found[inside] = cut
                continue
            robot = max(open_neighbours, key=lambda j: (near[j] & inside).bit_count())
            stack += [(inside | 1 << robot, outside), (inside, outside | 1 << robot)]
    return np.array(list(found)), np.array(list(found.values()))


def bits(mask):
    """The robots of a bit mask."""
    return [i for i in range(int(mask).bit_length()) if int(mask) >> i & 1]


def lost(name, weights, sums):
    """The criterion of posterior information (..., M, 3): what a team's value subtracts from the prior's."""
    a, b, c = np.moveaxis(sums, -1, 0)
    determinant = a * c - b * b
    if name == "trace":
        return (weights * (a + c) / determinant).sum(axis=-1)
    if name == "logdet":
        return -(weights * np.log(determinant)).sum(axis=-1)
    # The largest eigenvalue of the inverse is 1 / the smallest one.
    return (weights / (0.5 * (a + c) - np.sqrt(0.25 * (a - c) ** 2 + b * b))).max(axis=-1)


def blinding(name, weights, whole, seeing, information, free, first, count, most_lost):  # noqa: PLR0917
    """Robots, so many from ``first`` on, that lose more than ``most_lost`` if they are blinded; ``None`` : none do.

    ``whole`` : (M, 3) of all that are not blinded yet; ``seeing`` : of those before ``first``, which stay so
    """
    if count == 0:
        return [] if lost(name, weights, whole) > most_lost else None
    less = whole - information[first:]
    if count == 1:
        found = np.flatnonzero((lost(name, weights, less) > most_lost) & free[first:])
        return [first + int(found[0])] if len(found) else None
    kept = lost(name, weights, seeing + information[first:].cumsum(axis=0))
    for i in range(first, len(information) - count + 1):
        if free[i]:
            before = seeing + information[first:i].sum(axis=0)
            rest = blinding(name, weights, less[i - first], before, information, free, i + 1, count - 1, most_lost)
            if rest is not None:
                return [i, *rest]
        if kept[i - first] <= most_lost:
            return None
    return None


class SecondAttacker:
    """Decides thresholds for one plan of a problem whose criterion is ``name``."""

    def __init__(self, problem, elements, name):
        objective = problem.objective
        packed = [objective.prior_information, objective.information[np.asarray(elements)]]
        self._prior, robots = (m.reshape(*m.shape[:-2], 4)[..., [0, 1, 3]].copy() for m in packed)
        self._name, self._weights, self._problem = name, np.array(objective.weights), problem
        self._nothing = lost(name, self._weights, self._prior)
        alone = np.array([lost(name, self._weights, self._prior + one) for one in robots])
        self._order = np.argsort(alone, kind="stable")
        self._robots = robots
        self.groups, self.links = list_groups(problem)

    def attack_below(self, threshold):
        """Groups and the blinded robots of each that leave less than the threshold, as sets; ``None`` : there are none.

        Raises ``ArithmeticError`` : the solver of the program did not answer.
        """
        chosen = self._partition(self._needs(threshold))
        if chosen is None:
            return None
        return [(set(bits(group)), self._blind(group, threshold)) for group in self.groups[chosen]]

    def _needs(self, threshold):
        """(C,) fewest robots of each group to blind, up to one more than the budget."""
        most, need = self._problem.alpha_s, np.zeros(len(self.groups), dtype=np.int64)
        for g in np.argsort(np.bitwise_count(self.groups), kind="stable").tolist():
            if need[g] > most:
                continue
            found = self._blind(self.groups[g], threshold, int(need[g]))
            need[g] = most + 1 if found is None else len(found)
            if need[g]:
                need = np.maximum(need, need[g] - np.bitwise_count(self.groups[g] & ~self.groups).astype(np.int64))
        return need

    def _blind(self, group, threshold, least=0):
        """Fewest robots of a group to blind, no fewer than ``least``; ``None`` where the budget does not do."""
        members = [i for i in self._order.tolist() if int(group) >> i & 1]
        free = np.array([i not in self._problem.protected_robots for i in members])
        information = self._robots[members]
        team = self._name, self._weights, self._prior + information.sum(axis=0), self._prior, information, free
        for count in range(least, min(self._problem.alpha_s, len(members)) + 1):
            found = blinding(*team, 0, count, self._nothing - threshold)
            if found is not None:
                return {members[k] for k in found}
        return None

    def _partition(self, need):
        """Indices of groups that fit both budgets; ``None`` where the program has no solution."""
        problem, allowed = self._problem, np.flatnonzero(need <= self._problem.alpha_s)
        inside = self.groups[allowed] >> np.arange(problem.n_robots)[:, None] & 1
        if not inside.any(axis=1).all():
            return None
        costs = np.array([self.links[allowed], need[allowed]])
        ones, most = np.ones(problem.n_robots), [2 * problem.alpha_c, problem.alpha_s]
        rows = vstack([csr_array(inside.astype(float)), csr_array(costs.astype(float))])
        limits = LinearConstraint(rows, np.append(ones, [-np.inf, -np.inf]), np.append(ones, most))
        kinds = np.ones(len(allowed))
        answer = milp(np.zeros(len(allowed)), integrality=kinds, bounds=Bounds(0, 1), constraints=limits)
        if answer.status == INFEASIBLE:
            return None
        if answer.x is None:
            raise ArithmeticError(answer.message)
        return allowed[answer.x > 0.5]
