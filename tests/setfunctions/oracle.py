"""Properties and curvatures straight from their definitions, O(4**n); share nothing with the library."""

import numpy as np


def worst_slack(values, rule):
    """The smallest slack over all pairs of sets (the definitions, not their local forms)."""
    masks = np.arange(len(values))
    a, b = masks[:, None], masks[None, :]
    if rule == "non-negative":
        return values.min()
    if rule == "non-decreasing":
        return (values[a | b] - values[a]).min()
    if rule == "subadditive":
        return (values[a] + values[b] - values[a | b]).min()
    slack = values[a] + values[b] - values[a | b] - values[a & b]
    return slack.min() if rule == "submodular" else -np.abs(slack).max()


def pair_slack(f, found):
    """The slack of a witness, from values of the function."""
    a, b = set(found.a), set(found.b)
    if found.rule == "non-negative":
        return f(a)
    if found.rule == "non-decreasing":
        return f(a | b) - f(a)
    if found.rule == "subadditive":
        return f(a) + f(b) - f(a | b)
    slack = f(a) + f(b) - f(a | b) - f(a & b)
    return slack if found.rule == "submodular" else -abs(slack)


def marginals(values, x, allowed):
    """Marginals of ``x`` over the sets (masks) of ``allowed`` that stay allowed with ``x``."""
    return [values[s | 1 << x] - values[s] for s in allowed if not s >> x & 1 and (s | 1 << x) in allowed]


def allowed_sets(n, owners=None):
    """All masks, or those with at most one element per owner."""
    if owners is None:
        return set(range(2**n))
    ok = set()
    for mask in range(2**n):
        mine = [owners[e] for e in range(n) if mask >> e & 1]
        if len(mine) == len(set(mine)):
            ok.add(mask)
    return ok


def total_curvature(values, owners=None):
    """1 - min over x of smallest over largest marginal; elements that never add anything are left out."""
    n = len(values).bit_length() - 1
    allowed = allowed_sets(n, owners)
    ratios = []
    for x in range(n):
        found = marginals(values, x, allowed)
        if max(found) > 0:
            ratios.append(min(found) / max(found))
    return 1 - min(ratios) if ratios else 0.0


def curvature(values, owners=None):
    """1 - min over x of smallest marginal over own value."""
    n = len(values).bit_length() - 1
    allowed = allowed_sets(n, owners)
    ratios = [
        min(marginals(values, x, allowed)) / (values[1 << x] - values[0])
        for x in range(n)
        if values[1 << x] - values[0] > 0
    ]
    return 1 - min(ratios) if ratios else 0.0


def submodularity_ratio(values, owners=None):
    """Bian et al. 2017, Definition 1, over all disjoint pairs whose union is allowed."""
    n = len(values).bit_length() - 1
    allowed = allowed_sets(n, owners)
    best = 1.0
    for top in allowed:
        for s in allowed:
            gain = values[top] - values[s]
            if s & top == s and gain > 0:
                total = sum(values[s | 1 << w] - values[s] for w in range(n) if (top & ~s) >> w & 1)
                best = min(best, total / gain)
    return best


def generalised_curvature(values, owners=None):
    """Bian et al. 2017, Definition 2, over all nested pairs that stay allowed with the element."""
    n = len(values).bit_length() - 1
    allowed = allowed_sets(n, owners)
    worst = 0.0
    for i in range(n):
        open_sets = [s for s in allowed if not s >> i & 1 and (s | 1 << i) in allowed]
        for a in open_sets:
            early = values[a | 1 << i] - values[a]
            if early > 0:
                late = [values[b | 1 << i] - values[b] for b in open_sets if a & b == a]
                worst = max(worst, 1 - min(late) / early)
    return worst
