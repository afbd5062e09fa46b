"""Worst attacks where all groups that one may leave can be listed: no weak ones cover the team.

Open ``cover_search.py`` first. ``listed_groups.py`` knows what the groups need blinded and cost, ``weak_sets.py`` how
many robots of some sets may see in a group worth less, ``cover_prices.py`` finds prices. Certificates use the same.
"""
