"""``report.html``: one file to read, hover and print, with nothing fetched from anywhere.

Open ``page.py`` first: the sections in order. ``map_drawing.py`` draws the map, whose robots and targets tell who
they are; ``style.css`` (light, dark, print) and ``script.js`` (the toggles) are put into the file as they stand.
"""
