"""Covers: conditions on plans that are worth more than a level (``cover.py``).

After one attack on links, some number of robots must choose what the attack cannot afford to leave. Open
``cover_search.py`` first. The search at one level (``search.py``) goes in depth (``dive.py``, and compiled
``loops/``); a linear program adds covers up (``program.py``, ``sums.py``). ``separation.py`` finds covers,
``partitions.py`` how links may be cut, ``pool.py`` holds the covers, ``records.py`` makes a proof of a search.
"""
