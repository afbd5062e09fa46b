"""Smallest and largest marginals of any information criterion, bracketed by what the criterion states of them.

Open ``marginal_brackets.py`` first: the search over all elements. ``context_search.py`` is the branch and bound for one
element of a criterion with separable minorants, ``floor_search.py`` stands in where it has none, and
``best_context.py`` is the descent that attains the other end.
"""
