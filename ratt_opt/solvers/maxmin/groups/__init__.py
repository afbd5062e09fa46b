"""Which group of an outcome bounds the team value: the best one's value is not concave, a single group's is.

Open ``winners.py`` first: groups that provably stay weak leave one winner. It also divides a node if no winner is
known. ``closed_group.py`` finds such proofs, remembers them and writes them into the tree. ``small_groups.py`` is
a shortcut if groups are small enough to be listed.
"""
