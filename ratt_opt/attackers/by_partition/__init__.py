"""Worst attacks on any graph, by partitions of the team into groups.

Open ``threshold_search.py`` first: up to twenty robots, a table of all sets decides. ``split_search.py`` is for larger
teams that an attack can split in few ways; ``settled_partitions.py`` says who may be left seeing in one group,
and ``group_floors.py`` what all groups keep at least.
"""
