"""Worst attacks on complete graphs without protected links, where outcomes differ by their group sizes.

Open ``size_vector_search.py``: exchanges find weak families of groups (``group_exchanges.py``), and ``vector_search.py``
decides each vector of sizes: lists of weak sets (``low_lists.py``), a bound on all families (``cover_bound.py``), a
search for disjoint sets (``disjoint_sets.py``). Where lists are too long, the largest group is searched by
``../weakest_set`` and ``packing.py`` packs the others. Graphs with protected links are bounded by those without.
"""
