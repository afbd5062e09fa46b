"""The attack engine: which values an attack can push a team down to, decided threshold by threshold.

Open ``threshold_search.py`` first: it asks thresholds of a decision, ``dual_prices`` (any network) or ``size_vectors``
(complete graphs, and bounds on others). ``all_sets.py`` decides small teams by tables, ``listed_columns.py`` networks
whose groups can be listed; ``bounds.py`` needs no search. ``pricing.py`` and ``least_sets`` answer what these ask about
one group. ``edge_cuts`` is about cuts alone: the fewest for groups of a size, the smallest size for a number of them.
``task.py`` is what all are given, ``staging.py`` runs schedules.
"""
