"""Which group of an outcome bounds the team value: the best one's value is not concave, a single group's is.

Open ``winners.py`` first: groups that provably stay weak leave one winner. it also divides a node if no winner is
known. ``closed_group.py`` finds such proofs, remembers them and writes them into the tree. ``pair_outcomes.py`` is a
shortcut if pairs decide, ``small_groups.py`` one if groups are small enough to be listed.
"""
