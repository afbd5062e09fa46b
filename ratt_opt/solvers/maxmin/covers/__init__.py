"""Best plans where robots see few targets: is there a plan worth more than a level?

Open ``levels.py`` first: which levels are tried, one search each (``search.py``). What ends a search are covers
(``cover.py``): after one attack on links, so many robots must choose what the attack cannot afford to leave. The search
goes in depth (``dive.py``, and compiled ``loops/``); a linear program adds covers up (``program.py``, ``sums.py``).
``separation.py`` finds covers, ``partitions.py`` how links may be cut, ``pool.py`` holds the covers, ``records.py``
makes a proof of a search.
"""
