"""Worst attacks on any graph, by partitions of the team into groups.

Open ``split_search.py`` first: it is for teams that an attack can split in few ways. ``settled_partitions.py`` says who
may be left seeing in one group, and ``group_floors.py`` what all groups keep at least.
"""
