"""How code runs here: loops compiled once and kept, interrupts answered, worker processes, progress told.

``kept_code.py``, ``interrupts.py`` and most of ``compiling.py`` do nothing but make up for a compiler that runs while
the user waits: once loops are compiled when the package is installed, they go.
"""
