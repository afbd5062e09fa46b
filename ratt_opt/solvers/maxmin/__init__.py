"""The exact max-min search: the plan of largest worst-case value, and a proof that none is better.

Open ``solve.py`` first. ``upper_ends.py`` lets the searches for the upper end take turns. One is ``descent.py``, which
searches tree after tree, and ``search.py``, the loop over the nodes of one. If robots see few targets there are
``covers/`` and ``marginals/``, too, both by ``levels/``. ``frontier.py`` holds the nodes and the closing rule,
``turns.py`` says when to stop for a proof, ``plans/`` the lower end, ``relaxed/`` and ``groups/`` the upper end,
``division.py`` what a node is divided by, ``backjumps.py`` which divisions were needless. ``task.py`` is what all
share; the tree of ``proof.py`` grows and becomes a proof.
"""
