"""A mission for people and programs: tables, figures, an animation, a player.

Open ``write.py`` first: which files there are. ``tables.py`` has the rows of the CSV files, ``figures.py`` the curves,
``frames.py`` what one picture shows; ``animation.py`` draws it as a GIF, ``player.py`` as a page (``player.js``),
``log.py`` for the viewers of the field.
"""
