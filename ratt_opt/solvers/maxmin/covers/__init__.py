"""Covers: conditions on plans that are worth more than a level (``cover.py``).

After one attack on links, some number of robots must choose what the attack cannot afford to leave. Open
``cover_search.py`` first. The search at one level (``search.py``) goes in depth (``dive.py``, on ``tables.py``); a
linear program adds covers up (``program.py``, ``sums.py``). ``separation.py`` finds covers by what ``choices.py``
keeps, ``partitions.py`` how links may be cut, ``pool.py`` holds the covers, ``records.py`` makes a proof of a search.

Compiled, in ``native/src``: ``elements.c`` what elements tell, ``keeping.c`` what an attack can leave,
``cover_attacks.c`` attacks on all plans of a frame, ``cover_dive.c`` the search in depth.
"""
