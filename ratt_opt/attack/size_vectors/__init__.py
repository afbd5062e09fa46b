"""Worst attacks on complete graphs without protected links, by the sizes of the groups that are left; bounds on others.

Open ``size_vector_search.py``: exchanges find weak families of groups (``weak_families.py``). ``decision.py`` decides
thresholds by size vectors. It packs few groups around a largest one; else ``family_search.py`` lists sets,
bounds all families of a vector by a linear program over them (``cover_bound.py``), and searches the others for
disjoint sets (``disjoint_sets.py``; its loops are C). ``stages/possible_sizes.py`` bounds attacks on graphs
that are not complete.
"""
