"""Branch and bound: open nodes by their bounds, safe against limits and interrupts.

Open ``open_nodes.py``: take a node, keep its children, say that it is done. Whatever ends the search in between, no
node is lost, and the bound holds.
"""
