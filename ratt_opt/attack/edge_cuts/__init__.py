"""Edge cuts: the least weight of links for groups of a size, and the smallest size that a number of links leaves.

Open ``fewest.py`` first, then ``cut_search.py``: groups that keep much come by column generation (``program.py``), their
prices are proved by ``kept_links.py``, and what prices leave open by partitions into listed groups (``listed.py``).
``elimination.py`` decides sparse networks and few cuts by dynamic programming, whatever their number of robots.
``smallest.py`` asks the same search for one size after the other; ``network.py`` is what all are given.
"""
