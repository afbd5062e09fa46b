"""Worst attacks on complete graphs without protected links, where outcomes differ by their sizes; bounds on others.

Open ``size_vector_search.py``: exchanges find weak families of groups (``weak_families.py``), and
``vector_search.py`` decides each vector: lists of weak sets (``low_lists.py``), a bound on families
(``cover_bound.py``), disjoint sets (``disjoint_sets.py``). Where lists are too long, ``largest_first.py`` searches the
largest group and ``packing.py`` packs the others.
Where vectors are too many, families of all of them are annealed (``annealed_families.py``). There, and where several
groups are about equally good, ``family_prices/`` bounds all families at once.

Other graphs are bounded by ``relaxed_teams.py``: by attackers that may cut protected links too, or may leave any groups
of sizes that are possible on the graph; ``largest_groups.py`` then rules out sets that cannot be a largest group.
"""
