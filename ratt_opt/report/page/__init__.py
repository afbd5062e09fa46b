"""``report.html``: one file to read, hover and print, with nothing fetched from anywhere.

Open ``page.py`` first: the sections in order. ``map_drawing.py`` draws the map, whose robots and targets tell who
they are. It is not the map of the figure: two sizes of three maps by matplotlib would take 0.8 s and 370 kB, not 0.01 s
and 60 kB (six robots), without a dark look, and no key would reach a robot. ``style.css`` (light, dark, print) and
``script.js`` (the toggles) are put into the file as they stand.
"""
