"""Sets of one size bounded target by target: every target chooses a set of its own.

Open ``decomposition.py`` first. Shares of robots make the choices agree (``target_choices.py``); what a target's best
choice is worth at least is proved cell by cell (``slope_cells.py``, ``cell_bound.py``), beginning with the cells of the
last proof (``slope_meshes.py``).
"""
