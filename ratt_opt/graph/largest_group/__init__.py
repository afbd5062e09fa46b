"""The smallest possible largest group (the paper's ``n_max``): how small can cut links make the largest group?

Open ``smallest.py`` first: it chooses between the independent ways, one file each: ``complete.py`` (CAA and integer
partitions), ``enumeration.py`` (partitions into connected groups), ``integer_program.py``, and ``counting.py`` (a
bracket for any size). All return the record of ``result.py``, whose upper end is recomputed on the graph.
"""
