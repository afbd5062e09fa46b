"""Instances: four forms of a problem, their files, and a folder of them with the table of records.

Open ``instance.py`` first; ``forms.py`` has the forms that are no matrices, ``library.py`` the folder, and
``published.py`` finds it by name.
"""
