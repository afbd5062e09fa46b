"""The exact max-min search: the plan of largest worst-case value, and a proof that none is better.

Open ``solve.py`` first. ``both_searches.py`` lets two searches for the upper end take turns. One is ``covers/``, where
robots see few targets. The other is ``descent.py``, which searches tree after tree, and ``search.py``, the loop over
the nodes of one. ``frontier.py`` holds the nodes and the closing rule, ``turns.py`` says when to stop for a proof,
``plans/`` the lower end, ``relaxed/`` and ``groups/`` the upper end, ``division.py`` what a node is divided by,
``backjumps.py`` which divisions were needless. ``task.py`` is what all share; the tree of ``proof.py`` grows and
becomes a proof.
"""
