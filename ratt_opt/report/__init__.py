"""Tables, figures and files from results; nothing is computed here but where ink goes.

Open ``write.py`` first: the files of a bound report. ``figure.py`` puts ``map.py`` (the team, its targets and the worst
attack, from ``picture.py``; ``fields.py`` draws what each robot looks at) beside ``bars.py`` (what each planner
keeps); ``tables.py`` is the same as text, ``notebook.py`` as a notebook shows it. ``description.py`` knows names and
places; ``main_job`` builds on all of it.
"""
