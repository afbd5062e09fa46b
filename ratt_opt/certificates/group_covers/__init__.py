"""Proofs that no groups that an attack may leave cover the team, on any graph.

Open ``all_groups.py`` first, where all these groups are listed; ``proof.py`` is for larger teams, with a tree over the
robots inside a group (``group_tree.py``). ``weak_sets.py`` says how many robots of some sets may see in a group worth
less, ``cover_prices.py`` finds the prices.
"""
