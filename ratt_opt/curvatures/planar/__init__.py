"""Smallest and largest marginals of the max-eigenvalue criterion of targets with at most two coordinates, bracketed.

Open ``marginal_brackets.py`` first: the search over all elements. ``context_search.py`` is the branch and bound for one
of them, over the ``regions.py`` of its contexts; ``level_program.py`` bounds a region by a linear program and
``inequalities.py`` says what that leaves of a marginal. ``contexts.py`` has what contexts consist of and the
descent that attains the other end; the inner loops are in ``native/src/contexts.c``.
"""
