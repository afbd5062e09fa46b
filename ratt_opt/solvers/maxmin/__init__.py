"""The exact max-min search: the plan of largest worst-case value, and a proof that none is better.

Open ``solve.py`` first, then ``search.py``: the loop over nodes. ``frontier.py`` holds the nodes and the closing
rule, ``plans/`` the lower end, ``relaxed/`` and ``groups/`` the upper end, ``division.py`` what
a node is divided by. ``task.py`` is what all share; the tree of ``proof.py`` grows and becomes a proof.
"""
