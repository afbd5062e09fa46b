"""Whole instances of refuted lines: RATT's plan, an optimal plan and a worst attack; open ``search.py`` first.

``teams.py`` completes the group that a line speaks of to a team with budgets and an attack; ``requirements.py`` says
when that attack is a worst one and the compared plan optimal; ``search.py`` decides the line among teams that meet
them; ``replay.py`` re-checks what was found with the library's exact attack and exhaustive optimum. ``recorded.py``
re-checks the instances of an earlier search, which are in ``recorded.json``.
"""
