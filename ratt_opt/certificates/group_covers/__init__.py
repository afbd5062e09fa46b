"""Proofs that no groups that an attack may leave cover the team, on any graph.

Open ``proof.py`` first. ``weak_sets.py`` says how many robots of some sets may see in a group worth less,
``cover_prices.py`` finds the prices, ``group_tree.py`` decides robot by robot who is inside a group.
"""
