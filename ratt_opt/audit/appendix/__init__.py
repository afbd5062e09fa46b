"""The paper's lines as data: what each says, for whom, and as which claims; open ``entry.py`` first, then ``chain.py``.

``roles.py`` names who is bait and who is greedy, and the premises that follow. ``pattern1.py``, ``pattern2.py`` and
``submodular.py`` are the appendix's chains of inequalities, line by line; ``team_lines.py``, ``theorems.py``,
``lemmas.py`` and ``readings.py`` are what stands around them. Nothing is decided here.
"""
