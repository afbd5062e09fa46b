"""``report.html``: one file to read, hover and print, with nothing fetched from anywhere.

Open ``page.py`` first: the sections in order. ``map_svg.py`` puts the figure's map into the page and adds marks that
tell who each robot and target is; ``style.css`` (light, dark, print) and ``script.js`` (the toggles) are put into the
file as they stand.
"""
