"""Which group of an outcome bounds the team value: the best one's value is not concave, a single group's is.

Open ``winners.py`` first: groups that provably stay weak leave one winner. ``closed_group.py`` is such a proof,
``group_proofs.py`` remembers them and writes them into the tree, and ``winner_division.py`` divides a node where no
winner is known. ``pair_outcomes.py``, on the table ``pair_values.py``, is a shortcut where pairs decide.
"""
