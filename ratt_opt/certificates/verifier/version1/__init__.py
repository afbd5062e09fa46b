"""Format 1 of certificates, as it was verified when format 2 came: kept for one release, and not changed any more.

Its lower ends have six kinds, one a file; ``lower.py`` says which is meant. Trees over sizes or attacks
(``size_tree.py``, ``forced_size.py``); prices that no group below the claim pays (``group_prices.py``); prices with
slack, and no partition into the groups that nearly pay (``all_groups.py``, and ``group_covers.py`` with a tree that
leaves most groups out, with ``group_costs.py`` and ``partitions.py``); sizes of the groups that an attack can leave
(``group_sizes.py`` with ``largest_groups.py`` and ``link_scores.py``). Upper ends differ in names alone
(``upper.py``).
"""

from ratt_opt.certificates.verifier.version1.lower import LowerCheck
from ratt_opt.certificates.verifier.version1.upper import upper_of

__all__ = ["LowerCheck", "upper_of"]
