"""The smallest possible largest group (the paper's ``n_max``): how small can cut links make the largest group?

Open ``smallest.py`` first: it chooses between independent ways: ``counting.py`` (complete graphs by CAA and by integer
partitions; a bracket for any graph), ``bridges.py`` (graphs that are hardly more than trees), ``integer_program.py``,
and partitions into connected groups, which it enumerates itself. All return a ``LargestGroup``, whose upper end is
recomputed on the graph.
"""
