"""Parameters of searches on communication graphs: one frozen class for each algorithm.

They decide how soon a cut or a bound is found, never whether it holds.
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["CutAnnealingParams", "TreeParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class CutAnnealingParams:
    """Annealing of the links that are cut for groups of a size.

    ``hot``, ``cold`` : first and last temperature [links]
    ``oversize`` : price of a robot too many in a group, at least [links]; a robot's mean number of links and half as
    many again, if that is more: with a lower price groups stay too large on graphs of many links
    ``moves`` : for each robot in a cooling; more find rarer cuts, and take longer
    ``moves_at_once`` : between two looks at the budget
    ``misses`` : sizes in a row that are not met before annealing gives up
    ``spare_groups`` : groups beyond the fewest that hold all robots, one cooling each, in shares of these; teams of 200
    robots on sparse graphs need a third or more
    """

    hot: float = 3.0
    cold: float = 0.15
    oversize: float = 2.0
    moves: int = 1_500
    moves_at_once: int = 20_000
    misses: int = 4
    spare_groups: tuple[float, ...] = (0.0, 0.05, 0.15, 0.3, 0.6, 1.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class TreeParams:
    """Linear program of tree inequalities.

    ``towards_program`` : point at which trees are separated, from the best one that keeps all inequalities (0) to the
    program's own (1); at 1 the program needs several times as many rounds
    ``slack`` : trees that the program's point violates by less are not added [robots]
    ``most_trees`` : in a program, at most; more raise the bound of dense graphs, and take minutes there
    ``soon`` : trees times links at which the bound of a brief search ends
    ``largest_soon`` : robots times links up to which a brief search computes it
    """

    towards_program: float = 0.2
    slack: float = 1e-4
    most_trees: int = 6_000
    soon: int = 250_000
    largest_soon: int = 3_000_000
