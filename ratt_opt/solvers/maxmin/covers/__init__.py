"""Best plans by covers: conditions on plans that are worth more than a level (``pool.py``).

After one attack on links, some number of robots must choose what the attack cannot afford to leave.
Open ``cover_search.py`` first: at one level after the other it searches in depth (``dive.py``), and a linear program
adds covers up.
``separation.py`` finds covers, by ways to cut links and by what elements can be kept (``choices.py``).

Compiled, in ``native/src``: ``elements.c`` what elements tell, ``keeping.c`` what an attack can leave,
``cover_attacks.c`` attacks on all plans of a frame, ``cover_dive.c`` the search in depth.
"""
