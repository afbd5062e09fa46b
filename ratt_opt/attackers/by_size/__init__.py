"""Worst attacks on complete graphs without protected links, where outcomes differ by their group sizes.

Open ``size_vector_search.py``: exchanges find weak families of groups (``weak_families.py``), and
``vector_search.py`` decides each vector: lists of weak sets (``low_lists.py``), a bound on families
(``cover_bound.py``), disjoint sets (``disjoint_sets.py``). Where lists are too long, ``../weakest_set`` searches the
largest group and ``packing.py`` packs the others. Graphs with protected links are bounded by those without.
"""
