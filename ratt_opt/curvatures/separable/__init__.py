"""Smallest and largest marginals of any information criterion, bracketed by what the criterion states of them.

Open ``marginal_brackets.py`` first: the search over all elements. ``context_search.py`` is the one for one element:
branch and bound if the criterion has separable minorants, and descent to contexts that attain the other end.
"""
