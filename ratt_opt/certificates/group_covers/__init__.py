"""Proofs that no groups that an attack may leave cover the team, on any graph.

Open ``all_groups.py`` first, where all these groups are listed; ``proof.py`` is for larger teams, with a tree over the
robots inside a group (``group_tree.py``). ``covers.py`` is what both share; prices and weak sets are the attacker's
(``attackers/by_covers``).
"""
