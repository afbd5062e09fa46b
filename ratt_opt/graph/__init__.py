"""Attacks on a team's communication: the groups that they leave, and the smallest possible largest group.

Open ``threat.py`` first: it alone holds the graph and the budgets. ``outcomes.py`` lists what attacks leave, from the
partitions of ``connected_partitions.py`` or the sizes of ``survivor_sizes.py``; ``threshold.py`` and its compiled form
decide which values an attack can push a team to. ``group_list.py`` lists the groups that an attack may leave.
``link_scores.py`` bounds the links inside groups of each size, and ``possible_sizes.py`` says which sizes that allows.
``any_networkx.py`` makes any networkx graph one on robots ``0..N-1``.
``caa`` and the folder ``largest_group`` bound the smallest possible largest group (``n_max``), which
``attack/edge_cuts`` searches.
"""
