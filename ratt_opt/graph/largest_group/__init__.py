"""The smallest possible largest group (the paper's ``n_max``): how small can cut links make the largest group?

Independent ways, between which ``attack/edge_cuts/smallest.py`` chooses: ``counting.py`` (complete graphs by CAA and by
integer partitions; a bracket for any graph), and ``integer_program.py``, a check of the others whose claim proves
nothing. All return a ``LargestGroup``, whose upper end is recomputed on the graph.
"""
