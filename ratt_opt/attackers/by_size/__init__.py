"""Worst attacks on complete graphs without protected links, where outcomes differ by their sizes; bounds on others.

Open ``size_vector_search.py``: exchanges find weak families of groups (``weak_families.py``), and ``size_decision.py``
decides thresholds by vectors of group sizes, with the searches of ``attack/least_sets`` and ``attack/families``.

Other graphs are bounded by ``relaxed_teams.py``: by attackers that may cut protected links too, or may leave any groups
of sizes that are possible on the graph; ``largest_groups.py`` then rules out sets that cannot be a largest group.
"""
