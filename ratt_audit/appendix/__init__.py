"""The paper's lines as data: what each says, for whom, and as which claims; open ``entry.py`` first, then ``roles.py``.

``entry.py`` turns chains of inequalities into entries, and ``roles.py`` names who is bait and who is greedy, and the
premises that follow. ``patterns.py`` has the appendix's chains, line by line; ``team_lines.py``,
``theorems.py`` and ``readings.py`` are what stands around them. Nothing is decided here.
"""
