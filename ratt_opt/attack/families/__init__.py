"""Families of disjoint groups of given sizes on a complete graph, each worth less than a threshold.

Open ``family_search.py`` first: it lists sets (``set_lists.py``), bounds all families of a vector of sizes by a linear
program over them (``cover_bound.py``), and searches what is left for disjoint sets (``disjoint_sets.py``; its loops are
C). ``packing.py`` packs a few groups among given robots; ``group_exchanges.py`` finds families without a claim.
"""
