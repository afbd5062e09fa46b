"""Branch and bound: one loop over open nodes, safe against limits and interrupts.

Open ``branch_and_bound.py``: the calls that a search answers, and the loop that makes them. ``open_nodes.py`` keeps the
nodes. Whatever ends the search, no node is lost, and the bound holds.
"""
