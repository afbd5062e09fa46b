"""The relaxed plans of a node and the cuts that bound them: the upper end of the search.

Open ``cut_rounds.py`` first: it adds cuts that a relaxed plan violates. ``CutStore`` keeps all cuts of a search
as arrays and derives every bound from them; ``node_program.py`` is the linear program, of which only the
multipliers are used.
"""
